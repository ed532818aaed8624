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

use crate::guard::Guard;
use crate::joint::{lanes, pyramid};
use crate::points::{Motion, Points};
use crate::views::Views;
use glam::{Vec2, Vec3, Vec4};
use parbake_adam::{Adam, AdamOptions, rate_at};
use parbake_fit::canvas::Canvas;
use parbake_fit::views::unit_interval;
use parbake_fit::watch::{Stage, Watch};
use parbake_model::Mesh;
use parbake_render::edges::EdgeAdjacency;
use parbake_render::parallax::ShParallax;
use parbake_render::surface::{Surface, Textures};
use parbake_render::texture::Level;

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
    pub map: Option<ShParallax>,
    /// L_diff of each step.
    pub losses: Vec<f64>,
    /// Mean and longest way of a point, in the common frame.
    pub moved: [f32; 2],
}

fn start_map(order: usize, size: usize, epsilon: f32) -> ShParallax {
    let mut map = ShParallax::zeros(order, size);
    let noise = |i: usize| (2.0 * unit_interval(i as u64) as f32 - 1.0) * epsilon;
    for (i, c) in map.coefficients.iter_mut().enumerate() {
        *c = Vec2::new(noise(2 * i), noise(2 * i + 1));
    }
    map.depth = Some(Level::zeros(size, size));
    map
}

/// Coefficients and depth of a map, in lanes of four.
fn map_lanes(map: &ShParallax) -> [Vec<Vec4>; 2] {
    let pairs = map.coefficients.iter().map(|c| Vec4::new(c.x, c.y, 0.0, 0.0)).collect();
    let depth = map.depth.iter().flat_map(|d| &d.texels).map(|d| Vec4::new(d[0], 0.0, 0.0, 0.0)).collect();
    [pairs, depth]
}

/// Runs the algorithm.
pub fn paper_fit(
    mesh: &Mesh,
    views: &Views,
    seed: u64,
    options: &PaperOptions,
    watch: &impl Watch,
) -> PaperResult {
    let points = Points::new(&mesh.positions, &mesh.normals, &mesh.triangles);
    let guard = Guard::new(&points.home, &points.triangles);
    let edges = EdgeAdjacency::new(&mesh.positions, &mesh.triangles);
    let mut color = Canvas::solid(options.texture_size, Vec3::splat(0.5).extend(0.0));
    let mut normal = Canvas::solid(options.texture_size, Vec4::Z);
    let mut map = options.parallax.map(|(order, size)| start_map(order, size, options.epsilon));
    let mut map_values = map.as_ref().map(map_lanes).unwrap_or_default();
    let mut values = vec![Vec4::ZERO; points.home.len()];
    let mut at = points.home.clone();

    let adam = |count, rate| Adam::new(count, AdamOptions { rate, ..AdamOptions::default() });
    let texels = color.texels.len();
    let mut adam_color = adam(texels, options.rate);
    let mut adam_normal = adam(texels, options.rate);
    let mut adam_map = adam(map_values[0].len(), options.coefficient_rate);
    let mut adam_depth = adam(map_values[1].len(), options.rate);
    let mut adam_points = adam(values.len(), options.vertex_rate);
    let mut losses = Vec::new();
    let total = options.steps + options.last_steps;
    for step in 0..total {
        watch.progress(Stage::Shape, step, total);
        if views.references.is_empty() || watch.should_stop() {
            break;
        }
        let first = step * options.views_per_step;
        let chosen: Vec<(usize, u64)> = (first..first + options.views_per_step)
            .map(|i| (i % views.references.len(), seed ^ i as u64))
            .collect();
        let positions = points.vertices(&at);
        let surface = Surface {
            positions: &positions,
            normals: &mesh.normals,
            tangents: &mesh.tangents,
            uvs: &mesh.uvs,
            triangles: &mesh.triangles,
            edges: &edges,
        };
        let (colors, normals) = (pyramid(&color), pyramid(&normal));
        let textures = Textures::new(&colors, Some(&normals)).with_parallax(map.as_ref());
        let judged = views.look(&surface, &textures, &chosen);
        losses.push(judged.loss.image);
        let share = rate_at(
            step.saturating_sub(options.steps),
            if step < options.steps { 0 } else { options.last_steps },
        );

        let gradients = judged.gradients;
        adam_color.step(&mut color.texels, &lanes(gradients.color.levels.first()), share);
        for texel in &mut color.texels {
            *texel = texel.clamp(Vec4::ZERO, Vec4::ONE);
        }
        let to_normal = gradients.normal.as_ref().and_then(|n| n.levels.first());
        adam_normal.step(&mut normal.texels, &lanes(to_normal), share);
        for texel in &mut normal.texels {
            let [x, y, z, _] = texel.to_array();
            *texel = Vec3::new(x, y, z.max(0.02)).normalize().extend(0.0);
        }
        if let (Some(map), Some(to_map)) = (&mut map, &gradients.parallax) {
            let [to_coefficients, to_depth] = map_lanes(to_map);
            adam_map.step(&mut map_values[0], &to_coefficients, share);
            adam_depth.step(&mut map_values[1], &to_depth, share);
            for (c, value) in map.coefficients.iter_mut().zip(&map_values[0]) {
                *c = Vec2::new(value.x, value.y);
            }
            for (d, value) in map.depth.iter_mut().flat_map(|d| &mut d.texels).zip(&map_values[1]) {
                d[0] = value.x;
            }
        }
        if let Some(motion) = options.motion {
            let mut to_values = points.adjoint(motion, &gradients.positions);
            let pull = 2.0 * options.displacement * chosen.len() as f32 / values.len().max(1) as f32;
            for (gradient, value) in to_values.iter_mut().zip(&values) {
                *gradient += *value * pull;
            }
            adam_points.step(&mut values, &to_values, share);
            let mut next = points.displaced(motion, &values);
            if guard.hold(&at, &mut next) > 0 {
                values = points.values(motion, &next);
            }
            at = next;
        }
    }
    watch.progress(Stage::Shape, total, total);
    let way: Vec<f32> = at.iter().zip(&points.home).map(|(a, h)| a.distance(*h)).collect();
    let moved = [way.iter().sum::<f32>() / way.len().max(1) as f32, way.iter().copied().fold(0.0, f32::max)];
    PaperResult { positions: points.vertices(&at), map, losses, moved }
}
