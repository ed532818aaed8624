//! How many threads work: the result is the same for any number.

use crate::error::BakeError;

/// Runs `work` on a pool of this many threads; 0 for one a core.
pub fn with_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> Result<R, BakeError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|source| BakeError::Threads { threads, source })?;
    Ok(pool.install(work))
}

/// Runs both at once.
pub fn join<A: Send, B: Send>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(first, second)
}
