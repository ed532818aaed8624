//! How close the textures come to the high-poly, in numbers, before and after.

use parbake::{BakeError, Baked, Comparison, Message, Watcher, compare_bake};
use parbake_model::Model;

/// The comparison of a bake with FLIP: the one that was made already, or one made now. `tick` is called
/// after each view.
pub fn compared(high: &Model, baked: &Baked, tick: impl Fn() + Sync) -> Result<Comparison, BakeError> {
    match baked.report.comparison.as_ref().filter(|made| !made.options.no_flip) {
        Some(made) => {
            made.backgrounds.first().iter().flat_map(|first| &first.views).for_each(|_| tick());
            Ok(made.clone())
        }
        None => compare_bake(high, baked, true, &Ticks(tick)),
    }
}

/// Counts views only.
struct Ticks<F>(F);

impl<F: Fn() + Sync> Watcher for Ticks<F> {
    fn message(&self, message: Message) {
        if let Message::Progress { .. } = message {
            (self.0)();
        }
    }
}
