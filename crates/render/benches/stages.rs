//! What each stage costs for each pixel that the model covers, forward and adjoint.
//!
//! The scene is a torus of 2,304 triangles in a view of 512², with 512² textures and
//! mip levels. Items are covered pixels, so nanoseconds a pixel are 1000 over the
//! reported Mitem/s. What a stage reads comes from memory, what it returns goes there
//! (`black_box`): in the pipeline most of it stays in registers, see `view_*`.
//!
//! Rasterisation and the stages of one pixel run on one thread, the others on rayon's:
//! set `RAYON_NUM_THREADS=1` to compare all of them with one core's ceilings, which
//! the bench `machine` measures.

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{Vec2, Vec3, Vec4};
use parbake_image::FloatImage;
use parbake_image::MapValues;
use parbake_image::display::{Curve, Display};
use parbake_image::display_table::DisplayTable;
use parbake_image::pyramid::Pyramid;
use parbake_render::antialias::{Blends, find_blends};
use parbake_render::background::{Background, Composer};
use parbake_render::camera::{Camera, Projection};
use parbake_render::cutout::CutoutCoefficients;
use parbake_render::directions::ViewDirection;
use parbake_render::edges::EdgeAdjacency;
use parbake_render::frame::{TangentLight, tangent_light, tangent_light_adjoint};
use parbake_render::gradient_pixels::{GradientPixels, ShadedPixels};
use parbake_render::interpolate::{
    Barycentrics, barycentrics, barycentrics_adjoint, footprint_adjoint, interpolate,
};
use parbake_render::loss::{Comparison, ImageLoss, Reference, compare};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::pipeline::{self, Gradients, View};
use parbake_render::raster::{NOTHING, ScreenTriangles, Visibility, rasterise};
use parbake_render::scatter::{Fetch, Scatter};
use parbake_render::shade::{Brdf, Lambert};
use parbake_render::surface::{Surface, Textures};
use std::hint::black_box;

const SIZE: usize = 512;

fn main() {
    divan::main();
}

struct Bench {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    tangents: Vec<Vec4>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
    edges: EdgeAdjacency,
    color: Pyramid<3>,
    normal: Pyramid<3>,
    camera: Camera,
    composer: Composer,
    screen: ScreenTriangles,
    seen: Visibility,
    /// Premultiplied linear light.
    picture: Vec<[f32; 4]>,
    reference: Reference,
    /// Covered samples: triangle, x, y.
    samples: Vec<(usize, f64, f64)>,
}

fn texture(texel: impl Fn(f32, f32) -> [f32; 3]) -> Pyramid<3> {
    let at = |i: usize| texel((i % 512) as f32 / 512.0, (i / 512) as f32 / 512.0);
    Pyramid::from_base(FloatImage { width: 512, height: 512, texels: (0..512 * 512).map(at).collect() })
}

