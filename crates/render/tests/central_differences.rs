//! The whole view's adjoint, and antialiasing's, against central differences of the
//! forward pass: over random scenes, both projections and both facings.
//!
//! Where a step changes which triangle a pixel sees, the forward pass jumps by what no
//! gradient describes; such components are left out, and counted.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use parbake_image::FloatImage;
use parbake_image::display::{Curve, Display};
use parbake_image::pyramid::Pyramid;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Basis, Wrap};
use parbake_render::background::{Background, Composer};
use parbake_render::camera::{Camera, Projection};
use parbake_render::edges::EdgeAdjacency;
use parbake_render::gradient_pixels::GradientPixels;
use parbake_render::loss::{Comparison, ImageLoss, Reference};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::pipeline::{Gradients, Tape, View, adjoint, forward};
use parbake_render::shade::{Lambert, Unlit};
use parbake_render::surface::{Surface, Textures};

/// Uniform numbers (PCG's multiplier, top bits only).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn signed(&mut self) -> f32 {
        2.0 * self.next() - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

#[derive(Clone)]
struct Scene {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    tangents: Vec<Vec4>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
    edges: EdgeAdjacency,
    color: FloatImage<[f32; 3]>,
    normal: FloatImage<[f32; 3]>,
    reference: Vec<[f32; 4]>,
    camera: Camera,
    size: usize,
    trilinear: bool,
    background: Background,
    comparison: Comparison,
    antialias: bool,
    gradient_pixels: GradientPixels,
    lit: bool,
    parallax: Option<ParallaxCoefficients>,
}

/// A lumpy torus with one texture seam each way. Odd seeds are turned inside out:
/// every face is seen from behind, with normals that say so. From seed 8 on the two
/// textures differ in size.
fn scene(seed: u64, size: usize) -> Scene {
    let mut random = Random(seed.wrapping_mul(977) + 5);
    let (around, across) = (14usize, 8usize);
    let inside_out = seed % 2 == 1;
    let mut lumps = vec![Vec3::ZERO; around * across];
    lumps.iter_mut().for_each(|l| *l = random.vector() * 0.05);
    let mut s = Scene {
        positions: Vec::new(),
        normals: Vec::new(),
        tangents: Vec::new(),
        uvs: Vec::new(),
        triangles: Vec::new(),
        edges: EdgeAdjacency::default(),
        color: noise_texture(&mut random, 24, |r| [r.next(), r.next(), r.next()]),
        normal: noise_texture(&mut random, if seed < 8 { 24 } else { 20 }, |r| {
            [0.4 * r.signed(), 0.4 * r.signed(), 0.9]
        }),
        reference: (0..size * size)
            .map(|i| {
                let (x, y) = ((i % size) as f32 / size as f32, (i / size) as f32 / size as f32);
                let a = 0.5 + 0.5 * (5.0 * x).sin() * (4.0 * y).cos();
                [0.6 * a * x, 0.5 * a * y, 0.3 * a, a]
            })
            .collect(),
        camera: Camera::towards_origin(
            random.vector() + Vec3::new(0.0, 1.2, 0.4),
            3.5,
            if seed % 4 < 2 { Projection::Perspective(0.42) } else { Projection::Orthographic(1.35) },
        ),
        size,
        trilinear: true,
        background: Background::Color([0.1, 0.3, 0.2]),
        comparison: Comparison { image: ImageLoss::L2, coverage: 0.7, overhang_discount: 0.6 },
        antialias: true,
        gradient_pixels: GradientPixels::All,
        lit: true,
        parallax: None,
    };
    let facing = if inside_out { -1.0 } else { 1.0 };
    for i in 0..=around {
        for j in 0..=across {
            let (u, v) = (i as f32 / around as f32, j as f32 / across as f32);
            let (sin_u, cos_u) = (u * std::f32::consts::TAU).sin_cos();
            let (sin_v, cos_v) = (v * std::f32::consts::TAU).sin_cos();
            let out = Vec3::new(cos_u * cos_v, sin_v, sin_u * cos_v);
            // Wrapped corners must coincide to the bit: take them from the first.
            let (wi, wj) = (i % around, j % across);
            let p = if i == wi && j == wj {
                Vec3::new(cos_u, 0.0, sin_u) * 0.75 + out * 0.33 + lumps[i * across + j]
            } else {
                s.positions[if i == wi { i * (across + 1) } else { wj }]
            };
            s.positions.push(p);
            s.normals.push(facing * out + random.vector() * 0.2);
            let tangent = Vec3::new(-sin_u, 0.0, cos_u) + random.vector() * 0.2;
            s.tangents.push(tangent.extend(if seed.is_multiple_of(3) { -1.0 } else { 1.0 }));
            s.uvs.push(Vec2::new(u, v) * 1.4 + Vec2::new(random.signed(), random.signed()) * 0.02);
        }
    }
    for i in 0..around {
        for j in 0..across {
            let corner = |di: usize, dj: usize| ((i + di) * (across + 1) + j + dj) as u32;
            for mut t in
                [[corner(0, 0), corner(0, 1), corner(1, 0)], [corner(0, 1), corner(1, 1), corner(1, 0)]]
            {
                if inside_out {
                    t.swap(1, 2);
                }
                s.triangles.push(t);
            }
        }
    }
    s.edges = EdgeAdjacency::new(&s.positions, &s.triangles);
    s
}

