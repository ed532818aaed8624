//! Choosing triangles, on tiny scenes.

use glam::Vec3;
use parbake_image::display::{Curve, Display};
use parbake_model::{AlphaMode, Material, Mesh, Model};
use parbake_progress::Watcher;
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;
use parbake_simplify::change::Change;
use parbake_simplify::collapse::collapse_to;
use parbake_simplify::pictures::Pictures;
use parbake_simplify::polish::PolishOptions;
use parbake_simplify::surface::Surface;
use parbake_simplify::target::Target;
use parbake_simplify::{ChooseOptions, Chosen, CoarseSurfaces, choose_triangles};
use parbake_views::high_poly::{Conventions, HighPoly};
use parbake_views::pool::{Rig, view_pool};

const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };

/// What its triangles begin with.
fn coarse_surfaces(high: &HighPoly) -> CoarseSurfaces {
    CoarseSurfaces::new(high.scene.mesh(), &[])
}

/// The triangles that are chosen first.
fn chosen(high: &HighPoly, options: &ChooseOptions, watcher: &dyn Watcher) -> Chosen {
    choose_triangles(high, None, &coarse_surfaces(high), options, watcher).swap_remove(0)
}

/// A choice of so many triangles that takes no time.
fn brief(triangles: usize) -> ChooseOptions {
    ChooseOptions {
        triangles,
        least: 0,
        room: 2,
        views: 8,
        sets: 1,
        attempts: 1,
        view_size: 48,
        polish: PolishOptions { rounds: 1, sweeps: 1, ..PolishOptions::default() },
        seed: 0,
    }
}

/// A sphere within another one, which has the next material.
fn nested(outer: usize, inner: usize) -> Mesh {
    let (mut mesh, inner) = (sphere(outer), sphere(inner));
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(inner.positions.iter().map(|p| 0.3 * *p));
    mesh.triangles.extend(inner.triangles.iter().map(|t| t.map(|v| v + first)));
    mesh.triangle_materials.fill(1);
    mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    mesh
}

/// A sphere of `rows` × 2 `rows` quadrilaterals, around +Y.
fn sphere(rows: usize) -> Mesh {
    let columns = 2 * rows;
    let point = |row: usize, column: usize| {
        let polar = std::f32::consts::PI * row as f32 / rows as f32;
        let turn = std::f32::consts::TAU * (column % columns) as f32 / columns as f32;
        Vec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin())
    };
    let mut mesh = Mesh::default();
    for (row, column) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
        let [a, b, c, d] = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
            .map(|(r, c)| point(r, c));
        for corners in [[a, b, c], [a, c, d]] {
            if (corners[1] - corners[0]).cross(corners[2] - corners[0]).length() < 1e-6 {
                continue;
            }
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
    }
    // Poles and seams are made of sines: one point each.
    mesh.positions.iter_mut().for_each(|p| *p = (*p * 4096.0).round() / 4096.0);
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

fn prepared(mesh: Mesh) -> HighPoly {
    prepared_of(mesh, vec![Material::default()])
}

fn prepared_of(mesh: Mesh, materials: Vec<Material>) -> HighPoly {
    let model = Model { name: "high".into(), mesh, materials, ..Model::default() };
    let conventions = Conventions {
        interpretation: Interpretation {
            decode_srgb: true,
            trilinear: true,
            parallax: true,
            extensions: false,
        },
        display: Display { gain: 1.0, curve: Curve::Srgb },
        rig: RIG,
        whole_material: None,
        max_distance: 0.1,
    };
    HighPoly::new(&model, conventions).unwrap_or_else(|error| unreachable!("{error}"))
}

fn targets(high: &HighPoly, count: usize, size: usize) -> Vec<Target> {
    view_pool(count, &RIG, 0).iter().map(|view| Target::new(high, None, view.camera, size)).collect()
}

/// Protects the one figure that everything is judged by: what a change is said to gain is what it gains, whether
/// points move, edges collapse, flip or split, or parts go.
#[test]
fn gains_are_what_changes_do() {
    let high = prepared(sphere(12));
    let targets = targets(&high, 6, 48);
    let mut pictures = Pictures::new(&targets, Surface::new(&sphere(6)));
    let start = pictures.error();
    assert!(start > 0.0 && pictures.surface.count() == 6 * 12 * 2 - 24);
    let mut kinds = [0; 4];
    for step in 0..60u32 {
        let edges = pictures.surface.edges();
        let [a, b] = edges[(step as usize * 37) % edges.len()];
        let surface = &pictures.surface;
        let middle = 0.5 * (surface.points[a as usize] + surface.points[b as usize]);
        let change = match step % 4 {
            0 => Change::collapse(surface, b, a, middle),
            1 => Change::flip(surface, a, b),
            2 => Change::split(surface, a, b, middle.normalize()),
            _ => Change::shift(surface, a, 1.03 * surface.points[a as usize]),
        };
        let Some(change) = change else { continue };
        kinds[step as usize % 4] += 1;
        let before = pictures.error();
        let (said, _) = pictures.best_of(vec![change.clone()]).unwrap();
        pictures.apply(&change);
        let anew = Pictures::new(&targets, pictures.surface.clone()).error();
        assert!((pictures.error() - anew).abs() < 1e-7, "what is kept is what is drawn: {step}");
        assert!((before - said - anew).abs() < 2e-5, "{step}: {said} {}", before - anew);
    }
    assert!(kinds.iter().all(|&count| count > 2), "{kinds:?}");
}

