//! Parts of glTF that are only counted.

use serde::Deserialize;

/// Something that is only counted.
#[derive(Debug, Deserialize)]
pub(super) struct Ignored {}