fn noise_texture(
    random: &mut Random,
    width: usize,
    mut texel: impl FnMut(&mut Random) -> [f32; 3],
) -> FloatImage<[f32; 3]> {
    let texels = (0..width * 16).map(|_| texel(random)).collect();
    FloatImage { width, height: 16, texels }
}

impl Scene {
    fn run(&self, gradients: bool) -> (Tape, Option<Gradients>) {
        let pyramid = |level: &FloatImage<[f32; 3]>| {
            let mut p = if self.trilinear {
                Pyramid::from_base(level.clone())
            } else {
                Pyramid::single(level.clone())
            };
            p.wrap = [Wrap::Repeat, Wrap::Mirror];
            p
        };
        let (color, normal) = (pyramid(&self.color), pyramid(&self.normal));
        let surface = Surface {
            positions: &self.positions,
            normals: &self.normals,
            tangents: &self.tangents,
            uvs: &self.uvs,
            triangles: &self.triangles,
            edges: &self.edges,
        };
        let textures =
            Textures::new(&color, self.lit.then_some(&normal)).with_parallax(self.parallax.as_ref());
        let display = Display { gain: 0.95, curve: Curve::Srgb };
        let composer = Composer::new(self.background.for_view(3), display, self.size);
        let reference = Reference { size: self.size, pixels: self.reference.clone() };
        let view = View {
            camera: &self.camera,
            reference: &reference,
            composer: &composer,
            comparison: self.comparison,
            antialias: self.antialias,
            gradient_pixels: self.gradient_pixels,
        };
        let tape = if self.lit {
            forward(&surface, &textures, &Lambert, &view)
        } else {
            forward(&surface, &textures, &Unlit, &view)
        };
        let sums = gradients.then(|| {
            let mut sums = Gradients::zeros(&surface, &textures, true);
            if self.lit {
                adjoint(&surface, &textures, &Lambert, &view, &tape, &mut sums);
            } else {
                adjoint(&surface, &textures, &Unlit, &view, &tape, &mut sums);
            }
            sums
        });
        (tape, sums)
    }
}

