//! A mesh with more triangles where its texture shows least, so that coordinates can bend within what
//! were single triangles.
//!
//! Contract: surface, signal and layout are the same in more and smaller triangles.

use crate::optimise::Problem;
use crate::signal::{Pixels, Sample, Signal};
use parbake_atlas::{Layout, check};
use parbake_mesh::{Bisected, Piece};
use parbake_model::Mesh;
use parbake_model::glam::{DMat2, DVec2, Vec2, dvec2};
use rayon::prelude::*;

/// Edges are halved for as long as they have more texels: in smaller triangles it is texels that are
/// too few.
const LEAST_EDGE: f32 = 4.0;

/// A mesh some of whose edges are halved.
pub struct Finer {
    /// Its triangles.
    pub bisected: Bisected,
    /// Its layout.
    pub layout: Layout,
    /// The signal on its triangles.
    signal_scales: Vec<Signal>,
    /// The old layout's point of each old vertex.
    point_of_vertex: Vec<u32>,
}

impl Finer {
    /// Gives `mesh` as many more triangles where they lie in `layout` with the largest of `errors` (F, of
    /// any unit). None where there is nothing to halve.
    pub fn new(mesh: &Mesh, layout: &Layout, problem: &Problem, errors: &[f64], more: usize) -> Option<Self> {
        let mesh = Mesh { uvs: layout.uvs(), ..mesh.clone() };
        let least = LEAST_EDGE / problem.texture_size as f32;
        let bisected = Bisected::new(&mesh, errors, more, least);
        if bisected.midpoints.is_empty() {
            return None;
        }
        let finer = Layout::new(&bisected.of(&mesh));
        // Midpoints are rounded, which may turn over what is all but closed.
        if !check(&finer, problem.texture_size).is_bijective() {
            return None;
        }
        let signal_scales =
            problem.signal_scales.iter().map(|signal| divided(signal, &bisected.pieces)).collect();
        let point_of_vertex = layout.point_of_vertex.clone();
        Some(Self { bisected, layout: finer, signal_scales, point_of_vertex })
    }

    /// What the optimisation works on then.
    pub fn problem<'a>(&'a self, coarse: &Problem<'a>) -> Problem<'a> {
        Problem { rest: &self.layout.rest, signal_scales: &self.signal_scales, ..*coarse }
    }

    /// Its points where those of the old layout lie so.
    pub fn points(&self, old: &[Vec2]) -> Vec<Vec2> {
        let mut uvs: Vec<Vec2> = self.point_of_vertex.iter().map(|&p| old[p as usize]).collect();
        for [a, b] in &self.bisected.midpoints {
            uvs.push(0.5 * uvs[*a as usize] + 0.5 * uvs[*b as usize]);
        }
        let mut points = vec![Vec2::ZERO; self.layout.points.len()];
        for (uv, point) in uvs.iter().zip(&self.layout.point_of_vertex) {
            points[*point as usize] = *uv;
        }
        points
    }
}

/// The same signal on pieces of its triangles, those of one triangle after those of the one before it.
pub fn divided(signal: &Signal, pieces: &[Piece]) -> Signal {
    let places: Vec<Place> = pieces.iter().map(Place::new).collect();
    let families: Vec<&[Place]> = places.chunk_by(|a, b| a.triangle == b.triangle).collect();
    let sorted: Vec<(Vec<u32>, Vec<Sample>)> =
        families.par_iter().map(|family| shared_out(signal.of(family[0].triangle), family)).collect();
    let (mut first, mut samples) = (vec![0], Vec::with_capacity(signal.samples.len()));
    for (counts, own) in sorted {
        for count in counts {
            first.push(first[first.len() - 1] + count);
        }
        samples.extend(own);
    }
    let pixel = |place: &Place| signal.pixels.of(place.triangle).map(|pixel| place.inverse * *pixel);
    let pixels = places.iter().map(pixel).collect::<Option<Vec<_>>>();
    Signal { first, samples, pixels: pixels.map_or(Pixels::Sizeless, Pixels::Each) }
}

