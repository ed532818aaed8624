//! Simplification by edge collapses (meshoptimizer: Garland and Heckbert 1997,
//! with attributes after Hoppe 1999).
//!
//! Vertices are split by material first: the triangles' materials can then be told
//! from their vertices afterwards, and meshoptimizer keeps the two sides of a
//! material's border together as it does those of a texture seam. Whatever is
//! preserved holds the surface in its way, so several are tried (`Attempt`), and the
//! deviation of what comes out decides (`deviation.rs`). Where seams of normals were not
//! preserved, each corner takes the model's normal from there (`own_normals.rs`).
//!
//! Contract: the result's corners have positions and texture coordinates of the input's,
//! and its normals but where what they belonged to has collapsed, or where they would
//! look to their face's back (`facing.rs`); it is not empty unless the input is, and has
//! no tangents.

use crate::corner_vertices::{ToldApart, corner_vertices};
use crate::deviation::deviation;
use crate::facing::face_outwards;
use crate::own_normals::take_normals;
use crate::projection::HighSurface;
use crate::vertices::drop_unused;
use meshopt::SimplifyOptions as Flags;
use parbake_model::glam::{DVec3, Vec2, Vec3};
use parbake_model::{Bounds, Mesh};

/// How far, and what to preserve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimplifyOptions {
    /// How many triangles the result should have, at least 1.
    pub target_triangles: usize,
    /// How far the surface may move, relative to the longest side of its bounding
    /// box; 1 does not bound it.
    pub max_error: f32,
    /// How bad a texture that slips along the surface is, compared with a surface
    /// that moves by as much; 0 … 1.
    pub uv_weight: f32,
    /// How bad normals are that turn by a radian, compared with a surface that
    /// moves by the longest side of its bounding box; 0 … 1.
    pub normal_weight: f32,
}

impl Default for SimplifyOptions {
    fn default() -> Self {
        Self { target_triangles: 1000, max_error: 1.0, uv_weight: 0.5, normal_weight: 0.1 }
    }
}

/// What a try preserves.
#[derive(Clone, Copy, PartialEq)]
enum Attempt {
    /// Seams of texture and normals alike.
    AllSeams,
    /// Seams of texture. For models whose every edge is sharp, which otherwise
    /// have no vertex that may move.
    TextureSeams,
    /// As above, but texture seams may be collapsed where they are in the way.
    CrossingSeams,
    /// The shape; the texture layout is no longer of use.
    ShapeOnly,
    /// Roughly the shape, by clustering vertices, whatever the topology.
    Clustered,
}

/// A coarser mesh: of the attempts that come to a half to one and a half of the wanted triangles the
/// one whose surface deviates least, what each gives up taken into account; where none does, the one
/// that comes nearest.
pub fn simplify(mesh: &Mesh, options: SimplifyOptions) -> Mesh {
    let target = options.target_triangles.max(1);
    let mut best = Mesh { tangents: Vec::new(), ..mesh.clone() };
    if let Some(unit) = UnitBox::of(mesh).filter(|_| mesh.triangles.len() > target) {
        let original = unit.bare(mesh);
        let surface = HighSurface::new(&original);
        let (mut least, mut by) = ((true, f64::INFINITY), None);
        for attempt in Attempt::ALL {
            let coarse = attempt.run(mesh, &unit, target, &options);
            let count = coarse.triangles.len();
            if count == 0 || count >= mesh.triangles.len() {
                continue;
            }
            let misses = !(target..=3 * target).contains(&(2 * count));
            let cost = if misses {
                (count as f64 / target as f64).ln().abs()
            } else {
                let coarse = unit.bare(&coarse);
                attempt.price() * deviation((&original, &surface), (&coarse, &HighSurface::new(&coarse)))
            };
            if (misses, cost) < least {
                (least, by, best) = ((misses, cost), Some(attempt), coarse);
            }
        }
        let lost_normals = by.is_some_and(|attempt| attempt != Attempt::AllSeams);
        if lost_normals && !best.normals.is_empty() {
            take_normals(&mut best, mesh, &surface, |p| unit.place(p));
        }
    }
    drop_unused(&mut best);
    if !best.normals.is_empty() {
        face_outwards(&mut best);
    }
    best
}

impl Attempt {
    const ALL: [Attempt; 5] =
        [Self::AllSeams, Self::TextureSeams, Self::CrossingSeams, Self::ShapeOnly, Self::Clustered];

    /// What a deviation counts, so that looks are given up only for a shape that is as much better.
    fn price(self) -> f64 {
        match self {
            Self::AllSeams => 1.0,
            Self::TextureSeams => 1.25,
            Self::CrossingSeams => 1.5,
            Self::ShapeOnly => 3.0,
            Self::Clustered => 4.0,
        }
    }