/// Protects topology and the budget: a closed surface stays closed, whatever is asked for.
#[test]
fn closed_surfaces_stay_closed() {
    let high = prepared(sphere(12));
    let targets = targets(&high, 6, 48);
    for wanted in [200, 60, 8] {
        let mut pictures = Pictures::new(&targets, Surface::new(&sphere(12)));
        collapse_to(&mut pictures, wanted, &());
        let surface = &pictures.surface;
        assert!((wanted - 1..=wanted).contains(&surface.count()), "{} of {wanted}", surface.count());
        assert!(surface.edges().iter().all(|&[a, b]| surface.at_edge(a, b).len() == 2));
    }
}

/// Protects time budgets: without time left triangles are polished no more, but still there are no more than wanted.
#[test]
fn without_time_the_budget_of_triangles_holds() {
    struct Late;
    impl Watcher for Late {
        fn seconds_left(&self) -> Option<f64> {
            Some(0.0)
        }
    }
    let high = prepared(sphere(8));
    let polish = PolishOptions { rounds: 2, sweeps: 1, ..PolishOptions::default() };
    let options = ChooseOptions {
        triangles: 40,
        least: 0,
        room: 2,
        views: 4,
        sets: 1,
        view_size: 32,
        polish,
        attempts: 1,
        seed: 0,
    };
    let chosen = chosen(&high, &options, &Late);
    assert!((39..=40).contains(&chosen.mesh.triangles.len()), "{}", chosen.mesh.triangles.len());
    let [before, after] = chosen.layers[0].error;
    assert_eq!(before, after);
    let [before, after] = self::chosen(&high, &options, &()).layers[0].error;
    assert!(after < before);
}

/// Protects budgets from what is hidden: of a sphere within another one little is left.
#[test]
fn what_is_never_seen_goes_first() {
    let mut mesh = nested(10, 6);
    mesh.triangle_materials.fill(0);
    let high = prepared(mesh.clone());
    let targets = targets(&high, 8, 48);
    let mut pictures = Pictures::new(&targets, Surface::new(&mesh));
    let error = pictures.error();
    collapse_to(&mut pictures, sphere(10).triangles.len(), &());
    let left = pictures.surface.to_mesh().positions.iter().filter(|p| p.length() < 0.9).count();
    // Triangles at the poles of the outer one are too small to be seen as well.
    assert!(3 * left < Surface::new(&sphere(6)).points.len(), "{left} points of the inner one are left");
    assert!(pictures.error() <= error + 1e-6);
}

/// Protects the choice: within its budget it is better than equal triangles all over, it ends, and threads do not
/// change it.
#[test]
fn chosen_triangles_fit_and_are_the_same_for_any_threads() {
    let high = prepared(sphere(24));
    let options = ChooseOptions {
        triangles: 96,
        least: 0,
        room: 3,
        views: 12,
        sets: 2,
        attempts: 2,
        view_size: 64,
        polish: PolishOptions { rounds: 2, ..PolishOptions::default() },
        seed: 0,
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap_or_else(|e| unreachable!("{e}"));
        pool.install(|| choose_triangles(&high, None, &coarse_surfaces(&high), &options, &()))
    };
    let (one, three) = (on(1), on(3));
    assert!(one.iter().zip(&three).all(|(one, three)| one.mesh == three.mesh));
    let [one, other] = &one[..] else { panic!("two attempts") };
    assert_ne!(one.mesh, other.mesh);
    assert_ne!(one.layers[0].starts, other.layers[0].starts, "each tells its own start first");
    assert!(one.mesh.triangles.len() <= 96 && one.mesh.triangles.len() >= 94);
    let [layer] = &one.layers[..] else { panic!("one layer") };
    assert!(layer.error[1] < layer.error[0]);
    assert_eq!(layer.starts.len(), 2, "one start for each attempt");
    let test = targets(&high, 10, 96);
    let error = |mesh: &Mesh| Pictures::new(&test, Surface::new(mesh)).error();
    let even = sphere(5);
    assert!(even.triangles.len() >= 80);
    assert!(error(&one.mesh) < 0.6 * error(&even), "{} {}", error(&one.mesh), error(&even));
}

