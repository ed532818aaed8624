//! Which triangles of high-poly and low-poly belong together by their alpha and by the light that passes
//! them: what is opaque, what is cut out, what is blended and what transmits light are fitted as layers of
//! their own, so that a pane shows what is behind it and what is behind it does not show the pane.
//!
//! Contract: every triangle of the low-poly is in one layer; layers without triangles of the low-poly
//! are left out.

use crate::high_poly::HighPoly;
use parbake_image::material_maps::{fitted_alpha, transmits};
use parbake_model::glam::Vec3;
use parbake_model::{AlphaMode, Material, Mesh, Model};
use parbake_render::interpolate::interpolate;
use rayon::prelude::*;

/// What viewers draw in a pass of its own, and so has a material of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerKind {
    /// How alpha is to be understood.
    pub mode: AlphaMode,
    /// Whether light passes it (`KHR_materials_transmission`): viewers draw all else first, and refract it.
    pub transmits: bool,
}

/// The triangles of one kind, by their indices in either mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct AlphaLayer {
    /// How alpha is to be understood.
    pub mode: AlphaMode,
    /// Whether light passes it.
    pub transmits: bool,
    /// The high-poly's.
    pub high: Vec<u32>,
    /// The low-poly's.
    pub low: Vec<u32>,
}

/// The kinds in the order in which they are drawn.
const KINDS: [LayerKind; 6] = {
    const fn kind(mode: AlphaMode, transmits: bool) -> LayerKind {
        LayerKind { mode, transmits }
    }
    [
        kind(AlphaMode::Opaque, false),
        kind(AlphaMode::Mask, false),
        kind(AlphaMode::Opaque, true),
        kind(AlphaMode::Mask, true),
        kind(AlphaMode::Blend, false),
        kind(AlphaMode::Blend, true),
    ]
};

/// Barycentrics at which a triangle asks what it stands for.
const ASKED: [[f32; 3]; 4] = [[1.0 / 3.0; 3], [0.6, 0.2, 0.2], [0.2, 0.6, 0.2], [0.2, 0.2, 0.6]];

/// The kind of a material's layer: as it says where whole materials are fitted, else with what stands in
/// for light that passes.
fn kind_of(material: &Material, is_whole: bool) -> LayerKind {
    match is_whole {
        true => LayerKind { mode: material.alpha_mode, transmits: transmits(material) },
        false => LayerKind { mode: fitted_alpha(material).0, transmits: false },
    }
}

/// The kind of a triangle of the high-poly.
pub(crate) fn high_kind(high: &HighPoly, triangle: usize) -> LayerKind {
    let transmits = high.is_whole_material && high.scene.transmits(triangle);
    LayerKind { mode: high.scene.alpha(triangle).0, transmits }
}

/// The kind of each of the low-poly's triangles: as its own materials say, if `delivered` has any that is
/// more than opaque and as many triangles as `low`, and the high-poly has that kind; else, or where it is
/// opaque and the high-poly has glass, as most of the high-poly says where the triangle looks along its
/// normals. `low` is in the common frame.
pub fn layer_kinds(low: &Mesh, delivered: &Model, high: &HighPoly) -> Vec<LayerKind> {
    let (scene, is_whole) = (&high.scene, high.is_whole_material);
    let count = low.triangles.len();
    let plain = LayerKind::default();
    if scene.mesh().triangle_materials.is_empty() || !(scene.has_alpha() || scene.has_transmission()) {
        return vec![plain; count];
    }
    let mut there = [false; KINDS.len()];
    let place = |kind: LayerKind| KINDS.iter().position(|k| *k == kind).unwrap_or_default();
    (0..high.triangles).for_each(|t| there[place(high_kind(high, t))] = true);
    let is_told = delivered.materials.iter().any(|m| kind_of(m, is_whole) != plain);
    let told = |triangle: usize| {
        let material = *delivered.mesh.triangle_materials.get(triangle)?;
        let kind = kind_of(delivered.materials.get(material as usize)?, is_whole);
        // Files of low-polys often say nothing of light that passes: such glass is told opaque.
        let is_sure = there[place(kind)] && (kind != plain || !scene.has_transmission());
        (is_told && delivered.mesh.triangles.len() == count && is_sure).then_some(kind)
    };
    (0..count)
        .into_par_iter()
        .map(|triangle| {
            if let Some(kind) = told(triangle) {
                return kind;
            }
            let corners = low.triangles[triangle].map(|i| i as usize);
            let mut votes = [0usize; KINDS.len()];
            for weights in ASKED {
                let point: Vec3 = interpolate(corners.map(|i| low.positions[i]), weights);
                let normal: Vec3 = interpolate(corners.map(|i| low.normals[i]), weights);
                let reach = high.conventions.max_distance;
                let side = low.area_normal(triangle);
                if let Some(hit) = high.surface.project_facing(point, normal.normalize_or_zero(), side, reach)
                {
                    votes[place(high_kind(high, hit.triangle as usize))] += 1;
                }
            }
            // The first of those with most votes.
            let most = votes.iter().max().copied().unwrap_or_default();
            KINDS[votes.iter().position(|v| *v == most).unwrap_or_default()]
        })
        .collect()
}

/// The triangles of each kind that a high-poly has, in the order in which kinds are drawn.
pub fn high_layers(high: &HighPoly) -> Vec<(LayerKind, Vec<u32>)> {
    let of = |kind: LayerKind| {
        (0..high.triangles as u32).filter(|&t| high_kind(high, t as usize) == kind).collect()
    };
    KINDS
        .map(|kind| (kind, of(kind)))
        .into_iter()
        .filter(|(_, triangles): &(_, Vec<u32>)| !triangles.is_empty())
        .collect()
}

/// The layers of two models.
pub fn alpha_layers(kinds: &[LayerKind], high: &HighPoly) -> Vec<AlphaLayer> {
    let of = |kind: LayerKind| AlphaLayer {
        mode: kind.mode,
        transmits: kind.transmits,
        high: (0..high.triangles as u32).filter(|&t| high_kind(high, t as usize) == kind).collect(),
        low: (0..kinds.len() as u32).filter(|&t| kinds[t as usize] == kind).collect(),
    };
    KINDS.into_iter().map(of).filter(|layer| !layer.low.is_empty()).collect()
}
