//! The paper's optimiser for all but texture coordinates (Knodt et al. 2023, Algorithm 1):
//! Adam on colours, normals, depth, SH coefficients and displacements along the normal
//! together, from grey textures that know nothing of the high-poly.
//!
//! What the paper leaves open is settled so: L_diff is the absolute difference of display
//! values in front of black; a step looks at a few views; the rate is constant until the
//! last k₂ steps, of which it falls along a cosine in all but the first third; λ_ΔV weighs the mean squared
//! displacement in the common frame. Tangent frames are those of the start, as
//! displacements are only applied at the end.
//!
//! Contract: as of `joint.rs`. The mesh has normals and tangents.

use crate::moving_points::MovingPoints;
use crate::points::{Motion, Points};
use crate::provisional::{MovingTexture, Provisional};
use crate::views::{Judgement, Views};
use glam::{Vec2, Vec3, Vec4};
use parbake_image::FloatImage;
use parbake_image::maps::lift_to_hemisphere;
use parbake_model::Basis;
use parbake_model::Mesh;
use parbake_progress::{Stage, Watcher};
use parbake_render::edges::EdgeAdjacency;
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::surface::{Surface, Textures};
use parbake_solve::adam::{Adam, AdamOptions, rate_at};
use parbake_solve::random::unit_interval;

/// What moves, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperOptions {
    /// Steps at the constant rate: k₀ + f k₁.
    pub steps: usize,
    /// k₂: steps in which the rate falls.
    pub last_steps: usize,
    /// Views that a step looks at.
    pub views_per_step: usize,
    /// Whether vertices move, and how.
    pub motion: Option<Motion>,
    /// Order of the parallax map's functions, and its side in texels; none for no map.
    pub parallax: Option<(usize, usize)>,
    /// Side of the textures in texels.
    pub texture_size: usize,
    /// λ_ΔV of the mean squared displacement. The paper's 5 is in units that it does not name;
    /// in these it would hold vertices where they are.
    pub displacement: f32,
    /// Adam's rate for textures and depth.
    pub rate: f32,
    /// The same for coefficients.
    pub coefficient_rate: f32,
    /// The same for displacements.
    pub vertex_rate: f32,
    /// ε₀: coefficients begin within ± this.
    pub epsilon: f32,
}

impl Default for PaperOptions {
    fn default() -> Self {
        Self {
            steps: 4500,
            last_steps: 500,
            views_per_step: 3,
            motion: Some(Motion::Normal),
            parallax: Some((3, 64)),
            texture_size: 256,
            displacement: 0.05,
            rate: 0.01,
            coefficient_rate: 3e-4,
            vertex_rate: 4e-3,
            epsilon: 1e-5,
        }
    }
}

/// What came out.
#[derive(Clone, Debug)]
pub struct PaperResult {
    /// V positions in the common frame.
    pub positions: Vec<Vec3>,
    /// The parallax map with its depth, where one was asked for.
    pub map: Option<ParallaxCoefficients>,
    /// L_diff of each step.
    pub losses: Vec<f64>,
    /// Mean and longest way of a point, in the common frame.
    pub moved: [f32; 2],
}

fn start_map(order: usize, size: usize, epsilon: f32) -> ParallaxCoefficients {
    let mut map = ParallaxCoefficients::zeros(Basis::Harmonics(order), size);
    let noise = |i: usize| (2.0 * unit_interval(i as u64) as f32 - 1.0) * epsilon;
    for (i, c) in map.coefficients.iter_mut().enumerate() {
        *c = Vec2::new(noise(2 * i), noise(2 * i + 1));
    }
    map.depth = Some(FloatImage::zeros(size, size));
    map
}

/// Coefficients and depth of a map, in lanes of four.
fn map_lanes(map: &ParallaxCoefficients) -> [Vec<Vec4>; 2] {
    let pairs = map.coefficients.iter().map(|c| Vec4::new(c.x, c.y, 0.0, 0.0)).collect();
    let depth = map.depth.iter().flat_map(|d| &d.texels).map(|d| Vec4::new(d[0], 0.0, 0.0, 0.0)).collect();
    [pairs, depth]
}

