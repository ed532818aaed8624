//! The fits of crate `fit` on scenes of a few triangles and views of a few pixels: textures, parallax maps,
//! cutouts. Whole bakes are tested in `parbake`.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use parbake_fit::backend::{Backend, Cpu};
use parbake_fit::cutout::CutoutOptions;
use parbake_fit::parallax::{ParallaxOptions, State, mean_square};
use parbake_fit::parallax_maps::{FittedMaps, ParallaxInput, ParallaxPass, ParallaxPlan, fit_parallax_maps};
use parbake_fit::schedule::{Comparison, Fitted, Schedule, fit_textures};
use parbake_fit::texels::Texels;
use parbake_fit::view_gradient::Sums;
use parbake_image::MapKind;
use parbake_image::display::{Curve, Display};
use parbake_image::display_table::DisplayTable;
use parbake_image::quantise::to_image;
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Basis, Image, Material, Mesh, Model, TextureSlot};
use parbake_progress::{Message, Watcher};
use parbake_render::camera::Projection;
use parbake_render::directions::ViewDirection;
use parbake_render::interpretation::Interpretation;
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::shade::Lambert;
use parbake_views::high_poly::{Conventions, HighPoly, ViewSet};
use parbake_views::low_poly::LowPoly;
use parbake_views::pool::Rig;
use parbake_views::projection::{ProjectedMaps, project};
use parbake_views::reference::{Reference, Sampling};
use parbake_views::samples::collect_samples;
use parbake_views::view_sample::sample_views;
use parbake_views::view_sampler::{UncoveredPixels, ViewSampler};
use std::sync::Arc;

const DISPLAY: Display = Display { gain: 1.0, curve: Curve::Srgb };
const VIEW: usize = 48;
const TEXELS: usize = 32;

/// A square in the plane at this height, ±`half` wide, whose texture is the part of a soft checker that it
/// covers: squares of different sizes show the same.
fn square(name: &str, half: f32, height: f32) -> Model {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vec2::from);
    let mesh = Mesh {
        positions: corners.iter().map(|c| (*c * half).extend(height)).collect(),
        normals: vec![Vec3::Z; 4],
        uvs: corners.iter().map(|c| Vec2::new(0.5 + 0.5 * c.x, 0.5 - 0.5 * c.y)).collect(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![0; 2],
        ..Mesh::default()
    };
    let side = 64;
    let pixel = |i: usize| {
        let place = |k: usize| half * (2.0 * (k as f32 + 0.5) / side as f32 - 1.0);
        let (x, y) = (place(i % side), -place(i / side));
        let wave = (7.0 * x).sin() * (7.0 * y).sin();
        [
            (140.0 + 100.0 * wave) as u8,
            (120.0 - 80.0 * wave) as u8,
            (130.0 + 60.0 * (3.0 * x).cos()) as u8,
            255,
        ]
    };
    let pixels = (0..side * side).map(pixel).collect();
    let images = vec![Image { name: "checker".into(), width: side, height: side, pixels }];
    let slot = TextureSlot { image: 0, ..TextureSlot::default() };
    let materials = vec![Material { base_color_texture: Some(slot), ..Material::default() }];
    Model { name: name.into(), mesh, materials, images, ..Model::default() }
}

/// With what everything here is fitted. References are rendered with the same BRDF.
const COMPARISON: Comparison<Lambert, Cpu> =
    Comparison { backend: &Cpu, brdf: &Lambert, display: DISPLAY, srgb: true };

/// A pair made ready, and its views.
struct Scene {
    low: Model,
    high: HighPoly,
    prepared: LowPoly,
    projected: ProjectedMaps,
    references: Arc<Vec<Reference>>,
}

impl Scene {
    fn new(high: &Model, low: Model, views: usize) -> Self {
        let conventions = Conventions {
            whole_material: Some(false),
            interpretation: Interpretation::default(),
            display: DISPLAY,
            rig: Rig { radius: 3.5, projection: Projection::Perspective(0.4) },
            max_distance: 0.5,
        };
        let high = HighPoly::new(high, conventions).unwrap();
        let prepared = LowPoly::new(&low, &high.frame, TEXELS).unwrap();
        let projected = project(&prepared, &high);
        let sampling = Sampling { size: VIEW, filter: 0.5, samples: 2 };
        let references = high.references(&ViewSet { count: views, seed: 3, jitter: true, sampling }, &());
        Self { low, high, prepared, projected, references }
    }

