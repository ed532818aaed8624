//! Progress, time budgets and cancelling: one of each for all stages.
//!
//! A stage reports through a [`Watcher`] and asks it whether to stop. A [`ProgressScope`] is a
//! watcher that adds a time budget; its shares are the budgets of single stages. Front ends draw, and
//! read off an [`Estimate`] how long the whole run will still take.

mod clock;
mod estimate;
mod message;
mod portion;
mod scope;
mod stage;

pub use clock::{Clock, StageTime};
pub use estimate::Estimate;
pub use message::{Message, Watcher};
pub use portion::Portion;
pub use scope::ProgressScope;
pub use stage::Stage;
