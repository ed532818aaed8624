//! What each stage costs for each pixel that the model covers, forward and adjoint.
//!
//! The scene is a torus of 2,304 triangles in a view of 512², with 512² textures and
//! mip levels. The small stages run on one thread; those of the whole view (`view_*`)
//! on rayon's. Reported are items, covered pixels, per second.

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{Vec2, Vec3, Vec4};
use parbake_render::antialias::{Blends, find_blends};
use parbake_render::background::{Background, Composer};
use parbake_render::camera::{Camera, Projection};
use parbake_render::display::{Curve, Display};
use parbake_render::edges::EdgeAdjacency;
use parbake_render::frame::{TangentLight, tangent_light, tangent_light_adjoint};
use parbake_render::interpolate::{Barycentrics, barycentrics, barycentrics_adjoint, footprint_adjoint};
use parbake_render::loss::{Comparison, ImageLoss, Reference, compare};
use parbake_render::pipeline::{self, Gradients, Surface, Textures, View};
use parbake_render::raster::{NOTHING, ScreenTriangles, Visibility, rasterise};
use parbake_render::scatter::{Fetch, Scatter};
use parbake_render::shade::{Lambert, Shading};
use parbake_render::texture::{Level, Pyramid};
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
    Pyramid::from_base(Level { width: 512, height: 512, texels: (0..512 * 512).map(at).collect() })
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
        let samples = (seen.triangle.iter().enumerate())
            .filter(|(_, t)| **t != NOTHING)
            .map(|(i, &t)| (t as usize, (i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5))
            .collect();
        Self {
            edges: EdgeAdjacency::new(&positions, &triangles),
            color: texture(|u, v| [0.5 + 0.4 * (60.0 * u).sin(), 0.5 + 0.4 * (45.0 * v).cos(), u * v]),
            normal: texture(|u, v| [0.2 * (80.0 * u).sin(), 0.2 * (70.0 * v).sin(), 0.95]),
            reference: Reference::new(&picture, SIZE, &composer),
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
        let comparison = Comparison { image: ImageLoss::L2, coverage: 1.0 };
        View { camera, reference, composer, comparison, antialias: true }
    }

    fn blends(&self) -> Blends {
        let (screen, seen, edges) = (&self.screen, &self.seen, &self.edges);
        find_blends(screen, seen, edges, &self.positions, &self.triangles, &self.camera)
    }

    fn pixels(&self) -> ItemsCount {
        ItemsCount::new(self.samples.len())
    }

    /// Each covered sample's coordinate, one that changes from pixel to pixel as a
    /// real one does.
    fn coordinates(&self) -> Vec<Vec2> {
        let at = |&(_, x, y): &(usize, f64, f64)| Vec2::new(x as f32, y as f32) * (1.7 / SIZE as f32);
        self.samples.iter().map(at).collect()
    }
}

const SURFACE: TangentLight =
    TangentLight { light: Vec3::new(0.2, -0.3, 0.8), gram: [0.9, 0.7, 0.8, 0.1, -0.2, 0.05] };
const GRADIENT: Vec3 = Vec3::new(0.4, -0.3, 0.2);

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
            black_box(barycentrics_adjoint(&b.screen.triangles[t], x, y, [0.3, 0.2, 0.1]));
        }
    });
}

#[divan::bench]
fn interpolate_adjoint_with_footprint(bencher: Bencher) {
    let b = Bench::new();
    let g = Barycentrics { weights: [0.3, 0.2, 0.1], per_x: [1.0, 2.0, 3.0], per_y: [3.0, 2.0, 1.0] };
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, x, y) in &b.samples {
            black_box(footprint_adjoint(&b.screen.triangles[t], x, y, &g, &g));
        }
    });
}

#[divan::bench]
fn frame_forward(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, ..) in &b.samples {
            let v = b.triangles[t][0] as usize;
            black_box(tangent_light(b.normals[v], b.tangents[v].truncate(), 1.0, Vec3::Z, 1.0));
        }
    });
}

#[divan::bench]
fn frame_adjoint(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for &(t, ..) in &b.samples {
            let v = b.triangles[t][0] as usize;
            let tangent = b.tangents[v].truncate();
            black_box(tangent_light_adjoint(b.normals[v], tangent, 1.0, Vec3::Z, 1.0, &SURFACE));
        }
    });
}

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
            black_box(b.color.slopes_at(&b.color.reach(uv, lod)).adjoint(&GRADIENT.to_array()));
        }
    });
}

#[divan::bench(args = [0.0, 0.7])]
fn texture_adjoint_scatter(bencher: Bencher, lod: f32) {
    let b = Bench::new();
    let fetches: Vec<_> = b.coordinates().into_iter().map(|uv| Fetch { uv, lod }).collect();
    let gradients = vec![GRADIENT.to_array(); fetches.len()];
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
            black_box(Lambert.forward(black_box(&SURFACE), Vec3::ONE, Vec3::Z));
        }
    });
}

#[divan::bench]
fn shade_adjoint(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| {
        for _ in &b.samples {
            black_box(Lambert.adjoint(black_box(&SURFACE), Vec3::ONE, Vec3::Z, GRADIENT));
        }
    });
}

#[divan::bench]
fn antialias_find(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).bench_local(|| b.blends());
}

#[divan::bench]
fn antialias_forward_and_adjoint(bencher: Bencher) {
    let b = Bench::new();
    let (blends, mut rgba) = (b.blends(), b.picture.clone());
    bencher.counter(b.pixels()).bench_local(|| {
        let tape = blends.forward(&mut rgba);
        blends.adjoint(&tape, &mut rgba)
    });
}

/// Background, display and loss, forward and adjoint in one pass over all pixels.
#[divan::bench(args = [ImageLoss::L1, ImageLoss::L2, ImageLoss::LogL1])]
fn display_and_loss(bencher: Bencher, image: ImageLoss) {
    let b = Bench::new();
    let comparison = Comparison { image, coverage: 1.0 };
    bencher.counter(b.pixels()).bench_local(|| compare(&b.picture, &b.composer, &b.reference, &comparison));
}

#[divan::bench]
fn mip_forward(bencher: Bencher) {
    let b = Bench::new();
    bencher
        .counter(b.pixels())
        .with_inputs(|| b.color.levels[0].clone())
        .bench_local_values(Pyramid::from_base);
}

#[divan::bench]
fn mip_adjoint(bencher: Bencher) {
    let b = Bench::new();
    bencher.counter(b.pixels()).with_inputs(|| b.color.clone()).bench_local_values(|p| p.base_adjoint());
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