/// Compares some of `analytic` (the largest, and random ones) with central differences
/// of the loss; `nudge` moves a component and returns by how much it really moved.
///
/// One of three steps must agree to 1 %, or its part to one side: the forward pass has
/// kinks (texel cells, mip levels, the display curve's toe, L1 at 0, a silhouette half-way
/// between two pixels), which small steps pass by, and rounding, which large steps drown.
fn check(
    name: &str,
    scene: &Scene,
    analytic: &[f32],
    step: f32,
    nudge: impl Fn(&mut Scene, usize, f32) -> f64,
) {
    let scale = f64::from(analytic.iter().fold(0f32, |m, g| m.max(g.abs())));
    assert!(scale > 0.0, "{name}: no gradient at all");
    let mut order: Vec<usize> = (0..analytic.len()).collect();
    order.sort_by(|&a, &b| analytic[b].abs().total_cmp(&analytic[a].abs()));
    let mut random = Random(91);
    let others = (0..12).map(|_| (random.next() * analytic.len() as f32) as usize);
    let chosen: Vec<usize> = order[..12].iter().copied().chain(others).collect();
    let base = scene.run(false).0.loss.total(&scene.comparison);
    let mut left_out = 0;
    for &i in &chosen {
        let expected = f64::from(analytic[i]);
        let mut seen = Vec::new();
        for step in [step, step / 4.0, step / 16.0] {
            let (mut lo, mut hi) = (scene.clone(), scene.clone());
            let (back, ahead) = (nudge(&mut lo, i, -step), nudge(&mut hi, i, step));
            let ((lo, _), (hi, _)) = (lo.run(false), hi.run(false));
            if lo.seen.triangle != hi.seen.triangle {
                continue;
            }
            let [lo, hi] = [lo, hi].map(|tape| tape.loss.total(&scene.comparison));
            seen.extend([(hi - lo) / (ahead - back), (hi - base) / ahead, (lo - base) / back]);
        }
        left_out += usize::from(seen.is_empty());
        let close = |n: &f64| (n - expected).abs() <= 0.01 * expected.abs() + 0.003 * scale;
        let right = seen.is_empty() || seen.iter().any(close);
        assert!(
            right,
            "{name} {i}: differences (both sides, ahead, back) {seen:?}, adjoint {expected:e}, largest {scale:e}"
        );
    }
    assert!(left_out * 4 < chosen.len(), "{name}: {left_out} components only change what is seen");
}

fn nudge_by(value: &mut f32, step: f32) -> f64 {
    let before = *value;
    *value += step;
    f64::from(*value) - f64::from(before)
}

/// Vertices that a seam has split move together, or the surface would tear.
fn check_positions(name: &str, scene: &Scene, gradients: &[Vec3]) {
    let first = |v: usize| scene.positions.iter().position(|p| *p == scene.positions[v]).unwrap();
    let mut sums = vec![0.0; 3 * gradients.len()];
    for (v, gradient) in gradients.iter().enumerate() {
        for axis in 0..3 {
            sums[3 * first(v) + axis] += gradient[axis];
        }
    }
    let shared: Vec<f32> = (0..sums.len()).map(|i| sums[3 * first(i / 3) + i % 3]).collect();
    check(name, scene, &shared, 2e-4, |s, i, h| {
        let before = s.positions[i / 3];
        let mut after = before;
        let moved = nudge_by(&mut after[i % 3], h);
        s.positions.iter_mut().filter(|p| **p == before).for_each(|p| *p = after);
        moved
    });
}

fn check_all(scene: &Scene, name: &str) {
    let (_, gradients) = scene.run(true);
    let g = gradients.unwrap();
    let flat = |level: FloatImage<[f32; 3]>| level.texels.into_iter().flatten().collect::<Vec<f32>>();
    let flat3 = |v: &[Vec3]| v.iter().flat_map(|v| v.to_array()).collect::<Vec<f32>>();
    check(&format!("{name} colour"), scene, &flat(g.color.base_adjoint()), 4e-3, |s, i, h| {
        nudge_by(&mut s.color.texels[i / 3][i % 3], h)
    });
    let uvs: Vec<f32> = g.uvs.iter().flat_map(|v| v.to_array()).collect();
    check(&format!("{name} uv"), scene, &uvs, 2e-4, |s, i, h| nudge_by(&mut s.uvs[i / 2][i % 2], h));
    check_positions(&format!("{name} position"), scene, &g.positions);
    if let Some(normal) = g.normal {
        check(&format!("{name} normal map"), scene, &flat(normal.base_adjoint()), 4e-3, |s, i, h| {
            nudge_by(&mut s.normal.texels[i / 3][i % 3], h)
        });
        check(&format!("{name} normal"), scene, &flat3(&g.normals), 2e-3, |s, i, h| {
            nudge_by(&mut s.normals[i / 3][i % 3], h)
        });
        check(&format!("{name} tangent"), scene, &flat3(&g.tangents), 2e-3, |s, i, h| {
            nudge_by(&mut s.tangents[i / 3][i % 3], h)
        });
    }
}

