//! Silhouette antialiasing: what makes coverage change smoothly with the vertices.
//!
//! After the idea of Laine et al. 2020, "Modular Primitives for High-Performance
//! Differentiable Rendering", section 3.5. Where two neighbouring pixels see
//! different triangles, the way from the centre of the nearer one's pixel to the
//! other centre is followed over the mesh, from triangle to triangle across shared
//! edges, until it leaves the surface at a silhouette: an edge with no triangle on
//! its other side on this screen. With τ ∈ \[0, 1) the place of that edge on the way,
//! the nearer surface covers 1/2 + τ of its own pixel or τ − 1/2 of the other's, and
//! the pixel which the edge passes through is blended accordingly.
//!
//! Each silhouette edge acts along one axis, the one it is steeper against, so that a
//! slanted edge is not counted twice. Forward is two linear passes over the pixels,
//! `out = in + Σ w (source − in)`: along rows, then along columns, both with sources
//! from the picture as it came in. No pixel's own share can become negative.
//! Adjoint: the transposed passes in reverse; a weight's gradient `g · (source − in)`
//! reaches the edge's end points P, Q, since with the line `l = P × Q` and the crossing
//! c = (x, y, 1), `dx = −(dP · (Q × c) + dQ · (c × P)) / l_x`.
//!
//! Contract: premultiplied RGBA in linear light, one sample at each pixel's centre.

use crate::camera::Camera;
use crate::edges::EdgeAdjacency;
use crate::raster::{NOTHING, ScreenTriangles, Visibility};
use glam::DVec3;
use parbake_model::glam::Vec3;
use rayon::prelude::*;

/// Triangles crossed between two pixel centres before the search gives up: more
/// than that are only met where triangles are far smaller than pixels.
const LONGEST_WALK: usize = 16;

/// One pixel that a silhouette passes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Index of the pixel that changes.
    pub target: u32,
    /// Index of its neighbour, whose colour it takes in.
    pub source: u32,
    /// How much of it, 0 … 0.5.
    pub weight: f32,
    /// The silhouette edge's end points, as the mesh's vertex indices.
    pub vertices: [u32; 2],
    /// Derivative of the weight with respect to their (X, Y, W).
    pub derivative: [DVec3; 2],
}

/// All blends of one view, in the order of their pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Blends {
    /// Between pixels of one row; applied first.
    pub along_rows: Vec<Blend>,
    /// Between pixels of one column.
    pub along_columns: Vec<Blend>,
}

/// What the adjoint needs of a forward pass: for each blend, rows first, the source's
/// colour and the target's before the pass.
#[derive(Clone, Debug, Default)]
pub struct BlendTape(Vec<[[f32; 4]; 2]>);

/// The mesh as the search needs it.
struct Search<'a> {
    screen: &'a ScreenTriangles,
    edges: &'a EdgeAdjacency,
    positions: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    camera: &'a Camera,
    size: usize,
}

/// The edge at which a way across the mesh leaves the surface.
struct Silhouette {
    triangle: usize,
    /// The edge is the one opposite to this corner.
    corner: usize,
    /// Where on the way, 0 … 1.
    place: f64,
}

impl Search<'_> {
    /// Follows the way from a point on `triangle` to another point of the screen.
    fn walk(&self, mut triangle: usize, from: DVec3, to: DVec3, goal: u32) -> Option<Silhouette> {
        for _ in 0..LONGEST_WALK {
            let planes = &self.screen.triangles[triangle].planes;
            let (mut place, mut corner) = (1.0, 3);
            for (k, plane) in planes.iter().enumerate() {
                let (start, end) = (plane.dot(from), plane.dot(to));
                // Only edges that the way leaves by; the one it came in by rises.
                if end < 0.0 && end < start && start < place * (start - end) {
                    (place, corner) = (start / (start - end), k);
                }
            }
            if corner == 3 {
                return None;
            }
            // A neighbour lies beyond the edge if its plane falls the other way.
            let (mut beyond, outwards) = (None, planes[corner]);
            for (t, k) in self.edges.others(triangle, corner) {
                if outwards.dot(self.screen.triangles[t].planes[k]) < 0.0 {
                    if t as u32 == goal {
                        return None;
                    }
                    beyond = beyond.or(Some(t));
                }
            }
            match beyond {
                Some(next) => triangle = next,
                None => return Some(Silhouette { triangle, corner, place: place.max(0.0) }),
            }
        }
        None
    }

    /// The blend between two neighbouring pixels, if a silhouette parts them; `axis`
    /// is 0 along a row, 1 along a column.
    fn between(&self, seen: &Visibility, pixels: [usize; 2], axis: usize) -> Option<Blend> {
        let ids = pixels.map(|p| seen.triangle[p]);
        if ids[0] == ids[1] {
            return None;
        }
        let centre = |p: usize| DVec3::new((p % self.size) as f64 + 0.5, (p / self.size) as f64 + 0.5, 1.0);
        let centres = pixels.map(centre);
        let nearness = |i: usize| match ids[i] {
            NOTHING => f64::NEG_INFINITY,
            t => self.screen.triangles[t as usize].nearness.dot(centres[i]),
        };
        let near = usize::from(nearness(1) > nearness(0));
        let far = 1 - near;
        let found = self.walk(ids[near] as usize, centres[near], centres[far], ids[far])?;
        let corners = self.triangles[found.triangle];
        let vertices = [corners[(found.corner + 1) % 3], corners[(found.corner + 2) % 3]];
        let [p, q] = vertices.map(|v| self.camera.project(self.positions[v as usize], self.size).homogeneous);
        let line = p.cross(q);
        let steeper = line.x.abs() >= line.y.abs();
        if steeper != (axis == 0) || line[axis] == 0.0 {
            return None;
        }
        let mut crossing = centres[near];
        let direction = if near == 0 { 1.0 } else { -1.0 };
        crossing[axis] += direction * found.place;
        let own = found.place < 0.5;
        // d weight / d place, times d place / d crossing.
        let slope = if own { -direction } else { direction } / -line[axis];
        Some(Blend {
            target: pixels[if own { near } else { far }] as u32,
            source: pixels[if own { far } else { near }] as u32,
            weight: (found.place - 0.5).abs() as f32,
            vertices,
            derivative: [q.cross(crossing) * slope, crossing.cross(p) * slope],
        })
    }
}

