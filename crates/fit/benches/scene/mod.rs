//! The built-in pair of models as benches see it: a fifth of a default bake's views.

use parbake_image::display::{Curve, Display};
use parbake_mesh::demo::{demo_low, demo_model};
use parbake_mesh::{compute_tangents, ensure_normals};
use parbake_model::Mesh;
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;
use parbake_render::scene::Scene;
use parbake_render::shade::Lambert;
use parbake_views::pool::{Rig, view_pool};
use parbake_views::reference::{Reference, Sampling, render_references};

/// Pixels along a side of a view.
pub const VIEW_SIZE: usize = 192;
/// How light is shown.
pub const DISPLAY: Display = Display { gain: 1.0, curve: Curve::Srgb };

const VIEWS: usize = 128;

/// The low-poly, and the high-poly's views.
pub fn rendered() -> (Mesh, Vec<Reference>) {
    let mut high = demo_model();
    let mut low = demo_low(&high);
    ensure_normals(&mut high.mesh);
    ensure_normals(&mut low);
    compute_tangents(&mut low);
    let scene = Scene::new(high.mesh, &high.materials, &high.images, Interpretation::default());
    let rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };
    let pool = view_pool(VIEWS, &rig, 0);
    let sampling = Sampling { size: VIEW_SIZE, filter: 0.1875, samples: 1 };
    (low, render_references(&scene, &Lambert, &pool, &sampling, VIEWS, &()))
}
