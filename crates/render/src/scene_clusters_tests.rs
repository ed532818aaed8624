//! Scenes of many triangles: rasterised by clusters, each alpha mode by itself.

use super::*;
use crate::camera::Projection;
use crate::on_screen::MANY_TRIANGLES;
use parbake_model::glam::Vec3;

/// Cells along a side of a sheet.
const CELLS: u32 = 180;

/// Two sheets across the z axis, the nearer one of glass, half as wide.
fn sheets() -> Scene {
    let mut mesh = Mesh::default();
    for (material, (z, half)) in [(0.0, 1.0), (0.5, 0.5)].into_iter().enumerate() {
        let first = mesh.positions.len() as u32;
        for i in 0..(CELLS + 1) * (CELLS + 1) {
            let along = |k: u32| half * (2.0 * k as f32 / CELLS as f32 - 1.0);
            mesh.positions.push(Vec3::new(along(i % (CELLS + 1)), along(i / (CELLS + 1)), z));
            mesh.normals.push(Vec3::Z);
        }
        for cell in 0..CELLS * CELLS {
            let a = first + cell / CELLS * (CELLS + 1) + cell % CELLS;
            let c = a + CELLS + 1;
            mesh.triangles.extend([[a, a + 1, c + 1], [a, c + 1, c]]);
            mesh.triangle_materials.extend([material as u32; 2]);
        }
    }
    let glass = Material { alpha_mode: AlphaMode::Blend, ..Material::default() };
    Scene::new(mesh, &[Material::default(), glass], &[], Interpretation::default())
}

/// Protects large models with glass: each layer sees its own triangles, and all of them together what
/// drawing every triangle shows.
#[test]
fn layers_of_many_triangles_see_their_own() {
    let scene = sheets();
    let count = scene.mesh().triangles.len();
    assert!(count >= MANY_TRIANGLES);
    let (size, offset) = (40, (0.13, -0.21));
    let camera = Camera::towards_origin(Vec3::new(0.3, 0.2, 1.0), 3.5, Projection::Perspective(0.4));
    let look = |screen: &dyn Raster| {
        let mut seen = Visibility::default();
        screen.rasterise(size, offset, None, &mut seen);
        seen.triangle
    };
    let mesh = scene.mesh();
    let all = ScreenTriangles::new(&mesh.positions, &mesh.triangles, &camera, size);
    assert_eq!(look(&scene.on_screen(&camera, size)), look(&all));
    for (mode, own) in [(AlphaMode::Opaque, 0..count / 2), (AlphaMode::Blend, count / 2..count)] {
        let layer =
            scene.layer_on_screen(|own, _| own == mode, &camera, size).expect("it has many triangles");
        let seen: Vec<usize> =
            look(&layer).into_iter().filter(|&t| t != NOTHING).map(|t| t as usize).collect();
        assert!(seen.len() > 100 && seen.iter().all(|t| own.contains(t)));
        let triangle = seen[0];
        assert_eq!(layer.triangle(triangle), all.triangles[triangle]);
    }
    // Light that passes makes a layer of its own.
    let passed =
        scene.layer_on_screen(|_, transmits| transmits, &camera, size).expect("it has many triangles");
    assert!(look(&passed).iter().all(|&t| t == NOTHING));
    let none =
        scene.layer_on_screen(|own, _| own == AlphaMode::Mask, &camera, size).expect("it has many triangles");
    assert!(look(&none).iter().all(|&t| t == NOTHING));
}
