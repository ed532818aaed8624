//! Compares drafts of a level by their pictures.
//!
//! Contract: figures are of models as viewers show them, against the original, before anything is compressed.

use super::candidate::{Candidate, Shown};
use super::maker::{Draft, Maker};
use crate::copies::Copies;
use crate::error::BakeError;
use parbake_evaluate::renderer::PlacedModel;
use parbake_evaluate::screen_size::Pictures;
use parbake_levels::face_frames::with_face_tangents;
use parbake_model::{Mesh, Model};

/// Pixels that a model spans in pictures close up, the largest that are compared where a level is smaller.
const CLOSE_UP: f64 = 300.0;

/// A level, and what its pictures say.
pub(crate) type Tried = (Draft, Candidate);

/// Compares ways by their pictures.
pub(crate) struct PictureScore<'m> {
    maker: &'m Maker<'m>,
    /// The original at the level's size, and where that is small at twice that: a level is seen from closer, too.
    pictures: Vec<Pictures>,
    /// The original close up, where it is larger there: what maps have to hold up to.
    close_up: Option<Pictures>,
}

impl<'m> PictureScore<'m> {
    /// For a level of so many pixels.
    pub(crate) fn new(maker: &'m Maker<'m>, pixels: f64) -> Result<Self, BakeError> {
        let sizes = [pixels, (2.0 * pixels).min(CLOSE_UP)];
        let sizes = sizes.into_iter().enumerate().filter(|&(k, size)| k == 0 || size > pixels);
        let taken = |size| maker.screens.pictures(&maker.original, size);
        let pictures = sizes.map(|(_, size)| taken(size)).collect::<Result<_, _>>()?;
        let close_up = (2.0 * pixels < CLOSE_UP).then(|| taken(CLOSE_UP)).transpose()?;
        Ok(Self { maker, pictures, close_up })
    }

    /// PSNR in dB from some of the directions, the mean over the sizes: enough to compare maps of one surface.
    pub(crate) fn psnr_of_some(&self, model: &Model) -> Result<f64, BakeError> {
        let placed = self.maker.screens.place(&with_face_tangents(model))?;
        let psnr = |pictures| self.maker.screens.psnr_of_some(pictures, &placed);
        Ok(self.pictures.iter().map(psnr).sum::<f64>() / self.pictures.len() as f64)
    }

    fn mean(&self, model: &PlacedModel) -> f64 {
        let psnr = |pictures| self.maker.screens.psnr(pictures, model);
        self.pictures.iter().map(psnr).sum::<f64>() / self.pictures.len() as f64
    }

    /// PSNR in dB of all pictures, the mean over the sizes, and close up.
    pub(crate) fn shown(&self, model: &Model) -> Result<Shown, BakeError> {
        let placed = self.maker.screens.place(&with_face_tangents(model))?;
        let close_up = self.close_up.as_ref().map(|pictures| self.maker.screens.psnr(pictures, &placed));
        Ok(Shown { psnr: self.mean(&placed), close_up })
    }

    /// Judges copies of the model by the same pictures; `finish` makes a model of a mesh.
    pub(crate) fn copies<Finish: FnMut(Mesh) -> Model>(&self, finish: Finish) -> Copies<'_, Finish> {
        Copies::new(&self.maker.screens, &self.pictures, finish)
    }

    /// A draft with its figure.
    pub(crate) fn tried(&self, draft: Draft) -> Result<Tried, BakeError> {
        let shown = self.shown(&draft.baked.model)?;
        let candidate = draft.candidate(shown);
        Ok((draft, candidate))
    }
}
