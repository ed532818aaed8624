//! Charts of reports: lines over a continuous axis, violins and bars in groups.
//!
//! | file | what it draws |
//! |---|---|
//! | `lines.rs` | how values go on: a loss over its steps |
//! | `violins.rs` | how values spread: differences over models, a violin for each method |
//! | `bars.rs` | how large values are, beside those that a paper states |
//! | `scatter.rs` | which of many pairs of values is best: bytes against decibels |
//! | `scale.rs` | an axis and its round ticks |
//! | `places.rs` | an axis of groups and their names |
//! | `frame.rs` | grid, titles, where values stand |
//! | `looks.rs` | colours, marks, dashes, the legend |
//!
//! Contract: each chart is one `<svg class="chart">` and its `<ul class="legend">`. Names and
//! titles may be any text. Whatever the values, coordinates are finite and numbers readable;
//! the same chart gives the same bytes. Its `title` is not drawn: it names the chart for those
//! who do not see it, and a heading or a caption has to for the others.

mod bars;
mod frame;
mod lines;
mod looks;
mod places;
mod scale;
mod scatter;
mod violins;

pub use bars::{Bar, BarChart, BarGroup};
pub use lines::{LineChart, Series};
pub use scatter::{ScatterChart, ScatterPoint};
pub use violins::{Violin, ViolinChart, ViolinGroup};
