//! Which triangles of high-poly and low-poly belong together by their alpha: what is opaque, what is
//! cut out and what is blended are fitted as layers of their own, so that a pane shows what is behind
//! it and what is behind it does not show the pane.
//!
//! Contract: every triangle of the low-poly is in one layer; layers without triangles of the low-poly
//! are left out.

use crate::high_poly::HighPoly;
use parbake_image::material_maps::fitted_alpha;
use parbake_model::AlphaMode;
use parbake_model::glam::Vec3;
use parbake_model::{Mesh, Model};
use parbake_render::interpolate::interpolate;
use rayon::prelude::*;

/// The triangles of one alpha mode, by their indices in either mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct AlphaLayer {
    /// How alpha is to be understood.
    pub mode: AlphaMode,
    /// The high-poly's.
    pub high: Vec<u32>,
    /// The low-poly's.
    pub low: Vec<u32>,
}

/// The alpha modes in the order in which they are drawn.
const MODES: [AlphaMode; 3] = [AlphaMode::Opaque, AlphaMode::Mask, AlphaMode::Blend];

/// Barycentrics at which a triangle asks what it stands for.
const ASKED: [[f32; 3]; 4] = [[1.0 / 3.0; 3], [0.6, 0.2, 0.2], [0.2, 0.6, 0.2], [0.2, 0.2, 0.6]];

/// The alpha mode of each of the low-poly's triangles: as its own materials say, if `delivered` has any
/// that is not opaque and as many triangles as `low`; else, or where it is opaque and the high-poly has glass,
/// as most of the high-poly says where the
/// triangle looks along its normals. `low` is in the common frame.
pub fn alpha_modes(low: &Mesh, delivered: &Model, high: &HighPoly) -> Vec<AlphaMode> {
    let scene = &high.scene;
    let count = low.triangles.len();
    if scene.mesh().triangle_materials.is_empty() || !scene.has_alpha() {
        return vec![AlphaMode::Opaque; count];
    }
    let is_told = delivered.materials.iter().any(|m| fitted_alpha(m).0 != AlphaMode::Opaque);
    let told = |triangle: usize| {
        let material = *delivered.mesh.triangle_materials.get(triangle)?;
        let mode = fitted_alpha(delivered.materials.get(material as usize)?).0;
        // Files of low-polys often say nothing of light that passes: such glass is told opaque.
        let is_sure = mode != AlphaMode::Opaque || !scene.has_transmission();
        (is_told && delivered.mesh.triangles.len() == count && is_sure).then_some(mode)
    };
    (0..count)
        .into_par_iter()
        .map(|triangle| {
            if let Some(mode) = told(triangle) {
                return mode;
            }
            let corners = low.triangles[triangle].map(|i| i as usize);
            let mut votes = [0usize; MODES.len()];
            for weights in ASKED {
                let point: Vec3 = interpolate(corners.map(|i| low.positions[i]), weights);
                let normal: Vec3 = interpolate(corners.map(|i| low.normals[i]), weights);
                let reach = high.conventions.max_distance;
                if let Some(hit) = high.surface.project(point, normal.normalize_or_zero(), reach) {
                    votes[scene.alpha(hit.triangle as usize).0 as usize] += 1;
                }
            }
            // The first of those with most votes.
            let most = votes.iter().max().copied().unwrap_or_default();
            MODES[votes.iter().position(|v| *v == most).unwrap_or_default()]
        })
        .collect()
}

/// The layers of two models.
pub fn alpha_layers(modes: &[AlphaMode], high: &HighPoly) -> Vec<AlphaLayer> {
    let of = |mode: AlphaMode| AlphaLayer {
        mode,
        high: (0..high.triangles as u32).filter(|&t| high.scene.alpha(t as usize).0 == mode).collect(),
        low: (0..modes.len() as u32).filter(|&t| modes[t as usize] == mode).collect(),
    };
    MODES.into_iter().map(of).filter(|layer| !layer.low.is_empty()).collect()
}
