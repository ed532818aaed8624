//! What every reader gives: a model, and what there is to say of its files.

use crate::{Contents, PictureFiles, Warning};
use parbake_model::Model;

/// A model, and what is odd about its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// Keeps the model's contract; has at least one triangle, and every triangle an area.
    pub model: Model,
    /// One sentence each, to show to people; where a file was read, each begins with the file's name.
    pub warnings: Vec<Warning>,
    /// Bytes of its file and of all others that were read for it.
    pub bytes: u64,
    /// What those files hold that the model does not tell.
    pub contents: Contents,
    /// The files of its pictures, where they were asked for ([`crate::read_model_with_pictures`]).
    pub pictures: PictureFiles,
}
