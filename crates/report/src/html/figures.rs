//! How close the textures come to the high-poly, in numbers, before and after.

use parbake::{BakeError, Baked, Comparison, Detail, Message, Shading, Watcher, compare_bake};
use parbake_model::Model;

/// The comparison of a bake with MS-SSIM, FLIP and channels: the one that was made already, or one made now. `tick` is called
/// after each view.
pub fn compared(high: &Model, baked: &Baked, tick: impl Fn() + Sync) -> Result<Comparison, BakeError> {
    let is_whole = |made: &&Comparison| {
        let has_ms_ssim = made.backgrounds.iter().all(|on| on.mean.baked.ms_ssim.is_some());
        let has_channels = made.shading != Shading::Pbr || !made.channels.is_empty();
        has_ms_ssim && !made.options.no_flip && has_channels
    };
    match baked.report.comparison.as_ref().filter(is_whole) {
        Some(made) => {
            made.backgrounds.first().iter().flat_map(|first| &first.views).for_each(|_| tick());
            Ok(made.clone())
        }
        None => compare_bake(high, baked, Detail::ALL, &Ticks(tick)),
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
