//! The second built-in pair: a cube of brick walls with deep joints, made by formula, and the
//! plain cube that it was cut from (after Fig. 11 of Knodt et al. 2023).
//!
//! ```text
//! bricks (pattern) ─┬ depth → a fine grid on each face, pushed in
//!                   └ colour → its texture
//! ```
//!
//! Contract: 76 800 and 12 triangles within [−1, 1]³, normals outwards; both have one layout,
//! six squares 6 texels apart at a texture of 512²; the same numbers on every run.

use super::bricks::{COURSE, Face, color, depth};
use super::paint::bytes;
use super::shape::smoothstep;
use crate::normals::smooth_normals;
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Image, Material, Mesh, Model, TextureSlot};
use rayon::prelude::*;

/// Half a side of the cube.
const HALF: f32 = 0.9;
/// Texels along each side of the detailed model's texture.
const TEXTURE_SIZE: usize = 1024;
/// Texture widths between two faces.
const GUTTER: f32 = 6.0 / 512.0;
/// Texture widths of a face: three side by side.
const SIDE: f32 = (1.0 - 4.0 * GUTTER) / 3.0;
/// Lines of the grid in a course, closest where a joint has its flanks.
const LINES: [f32; 10] = [0.0, 0.016, 0.026, 0.036, 0.065, 0.125, 0.185, 0.214, 0.224, 0.234];
/// Where a face's relief begins to be pushed in along its neighbour's normal, too. At an edge
/// both push as much, and before it less than grid lines are apart.
const MITRE: f32 = 0.7;

/// The detailed wall: 1 material with a colour texture of 1024² texels.
pub fn wall_model() -> Model {
    let material = Material {
        name: "bricks".into(),
        base_color_texture: Some(TextureSlot::default()),
        ..Default::default()
    };
    let mut mesh = grid(&lines(), true);
    mesh.normals = smooth_normals(&mesh);
    Model {
        name: "demo wall".into(),
        mesh,
        materials: vec![material],
        images: vec![texture(TEXTURE_SIZE)],
        ..Model::default()
    }
}

/// The cube to bake it onto, with hard edges.
pub fn wall_low() -> Mesh {
    let mut mesh = grid(&[-1.0, 1.0], false);
    mesh.normals = (0..6).flat_map(|face| [Face(face).axes()[0]; 4]).collect();
    mesh
}

/// Grid lines of a face, −1 … 1, the same from either end.
fn lines() -> Vec<f32> {
    let courses = (1.0 / COURSE) as usize;
    let half = (0..courses).flat_map(|k| LINES.map(|x| 1.0 - (k as f32 * COURSE + x)));
    let half: Vec<f32> = half.collect();
    let mirrored = half.iter().map(|x| -x);
    mirrored.chain([0.0]).chain(half.iter().rev().copied()).collect()
}

/// All six faces, divided by these lines.
fn grid(lines: &[f32], relief: bool) -> Mesh {
    let mut mesh = Mesh::default();
    for face in (0..6).map(Face) {
        let start = mesh.positions.len() as u32;
        for &b in lines {
            for &a in lines {
                let at = Vec2::new(a, b);
                let mut p = face.point(at) * HALF;
                if relief {
                    let inwards =
                        face.point(at).to_array().map(|x| x.signum() * smoothstep(MITRE, 1.0, x.abs()));
                    p -= Vec3::from(inwards) * depth(face, at);
                }
                mesh.positions.push(p);
                mesh.uvs.push(corner(face) + Vec2::new(a + 1.0, 1.0 - b) * (0.5 * SIDE));
            }
        }
        let across = lines.len() as u32;
        for row in 0..across - 1 {
            for column in 0..across - 1 {
                let a = start + row * across + column;
                let (b, c, d) = (a + 1, a + across + 1, a + across);
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

/// Top left corner of a face in the texture.
fn corner(face: Face) -> Vec2 {
    Vec2::new((face.0 % 3) as f32, (face.0 / 3) as f32) * (SIDE + GUTTER) + GUTTER
}

/// The texture, `size`² texels; what lies beside a face goes on with its border.
fn texture(size: usize) -> Image {
    let mut pixels = vec![[0; 4]; size * size];
    pixels.par_chunks_mut(size).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size as f32;
            let cell = ((place - 0.5 * GUTTER) / (SIDE + GUTTER)).max(Vec2::ZERO).as_uvec2();
            let face = Face((cell.x.min(2) + 3 * cell.y.min(1)) as usize);
            let at = (place - corner(face)) / (0.5 * SIDE) - 1.0;
            *pixel = bytes(color(face, Vec2::new(at.x, -at.y).clamp(Vec2::NEG_ONE, Vec2::ONE)));
        }
    });
    Image { name: "bricks".into(), width: size, height: size, pixels }
}

#[cfg(test)]
#[path = "wall_tests.rs"]
mod tests;
