//! A wall around other people's decoders.
//!
//! Draco, Basis Universal and picture decoders read bytes that strangers made. They promise
//! errors, not panics, but none is proved: an index that is out of range in one of them must
//! end in an error about the file, not in the end of the program.
//!
//! Contract: [`guarded`] gives `None` where the work panics, and nothing is printed. What the
//! work had borrowed mutably must not be used after that.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// How many guards this thread is inside.
    static INSIDE: Cell<u32> = const { Cell::new(0) };
}

/// Runs `work`; `None` where it panics.
pub(crate) fn guarded<T>(work: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    // The default hook prints "thread panicked at …" before anybody can catch it. Panics that are
    // not inside a guard go on to the hook that was there.
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |info| {
            if INSIDE.get() == 0 {
                before(info);
            }
        }));
    });
    INSIDE.set(INSIDE.get() + 1);
    let result = catch_unwind(AssertUnwindSafe(work));
    INSIDE.set(INSIDE.get() - 1);
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the program from a decoder's panic, and the count that silences its message.
    #[test]
    fn panics_end_at_the_guard() {
        assert_eq!(guarded(|| 7), Some(7));
        let empty: Vec<u8> = Vec::new();
        assert_eq!(guarded(|| empty[std::hint::black_box(3)]), None);
        assert_eq!(INSIDE.get(), 0);
    }
}