impl Bench {
    fn new() -> Self {
        let (around, across) = (48u32, 24u32);
        let tau = std::f32::consts::TAU;
        let (mut positions, mut normals, mut tangents) = (Vec::new(), Vec::new(), Vec::new());
        let (mut uvs, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..=around {
            for j in 0..=across {
                let (u, v) = (i as f32 / around as f32, j as f32 / across as f32);
                let ((su, cu), (sv, cv)) = (
                    ((i % around) as f32 / around as f32 * tau).sin_cos(),
                    ((j % across) as f32 / across as f32 * tau).sin_cos(),
                );
                let out = Vec3::new(cu * cv, sv, su * cv);
                positions.push(Vec3::new(cu, 0.0, su) * 0.65 + out * 0.35);
                normals.push(out);
                tangents.push(Vec4::new(-su, 0.0, cu, 1.0));
                uvs.push(Vec2::new(u, v));
            }
        }
        for i in 0..around {
            for j in 0..across {
                let at = |di: u32, dj: u32| (i + di) * (across + 1) + j + dj;
                triangles.push([at(0, 0), at(0, 1), at(1, 0)]);
                triangles.push([at(0, 1), at(1, 1), at(1, 0)]);
            }
        }
        let camera = Camera::towards_origin(Vec3::new(0.4, 1.0, 0.7), 3.5, Projection::Perspective(0.4));
        let display = Display { gain: 1.0, curve: Curve::Srgb };
        let composer = Composer::new(Background::Grey.for_view(0), display, SIZE);
        let screen = ScreenTriangles::new(&positions, &triangles, &camera, SIZE);
        let mut seen = Visibility::default();
        rasterise(&screen, SIZE, (0.0, 0.0), &mut seen);
        let picture: Vec<[f32; 4]> = seen
            .triangle
            .iter()
            .map(|&t| if t == NOTHING { [0.0; 4] } else { [0.4, 0.3, 0.2, 1.0] })
            .collect();
        // Not quite the same: where nothing differs, nothing is computed.
        let wanted: Vec<[f32; 4]> = picture.iter().map(|p| p.map(|x| 0.9 * x)).collect();
        let samples = (seen.triangle.iter().enumerate())
            .filter(|(_, t)| **t != NOTHING)
            .map(|(i, &t)| (t as usize, (i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5))
            .collect();
        Self {
            edges: EdgeAdjacency::new(&positions, &triangles),
            color: texture(|u, v| [0.5 + 0.4 * (60.0 * u).sin(), 0.5 + 0.4 * (45.0 * v).cos(), u * v]),
            normal: texture(|u, v| [0.2 * (80.0 * u).sin(), 0.2 * (70.0 * v).sin(), 0.95]),
            reference: Reference { size: SIZE, pixels: wanted },
            picture,
            positions,
            normals,
            tangents,
            uvs,
            triangles,
            camera,
            composer,
            screen,
            seen,
            samples,
        }
    }

    fn surface(&self) -> Surface<'_> {
        let Self { positions, normals, tangents, uvs, triangles, edges, .. } = self;
        Surface { positions, normals, tangents, uvs, triangles, edges }
    }

    fn textures(&self) -> Textures<'_> {
        Textures::new(&self.color, Some(&self.normal))
    }

    fn view(&self) -> View<'_> {
        let (camera, reference, composer) = (&self.camera, &self.reference, &self.composer);
        let comparison = Comparison { image: ImageLoss::L2, coverage: 1.0, ..Comparison::default() };
        View {
            camera,
            reference,
            composer,
            comparison,
            antialias: true,
            gradient_pixels: GradientPixels::All,
        }
    }

    fn blends(&self) -> Blends {
        let (screen, seen, edges) = (&self.screen, &self.seen, &self.edges);
        find_blends(screen, seen, edges, &self.positions, &self.triangles, &self.camera)
    }

    fn pixels(&self) -> ItemsCount {
        ItemsCount::new(self.samples.len())
    }

    fn texels(&self) -> ItemsCount {
        ItemsCount::new(self.color.levels[0].texels.len())
    }

    /// Each covered sample's coordinate, one that changes from pixel to pixel as a
    /// real one does.
    fn coordinates(&self) -> Vec<Vec2> {
        let at =
            |&(_, x, y): &(usize, f64, f64)| (Vec2::new(x as f32, y as f32) * (1.7 / SIZE as f32)).fract();
        self.samples.iter().map(at).collect()
    }
}

/// What one sample's shading reads, and the gradients that come back.
struct Shaded {
    surface: TangentLight,
    color: Vec3,
    map_normal: Vec3,
    gradient: Vec3,
}

const SHADED: Shaded = Shaded {
    surface: TangentLight { light: Vec3::new(0.2, -0.3, 0.8), gram: [0.9, 0.7, 0.8, 0.1, -0.2, 0.05] },
    color: Vec3::new(0.6, 0.5, 0.3),
    map_normal: Vec3::new(0.1, 0.2, 0.9),
    gradient: Vec3::new(0.4, -0.3, 0.2),
};

/// What one sample's frame reads besides its vertices.
struct Lit {
    to_light: Vec3,
    handedness: f32,
    facing: f32,
}

const LIT: Lit = Lit { to_light: Vec3::new(0.3, 0.2, 0.93), handedness: 1.0, facing: -1.0 };

#[divan::bench]
fn raster(bencher: Bencher) {
    let b = Bench::new();
    let mut seen = Visibility::default();
    bencher.counter(b.pixels()).bench_local(|| {
        let screen = ScreenTriangles::new(&b.positions, &b.triangles, &b.camera, SIZE);
        rasterise(&screen, SIZE, (0.0, 0.0), &mut seen);
    });
}

#[divan::bench]
fn interpolate_forward(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, x, y) in &b.samples {
            black_box(barycentrics(&b.screen.triangles[t], x, y));
        }
    });
}