/// Finds every silhouette between neighbouring pixel centres.
///
/// `seen` must be the visibility of `screen` at offset (0, 0), and both must be of
/// these positions, triangles and camera.
pub fn find_blends(
    screen: &ScreenTriangles,
    seen: &Visibility,
    edges: &EdgeAdjacency,
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    camera: &Camera,
) -> Blends {
    let size = seen.size;
    let search = Search { screen, edges, positions, triangles, camera, size };
    let rows: Vec<Blends> = (0..size)
        .into_par_iter()
        .with_min_len(8)
        .map(|row| {
            let pixels = row * size..(row + 1) * size;
            let right = pixels.clone().skip(1).filter_map(|p| search.between(seen, [p - 1, p], 0));
            let along_rows = right.collect();
            let down = pixels.filter(|p| p + size < size * size);
            let along_columns = down.filter_map(|p| search.between(seen, [p, p + size], 1)).collect();
            Blends { along_rows, along_columns }
        })
        .collect();
    let mut all = Blends::default();
    for row in rows {
        all.along_rows.extend(row.along_rows);
        all.along_columns.extend(row.along_columns);
    }
    all
}

impl Blends {
    /// Blends the picture in place.
    pub fn forward(&self, rgba: &mut [[f32; 4]]) -> BlendTape {
        let blends = || self.along_rows.iter().chain(&self.along_columns);
        // Sources are those of the picture as it came in.
        let mut tape: Vec<_> = blends().map(|b| [rgba[b.source as usize], [0.0; 4]]).collect();
        let (rows, columns) = tape.split_at_mut(self.along_rows.len());
        for (blends, tape) in [(&self.along_rows, rows), (&self.along_columns, columns)] {
            for (blend, tape) in blends.iter().zip(tape.iter_mut()) {
                tape[1] = rgba[blend.target as usize];
            }
            for (blend, [source, before]) in blends.iter().zip(tape) {
                let target = &mut rgba[blend.target as usize];
                for k in 0..4 {
                    target[k] += blend.weight * (source[k] - before[k]);
                }
            }
        }
        BlendTape(tape)
    }

    /// Adjoint of [`Blends::forward`]: turns the gradient of the blended picture into
    /// that of the picture before, in place, and returns each blend's end points with
    /// the gradients of their (X, Y, W), rows first.
    pub fn adjoint(&self, tape: &BlendTape, gradient: &mut [[f32; 4]]) -> Vec<([u32; 2], [DVec3; 2])> {
        let mut to_vertices = Vec::with_capacity(tape.0.len());
        let mut to_sources = Vec::with_capacity(tape.0.len());
        let (rows, columns) = tape.0.split_at(self.along_rows.len());
        for (blends, tape) in [(&self.along_columns, columns), (&self.along_rows, rows)] {
            let start = to_sources.len();
            for (blend, [source, before]) in blends.iter().zip(tape) {
                let g = gradient[blend.target as usize];
                let to_weight: f32 = (0..4).map(|k| g[k] * (source[k] - before[k])).sum();
                to_vertices.push((blend.vertices, blend.derivative.map(|d| d * f64::from(to_weight))));
                to_sources.push((blend, g.map(|g| g * blend.weight)));
            }
            for (blend, share) in &to_sources[start..] {
                let target = &mut gradient[blend.target as usize];
                for k in 0..4 {
                    target[k] -= share[k];
                }
            }
        }
        for (blend, share) in to_sources {
            let source = &mut gradient[blend.source as usize];
            for k in 0..4 {
                source[k] += share[k];
            }
        }
        to_vertices
    }
}
