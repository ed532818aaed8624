//! Models made from models, and from nothing.

use parbake_mesh::demo::{demo_low, demo_model};
use parbake_mesh::simplify::{SimplifyOptions, simplify};
use parbake_mesh::subdivide::subdivide;
use parbake_model::{Material, Model};

/// A coarser copy of about this many triangles, with the same materials.
pub fn simplified(model: &Model, triangles: usize) -> Model {
    let options = SimplifyOptions { target_triangles: triangles, ..SimplifyOptions::default() };
    Model { mesh: simplify(&model.mesh, options), ..model.clone() }
}

/// A copy with four times the triangles and the same shape.
pub fn subdivided(model: &Model) -> Model {
    Model { mesh: subdivide(&model.mesh), ..model.clone() }
}

/// The built-in detailed model and its coarse counterpart.
pub fn demo_pair() -> (Model, Model) {
    let high = demo_model();
    let low = Model {
        name: "demo jar".into(),
        mesh: demo_low(&high),
        materials: vec![Material::default()],
        images: Vec::new(),
    };
    (high, low)
}
