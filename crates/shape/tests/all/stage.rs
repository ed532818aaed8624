//! The fit of vertices on an octahedron whose high-poly is a ball: outlines come closer, the mesh stays what
//! it was, and one that fits already does not move.

use glam::{Vec2, Vec3, Vec4};
use parbake_image::FloatImage;
use parbake_image::display::{Curve, Display};
use parbake_model::{Material, Mesh, Model};
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;
use parbake_shape::points::Motion;
use parbake_shape::provisional::Provisional;
use parbake_shape::seen::{ShapeViews, smooth_references};
use parbake_shape::stage::{ShapePlan, ShapeReport, grow_for_cutout, shape, shape_views};
use parbake_shape::{ShapeOptions, fit_shape};
use parbake_views::frame::{placed, scene};
use parbake_views::high_poly::{Conventions, HighPoly};
use parbake_views::low_poly::LowPoly;
use parbake_views::pool::Rig;

/// An octahedron whose triangles were halved along all edges so often, on the ball of this radius. Each of the
/// eight faces is a chart of its own, so every edge between them is a seam.
fn ball(name: &str, halvings: usize, radius: f32) -> Model {
    let mut mesh = Mesh::default();
    for face in 0..8u32 {
        let signs = Vec3::from([0, 1, 2].map(|axis| if face >> axis & 1 == 0 { 1.0 } else { -1.0 }));
        let mut triangles =
            vec![[Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (axis * signs, Vec2::new(axis.x, axis.y)))];
        for _ in 0..halvings {
            triangles = triangles
                .into_iter()
                .flat_map(|[a, b, c]| {
                    let mid = |a: (Vec3, Vec2), b: (Vec3, Vec2)| ((a.0 + b.0).normalize(), 0.5 * (a.1 + b.1));
                    let [ab, bc, ca] = [mid(a, b), mid(b, c), mid(c, a)];
                    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                })
                .collect();
        }
        let cell = Vec2::new((face % 4) as f32, (face / 4) as f32);
        for triangle in triangles {
            let first = mesh.positions.len() as u32;
            for (position, uv) in triangle {
                mesh.positions.push(position * radius);
                mesh.normals.push(position);
                mesh.uvs.push((cell + Vec2::splat(0.1) + 0.8 * uv) * Vec2::new(0.25, 0.5));
            }
            let flipped = signs.x * signs.y * signs.z < 0.0;
            mesh.triangles.push(if flipped {
                [first, first + 2, first + 1]
            } else {
                [first, first + 1, first + 2]
            });
            mesh.triangle_materials.push(0);
        }
    }
    Model { name: name.into(), mesh, materials: vec![Material::default()], ..Model::default() }
}

fn prepared(high: &Model) -> HighPoly {
    let conventions = Conventions {
        whole_material: Some(false),
        interpretation: Interpretation::default(),
        display: Display { gain: 1.0, curve: Curve::Srgb },
        rig: Rig { radius: 3.5, projection: Projection::Perspective(0.4) },
        max_distance: 0.5,
    };
    HighPoly::new(high, conventions).expect("a ball has an extent")
}

fn plan(motion: Motion) -> ShapePlan {
    let fit = ShapeOptions { motion, steps: 30, views_per_step: 6, seed: 5, ..ShapeOptions::default() };
    ShapePlan { views: 24, view_size: 64, largest_size: 64, texture_size: 32, samples: 2, fit }
}

fn fitted(high: &Model, low: &Model, motion: Motion, threads: usize) -> (Mesh, ShapeReport) {
    let (mesh, report, _) = fitted_and_seen(high, low, motion, threads);
    (mesh, report)
}

fn fitted_and_seen(
    high: &Model,
    low: &Model,
    motion: Motion,
    threads: usize,
) -> (Mesh, ShapeReport, ShapeViews) {
    let (high, plan) = (prepared(high), plan(motion));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    let mut mesh = low.mesh.clone();
    let (report, seen) = pool.install(|| {
        shape("low", &mut mesh, &high, &plan, &()).expect("every face has its place in the texture")
    });
    (mesh, report, seen)
}

/// Protects what the stage is for: vertices of a coarse ball move out until its outlines lie about the
/// high-poly's, along normals or freely; seams stay closed, no triangle turns over, coordinates and
/// triangles stay, and threads change nothing.
#[test]
fn outlines_come_closer() {
    let (high, low) = (ball("high", 3, 1.0), ball("low", 1, 1.0));
    for motion in [Motion::Normal, Motion::Free] {
        let (mesh, report) = fitted(&high, &low, motion, 1);
        assert!(report.gap[1] < 0.7 * report.gap[0], "{motion:?}: {:?}", report.gap);
        assert!(report.before[1] > report.before[0], "a coarse ball lies inside: {:?}", report.before);
        assert!(report.steps == 30 && report.moved[1] >= report.moved[0] && report.moved[0] > 0.0);
        let radius = |mesh: &Mesh| mesh.positions.iter().map(|p| p.length()).sum::<f32>();
        assert!(radius(&mesh) > radius(&low.mesh));
        assert_eq!((&mesh.uvs, &mesh.triangles), (&low.mesh.uvs, &low.mesh.triangles));
        let moved = &mesh.positions;
        for (i, a) in low.mesh.positions.iter().enumerate() {
            for (j, b) in low.mesh.positions.iter().enumerate().take(i) {
                assert!(a != b || moved[i] == moved[j], "the seam at {a} opened");
            }
        }
        assert!((0..mesh.triangles.len()).all(|t| mesh.area_normal(t).dot(low.mesh.area_normal(t)) > 0.0));
        assert!(fitted(&high, &low, motion, 3).0 == mesh, "threads change the result");
    }
}