#[divan::bench]
fn interpolate_adjoint(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, x, y) in &b.samples {
            let gradient = black_box([0.3, 0.2, 0.1]);
            black_box(barycentrics_adjoint(&b.screen.triangles[t], x, y, gradient));
        }
    });
}

#[divan::bench]
fn interpolate_adjoint_with_footprint(bencher: Bencher) {
    let b = Bench::new();
    let g = Barycentrics { weights: [0.3, 0.2, 0.1], per_x: [1.0, 2.0, 3.0], per_y: [3.0, 2.0, 1.0] };
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, x, y) in &b.samples {
            let g = black_box(&g);
            black_box(footprint_adjoint(&b.screen.triangles[t], x, y, g, g));
        }
    });
}

/// What the vertices carry, blended: texture coordinate with its footprint, position,
/// normal and tangent.
#[divan::bench]
fn interpolate_attributes(bencher: Bencher) {
    let b = Bench::new();
    let weights =
        Barycentrics { weights: [0.3, 0.2, 0.5], per_x: [0.1, 0.2, -0.3], per_y: [-0.1, 0.3, -0.2] };
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, ..) in &b.samples {
            let corners = b.triangles[t].map(|i| i as usize);
            let w = black_box(&weights);
            let uvs = corners.map(|i| b.uvs[i]);
            black_box([w.weights, w.per_x, w.per_y].map(|w| interpolate(uvs, w)));
            black_box(interpolate(corners.map(|i| b.positions[i]), w.weights));
            black_box(interpolate(corners.map(|i| b.normals[i]), w.weights));
            black_box(interpolate(corners.map(|i| b.tangents[i].truncate()), w.weights));
        }
    });
}

/// Where each sample falls, and from where it is seen.
fn view_directions(b: &Bench) -> Vec<(Vec2, ViewDirection)> {
    let view_direction = |&(t, x, y): &(usize, f64, f64)| {
        let weights = barycentrics(&b.screen.triangles[t], x, y).weights;
        let corners = b.triangles[t].map(|i| i as usize);
        let direction = b.camera.view_direction(interpolate(corners.map(|i| b.positions[i]), weights));
        let normal = interpolate(corners.map(|i| b.normals[i]), weights).normalize();
        let view_direction = ViewDirection { direction, cosine: normal.dot(direction) };
        (interpolate(corners.map(|i| b.uvs[i]), weights), view_direction)
    };
    b.samples.iter().map(view_direction).collect()
}

/// A parallax map of 64², by the order of its functions.
#[divan::bench(args = [0, 1, 2, 3, 4, 5, 6, 7])]
fn parallax_forward(bencher: Bencher, order: usize) {
    let b = Bench::new();
    let (map, view_directions) =
        (ParallaxCoefficients::zeros(parbake_model::Basis::Harmonics(order), 64), view_directions(&b));
    bencher.counter(b.pixels()).bench_local(|| {
        for (uv, view_direction) in &view_directions {
            black_box(map.shift(*uv, view_direction));
        }
    });
}

#[divan::bench(args = [0, 1, 2, 3, 4, 5, 6, 7])]
fn parallax_adjoint(bencher: Bencher, order: usize) {
    let b = Bench::new();
    let (map, view_directions) =
        (ParallaxCoefficients::zeros(parbake_model::Basis::Harmonics(order), 64), view_directions(&b));
    let mut into = map.zeros_like();
    bencher.counter(b.pixels()).bench_local(|| {
        for (uv, view_direction) in &view_directions {
            map.adjoint_of_maps(*uv, view_direction, black_box(Vec2::splat(0.1)), &mut into);
        }
    });
}

#[divan::bench(args = [0, 1, 2, 3])]
fn cutout_forward(bencher: Bencher, order: usize) {
    let b = Bench::new();
    let (map, view_directions) =
        (CutoutCoefficients::opaque(parbake_model::Basis::Harmonics(order), 128), view_directions(&b));
    bencher.counter(b.pixels()).bench_local(|| {
        for (uv, view_direction) in &view_directions {
            black_box(map.opacity(*uv, view_direction.direction));
        }
    });
}

#[divan::bench]
fn frame_forward(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, ..) in &b.samples {
            let (v, lit) = (b.triangles[t][0] as usize, black_box(&LIT));
            let tangent = b.tangents[v].truncate();
            black_box(tangent_light(b.normals[v], tangent, lit.handedness, lit.to_light, lit.facing));
        }
    });
}

