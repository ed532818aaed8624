//! A model for pictures as viewers make them: how glass is drawn, and tangents that a file lacks.

use crate::face_frames::with_face_tangents;
use crate::see_through::with_blending;
use parbake_model::Model;
use std::borrow::Cow;

/// A model for pictures as viewers make them.
pub fn as_viewers_do(model: &Model) -> Cow<'_, Model> {
    with_face_tangents(with_blending(model))
}