/// Protects what is behind glass: it is a layer of its own and keeps its share, though the pane is before it from
/// every side.
#[test]
fn what_is_behind_glass_is_kept() {
    let mesh = nested(10, 8);
    let base_color = [1.0, 1.0, 1.0, 0.3];
    let glass = Material { alpha_mode: AlphaMode::Blend, base_color, ..Material::default() };
    let high = prepared_of(mesh, vec![Material::default(), glass]);
    let options = ChooseOptions {
        triangles: 120,
        least: 0,
        room: 2,
        views: 6,
        sets: 1,
        attempts: 1,
        view_size: 48,
        polish: PolishOptions { rounds: 0, sweeps: 1, ..PolishOptions::default() },
        seed: 0,
    };
    let chosen = chosen(&high, &options, &());
    let is_inner = |t: &&[u32; 3]| t.iter().all(|&v| chosen.mesh.positions[v as usize].length() < 0.6);
    let inner = chosen.mesh.triangles.iter().filter(is_inner).count();
    assert!(
        inner >= 12 && chosen.mesh.triangles.len() > inner + 24,
        "{inner} of {}",
        chosen.mesh.triangles.len()
    );
    assert!(chosen.mesh.triangles.len() <= 120);
    assert_eq!(chosen.layers.len(), 2);
}

/// A cube of `cells`² squares a side with the normals of its sides.
fn cube(cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for side in 0..6 {
        let (axis, sign) = (side % 3, if side < 3 { 1.0f32 } else { -1.0 });
        let first = mesh.positions.len() as u32;
        for (row, column) in (0..=cells).flat_map(|row| (0..=cells).map(move |column| (row, column))) {
            let at = |i: u32| 2.0 * i as f32 / cells as f32 - 1.0;
            let mut point = [0.0; 3];
            (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (sign, at(column), sign * at(row));
            let mut normal = [0.0; 3];
            normal[axis] = sign;
            mesh.positions.push(0.5 * Vec3::from(point));
            mesh.normals.push(Vec3::from(normal));
        }
        for (row, column) in (0..cells).flat_map(|row| (0..cells).map(move |column| (row, column))) {
            let a = first + row * (cells + 1) + column;
            mesh.triangles.extend([[a, a + 1, a + cells + 2], [a, a + cells + 2, a + cells + 1]]);
        }
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

/// Protects flat sides from normals that lean over their edges, and round things from edges: low-polys are hard where the
/// high-poly is.
#[test]
fn edges_are_hard_where_the_high_poly_has_them() {
    let options = brief(40);
    let mesh = chosen(&prepared(cube(4)), &options, &()).mesh;
    let lean = |index: usize| {
        let face = mesh.area_normal(index).normalize();
        let normals = mesh.triangles[index].map(|vertex| mesh.normals[vertex as usize]);
        normals.map(|normal| face.angle_between(normal).to_degrees()).iter().sum::<f32>() / 3.0
    };
    let mean = (0..mesh.triangles.len()).map(lean).sum::<f32>() / mesh.triangles.len() as f32;
    // Smooth ones lean by about 40; a corner that was cut off does so a little.
    assert!(mean < 10.0, "normals lean by {mean} degrees");
    let mesh = chosen(&prepared(sphere(12)), &options, &()).mesh;
    // Euler's formula for a closed surface: no vertex is split.
    assert_eq!(mesh.positions.len(), mesh.triangles.len() / 2 + 2);
}

/// Never has time.
struct Stopped;

impl Watcher for Stopped {
    fn stopped(&self) -> bool {
        true
    }
}

/// Protects the number of triangles that was asked for, also where there is no time to choose them by pictures.
#[test]
fn a_stop_leaves_no_more_triangles_than_were_asked_for() {
    let found = chosen(&prepared(sphere(16)), &ChooseOptions { room: 3, ..brief(60) }, &Stopped);
    assert!((20..=60).contains(&found.mesh.triangles.len()), "{}", found.mesh.triangles.len());
}

/// Protects parts that have to stay from quadrics that would let the small one go, where there is no time.
#[test]
fn a_stop_leaves_each_part_what_it_keeps() {
    let high = prepared_of(nested(16, 4), vec![Material::default(); 2]);
    let coarse = CoarseSurfaces::new(high.scene.mesh(), &[0, 1]);
    let options = ChooseOptions { least: 4, room: 3, ..brief(60) };
    let mesh = choose_triangles(&high, None, &coarse, &options, &Stopped).swap_remove(0).mesh;
    let small = mesh.triangle_materials.iter().filter(|&&material| material == 0).count();
    assert!(small >= 4 && mesh.triangles.len() <= 60, "{small} of {}", mesh.triangles.len());
}