#[divan::bench]
fn frame_adjoint(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, ..) in &b.samples {
            let (v, lit) = (b.triangles[t][0] as usize, black_box(&LIT));
            let (normal, tangent) = (b.normals[v], b.tangents[v].truncate());
            let gradient = &black_box(&SHADED).surface;
            black_box(tangent_light_adjoint(
                normal,
                tangent,
                lit.handedness,
                lit.to_light,
                lit.facing,
                gradient,
            ));
        }
    });
}

/// The level of detail of a footprint: one logarithm.
#[divan::bench]
fn texture_lod(bencher: Bencher) {
    let b = Bench::new();
    let footprint = (Vec2::new(0.004, 0.001), Vec2::new(-0.001, 0.003));
    bencher.counter(b.pixels()).bench_local(|| {
        for _ in &b.samples {
            let (per_x, per_y) = *black_box(&footprint);
            black_box(b.color.lod(per_x, per_y));
        }
    });
}

/// Bilinear at level of detail 0, trilinear at 0.7.
#[divan::bench(args = [0.0, 0.7])]
fn texture_forward(bencher: Bencher, lod: f32) {
    let b = Bench::new();
    let uvs = b.coordinates();
    bencher.counter(b.pixels()).bench_local(|| {
        for &uv in &uvs {
            black_box(b.color.fetch(uv, lod));
        }
    });
}

#[divan::bench(args = [0.0, 0.7])]
fn texture_adjoint_slopes(bencher: Bencher, lod: f32) {
    let b = Bench::new();
    let uvs = b.coordinates();
    bencher.counter(b.pixels()).bench_local(|| {
        for &uv in &uvs {
            let gradient = black_box([0.4, -0.3, 0.2]);
            black_box(b.color.slopes_at(&b.color.reach(uv, lod)).adjoint(&gradient));
        }
    });
}

#[divan::bench(args = [0.0, 0.7])]
fn texture_adjoint_scatter(bencher: Bencher, lod: f32) {
    let b = Bench::new();
    let fetches: Vec<_> = b.coordinates().into_iter().map(|uv| Fetch { uv, lod }).collect();
    let gradients = vec![[0.4, -0.3, 0.2]; fetches.len()];
    let mut into = b.color.zeros_like();
    bencher.counter(b.pixels()).bench_local(|| {
        let gradients: Vec<_> = gradients.chunks(2048).collect();
        Scatter::new(&b.color, fetches.chunks(2048)).add(&gradients, &mut into);
    });
}

#[divan::bench]
fn shade_forward(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for _ in &b.samples {
            let s = black_box(&SHADED);
            black_box(Lambert.light(&s.surface, &MapValues::of(s.color, s.map_normal)));
        }
    });
}

#[divan::bench]
fn shade_adjoint(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for _ in &b.samples {
            let s = black_box(&SHADED);
            black_box(Lambert.adjoint(&s.surface, &MapValues::of(s.color, s.map_normal), s.gradient));
        }
    });
}

/// Finding the silhouettes, which both directions share.
#[divan::bench]
fn antialias_find(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| b.blends());
}

#[divan::bench]
fn antialias_forward(bencher: Bencher) {
    let b = Bench::new();
    let (blends, mut rgba) = (b.blends(), b.picture.clone());
    bencher.counter(b.pixels()).bench_local(|| blends.forward(&mut rgba));
}

#[divan::bench]
fn antialias_adjoint(bencher: Bencher) {
    let b = Bench::new();
    let (blends, mut rgba) = (b.blends(), b.picture.clone());
    let tape = blends.forward(&mut rgba);
    bencher.counter(b.pixels()).bench_local(|| blends.adjoint(&tape, &mut rgba));
}

/// Values of a covered pixel that change from pixel to pixel, as curves see them.
fn lights(b: &Bench) -> Vec<[f32; 4]> {
    let at = |&(_, x, y): &(usize, f64, f64)| {
        [x as f32 / SIZE as f32, y as f32 / SIZE as f32, 0.3, 1.0 - (x as f32) / (4 * SIZE) as f32]
    };
    b.samples.iter().map(at).collect()
}

/// Background and display together, as a pixel meets them.
#[divan::bench]
fn background_and_display_forward(bencher: Bencher) {
    let b = Bench::new();
    let lights = lights(&b);
    bencher.counter(b.pixels()).bench_local(|| {
        for light in &lights {
            black_box(b.composer.forward(light, 10, 20));
        }
    });
}

