//! Makes two models comparable: what each needs for shading, and the one frame that
//! both are moved into (the high-poly's bounding box becomes [−1, 1]³ along its
//! longest side; normalising each by its own box would misalign them).

use crate::error::BakeError;
use parbake_mesh::{compute_tangents, ensure_normals};
use parbake_model::{Bounds, Model, Placement};

/// Gives a model what shading needs: unit normals, and tangents where a normal map
/// asks for them or `tangents` says so. Tangents of the file are kept unless `fresh`.
pub fn make_shadeable(model: &mut Model, tangents: bool, fresh: bool) -> usize {
    let repaired = ensure_normals(&mut model.mesh);
    let wanted = tangents || model.materials.iter().any(|m| m.normal_texture.is_some());
    if wanted && (fresh || repaired > 0 || model.mesh.tangents.is_empty()) {
        compute_tangents(&mut model.mesh);
    }
    repaired
}

/// The common frame of a pair.
pub fn common_frame(high: &Model) -> Result<Placement, BakeError> {
    Bounds::of(&high.mesh)
        .and_then(|bounds| Placement::unit_box(&bounds))
        .ok_or_else(|| BakeError::NoExtent { model: high.name.clone() })
}