/// A triangle's samples piece by piece, and how many each has.
fn shared_out(samples: &[Sample], family: &[Place]) -> (Vec<u32>, Vec<Sample>) {
    if family.len() == 1 {
        return (vec![samples.len() as u32], samples.to_vec());
    }
    let mut own = vec![Vec::new(); family.len()];
    let cells = Cells::new(family);
    for sample in samples {
        let inside = cells.near(sample).iter().map(|&piece| (piece, family[piece as usize].weights(sample)));
        // Rounding may leave a sample that lies on an edge outside of both pieces.
        let depth = |[b, c]: [f32; 2]| b.min(c).min(1.0 - b - c);
        let deepest = inside.max_by(|(_, a), (_, b)| depth(*a).total_cmp(&depth(*b)));
        if let Some((piece, barycentric)) = deepest {
            own[piece as usize].push(Sample { barycentric, ..*sample });
        }
    }
    (own.iter().map(|samples| samples.len() as u32).collect(), own.concat())
}

/// The pieces of a triangle by the cells of a grid over its barycentric weights that they touch.
struct Cells {
    side: usize,
    pieces: Vec<Vec<u32>>,
}

impl Cells {
    fn new(family: &[Place]) -> Self {
        let side = (family.len() as f64).sqrt().ceil() as usize;
        let mut cells = Self { side, pieces: vec![Vec::new(); side * side] };
        for (piece, place) in (0u32..).zip(family) {
            let corners = place.corners();
            let [low, high] =
                [corners.iter().copied().reduce(DVec2::min), corners.iter().copied().reduce(DVec2::max)]
                    .map(|bound| bound.unwrap_or_default());
            // A sample on an edge finds the pieces on both sides.
            let ([x0, y0], [x1, y1]) = (cells.cell(low - ROUNDING), cells.cell(high + ROUNDING));
            for y in y0..=y1 {
                (x0..=x1).for_each(|x| cells.pieces[y * side + x].push(piece));
            }
        }
        cells
    }

    fn cell(&self, weights: DVec2) -> [usize; 2] {
        (weights * self.side as f64).to_array().map(|x| (x.max(0.0) as usize).min(self.side - 1))
    }

    /// The pieces that a sample may lie on.
    fn near(&self, sample: &Sample) -> &[u32] {
        let [b, c] = sample.barycentric.map(f64::from);
        let [x, y] = self.cell(dvec2(b, c));
        &self.pieces[y * self.side + x]
    }
}

/// What rounding may do to barycentric weights, with room to spare.
const ROUNDING: f64 = 1e-5;

/// A piece's place among the weights of its triangle's second and third point.
struct Place {
    triangle: usize,
    /// Weights of its first point.
    first: DVec2,
    /// From weights relative to that to those of its own second and third point.
    inverse: DMat2,
}

impl Place {
    fn new(piece: &Piece) -> Self {
        // A layout's second and third corner are the mesh's third and second.
        let [a, c, b] = piece.corners.map(|weights| dvec2(f64::from(weights[2]), f64::from(weights[1])));
        let edges = DMat2::from_cols(b - a, c - a);
        Self { triangle: piece.triangle as usize, first: a, inverse: edges.inverse() }
    }

    /// Its corners, in weights of the triangle's second and third point.
    fn corners(&self) -> [DVec2; 3] {
        let edges = self.inverse.inverse();
        [self.first, self.first + edges.x_axis, self.first + edges.y_axis]
    }