#[divan::bench]
fn background_and_display_adjoint(bencher: Bencher) {
    let b = Bench::new();
    let composed: Vec<_> = lights(&b).iter().map(|light| b.composer.forward(light, 10, 20)).collect();
    bencher.counter(b.pixels()).bench_local(|| {
        for at in &composed {
            let gradient = black_box([0.4, -0.3, 0.2]);
            black_box(b.composer.adjoint(at, gradient, 10, 20));
        }
    });
}

/// The display curve alone, three channels a pixel.
#[divan::bench]
fn display_forward(bencher: Bencher) {
    let b = Bench::new();
    let (lights, display) = (lights(&b), Display { gain: 1.0, curve: Curve::Srgb });
    bencher.counter(b.pixels()).bench_local(|| {
        for &[r, g, b, _] in &lights {
            black_box([r, g, b].map(|x| display.encode(x)));
        }
    });
}

/// Value and slope by a power, which is what the adjoint costs.
#[divan::bench]
fn display_with_derivative(bencher: Bencher) {
    let b = Bench::new();
    let (lights, display) = (lights(&b), Display { gain: 1.0, curve: Curve::Srgb });
    bencher.counter(b.pixels()).bench_local(|| {
        for &[r, g, b, _] in &lights {
            black_box([r, g, b].map(|x| display.encode_with_derivative(x)));
        }
    });
}

/// The same from the table that the composer and the solvers use.
#[divan::bench]
fn display_table_with_derivative(bencher: Bencher) {
    let b = Bench::new();
    let (lights, display) = (lights(&b), DisplayTable::new(&Display { gain: 1.0, curve: Curve::Srgb }));
    bencher.counter(b.pixels()).bench_local(|| {
        for &[r, g, b, _] in &lights {
            black_box([r, g, b].map(|x| display.encode_with_derivative(x)));
        }
    });
}

/// The loss of three channels and its derivative: one function gives both.
#[divan::bench(args = [ImageLoss::L1, ImageLoss::L2, ImageLoss::LogL1])]
fn loss_forward_and_adjoint(bencher: Bencher, image: ImageLoss) {
    let b = Bench::new();
    let lights = lights(&b);
    bencher.counter(b.pixels()).bench_local(|| {
        for &[r, g, b, wanted] in &lights {
            black_box([r, g, b].map(|x| image.with_derivative(x, wanted)));
        }
    });
}

/// Background, display and loss, forward and adjoint in one pass over all pixels.
#[divan::bench(args = [ImageLoss::L1, ImageLoss::L2, ImageLoss::LogL1])]
fn compare_picture(bencher: Bencher, image: ImageLoss) {
    let b = Bench::new();
    let comparison = Comparison { image, coverage: 1.0, ..Comparison::default() };
    let shaded = ShadedPixels::all(SIZE);
    let run = || compare(&b.picture, &b.composer, &b.reference, &comparison, &shaded);
    bencher.counter(b.pixels()).bench_local(run);
}

/// Items are texels of the finest level.
#[divan::bench]
fn mip_forward(bencher: Bencher) {
    let b = Bench::new();
    bencher
        .counter(b.texels())
        .with_inputs(|| b.color.levels[0].clone())
        .bench_local_values(Pyramid::from_base);
}

/// Items are texels of the finest level.
#[divan::bench]
fn mip_adjoint(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.texels()).with_inputs(|| b.color.clone()).bench_local_values(|p| p.base_adjoint());
}

#[divan::bench]
fn view_forward(bencher: Bencher) {
    let b = Bench::new();
    bencher
        .counter(b.pixels())
        .bench_local(|| pipeline::forward(&b.surface(), &b.textures(), &Lambert, &b.view()));
}

/// With and without the gradients of what the vertices carry.
#[divan::bench(args = [false, true])]
fn view_adjoint(bencher: Bencher, vertices: bool) {
    let b = Bench::new();
    let (surface, textures, view) = (b.surface(), b.textures(), b.view());
    let tape = pipeline::forward(&surface, &textures, &Lambert, &view);
    let mut sums = Gradients::zeros(&surface, &textures, vertices);
    bencher
        .counter(b.pixels())
        .bench_local(|| pipeline::adjoint(&surface, &textures, &Lambert, &view, &tape, &mut sums));
}
