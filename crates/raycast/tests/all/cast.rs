//! Whole textures: samples, borders of charts, gutters, rays.

use crate::scenes::{WHOLE, add_sheet, cube, painted, pair, square};
use parbake_image::MapKind;
use parbake_model::Mesh;
use parbake_model::glam::{Vec3, vec2, vec3};
use parbake_raycast::{CastMaps, CastOptions, GeometryMap, cast_maps};
use parbake_views::projection::Search;

fn options(samples: usize, maps: &[GeometryMap]) -> CastOptions {
    CastOptions {
        samples,
        search: Search::Nearest,
        smooth_rays: true,
        maps: maps.to_vec(),
        rays: 16,
        occlusion_distance: 2.0,
        curvature_radius: 0.02,
    }
}

/// Base colour's first channel of a texel.
fn red(maps: &CastMaps, size: usize, x: usize, y: usize) -> f32 {
    maps.maps.get(MapKind::BaseColor).unwrap().texels[y * size + x].x
}

/// A white half and a black half that meet at this x, on the square of the scene.
fn halves(x: f32) -> Mesh {
    let mut mesh = Mesh::default();
    add_sheet(&mut mesh, vec3(-1.0, -1.0, 0.0), [Vec3::X * (1.0 + x), Vec3::Y * 2.0], 0, WHOLE);
    add_sheet(&mut mesh, vec3(x, -1.0, 0.0), [Vec3::X * (1.0 - x), Vec3::Y * 2.0], 1, WHOLE);
    mesh
}

/// Protects edges from stairs: a texel over a border of colours has the mean of its samples in linear light;
/// with one sample it has either.
#[test]
fn texels_are_means_of_their_samples() {
    // Of 8 texels of width 0.25 the fifth has its middle at 0.125.
    let high = painted(halves(0.125), &[[1.0; 3], [0.0; 3]]);
    let (high, low) = pair(&high, square(1.0, 0.0), 8, 0.1);
    let column = |samples| {
        let cast = cast_maps(&low, &high, &options(samples, &[]), &()).unwrap();
        [3, 4, 5].map(|x| red(&cast, 8, x, 3))
    };
    assert_eq!(column(4), [1.0, 0.5, 0.0]);
    assert_eq!(column(16), [1.0, 0.5, 0.0]);
    assert!(column(1)[1] == 0.0 || column(1)[1] == 1.0);
}

/// Protects mip levels: texels that a chart covers in part have the mean of that part, and all others are
/// filled, so that nothing of another colour is anywhere.
#[test]
fn borders_and_gutters_have_the_charts_colour() {
    let high = painted(square(1.0, 0.0), &[[0.25, 0.5, 0.75]]);
    let mut low = square(1.0, 0.0);
    low.uvs.iter_mut().for_each(|uv| *uv = *uv * 0.45 + vec2(0.21, 0.33));
    let (high, low) = pair(&high, low, 16, 0.1);
    let cast = cast_maps(&low, &high, &options(16, &[]), &()).unwrap();
    // 7.2² texels, and those that they touch.
    let covered = cast.known.iter().filter(|known| **known).count();
    assert!(covered > 52 && covered <= 81, "{covered}");
    for texel in &cast.maps.get(MapKind::BaseColor).unwrap().texels {
        assert!((texel.truncate() - vec3(0.25, 0.5, 0.75)).length() < 1e-5, "{texel}");
    }
}

/// Protects the unit and sign of height, the axes of positions and of object-space normals.
#[test]
fn maps_of_place_are_those_of_the_high_poly() {
    let high = painted(square(1.0, 0.0), &[[1.0; 3]]);
    let maps = [GeometryMap::Height, GeometryMap::Position, GeometryMap::ObjectNormal];
    for z in [-0.03, 0.02] {
        let (high, low) = pair(&high, square(1.0, z), 8, 0.1);
        let cast = cast_maps(&low, &high, &options(4, &maps), &()).unwrap();
        let value = |place: usize| cast.geometry[place].1.texels[2 * 8 + 1].truncate();
        assert!((value(0).x + z).abs() < 1e-6, "{}", value(0));
        // The middle of the second texel of the third row.
        assert!((value(1) - vec3(-0.625, 0.375, 0.0)).length() < 1e-5, "{}", value(1));
        assert!((value(2) - Vec3::Z).length() < 1e-6);
        assert_eq!(cast.missed, 0);
    }
}

