//! What a film is wound on: any format that takes frames in turn.

use super::sheet::Sheet;
use std::io;

/// A file that is being written.
pub(super) trait Reel: Send {
    /// Appends a frame; all have one size.
    ///
    /// # Errors
    /// What the writer behind it says.
    fn add(&mut self, sheet: Sheet) -> io::Result<()>;

    /// Writes what comes after the last frame.
    ///
    /// # Errors
    /// What the writer behind it says.
    fn finish(self: Box<Self>) -> io::Result<()>;
}
