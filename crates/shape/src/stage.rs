//! A low-poly's vertices before the bake: kept, or moved until its silhouettes and pictures
//! agree with the high-poly's.
//!
//! ```text
//! repaired low-poly ─┬ provisional texture (projected) ─┬ fit ─ positions, turned normals
//! high-poly ─────────┴ small smooth views (seen) ───────┘
//! ```
//!
//! Contract: what is not moved keeps its position and its normal to the bit; triangles stay in their
//! order, and so do their corners' texture coordinates. Vertices are split where a normal would end up on its
//! face's back.

use crate::joint::{ShapeOptions, Shaped, fit_shape, picture_loss};
use crate::normals::turned_normals;
use crate::outline::Outline;
use crate::provisional::Provisional;
use crate::seen::{Seen, ShapeViews, smooth_references};
use crate::uncross::with_sides_in_order;
use glam::{Mat3, Vec3, Vec4};
use parbake_image::{FloatImage, MapKind, MapSet};
use parbake_mesh::{TexelMap, face_outwards};
use parbake_model::{Material, Mesh, Model, Placement};
use parbake_progress::{Portion, Stage, Watcher};
use parbake_render::interpolate::interpolate;
use parbake_solve::random::mixed;
use parbake_views::PrepareError;
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;
use parbake_views::projection::project;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapePlan {
    /// Views that vertices are fitted to.
    pub views: usize,
    /// Side of these views in pixels, at least.
    pub view_size: usize,
    /// Their side at most, where outlines are so close that smaller views would not show it.
    pub largest_size: usize,
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
    /// Mean and longest way of a vertex, as shares of the high-poly's longest side, after thin walls were pulled apart.
    pub moved: [f32; 2],
    /// How far outlines were apart in the mean before and after, as shares of the high-poly's
    /// longest side; zeros by the paper's method, which does not look.
    pub gap: [f32; 2],
    /// Shares of a picture's area that only the low-poly covers, and only the high-poly, before.
    pub before: [f64; 2],
    /// The same after.
    pub after: [f64; 2],
}

/// Views that vertices are checked with.
const CHECKED: usize = 24;
/// Their seed differs from that of the views that vertices are fitted to.
const OF_CHECKS: u64 = 0x5eed_c4ec;
/// Distance between outlines, in pixels, that views show well enough to move vertices by.
const SHOWN: f32 = 0.25;
/// The mesh with thin walls pulled apart is taken if its picture loss is below this multiple of the loss before: small pictures hardly
/// show patches that are clearly visible in large ones. A chair at 1.003 gains 1.6 dB, a jet at 1.03 loses 0.5, a car at 1.23 loses 1.2.
const NO_WORSE: f64 = 1.01;
/// Share of the time that the pictures of the high-poly take.
const LOOKING: f64 = 0.2;

/// Moves the vertices of a low-poly to where its outlines and pictures agree with the high-poly's. Returns what it
/// looked at, too.
///
/// # Errors
/// Where its texture coordinates are absent or have no area.
pub fn shape(
    name: &str,
    mesh: &mut Mesh,
    high: &HighPoly,
    plan: &ShapePlan,
    watcher: &dyn Watcher,
) -> Result<(ShapeReport, ShapeViews), PrepareError> {
    let (mut placed, mut start) = textured(prepared(name, mesh, high, plan)?, high);
    let seen = shape_views(&placed, high, plan, watcher);
    // Textures of matte surfaces take the colours of either side.
    let apart = match high.is_whole_material {
        true => with_sides_in_order(&placed, &high.scene, &high.conventions.rig, watcher),
        false => None,
    };
    if let Some(apart) = apart {
        let mut other = mesh.clone();
        move_vertices(&mut other, &placed, &apart, &high.frame);
        let (own, texture) = textured(prepared(name, &other, high, plan)?, high);
        let loss = |mesh: &Mesh, texture: &Provisional| {
            picture_loss(mesh, texture, &seen, high.conventions.display, &plan.fit)
        };
        if loss(&own, &texture) < NO_WORSE * loss(&placed, &start) {
            (*mesh, placed, start) = (other, own, texture);
        }
    }
    let shaped = fitted(&placed, start, high, &seen, plan, &Portion::new(watcher, LOOKING..1.0));
    move_vertices(mesh, &placed, &shaped.positions, &high.frame);
    Ok((report(&shaped), seen))
}

