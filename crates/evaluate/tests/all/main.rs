//! Comparisons of whole models: one program for all, since each would be linked with everything anew.

#![allow(clippy::unwrap_used)]

mod channels;
mod screen_size;

use parbake_model::Model;

/// The demo's jar in one colour, of this roughness and metal, scaled about the origin.
fn jar(roughness: f32, metallic: f32, scale: f32) -> Model {
    let mut jar = parbake_mesh::demo_model();
    for material in &mut jar.materials {
        (material.base_color_texture, material.normal_texture) = (None, None);
        (material.roughness, material.metallic) = (roughness, metallic);
    }
    jar.mesh.positions.iter_mut().for_each(|p| *p *= scale);
    jar
}
