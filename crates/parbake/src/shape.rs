//! A low-poly's vertices before the bake: kept, or moved until its silhouettes and pictures
//! agree with the high-poly's.
//!
//! ```text
//! mended low-poly ─┬ provisional texture (projected) ─┬ fit ─ positions, turned normals
//! high-poly ───────┴ small smooth views ──────────────┘
//! ```
//!
//! Contract: what is not moved keeps its position and its normal to the bit; triangles stay in their
//! order, and so do their corners' texture coordinates. Vertices are split where a normal would end up on its
//! face's back.

use crate::error::BakeError;
use crate::low::LowPoly;
use crate::unfold::Mended;
use parbake_fit::canvas::Canvas;
use parbake_fit::reference::{Reference, Sampling, render_references};
use parbake_fit::start::project;
use parbake_fit::views::{Rig, View, view_pool};
use parbake_fit::watch::Watch;
use parbake_mesh::{HighSurface, TexelMap, face_outwards};
use parbake_model::glam::{Mat3, Vec3};
use parbake_model::{Material, Mesh, Model, Placement};
use parbake_render::display::Display;
use parbake_render::interpolate::interpolate;
use parbake_render::scene::Scene;
use parbake_render::shade::Lambert;
use parbake_shape::normals::turned_normals;
use parbake_shape::provisional::Provisional;
use parbake_shape::views::Outline;
use parbake_shape::{ShapeOptions, fit_shape};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapePlan {
    /// Views that vertices are fitted to.
    pub views: usize,
    /// Side of these views in pixels.
    pub view_size: usize,
    /// Side of the provisional texture in texels.
    pub texture_size: usize,
    /// Samples along a side of each pixel of the high-poly's views.
    pub samples: usize,
    /// The fit's own.
    pub fit: ShapeOptions,
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShapeReport {
    /// Steps that vertices took.
    pub steps: usize,
    /// Mean and longest way of a vertex, as shares of the high-poly's longest side.
    pub moved: [f32; 2],
    /// How far outlines were apart in the mean before and after, as shares of the high-poly's
    /// longest side; zeros by the paper's method, which does not look.
    pub gap: [f32; 2],
    /// Shares of a picture's area that only the low-poly covers, and only the high-poly, before.
    pub before: [f64; 2],
    /// The same after.
    pub after: [f64; 2],
}

/// The high-poly, as vertices are fitted to it.
#[derive(Clone, Copy)]
pub struct Target<'a> {
    /// To be rendered.
    pub scene: &'a Scene,
    /// To be projected.
    pub surface: &'a HighSurface,
    /// How far projection looks to either side, in the common frame.
    pub reach: f32,
    /// How light is shown.
    pub display: Display,
    /// Whether colours are stored as sRGB of what light is reckoned with.
    pub srgb: bool,
    /// Where cameras stand.
    pub rig: Rig,
}

/// Moves the vertices of a low-poly that `frame` places.
///
/// # Errors
/// Where its texture coordinates are absent or have no area.
pub fn shape(
    low: &mut Mended,
    frame: &Placement,
    target: &Target,
    plan: &ShapePlan,
    seed: u64,
    watch: &impl Watch,
) -> Result<ShapeReport, BakeError> {
    let model = Model {
        name: low.name.clone(),
        mesh: low.mesh.clone(),
        materials: vec![Material::default()],
        images: Vec::new(),
    };
    let LowPoly { placed, map, atlas, .. } = LowPoly::new(&model, frame, plan.texture_size)?;
    let start = project(&placed, &map, &atlas, target.scene, target.surface, target.reach);
    let start = Provisional { normal: in_world(&placed, &map, &start.normal), color: start.color };
    let references = smooth_references(target, plan.views, plan.view_size, plan.samples, seed, watch);
    let options = ShapeOptions { seed, ..plan.fit };
    let shaped = fit_shape(&placed, start, &references, plan.view_size, target.display, &options, watch);

    move_vertices(&mut low.mesh, &placed, &shaped.positions, frame);
    let outlines = |o: &Outline| [o.overhang, o.underhang];
    Ok(ShapeReport {
        steps: shaped.losses.len(),
        moved: shaped.moved.map(|way| 0.5 * way),
        gap: shaped.gap.map(|gap| 0.5 * gap),
        before: outlines(&shaped.outline[0]),
        after: outlines(&shaped.outline[1]),
    })
}

/// Views of the high-poly for gradients through silhouettes: edges are told from each other by
/// how much of a pixel they cover, so whole pixels are averaged, and none is shifted.
pub(crate) fn smooth_references(
    target: &Target,
    views: usize,
    size: usize,
    samples: usize,
    seed: u64,
    watch: &impl Watch,
) -> Vec<Reference> {
    let pool: Vec<View> = (view_pool(views, &target.rig, seed).into_iter())
        .map(|view| View { jitter: [0.0; 2], ..view })
        .collect();
    let sampling = Sampling { size, filter: 1.0, samples };
    render_references(target.scene, &Lambert, &pool, &sampling, 1, watch)
}