    fn run(self, mesh: &Mesh, unit: &UnitBox, target: usize, options: &SimplifyOptions) -> Mesh {
        let (mut work, materials) = self.welded(mesh);
        let positions: Vec<[f32; 3]> = work.positions.iter().map(|&p| unit.place(p).to_array()).collect();
        let indices: Vec<u32> = work.triangles.iter().flatten().copied().collect();
        let (count, error) = (3 * target, options.max_error.max(0.0));
        let simplified = match self {
            Self::ShapeOnly => {
                meshopt::simplify_decoder(&indices, &positions, count, error, Flags::Prune, None)
            }
            Self::Clustered => meshopt::simplify_sloppy_decoder(&indices, &positions, count, error, None),
            _ => {
                let (attributes, weights) = attributes(&work, &positions, options, self == Self::AllSeams);
                let unlocked = vec![false; positions.len()];
                // Nothing is pruned while there are seams to keep: small parts cost less
                // than seams, and all but the largest part of a model would go.
                let flags = if self == Self::CrossingSeams { Flags::Permissive } else { Flags::None };
                meshopt::simplify_with_attributes_and_locks_decoder(
                    &indices,
                    &positions,
                    &attributes,
                    &weights,
                    weights.len() * size_of::<f32>(),
                    &unlocked,
                    count,
                    error,
                    flags,
                    None,
                )
            }
        };
        work.triangles = simplified.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        work.triangle_materials = work.triangles.iter().map(|t| materials[t[0] as usize]).collect();
        work
    }

    /// The mesh's vertices as this try tells them apart, and each vertex's material.
    fn welded(self, mesh: &Mesh) -> (Mesh, Vec<u32>) {
        let seams = self != Self::ShapeOnly && self != Self::Clustered;
        corner_vertices(mesh, ToldApart { seams, normals: self == Self::AllSeams, tangents: false })
    }
}

/// Where the longest side of a mesh's box is 1, whatever the file's unit: meshoptimizer's own scaling
/// would overflow.
pub(crate) struct UnitBox {
    low: DVec3,
    longest: f64,
}

impl UnitBox {
    pub(crate) fn of(mesh: &Mesh) -> Option<Self> {
        let bounds = Bounds::of(mesh)?;
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        Some(Self { low, longest: (high - low).max_element().max(f64::MIN_POSITIVE) })
    }

    pub(crate) fn place(&self, p: Vec3) -> Vec3 {
        ((p.as_dvec3() - self.low) / self.longest).as_vec3()
    }

    /// Where a point of this box was.
    pub(crate) fn back(&self, p: Vec3) -> Vec3 {
        (p.as_dvec3() * self.longest + self.low).as_vec3()
    }

    /// A mesh's surface in this box, and nothing else of it.
    fn bare(&self, mesh: &Mesh) -> Mesh {
        Mesh {
            positions: mesh.positions.iter().map(|&p| self.place(p)).collect(),
            triangles: mesh.triangles.clone(),
            triangle_materials: vec![0; mesh.triangles.len()],
            ..Mesh::default()
        }
    }
}

/// Length on the surface of one texture, so that neither its size nor its tiling counts; 0 where coordinates without area
/// say nothing.
pub(crate) fn texture_scale(mesh: &Mesh, positions: &[[f32; 3]]) -> f64 {
    let (mut surface, mut texture) = (0.0, 0.0);
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|v| Vec3::from(positions[v as usize]).as_dvec3());
        surface += (b - a).cross(c - a).length();
        let [a, b, c] = mesh.corner_uvs(index).map(Vec2::as_dvec2);
        texture += (b - a).perp_dot(c - a).abs();
    }
    let scale = (surface / texture).sqrt();
    if scale.is_finite() && scale > 0.0 { scale } else { 0.0 }
}

/// Per vertex: the texture coordinate, in units of the surface's length so that
/// neither the texture's size nor its tiling counts, and the normal. Their
/// weights follow.
fn attributes(
    mesh: &Mesh,
    positions: &[[f32; 3]],
    options: &SimplifyOptions,
    normals: bool,
) -> (Vec<f32>, [f32; 5]) {
    let scale = texture_scale(mesh, positions);
    let mut values = Vec::with_capacity(5 * positions.len());
    for v in 0..positions.len() {
        let uv = mesh.uvs.get(v).copied().unwrap_or_default().as_dvec2() * scale;
        let normal = mesh.normals.get(v).copied().unwrap_or_default();
        values.extend(uv.clamp_length_max(1e6).as_vec2().to_array());
        values.extend(normal.to_array());
    }
    let uv = options.uv_weight.clamp(0.0, 1.0);
    let normal = if normals { options.normal_weight.clamp(0.0, 1.0) } else { 0.0 };
    (values, [uv, uv, normal, normal, normal])
}

#[cfg(test)]
#[path = "simplify_tests.rs"]
mod tests;
