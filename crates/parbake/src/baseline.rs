//! What a bake is compared with: the ray-cast bake of the low-poly as it was delivered.

use crate::options::{BakeOptions, UvMode};
use crate::work::Work;
use parbake_model::{Material, Mesh, Model};
use parbake_uv::surface::{RepairedLowPoly, UvStageOptions, repair_uvs};
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;

/// The delivered low-poly made ready to be compared with, as [`Baked::ray_cast`](crate::Baked::ray_cast) says; none where that
/// is what was prepared for the bake already, or where its own coordinates have no place for a texture. `repaired` is the
/// delivered low-poly where the bake began with its own coordinates.
pub(crate) fn other_baseline(
    delivered: &Model,
    repaired: Option<RepairedLowPoly>,
    prepared: &LowPoly,
    work: Work,
    high: &HighPoly,
    options: &BakeOptions,
) -> Option<LowPoly> {
    let same = |mesh: &Mesh| {
        let own = &prepared.written;
        own.uvs == mesh.uvs && own.positions == mesh.positions && own.triangles == mesh.triangles
    };
    if work == Work::Compress || same(&delivered.mesh) {
        return None;
    }
    let repair = || {
        let mode = if options.uv == UvMode::Keep { UvMode::Keep } else { UvMode::Repair };
        // A gutter that was asked for is no reason to pack anew what is sound.
        let asked = UvStageOptions { gutter_required: false, ..options.uv_stage_as(mode) };
        repair_uvs(delivered, &asked).ok()
    };
    let RepairedLowPoly { name, mut mesh, .. } = repaired.or_else(repair)?;
    if same(&mesh) {
        return None;
    }
    mesh.triangle_materials.fill(0);
    let model = Model { name, mesh, materials: vec![Material::default()], ..Model::default() };
    LowPoly::new(&model, &high.frame, options.texture_size).ok()
}