/// A parallax map on its way.
struct MovingMap {
    map: ParallaxCoefficients,
    /// Of coefficients and of depth.
    values: [Vec<Vec4>; 2],
    adams: [Adam; 2],
}

impl MovingMap {
    fn new(order: usize, size: usize, options: &PaperOptions) -> Self {
        let map = start_map(order, size, options.epsilon);
        let values = map_lanes(&map);
        let adam =
            |count: &Vec<Vec4>, rate| Adam::new(count.len(), AdamOptions { rate, ..AdamOptions::default() });
        let adams = [adam(&values[0], options.coefficient_rate), adam(&values[1], options.rate)];
        Self { map, values, adams }
    }

    fn step(&mut self, to_map: &ParallaxCoefficients, share: f32) {
        for ((adam, values), gradient) in self.adams.iter_mut().zip(&mut self.values).zip(map_lanes(to_map)) {
            adam.step(values, &gradient, share);
        }
        let [coefficients, depth] = &self.values;
        for (c, value) in self.map.coefficients.iter_mut().zip(coefficients) {
            *c = Vec2::new(value.x, value.y);
        }
        for (d, value) in self.map.depth.iter_mut().flat_map(|d| &mut d.texels).zip(depth) {
            d[0] = value.x;
        }
    }
}

/// Runs the algorithm.
pub fn paper_fit(
    mesh: &Mesh,
    views: &Views,
    seed: u64,
    options: &PaperOptions,
    watcher: &dyn Watcher,
) -> PaperResult {
    let points = Points::new(&mesh.positions, &mesh.normals, &mesh.triangles);
    let edges = EdgeAdjacency::new(&mesh.positions, &mesh.triangles);
    let mut moving = MovingPoints::new(&points, options.motion.unwrap_or_default(), options.vertex_rate);
    let grey = Provisional {
        color: FloatImage::solid(options.texture_size, Vec3::splat(0.5).extend(0.0)),
        normal: FloatImage::solid(options.texture_size, Vec4::Z),
    };
    let mut provisional = MovingTexture::new(grey, options.rate, lift_to_hemisphere);
    let mut map = options.parallax.map(|(order, size)| MovingMap::new(order, size, options));
    let mut losses = Vec::new();
    let total = options.steps + options.last_steps;
    for step in 0..total {
        watcher.progress(Stage::Shape, step, total);
        if views.references.is_empty() || watcher.stopped() {
            break;
        }
        let first = step * options.views_per_step;
        let chosen: Vec<(usize, u64)> = (first..first + options.views_per_step)
            .map(|i| (i % views.references.len(), seed ^ i as u64))
            .collect();
        let positions = points.vertices(moving.at());
        let surface = Surface {
            positions: &positions,
            normals: &mesh.normals,
            tangents: &mesh.tangents,
            uvs: &mesh.uvs,
            triangles: &mesh.triangles,
            edges: &edges,
        };
        let [colors, normals] = provisional.texture.pyramids();
        let textures = Textures::new(&colors, Some(&normals)).with_parallax(map.as_ref().map(|m| &m.map));
        let Judgement { loss, gradients } = views.look(&surface, &textures, &chosen);
        losses.push(loss.image);
        let share = rate_at(
            step.saturating_sub(options.steps),
            if step < options.steps { 0 } else { options.last_steps },
        );
        provisional.step(&gradients, share);
        if let (Some(map), Some(to_map)) = (&mut map, &gradients.parallax) {
            map.step(to_map, share);
        }
        if options.motion.is_some() {
            moving.step(&gradients.positions, &[], options.displacement * chosen.len() as f32, share);
        }
    }
    watcher.progress(Stage::Shape, total, total);
    PaperResult {
        positions: points.vertices(moving.at()),
        map: map.map(|m| m.map),
        losses,
        moved: moving.moved(),
    }
}