    fn sampler(&self) -> ViewSampler<'_> {
        ViewSampler::new(&self.prepared.placed, VIEW, &DISPLAY, UncoveredPixels::Ignore)
    }

    fn parallax_maps(&self, plan: &ParallaxPlan) -> FittedMaps {
        let Self { low, high, prepared, projected, references } = self;
        let sampler = &self.sampler();
        let input = ParallaxInput { low, prepared, projected, high, references, sampler };
        fit_parallax_maps(&input, &COMPARISON, plan, &()).unwrap()
    }

    fn textures(&self, watcher: &dyn Watcher) -> Fitted {
        let samples = collect_samples(&self.sampler(), &self.references, TEXELS, &());
        let (atlas, start) = (&self.prepared.atlas, &self.projected.maps);
        fit_textures(&samples, atlas, start, &COMPARISON, &Schedule::default(), watcher)
    }
}

fn plan(cutout: Option<CutoutOptions>, steps: usize) -> ParallaxPlan {
    let pass = |steps| ParallaxPass { texture_size: TEXELS, steps, rate: 2e-3 };
    let parallax = ParallaxOptions { size: 8, views_per_step: 8, ..ParallaxOptions::default() };
    ParallaxPlan { views: 64, cutout, parallax, passes: [pass(steps), pass(0), pass(0)] }
}

/// A square whose high-poly lies below it: what is seen moves with the direction.
fn sunken() -> Scene {
    Scene::new(&square("high", 1.0, -0.12), square("low", 0.8, 0.0), 48)
}

/// Runs with so many threads.
fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// Protects the sign and the size of shifts: a plane that lies deeper is seen where geometry says, the views
/// agree better, and the number of threads changes nothing.
#[test]
fn shifts_show_what_lies_deeper() {
    let scene = sunken();
    let fitted = with_threads(1, || scene.parallax_maps(&plan(None, 80)));
    let report = fitted.report.as_ref().unwrap();
    let [first, last] = report.mean_square[0];
    assert!(last < 0.5 * first, "{first} {last}");
    assert_eq!(report.misplaced, None);
    let map = &fitted.maps.parallax;
    let to_viewer = Vec3::new(0.5, 0.0, 1.0).normalize();
    // A point at depth 0.12 below a square 1.6 wide, seen along the direction.
    let wanted = -0.12 * (to_viewer.x / to_viewer.z) / 1.6;
    for uv in [Vec2::new(0.35, 0.5), Vec2::new(0.6, 0.4), Vec2::new(0.5, 0.6)] {
        let shift = map.shift(uv, &ViewDirection { direction: to_viewer, cosine: to_viewer.z });
        assert!((shift.x - wanted).abs() < 0.5 * wanted.abs(), "{uv}: {shift} {wanted}");
        assert!(shift.y.abs() < 0.5 * wanted.abs(), "{uv}: {shift}");
    }
    let other = with_threads(3, || scene.parallax_maps(&plan(None, 80)));
    assert!(other.maps.parallax == *map, "threads change the result");
}

/// Protects outlines: where the low-poly stands out beyond the high-poly it is left out from where that is
/// seen, and only there.
#[test]
fn what_stands_out_is_cut() {
    let scene = Scene::new(&square("high", 0.7, 0.0), square("low", 1.0, 0.0), 32);
    let options = CutoutOptions { size: 16, steps: 60, views_per_step: 8, ..CutoutOptions::default() };
    let fitted = scene.parallax_maps(&plan(Some(options), 0));
    let [before, after] = fitted.report.unwrap().misplaced.unwrap();
    assert!(before > 0.3 && after < 0.2 * before, "{before} {after}");
    let cutout = fitted.maps.cutout.unwrap();
    assert!(cutout.opacity(Vec2::splat(0.5), Vec3::Z) > 0.0, "the middle stays");
    assert!(cutout.opacity(Vec2::splat(0.05), Vec3::Z) < 0.0, "the border is left out");
    // What is left are the pixels that the high-poly fills too.
    let kept: usize = fitted.views.iter().map(Vec::len).sum();
    let all: usize = sample_views(&scene.sampler(), &scene.references).iter().map(Vec::len).sum();
    assert!(kept > 0 && kept <= all, "{kept} {all}");
}

