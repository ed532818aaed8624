//! Judges coarser copies of a model by their pictures, for collapses of edges (`levels/collapses.rs`).
//!
//! Contract: figures are those of [`ScreenComparison`], the mean over all sets of pictures.

use parbake_evaluate::EvaluateError;
use parbake_evaluate::differences::{Difference, Differences};
use parbake_evaluate::renderer::PlacedModel;
use parbake_evaluate::screen_size::{Compared, Pictures, ScreenComparison};
use parbake_levels::collapses::Judge;
use parbake_levels::face_frames::with_face_tangents;
use parbake_levels::missed::Lost;
use parbake_model::{Mesh, Model};

/// Compares copies with pictures of the original.
pub(crate) struct Copies<'p, Finish> {
    screens: &'p ScreenComparison,
    pictures: &'p [Pictures],
    /// Makes a model of a copy; all have the same materials and images.
    finish: Finish,
    /// The first copy, as long as others are judged: its textures are those of all.
    first: Option<PlacedModel>,
    /// For each set of pictures, once they are asked for.
    differences: Vec<Differences<'p>>,
}

/// The mesh of a finished copy, and how it compares with each set of pictures.
pub(crate) struct Copy {
    pub mesh: Mesh,
    compared: Vec<Compared>,
}

impl<'p, Finish: FnMut(Mesh) -> Model> Copies<'p, Finish> {
    /// `finish` makes a model of a copy, always with the same materials and images, and is called once for each that is judged.
    pub fn new(screens: &'p ScreenComparison, pictures: &'p [Pictures], finish: Finish) -> Self {
        Self { screens, pictures, finish, first: None, differences: Vec::new() }
    }
}

impl<Finish: FnMut(Mesh) -> Model> Judge for Copies<'_, Finish> {
    type Made = Copy;
    type Error = EvaluateError;

    fn judged(&mut self, copy: Mesh) -> Result<(Copy, f64), EvaluateError> {
        let model = (self.finish)(copy);
        let placed = {
            let shown = with_face_tangents(&model);
            match &self.first {
                Some(first) => self.screens.place_like(&shown, first)?,
                None => self.screens.place(&shown)?,
            }
        };
        let compare = |pictures: &Pictures| self.screens.compared(pictures, &placed);
        let compared: Vec<Compared> = self.pictures.iter().map(compare).collect();
        let psnr = compared.iter().map(|own| own.psnr).sum::<f64>() / compared.len() as f64;
        self.first.get_or_insert(placed);
        Ok((Copy { mesh: model.mesh, compared }, psnr))
    }

    fn lost(&mut self, made: &Copy, finer: &Mesh) -> Vec<Lost> {
        if self.differences.is_empty() {
            self.differences = self.pictures.iter().map(|own| Differences::new(own, finer)).collect();
        }
        let lost = |Difference { of_copy, of_surface, error }| Lost { of_copy, of_finer: of_surface, error };
        (self.differences.iter().zip(&made.compared))
            .flat_map(|(differences, compared)| differences.of(&made.mesh, compared))
            .map(lost)
            .collect()
    }

    fn mesh(made: &Copy) -> &Mesh {
        &made.mesh
    }
}
