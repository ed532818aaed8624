//! How much worse or better layouts show a surface than the one that was given.

use super::errors;
use crate::optimise::Problem;
use parbake_atlas::{Layout, check};
use parbake_model::Mesh;

/// The given layout, and what others are compared by.
pub struct LayoutScore<'a> {
    /// The mesh with the given coordinates.
    pub mesh: &'a Mesh,
    /// The layout that was given.
    pub start: &'a Layout,
    /// What it shall show.
    pub problem: &'a Problem<'a>,
    /// Whether it is a model's own: then textures are judged at all their mip levels. A low-poly's is
    /// fitted to views, which reads its first level alone.
    pub own: bool,
    /// The gutter in texels that a layout must have, where one was asked for.
    pub gutter: Option<f64>,
    /// The given layout's error by scale: at full size, half and so on.
    pub kept: Vec<f64>,
}

impl<'a> LayoutScore<'a> {
    /// A judge by the given layout.
    pub fn new(
        mesh: &'a Mesh,
        start: &'a Layout,
        problem: &'a Problem<'a>,
        own: bool,
        gutter: Option<f64>,
    ) -> Self {
        Self { mesh, start, problem, own, gutter, kept: errors(problem, start, own) }
    }

    /// The proof that a layout may be written: one to one, with the gutter that was asked for.
    pub fn is_sound(&self, layout: &Layout) -> bool {
        let found = check(layout, self.problem.contact.texture_size as usize);
        let is_wide = |least: f64| found.gutter.as_ref().is_none_or(|own| own.texels >= least);
        found.is_bijective() && self.gutter.is_none_or(is_wide)
    }

    /// Errors as shares of those of the given layout; `problem` is its own, or the same on pieces of its
    /// triangles.
    pub fn relative(&self, problem: &Problem, layout: &Layout) -> Vec<f64> {
        let errors = errors(problem, layout, self.own);
        errors.iter().zip(&self.kept).map(|(a, b)| a / b.max(1e-12)).collect()
    }
}
