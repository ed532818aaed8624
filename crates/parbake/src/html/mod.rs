//! The HTML report of a bake.

use crate::bake::Baked;
use crate::error::BakeError;
use crate::message::Watcher;
use parbake_model::Model;

/// A self-contained page.
pub fn html_report(high: &Model, baked: &Baked, watcher: &impl Watcher) -> Result<String, BakeError> {
    let _ = (high, baked, watcher);
    Ok(String::new())
}