/// What vertices of a low-poly in the common frame are fitted to. Where its outlines are close to the high-poly's already,
/// views are larger, up to [`ShapePlan::largest_size`].
pub fn shape_views(placed: &Mesh, high: &HighPoly, plan: &ShapePlan, watcher: &dyn Watcher) -> ShapeViews {
    let look = |views, size, seed, share| {
        let watcher = Portion::new(watcher, share).of_stage(Stage::Reference, Stage::Shape);
        Seen {
            references: smooth_references(high, views, size, plan.samples, seed, &watcher),
            size,
            samples: plan.samples,
        }
    };
    let seed = plan.fit.seed;
    let checked = look(CHECKED.min(plan.views), plan.view_size, mixed(seed ^ OF_CHECKS), 0.0..0.2 * LOOKING);
    let apart = Outline::of(&placed.positions, &placed.triangles, &checked).gap() as f32;
    let wanted = (plan.view_size as f32 * SHOWN / apart.max(1e-3)) as usize / 2 * 2;
    let size = wanted.clamp(plan.view_size, plan.view_size.max(plan.largest_size));
    ShapeViews { fitted: look(plan.views, size, seed, 0.2 * LOOKING..LOOKING), checked }
}

/// Sets the offsets of a low-poly's vertices from which a cutout can take away what stands out: where outlines are
/// apart, they reach beyond the high-poly's rather than stay behind. Positions and normals stay; where that gains nothing,
/// there are no offsets.
///
/// # Errors
/// As of [`shape`].
pub fn grow_for_cutout(
    name: &str,
    mesh: &mut Mesh,
    high: &HighPoly,
    seen: &ShapeViews,
    plan: &ShapePlan,
    watcher: &dyn Watcher,
) -> Result<ShapeReport, PrepareError> {
    let (placed, start) = textured(prepared(name, mesh, high, plan)?, high);
    let shaped = fitted(&placed, start, high, seen, plan, watcher);
    let ways = shaped.positions.iter().zip(&placed.positions).map(|(after, before)| *after - *before);
    // Copies for tangents are at the end, and of what is here.
    let offsets: Vec<Vec3> = ways.take(mesh.positions.len()).map(|way| way / high.frame.scale).collect();
    if offsets.iter().any(|&offset| offset != Vec3::ZERO) {
        mesh.parallax_offsets = offsets;
    }
    Ok(report(&shaped))
}

/// The low-poly in the common frame, with a small texture.
fn prepared(name: &str, mesh: &Mesh, high: &HighPoly, plan: &ShapePlan) -> Result<LowPoly, PrepareError> {
    let model = Model {
        name: name.into(),
        mesh: mesh.clone(),
        materials: vec![Material::default()],
        images: Vec::new(),
        ..Model::default()
    };
    LowPoly::new(&model, &high.frame, plan.texture_size)
}

/// The low-poly in the common frame, with the high-poly's maps as a small texture.
fn textured(low: LowPoly, high: &HighPoly) -> (Mesh, Provisional) {
    let start = project(&low, high);
    let LowPoly { placed, map, .. } = low;
    let start = provisional(start.maps, &placed, &map);
    (placed, start)
}

/// Where the vertices of a low-poly are to go.
fn fitted(
    placed: &Mesh,
    start: Provisional,
    high: &HighPoly,
    seen: &ShapeViews,
    plan: &ShapePlan,
    watcher: &dyn Watcher,
) -> Shaped {
    let fit = ShapeOptions { keeps_sides: high.is_whole_material, ..plan.fit };
    fit_shape(placed, start, seen, high.conventions.display, &fit, watcher)
}

fn report(shaped: &Shaped) -> ShapeReport {
    let outlines = |o: &Outline| [o.overhang, o.underhang];
    ShapeReport {
        steps: shaped.losses.len(),
        moved: shaped.moved.map(|way| 0.5 * way),
        gap: shaped.gap.map(|gap| 0.5 * gap),
        before: outlines(&shaped.outline[0]),
        after: outlines(&shaped.outline[1]),
    }
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

/// The projected maps as a provisional texture: normals in world space, and what shines by itself as
/// a part of the colour.
fn provisional(mut maps: MapSet, placed: &Mesh, map: &TexelMap) -> Provisional {
    let mut take = |kind: MapKind| maps.get_mut(kind).map(std::mem::take).unwrap_or_default();
    let mut color = take(MapKind::BaseColor);
    let emissive = take(MapKind::Emissive);
    for (color, emissive) in color.texels.iter_mut().zip(&emissive.texels) {
        *color = (*color + *emissive).min(Vec4::ONE);
    }
    Provisional { color, normal: in_world(placed, map, &take(MapKind::Normal)) }
}

/// Tangent-space normals turned into world space, texel by texel.
fn in_world(mesh: &Mesh, map: &TexelMap, normals: &FloatImage<Vec4>) -> FloatImage<Vec4> {
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
    FloatImage::square(normals.width, texels)
}