/// Protects the gradient of a view by parallax coefficients and by both maps, against central differences of
/// its loss.
#[test]
fn a_views_gradient_is_its_losss() {
    let scene = sunken();
    let views = sample_views(&scene.sampler(), &scene.references[..2]);
    let display = DisplayTable::new(&DISPLAY);
    let mut map = ParallaxCoefficients::zeros(Basis::Harmonics(1), 4);
    map.coefficients.iter_mut().enumerate().for_each(|(i, c)| {
        *c = Vec2::new(((7 * i) % 11) as f32 - 5.0, ((5 * i) % 13) as f32 - 6.0) * 1e-3;
    });
    let state = State { map, maps: scene.projected.maps.clone() };
    let texels = Texels::<2>::new(&state.maps);
    let mut sums = Sums::zeros(&state.map, &texels);
    for view in &views {
        Cpu.view_gradient(view, &state.map, &texels, &Lambert, &display, &mut sums);
    }
    let count: usize = views.iter().map(Vec::len).sum();
    let loss = |state: &State| 3.0 * count as f64 * mean_square(&Cpu, &views, state, &Lambert, &display);
    assert!((sums.loss - loss(&state)).abs() < 1e-9 * sums.loss.max(1.0));
    let check = |what: &str, half: f32, h: f32, moved: &dyn Fn(f32) -> State| {
        let slope = (loss(&moved(h)) - loss(&moved(-h))) / (4.0 * f64::from(h));
        let off = (f64::from(half) - slope).abs();
        assert!(off < 0.05 * slope.abs().max(0.2), "{what}: {half} {slope}");
    };
    for i in [0, 9, 22, 37, 50, 63] {
        check("coefficient", sums.map.coefficients[i].x, 2e-4, &|h| {
            let mut moved = state.clone();
            moved.map.coefficients[i].x += h;
            moved
        });
    }
    for texel in [200, 500, 530, 800] {
        for (k, kind) in texels.kinds.into_iter().enumerate() {
            check(kind.spec().name, sums.texels[texel][k].x, 2e-3, &|h| {
                let mut moved = state.clone();
                moved.maps.get_mut(kind).unwrap().texels[texel].x += h;
                moved
            });
        }
    }
}

/// Protects the solve: from a projection that sees the high-poly below, textures come closer to the views in
/// steps whose losses are reported, whatever the number of threads.
#[test]
fn textures_come_closer_to_the_views() {
    let scene = sunken();
    let one = with_threads(1, || scene.textures(&()));
    let [first, last] = [one.losses.first(), one.losses.last()].map(|loss| loss.unwrap().mean_square);
    assert!(last < 0.95 * first, "{first} {last}");
    assert!(!one.stopped && one.covered > 0 && one.unseen < one.covered / 10);
    let kinds: Vec<MapKind> = one.images.iter().map(|(kind, _)| *kind).collect();
    assert_eq!(kinds, [MapKind::BaseColor, MapKind::Normal]);
    assert!(with_threads(3, || scene.textures(&())).images == one.images, "threads change the result");
}

/// Asks to stop at once.
struct Impatient;

impl Watcher for Impatient {
    fn message(&self, _: Message) {}

    fn stopped(&self) -> bool {
        true
    }
}

/// Protects runs that are stopped: what is written is no worse than the projection, which it is here.
#[test]
fn a_stopped_solve_gives_the_projection() {
    let scene = sunken();
    let stopped = scene.textures(&Impatient);
    assert!(stopped.stopped);
    let image = |kind| to_image(kind, scene.projected.maps.get(kind).unwrap(), true);
    let color = image(MapKind::BaseColor);
    let own = stopped.images.iter().find(|(kind, _)| *kind == MapKind::BaseColor).unwrap();
    let differing = own.1.pixels.iter().zip(&color.pixels).filter(|(a, b)| a[..3] != b[..3]).count();
    assert!(differing <= own.1.pixels.len() / 100, "{differing} of {}", own.1.pixels.len());
}
