//! The built-in pairs of models. The first is an ornate jar, made by formula, and a coarse
//! counterpart of the same form with a texture layout of its own; the second is in `wall.rs`.
//!
//! ```text
//! shape (form, relief) ──┬→ layout (charts, triangles) → the two meshes
//!                        └→ paint  (colours)           → the detailed one's texture
//! ```
//!
//! Contract: about 58 000 and 880 triangles within [−1, 1]³, normals outwards;
//! charts do not overlap and keep gutters; the same numbers on every run.

mod bricks;
mod layout;
mod paint;
mod shape;
mod wall;

pub use wall::{wall_low, wall_model};

use layout::Layout;
use parbake_model::{Bounds, Material, Mesh, Model, TextureSlot};

/// Texels along each side of the detailed model's texture.
const TEXTURE_SIZE: usize = 1024;

/// The detailed model: 1 material with a colour texture of 1024² texels.
pub fn demo_model() -> Model {
    let layout = Layout::detailed();
    let material = Material {
        name: "jar".into(),
        base_color_texture: Some(TextureSlot::default()),
        ..Default::default()
    };
    Model {
        name: "demo jar".into(),
        mesh: layout.tessellate(),
        materials: vec![material],
        images: vec![paint::texture(&layout, TEXTURE_SIZE)],
        ..Model::default()
    }
}

/// The coarse mesh to bake the detailed model's look onto: the jar's plain form
/// with a sixtieth of the triangles, in other charts (6 texels apart at
/// a texture of 512²), in the detailed model's place and size.
pub fn demo_low(high: &Model) -> Mesh {
    let mut mesh = Layout::coarse().tessellate();
    // The caller may have moved the detailed model since it was made.
    let (from, to) = (Bounds::of(&Layout::detailed().tessellate()), Bounds::of(&high.mesh));
    if let (Some(from), Some(to)) = (from, to) {
        let scale = to.size().max_element() / from.size().max_element();
        let centres = [(from.min + from.max) * 0.5, (to.min + to.max) * 0.5];
        for p in &mut mesh.positions {
            *p = (*p - centres[0]) * scale + centres[1];
        }
    }
    mesh
}

#[cfg(test)]
#[path = "demo_tests.rs"]
mod tests;