/// Protects every gradient of a fit: four seeds are both projections × both facings.
#[test]
fn whole_view_trilinear() {
    for seed in 0..4 {
        check_all(&scene(seed, 48), &format!("seed {seed}"));
    }
}

/// Protects the gradients through shifted fetches, and those of what shifts them: maps,
/// direction and cosine.
#[test]
fn whole_view_with_parallax() {
    for seed in 0..4 {
        let mut random = Random(seed + 400);
        let mut map = ParallaxCoefficients {
            wrap: [Wrap::Repeat; 2],
            ..ParallaxCoefficients::zeros(Basis::Harmonics(2), 6)
        };
        let mut shift = || Vec2::new(random.signed(), random.signed()) * 0.02;
        map.coefficients.iter_mut().for_each(|c| *c = shift());
        let texels = (0..25).map(|i| [0.5 + (i % 7) as f32 * 0.2]).collect();
        map.depth = (seed % 2 == 0).then_some(FloatImage { width: 5, height: 5, texels });
        let s = Scene { parallax: Some(map), ..scene(seed, 48) };
        check_all(&s, &format!("seed {seed}"));
        let maps = s.run(true).1.unwrap().parallax.unwrap();
        let to_map: Vec<f32> = maps.coefficients.iter().flat_map(|c| c.to_array()).collect();
        check(&format!("seed {seed} coefficients"), &s, &to_map, 4e-4, |s, i, h| {
            nudge_by(&mut s.parallax.as_mut().unwrap().coefficients[i / 2][i % 2], h)
        });
        if let Some(depth) = maps.depth {
            let to_depth: Vec<f32> = depth.texels.iter().map(|t| t[0]).collect();
            check(&format!("seed {seed} depth"), &s, &to_depth, 1e-2, |s, i, h| {
                nudge_by(&mut s.parallax.as_mut().unwrap().depth.as_mut().unwrap().texels[i][0], h)
            });
        }
    }
}

/// Protects the fast path: bilinear, logarithmic loss, checker.
#[test]
fn whole_view_bilinear_log_loss() {
    for seed in 4..8 {
        let comparison = Comparison { image: ImageLoss::LogL1, coverage: 0.0, ..Comparison::default() };
        let background = Background::Checker { cells: 6 };
        let s = Scene { trilinear: false, comparison, background, ..scene(seed, 48) };
        check_all(&s, &format!("seed {seed}"));
    }
}

/// Protects pictures on planes: no light, no normal map, L1.
#[test]
fn whole_view_unlit() {
    for seed in 8..12 {
        let comparison = Comparison { image: ImageLoss::L1, coverage: 0.3, ..Comparison::default() };
        check_all(&Scene { lit: false, comparison, ..scene(seed, 48) }, &format!("seed {seed}"));
    }
}

/// Protects the interior's gradients by themselves, with nothing blended.
#[test]
fn whole_view_without_antialiasing() {
    for seed in 12..16 {
        let comparison = Comparison { image: ImageLoss::L2, coverage: 0.0, ..Comparison::default() };
        check_all(&Scene { antialias: false, comparison, ..scene(seed, 48) }, &format!("seed {seed}"));
    }
}

/// Protects a stochastic descent from a bias: gradients and losses of a quarter of the pixels are those of all in the mean.
#[test]
fn quarters_of_the_pixels_agree_in_the_mean() {
    let s = scene(5, 48);
    let (tape, all) = s.run(true);
    let all = all.unwrap();
    let mut loss = 0.0;
    let largest = all.positions.iter().map(|g| g.abs().max_element()).fold(0.0, f32::max);
    let quarters = [0, 1, 2, 3].map(GradientPixels::Quarter);
    let mut mean = vec![Vec3::ZERO; all.positions.len()];
    for gradient_pixels in quarters {
        let (quarter, one) = Scene { gradient_pixels, ..s.clone() }.run(true);
        let one = one.unwrap();
        loss += quarter.loss.total(&s.comparison) / quarters.len() as f64;
        assert_ne!(one.positions, all.positions);
        for (sum, own) in mean.iter_mut().zip(&one.positions) {
            *sum += *own / quarters.len() as f32;
        }
    }
    for (mean, all) in mean.iter().zip(&all.positions) {
        assert!((*mean - *all).abs().max_element() < 1e-4 * largest, "{mean} {all}");
    }
    let whole = tape.loss.total(&s.comparison);
    assert!((loss - whole).abs() < 1e-6 * whole, "{loss} {whole}");
}