/// Protects a low-poly that fits already: it stays to the bit, whatever noise its views have.
#[test]
fn a_mesh_that_fits_stays() {
    let model = ball("same", 2, 1.0);
    let (mesh, report) = fitted(&model, &model, Motion::Free, 2);
    assert_eq!(mesh.positions, model.mesh.positions);
    assert_eq!(report.moved, [0.0; 2]);
}

/// Protects time and shape: where views show outlines in one place, also of triangles smaller than pixels, no step is taken.
#[test]
fn outlines_that_agree_take_no_steps() {
    // Those of the second one are smaller than pixels: several edges cross each at the outline.
    for (halvings, view_size) in [(3, 64), (5, 24)] {
        let model = ball("same", halvings, 1.0);
        let plan = ShapePlan { view_size, largest_size: view_size, ..plan(Motion::Free) };
        let mut mesh = model.mesh.clone();
        let (report, _) = shape("low", &mut mesh, &prepared(&model), &plan, &()).expect("it has coordinates");
        assert_eq!((report.steps, report.gap), (0, [0.0; 2]), "{halvings}");
        assert_eq!(mesh.positions, model.mesh.positions);
    }
}

/// Protects outlines that are close from views whose pixels do not show how close, and time where they are far apart.
#[test]
fn close_outlines_are_looked_at_closely() {
    let high = prepared(&ball("high", 4, 1.0));
    let plan = ShapePlan { largest_size: 72, ..plan(Motion::Free) };
    let sizes = [1, 3].map(|halvings| {
        let placed = placed(&ball("low", halvings, 1.0), &high.frame);
        shape_views(&placed, &high, &plan, &()).fitted.size
    });
    assert_eq!(sizes, [64, 72]);
}

/// Protects vertices from views that they were fitted to: where others show outlines no closer, they stay.
#[test]
fn other_views_have_the_last_word() {
    let (high, low) = (prepared(&ball("high", 3, 1.0)), ball("low", 1, 1.0));
    let plan = plan(Motion::Free);
    let mesh = LowPoly::new(&low, &high.frame, plan.texture_size).expect("it has coordinates").placed;
    let mut seen = shape_views(&mesh, &high, &plan, &());
    let has_moved = |seen: &ShapeViews| {
        let texture = |value| FloatImage::solid(plan.texture_size, value);
        let start = Provisional { color: texture(Vec4::ONE), normal: texture(Vec4::Z) };
        fit_shape(&mesh, start, seen, high.conventions.display, &plan.fit, &()).positions != mesh.positions
    };
    assert!(has_moved(&seen));
    // These show the low-poly as it is.
    let mut same = prepared(&low);
    same.scene = scene(&low, &high.frame, Interpretation::default());
    seen.checked.references = smooth_references(&same, 12, plan.view_size, plan.samples, 9, &());
    assert!(!has_moved(&seen));
}

/// Protects the surface that a cutout is taken from: beyond where the vertices are by themselves there is less of the
/// high-poly that it does not cover; what other viewers show stays to the bit, and seams stay closed.
#[test]
fn what_will_be_cut_reaches_further() {
    let (high, low) = (ball("high", 3, 1.0), ball("low", 1, 1.0));
    let (mut mesh, before, seen) = fitted_and_seen(&high, &low, Motion::Free, 2);
    let (high, mut plan) = (prepared(&high), plan(Motion::Free));
    plan.fit = ShapeOptions { overhang_discount: 0.9, least_gap: 2.0 * before.gap[0], ..plan.fit };
    let plain = mesh.clone();
    let report = grow_for_cutout("low", &mut mesh, &high, &seen, &plan, &()).expect("it has coordinates");
    assert!(report.after[1] < 0.7 * report.before[1], "{:?} {:?}", report.before, report.after);
    let outwards = |(p, offset): (&Vec3, &Vec3)| offset.dot(p.normalize());
    assert!(mesh.positions.iter().zip(&mesh.parallax_offsets).map(outwards).sum::<f32>() > 0.0);
    for (i, a) in plain.positions.iter().enumerate() {
        for (j, b) in plain.positions.iter().enumerate().take(i) {
            assert!(a != b || mesh.parallax_offsets[i] == mesh.parallax_offsets[j], "the seam at {a} opened");
        }
    }
    mesh.parallax_offsets.clear();
    assert!(mesh == plain);
}
