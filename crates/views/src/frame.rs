//! Makes two models comparable: what each needs for shading, and the one frame that
//! both are moved into (the high-poly's bounding box becomes [−1, 1]³ along its
//! longest side; normalising each by its own box would misalign them).

use crate::error::PrepareError;
use parbake_mesh::{compute_tangents, ensure_normals};
use parbake_model::{Bounds, Image, Mesh, Model, Placement};
use parbake_render::interpretation::Interpretation;
use parbake_render::scene::Scene;

/// The common frame of a pair.
pub fn common_frame(high: &Model) -> Result<Placement, PrepareError> {
    Bounds::of(&high.mesh)
        .and_then(|bounds| Placement::unit_box(&bounds))
        .ok_or_else(|| PrepareError::NoExtent { model: high.name.clone() })
}

/// A copy of the model's mesh in the common frame, with all that its materials need
/// for shading: unit normals, and tangents where something is said in a tangent frame.
pub fn placed(model: &Model, frame: &Placement) -> Mesh {
    let mut mesh = model.mesh.clone();
    let repaired = ensure_normals(&mut mesh);
    let mapped = model.materials.iter().any(|m| m.has_normal_map());
    if mapped && (repaired > 0 || mesh.tangents.is_empty()) {
        compute_tangents(&mut mesh);
    }
    frame.apply(&mut mesh);
    mesh
}

/// Whether a material of the model is more than rough, opaque and not metallic, as
/// [`Scene::needs_whole_material`] says, or has an extension with an effect; textures are not unpacked for it.
pub fn needs_whole_material(model: &Model) -> bool {
    if model.materials.iter().any(|m| m.extensions.show()) {
        return true;
    }
    let images: Vec<Image> = model.images.iter().map(|_| Image::solid("", 1, 1, [255; 4])).collect();
    Scene::new(Mesh::default(), &model.materials, &images, Interpretation::default()).needs_whole_material()
}

/// The model in the common frame, ready for rendering.
pub fn scene(model: &Model, frame: &Placement, interpretation: Interpretation) -> Scene {
    let scene = Scene::new(placed(model, frame), &model.materials, &model.images, interpretation);
    scene.with_unit(frame.scale)
}