/// Moves a mesh as its copy in the common frame has moved, its normals with it; vertices are split
/// where a normal would end up on its face's back.
pub(crate) fn move_vertices(mesh: &mut Mesh, placed: &Mesh, positions: &[Vec3], frame: &Placement) {
    for ((written, before), after) in mesh.positions.iter_mut().zip(&placed.positions).zip(positions) {
        *written += (*after - *before) / frame.scale;
    }
    mesh.normals = turned_normals(&placed.positions, positions, &mesh.normals, &mesh.triangles);
    face_outwards(mesh);
}

/// Tangent-space normals turned into world space, texel by texel.
fn in_world(mesh: &Mesh, map: &TexelMap, normals: &Canvas) -> Canvas {
    let texels = (normals.texels.par_iter().enumerate())
        .map(|(texel, m)| {
            let Some(triangle) = mesh.triangles.get(map.triangle[texel] as usize) else {
                return Vec3::Z.extend(0.0);
            };
            let corners = triangle.map(|i| i as usize);
            let [second, third] = map.barycentric[texel];
            let weights = [1.0 - second - third, second, third];
            let normal = interpolate(corners.map(|i| mesh.normals[i]), weights);
            let tangent = interpolate(corners.map(|i| mesh.tangents[i].truncate()), weights);
            let bitangent = normal.cross(tangent) * mesh.tangents[corners[0]].w;
            let world = Mat3::from_cols(tangent, bitangent, normal) * m.truncate();
            world.normalize_or(Vec3::Z).extend(0.0)
        })
        .collect();
    Canvas { size: normals.size, texels }
}

#[cfg(test)]
mod tests {
    use crate::options::{BakeOptions, Method, Preset, ShapeMode, UvMode};
    use crate::{bake, demo_pair, with_threads};
    use parbake_model::Mesh;

    fn quick(shape: ShapeMode) -> BakeOptions {
        BakeOptions {
            texture_size: 32,
            preset: Preset::Fast,
            uv: UvMode::Keep,
            shape,
            views: Some(12),
            view_size: Some(48),
            rounds: Some(0),
            ..BakeOptions::default()
        }
    }

    /// Seams are closed and no triangle has turned over.
    fn is_sane(before: &Mesh, after: &Mesh) -> bool {
        let closed = (0..before.positions.len()).all(|i| {
            (0..i).all(|j| {
                before.positions[i] != before.positions[j] || after.positions[i] == after.positions[j]
            })
        });
        let facing = |t| before.area_normal(t).dot(after.area_normal(t)) > 0.0;
        closed && (0..before.triangles.len()).all(facing)
    }

    /// Protects the mesh: vertices move, and it stays what it was.
    #[test]
    fn vertices_move_and_the_mesh_stays_sane() {
        let (high, low) = demo_pair();
        for (method, shape) in [
            (Method::Fit, ShapeMode::Free),
            (Method::Fit, ShapeMode::Normal),
            (Method::Paper, ShapeMode::Normal),
        ] {
            let options = BakeOptions { method, uv_steps: Some(0), ..quick(shape) };
            let baked = bake(&high, &low, &options, &()).unwrap();
            assert_ne!(baked.model.mesh.positions, low.mesh.positions);
            assert!(is_sane(&low.mesh, &baked.model.mesh), "{shape:?}");
            let report = baked.report.shape.unwrap();
            assert!(report.steps > 0 && report.moved[1] > report.moved[0] && report.moved[0] > 0.0);
        }
    }

    /// Protects views of half the size, with which vertices that are far off begin: they bring outlines
    /// closer, the mesh stays what it was, and threads change nothing.
    #[test]
    fn coarse_views_bring_outlines_closer_whatever_the_number_of_threads() {
        let (high, mut low) = demo_pair();
        low.mesh.positions.iter_mut().for_each(|p| *p *= 1.06);
        let options = BakeOptions { view_size: Some(160), ..quick(ShapeMode::Free) };
        let baked = |threads| with_threads(threads, || bake(&high, &low, &options, &())).unwrap().unwrap();
        let one = baked(1);
        assert!(one.model == baked(3).model, "threads change the result");
        assert!(is_sane(&low.mesh, &one.model.mesh));
        let report = one.report.shape.unwrap();
        // In pixels, of which 160 show 1.4 times the model's length: coarse views are used at all.
        assert!(160.0 / 1.4 * report.gap[0] > 1.5, "{:?}", report.gap);
        assert!(report.gap[1] < 0.8 * report.gap[0], "{:?}", report.gap);
    }

    /// Protects who wants their vertices as they are.
    #[test]
    fn kept_vertices_are_kept_to_the_bit() {
        let (high, low) = demo_pair();
        let baked = bake(&high, &low, &quick(ShapeMode::Keep), &()).unwrap();
        assert_eq!(baked.model.mesh.positions, low.mesh.positions);
        assert!(baked.report.shape.is_none());
    }
}
