//! Compares drafts of a level by their pictures.
//!
//! Contract: figures are of models as viewers show them, against the original, before anything is compressed.

use super::candidate::Candidate;
use super::maker::{Draft, Maker};
use crate::copies::Copies;
use crate::error::BakeError;
use parbake_evaluate::screen_size::Pictures;
use parbake_levels::face_frames::with_face_tangents;
use parbake_model::{Mesh, Model};

/// Pixels that a model spans at most in the larger ones of the pictures that are compared.
const LARGEST: f64 = 300.0;

/// A level, and what its pictures say.
pub(crate) type Tried = (Draft, Candidate);

/// Compares ways by their pictures.
pub(crate) struct PictureScore<'m> {
    maker: &'m Maker<'m>,
    /// The original at the level's size, and where that is small at twice that: a level is seen from closer, too.
    pictures: Vec<Pictures>,
}

impl<'m> PictureScore<'m> {
    /// For a level of so many pixels.
    pub(crate) fn new(maker: &'m Maker<'m>, pixels: f64) -> Result<Self, BakeError> {
        let sizes = [pixels, (2.0 * pixels).min(LARGEST)];
        let sizes = sizes.into_iter().enumerate().filter(|&(k, size)| k == 0 || size > pixels);
        let pictures = sizes.map(|(_, size)| maker.screens.pictures(&maker.original, size));
        Ok(Self { maker, pictures: pictures.collect::<Result<_, _>>()? })
    }

    /// PSNR in dB, the mean over the sizes.
    pub(crate) fn psnr(&self, model: &Model) -> Result<f64, BakeError> {
        let screens = &self.maker.screens;
        let placed = screens.place(&with_face_tangents(model))?;
        let sum: f64 = self.pictures.iter().map(|pictures| screens.psnr(pictures, &placed)).sum();
        Ok(sum / self.pictures.len() as f64)
    }

    /// Judges copies of the model by the same pictures; `finish` makes a model of a mesh.
    pub(crate) fn copies<Finish: FnMut(Mesh) -> Model>(&self, finish: Finish) -> Copies<'_, Finish> {
        Copies::new(&self.maker.screens, &self.pictures, finish)
    }

    /// A draft with its figure.
    pub(crate) fn tried(&self, draft: Draft) -> Result<Tried, BakeError> {
        let psnr = self.psnr(&draft.baked.model)?;
        let candidate = draft.candidate(psnr);
        Ok((draft, candidate))
    }
}