    fn weights(&self, sample: &Sample) -> [f32; 2] {
        let [b, c] = sample.barycentric.map(f64::from);
        (self.inverse * (dvec2(b, c) - self.first)).as_vec2().to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::ContactOptions;
    use parbake_model::glam::{Vec3, Vec4, vec2};

    /// Two right triangles that share an edge and one by itself, with samples all over them.
    fn sheet() -> (Mesh, Signal) {
        let uvs = vec![vec2(0.1, 0.1), vec2(0.1, 0.5), vec2(0.5, 0.1), vec2(0.5, 0.5), vec2(0.6, 0.6)];
        let mesh = Mesh {
            positions: uvs.iter().map(|uv| Vec3::new(uv.x, -uv.y, 0.3 * uv.x * uv.y)).collect(),
            uvs,
            triangles: vec![[0, 1, 2], [2, 1, 3], [3, 4, 2]],
            triangle_materials: vec![0; 3],
            ..Mesh::default()
        };
        let mut samples = Vec::new();
        for t in 0..3u32 {
            for (i, j) in (0..9).flat_map(|i| (0..9 - i).map(move |j| (i, j))) {
                let barycentric = [i as f32 / 8.0, j as f32 / 8.0];
                samples.push((t, Sample { barycentric, target: Vec4::splat(t as f32), weight: 1.0 }));
            }
        }
        let mut signal = Signal::new(3, &samples);
        signal.pixels = Pixels::Each(vec![DMat2::IDENTITY * 0.01; 3]);
        (mesh, signal)
    }

    /// Where a triangle's samples lie in a layout, sorted.
    fn spots(layout: &Layout, signal: &Signal) -> Vec<[i32; 2]> {
        let spot = |t: usize, sample: &Sample| {
            let [a, b, c] = layout.corners(t);
            let [wb, wc] = sample.barycentric.map(f64::from);
            ((a + (b - a) * wb + (c - a) * wc) * 1e5).round().as_ivec2().to_array()
        };
        let of = |t: usize| signal.of(t).iter().map(move |sample| spot(t, sample));
        let mut spots: Vec<_> = (0..layout.triangles.len()).flat_map(of).collect();
        spots.sort_unstable();
        spots
    }

    /// Protects what a texture is solved for: after a split, all samples lie where they lay and
    /// inside of their triangles, and a pixel is as wide as before.
    #[test]
    fn pieces_have_the_signal_of_the_whole() {
        let (mesh, signal) = sheet();
        let layout = Layout::new(&mesh);
        let signal_scales = [signal];
        let contact = ContactOptions::default();
        let problem = Problem {
            rest: &layout.rest,
            signal_scales: &signal_scales,
            texture_size: 256,
            contact: &contact,
        };
        let finer = Finer::new(&mesh, &layout, &problem, &[1.0, 3.0, 0.1], 30).expect("edges are long");
        let fine = finer.problem(&problem);
        // An edge of two triangles adds two, so that one of thirty may be left over.
        assert!(matches!(fine.rest.len(), 32 | 33));
        assert_eq!(spots(&finer.layout, &fine.signal_scales[0]), spots(&layout, &signal_scales[0]));
        let inside = |s: &Sample| {
            s.barycentric[0].min(s.barycentric[1]) > -1e-5 && s.barycentric.iter().sum::<f32>() < 1.0 + 1e-5
        };
        assert!(fine.signal_scales[0].samples.iter().all(inside));
        for (t, piece) in finer.bisected.pieces.iter().enumerate() {
            let width = |layout: &Layout, t: usize, signal: &Signal| {
                let [a, b, c] = layout.corners(t);
                DMat2::from_cols(b - a, c - a) * *signal.pixels.of(t).expect("a pixel has a size")
            };
            let (own, whole) = (
                width(&finer.layout, t, &fine.signal_scales[0]),
                width(&layout, piece.triangle as usize, &signal_scales[0]),
            );
            assert!((own - whole).to_cols_array().iter().all(|d| d.abs() < 1e-7));
        }
        let points: Vec<Vec2> = layout.points.iter().map(|p| p.as_vec2()).collect();
        let own: Vec<Vec2> = finer.layout.points.iter().map(|p| p.as_vec2()).collect();
        assert_eq!(finer.points(&points), own);
    }
}