/// Protects parts that float over a surface: rays from outside meet them, the nearest point is under them.
#[test]
fn the_outermost_hides_what_is_under_it() {
    let mut high = square(1.0, 0.0);
    add_sheet(&mut high, vec3(-1.0, -1.0, 0.02), [Vec3::X * 2.0, Vec3::Y * 2.0], 1, WHOLE);
    let (high, low) = pair(&painted(high, &[[0.0; 3], [1.0; 3]]), square(1.0, 0.0), 8, 0.1);
    // The frame's origin is half-way between them, so the low-poly lies on the lower one.
    for (search, wanted) in [(Search::Nearest, 0.0), (Search::Outermost, 1.0), (Search::ClosestPoint, 0.0)] {
        let cast = cast_maps(&low, &high, &CastOptions { search, ..options(1, &[]) }, &()).unwrap();
        assert_eq!(red(&cast, 8, 3, 3), wanted, "{search:?}");
    }
}

/// Protects hard edges: along averaged normals every ray from a larger box meets the smaller one in it somewhere
/// else; along its own normals those near the edges go by, and all take a point of the edge itself.
#[test]
fn averaged_normals_leave_no_gaps() {
    let high = painted(cube(1.0), &[[1.0; 3]]);
    let (high, low) = pair(&high, cube(1.15), 64, 0.4);
    let on_edges = |smooth_rays| {
        let options = CastOptions { smooth_rays, ..options(1, &[GeometryMap::Position]) };
        let cast = cast_maps(&low, &high, &options, &()).unwrap();
        let covered =
            cast.geometry[0].1.texels.iter().zip(&low.atlas.covered).filter(|(_, covered)| **covered);
        let is_on_edge = |p: Vec3| p.abs().to_array().iter().filter(|x| **x > 0.9999).count() > 1;
        covered.filter(|(p, _)| is_on_edge(p.truncate())).count()
    };
    assert!(on_edges(true) == 0 && on_edges(false) > 200, "{} {}", on_edges(true), on_edges(false));
}

/// Protects leaves and cloth: the two sides of a sheet share their positions, where normals cancel out, and
/// each looks along its own all the same.
#[test]
fn both_sides_of_a_sheet_look_outwards() {
    let sheets = |z: f32| {
        let (mut mesh, half) = (Mesh::default(), vec2(0.45, 0.9));
        let [front, back] = [vec2(0.02, 0.05), vec2(0.52, 0.05)].map(|from| [from, from + half]);
        add_sheet(&mut mesh, vec3(-1.0, -1.0, z), [Vec3::X * 2.0, Vec3::Y * 2.0], 0, front);
        add_sheet(&mut mesh, vec3(-1.0, -1.0, -z), [Vec3::Y * 2.0, Vec3::X * 2.0], 0, back);
        mesh
    };
    let (high, low) = pair(&painted(sheets(0.03), &[[1.0; 3]]), sheets(0.0), 16, 0.1);
    let cast = cast_maps(&low, &high, &options(2, &[GeometryMap::Height]), &()).unwrap();
    let height = |x: usize| cast.geometry[0].1.texels[8 * 16 + x].x;
    assert!(
        (height(4) - 0.03).abs() < 1e-5 && (height(12) - 0.03).abs() < 1e-5,
        "{} {}",
        height(4),
        height(12)
    );
}

/// Protects scripts: the same numbers for 1, 2 and 5 threads, all maps included.
#[test]
fn threads_change_nothing() {
    let high = painted(cube(1.0), &[[0.3, 0.6, 0.9]]);
    let (high, low) = pair(&high, cube(1.02), 32, 0.1);
    let cast = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let cast = pool.install(|| cast_maps(&low, &high, &options(3, &GeometryMap::ALL), &()).unwrap());
        (cast.maps, cast.geometry)
    };
    let one = cast(1);
    assert!(one == cast(2) && one == cast(5));
}

/// Protects Ctrl-C: who is told to stop has no half-finished maps.
#[test]
fn a_stopped_cast_has_no_maps() {
    struct Stop;
    impl parbake_progress::Watcher for Stop {
        fn stopped(&self) -> bool {
            true
        }
    }
    let (high, low) = pair(&painted(square(1.0, 0.0), &[[1.0; 3]]), square(1.0, 0.0), 8, 0.1);
    assert!(cast_maps(&low, &high, &options(1, &[]), &Stop).is_none());
}
