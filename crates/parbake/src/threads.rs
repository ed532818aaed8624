//! How many threads work: the result is the same for any number.

use crate::error::BakeError;

/// More threads than any machine has cores would only take memory.
pub const MOST_THREADS: usize = 256;

/// Bytes of each thread's stack. A thread that waits takes up other work, whose frames lie on those of its own.
const STACK: usize = 8 << 20;

/// Runs `work` on a pool of this many threads, at most 256; 0 for one a core.
pub fn with_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> Result<R, BakeError> {
    if threads > MOST_THREADS {
        return Err(BakeError::Option {
            option: "threads",
            value: threads.to_string(),
            range: format!("0 to {MOST_THREADS}"),
        });
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK)
        .build()
        .map_err(|source| BakeError::Threads { threads, source })?;
    Ok(pool.install(work))
}

/// Runs both at once.
pub fn join<A: Send, B: Send>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(first, second)
}
