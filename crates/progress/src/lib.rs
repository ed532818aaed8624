//! Progress, time budgets and cancelling: one of each for all stages.
//!
//! A stage reports through a [`Watcher`] and asks it whether to stop. A [`ProgressScope`] is a
//! watcher that adds a time budget; its shares are the budgets of single stages. Front ends draw, and
//! read off an [`Estimate`] how long the whole run will still take. To those who want to see it, a run shows
//! [`Snapshot`]s of what it has.
//!
//! Stages take a `&dyn Watcher`, and all that wraps one holds one: a generic stage would be compiled once more for each
//! wrapper around it, which doubled the time that the crate `parbake` took to compile.

mod clock;
mod estimate;
mod message;
mod muted;
mod portion;
mod scope;
mod showing;
mod snapshot;
mod stage;

pub use clock::{Clock, StageTime};
pub use estimate::Estimate;
pub use message::{Message, Watcher};
pub use muted::{Muted, WithoutWarnings};
pub use portion::Portion;
pub use scope::ProgressScope;
pub use showing::Showing;
pub use snapshot::{MOST_TEXELS, PackedParallax, Snapshot};
pub use stage::Stage;