/// Protects the silhouette's gradient: coverage alone, which nothing else moves.
#[test]
fn coverage_moves_vertices() {
    for seed in 0..8 {
        let mut s = scene(seed, 48);
        s.color.texels.fill([0.0; 3]);
        s.background = Background::Black;
        let (tape, gradients) = s.run(true);
        assert!(tape.rgba.iter().any(|p| p[3] > 0.0 && p[3] < 1.0));
        check_positions(&format!("seed {seed}"), &s, &gradients.unwrap().positions);
    }
}

/// Protects coverage itself: on a turned square's outline it is the covered share of
/// each pixel, and inside, inner edges and seams leave no trace.
#[test]
fn coverage_is_the_covered_share() {
    const SIZE: usize = 64;
    for seed in 0..20 {
        let mut random = Random(seed);
        let (mut s, turn) = (scene(2, SIZE), random.next() * 1.5);
        let (sin, cos) = turn.sin_cos();
        let centre = Vec3::new(random.signed(), random.signed(), 0.0) * 0.1;
        let corner = |x: f32, y: f32| centre + Vec3::new(cos * x - sin * y, sin * x + cos * y, 0.0) * 0.5;
        let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        s.camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Orthographic(1.0));
        s.positions = vec![a, b, c, a, c, d];
        s.triangles = vec![[0, 1, 2], [3, 4, 5]];
        s.edges = EdgeAdjacency::new(&s.positions, &s.triangles);
        let (smooth, rough) = (s.run(false).0, Scene { antialias: false, ..s.clone() }.run(false).0);

        let inside = |x: f32, y: f32| {
            let p = Vec3::new(2.0 * x / SIZE as f32 - 1.0, 1.0 - 2.0 * y / SIZE as f32, 0.0) - centre;
            (cos * p.x + sin * p.y).abs() <= 0.5 && (cos * p.y - sin * p.x).abs() <= 0.5
        };
        let mut error = [0.0; 2];
        let mut outline = 0;
        for i in 0..SIZE * SIZE {
            let (x, y) = ((i % SIZE) as f32, (i / SIZE) as f32);
            let part = |k: usize| (k as f32 + 0.5) / 16.0;
            let samples = (0..256).filter(|k| inside(x + part(k % 16), y + part(k / 16))).count();
            if samples == 256 {
                assert!(smooth.rgba[i][3] > 0.85, "turn {turn}: a hole at {x} {y}");
            } else if samples > 0 {
                outline += 1;
                for (sum, tape) in error.iter_mut().zip([&smooth, &rough]) {
                    *sum += (tape.rgba[i][3] - samples as f32 / 256.0).abs();
                }
            }
            let next = |dx: usize, dy: usize| {
                rough.rgba.get(i + dx + dy * SIZE - SIZE - 1).is_some_and(|p| p[3] > 0.0)
            };
            if x > 0.0 && y > 0.0 && (0..9).all(|k| next(k % 3, k / 3)) {
                assert_eq!(smooth.rgba[i], rough.rgba[i], "turn {turn}: a trace at {x} {y}");
            }
        }
        let [smooth, rough] = error.map(|sum| sum / outline as f32);
        // Worst at 45°, where an edge touches pixels beyond the pair that it parts.
        assert!(smooth < 0.08 && smooth < 0.6 * rough, "turn {turn}: {smooth}, without blending {rough}");
    }
}

/// Protects reproducible bakes: the same bits whatever the threads.
#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let s = scene(1, 96);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (tape, gradients) = pool.install(|| s.run(true));
        (tape.rgba, tape.loss, gradients.unwrap())
    };
    let (one, two, five) = (on(1), on(2), on(5));
    assert!(one.0 == two.0 && one.1 == two.1 && one.2 == two.2);
    assert!(one.0 == five.0 && one.1 == five.1 && one.2 == five.2);
}
