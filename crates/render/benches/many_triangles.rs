//! What a view of millions of triangles costs: a bumpy ball of 4 million, in views where a sample is many
//! triangles wide.
//!
//! Items are covered samples. One thread.

use divan::Bencher;
use divan::counter::ItemsCount;
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Material, Mesh};
use parbake_render::camera::{Camera, Projection, fibonacci_sphere};
use parbake_render::interpretation::Interpretation;
use parbake_render::on_screen::Raster;
use parbake_render::raster::{NOTHING, Visibility};
use parbake_render::scene::Scene;
use parbake_render::shade::Lambert;
use std::f32::consts::{PI, TAU};
use std::hint::black_box;
use std::sync::LazyLock;

const RINGS: u32 = 1000;
const SIDES: u32 = 2000;
const VIEWS: usize = 4;

fn main() {
    divan::main();
}

fn ball() -> Mesh {
    let mut mesh = Mesh::default();
    for ring in 0..=RINGS {
        for side in 0..SIDES {
            let (a, b) = (PI * ring as f32 / RINGS as f32, TAU * side as f32 / SIDES as f32);
            let radius =
                0.8 + 0.1 * (7.0 * a).sin() * (5.0 * b).cos() + 0.02 * (90.0 * a).sin() * (70.0 * b).sin();
            let direction = Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin());
            mesh.positions.push(direction * radius);
            mesh.normals.push(direction);
            mesh.uvs.push(Vec2::new(b / TAU, a / PI));
        }
    }
    let at = |ring: u32, side: u32| ring * SIDES + side % SIDES;
    for ring in 0..RINGS {
        for side in 0..SIDES {
            let [a, b, c, d] =
                [at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)];
            mesh.triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

fn scene() -> Scene {
    Scene::new(ball(), &[Material::default()], &[], Interpretation::default())
}

static SCENE: LazyLock<Scene> = LazyLock::new(scene);

fn cameras() -> Vec<Camera> {
    let camera = |direction| Camera::towards_origin(direction, 3.5, Projection::Perspective(0.4));
    fibonacci_sphere(VIEWS, 0.3).into_iter().map(camera).collect()
}

/// The first look, which builds the tree.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn first_look(bencher: Bencher) {
    let camera = cameras()[0];
    bencher.with_inputs(scene).bench_local_values(|scene| {
        let mut seen = Visibility::default();
        scene.on_screen(&camera, 8).rasterise(8, (0.0, 0.0), None, &mut seen);
        (scene, seen)
    });
}

fn see(size: usize) -> Vec<Visibility> {
    let look = |camera: Camera| {
        let mut seen = Visibility::default();
        SCENE.on_screen(&camera, size).rasterise(size, (0.0, 0.0), None, &mut seen);
        seen
    };
    cameras().into_iter().map(look).collect()
}

/// Which triangle is seen.
#[divan::bench(args = [48, 192, 480, 1024], sample_count = 5, sample_size = 1)]
fn rasterised(bencher: Bencher, size: usize) {
    let covered: usize =
        see(size).iter().map(|seen| seen.triangle.iter().filter(|&&t| t != NOTHING).count()).sum();
    bencher.counter(ItemsCount::new(covered)).bench_local(|| black_box(see(size)));
}

/// The same, and its light.
#[divan::bench(args = [192, 480], sample_count = 5, sample_size = 1)]
fn shaded(bencher: Bencher, size: usize) {
    let covered: usize =
        see(size).iter().map(|seen| seen.triangle.iter().filter(|&&t| t != NOTHING).count()).sum();
    bencher.counter(ItemsCount::new(covered)).bench_local(|| {
        cameras().iter().zip(see(size)).fold(Vec3::ZERO, |sum, (camera, seen)| {
            let screen = SCENE.on_screen(camera, size);
            let seen = seen.triangle.iter().enumerate().filter(|(_, t)| **t != NOTHING);
            seen.fold(sum, |sum, (sample, &triangle)| {
                let at = ((sample % size) as f64 + 0.5, (sample / size) as f64 + 0.5);
                sum + SCENE.shade(&Lambert, camera, &screen, triangle as usize, at, 1.0)
            })
        })
    });
}
