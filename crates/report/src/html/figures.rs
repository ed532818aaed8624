//! How close the textures come to the high-poly, in numbers, before and after.

use parbake::{BakeError, Baked, Comparison, Detail, Message, Shading, Watcher, compare_bake};
use parbake_model::Model;

/// The comparison of a bake with FLIP and with channels: the one that was made already, or one made now. `tick` is called
/// after each view.
pub fn compared(high: &Model, baked: &Baked, tick: impl Fn() + Sync) -> Result<Comparison, BakeError> {
    let is_whole = |made: &&Comparison| {
        !made.options.no_flip && (made.shading != Shading::Pbr || !made.channels.is_empty())
    };
    match baked.report.comparison.as_ref().filter(is_whole) {
        Some(made) => {
            made.backgrounds.first().iter().flat_map(|first| &first.views).for_each(|_| tick());
            Ok(made.clone())
        }
        None => compare_bake(high, baked, Detail { flip: true, channels: true }, &Ticks(tick)),
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
