//! What writers ask of a model before they touch the disk: that it keeps its
//! contract, so that no index can go astray.

use crate::{FileError, Place};
use parbake_model::glam::DAffine3;
use parbake_model::{Material, Model};
use std::path::Path;

/// Refuses models that break [`Model`]'s or [`Mesh`](parbake_model::Mesh)'s contract.
pub(crate) fn check(path: &Path, model: &Model) -> Result<(), FileError> {
    let refuse = |reason: String| {
        let reason = format!("the model cannot be written: {reason}");
        Err(FileError::Invalid { path: path.into(), place: Place::File, reason })
    };
    let mesh = &model.mesh;
    let count = mesh.positions.len();
    if mesh.triangles.is_empty() {
        return Err(FileError::Empty { path: path.into(), detail: String::new() });
    }
    let lengths = [
        ("normals", mesh.normals.len()),
        ("tangents", mesh.tangents.len()),
        ("texture coordinates", mesh.uvs.len()),
        ("second texture coordinates", mesh.uvs1.len()),
        ("colours", mesh.colors.len()),
        ("parallax offsets", mesh.parallax_offsets.len()),
    ];
    if let Some((what, n)) = lengths.iter().find(|(_, n)| *n != 0 && *n != count) {
        return refuse(format!("it has {count} positions but {n} {what}"));
    }
    if mesh.triangle_materials.len() != mesh.triangles.len() {
        return refuse("not every triangle has a material".into());
    }
    if mesh.triangles.iter().flatten().any(|&i| i as usize >= count) {
        return refuse("a triangle names a vertex that is not there".into());
    }
    if mesh.triangle_materials.iter().any(|&m| m as usize >= model.materials.len()) {
        return refuse("a triangle names a material that is not there".into());
    }
    let used = model.materials.iter().flat_map(Material::all_texture_slots);
    if used.clone().any(|s| s.image >= model.images.len()) {
        return refuse("a material names an image that is not there".into());
    }
    let transforms = used.clone().map(|s| s.transform);
    if transforms
        .into_iter()
        .any(|t| !(t.offset.is_finite() && t.rotation.is_finite() && t.scale.is_finite()))
    {
        return refuse("a texture's transform is not finite".into());
    }
    if let Some(image) = used.map(|s| &model.images[s.image]).find(|i| !i.is_whole()) {
        let (w, h, n) = (image.width, image.height, image.pixels.len());
        return refuse(format!("image {:?} should have {w} × {h} texels, but has {n}", image.name));
    }
    let maps = model.materials.iter().filter_map(|m| m.parallax.as_ref());
    if let Some(fault) = maps.filter_map(|map| map.check(&model.images).err()).next() {
        return refuse(format!("a parallax map is broken: {fault}"));
    }
    if let Some(fault) = model.rig.as_ref().and_then(|rig| rig.fault(count)) {
        return refuse(format!("its rig has {fault}"));
    }
    if let Some(parts) = &model.parts {
        if let Some(fault) = parts.fault(mesh.triangles.len()) {
            return refuse(format!("its parts have {fault}"));
        }
        let worlds = parts.worlds();
        let flat = |(world, &count): (&DAffine3, &usize)| count > 0 && !world.inverse().is_finite();
        if worlds.iter().zip(&parts.counts()).any(flat) {
            return refuse("a part hangs on a node without size".into());
        }
        if model.rig.is_some() {
            return refuse("parts that stay apart cannot have a rig".into());
        }
    }
    let finite = mesh.positions.iter().chain(&mesh.parallax_offsets).all(|p| p.is_finite())
        && mesh.uvs.iter().chain(&mesh.uvs1).all(|uv| uv.is_finite())
        && mesh.colors.iter().all(|c| c.is_finite());
    if !finite {
        return refuse("a position, texture coordinate or colour is not finite".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec3;
    use parbake_model::{Image, Mesh, ParallaxMap, TextureSlot, UvTransform};

    fn turned(rotation: f32) -> Option<TextureSlot> {
        let transform = UvTransform { rotation, ..UvTransform::default() };
        Some(TextureSlot { transform, ..TextureSlot::default() })
    }

    /// Protects the writers from panics on models that break the contract.
    #[test]
    fn broken_models_are_refused() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        };
        let materials = vec![Material { base_color_texture: turned(1.0), ..Material::default() }];
        let images = vec![Image::solid("a", 2, 2, [1; 4])];
        let good = Model { mesh, materials, images, ..Model::default() };
        let breakages: [fn(&mut Model); 12] = [
            |m| m.mesh.triangles[0][1] = 3,
            |m| m.mesh.triangle_materials[0] = 1,
            |m| m.mesh.triangle_materials.clear(),
            |m| m.mesh.normals.push(Vec3::X),
            |m| m.mesh.positions[0].x = f32::NAN,
            |m| m.images.clear(),
            |m| m.mesh.triangles.clear(),
            |m| m.images[0].width = 3,
            |m| m.images[0].pixels.clear(),
            |m| m.materials[0].base_color_texture = turned(f32::NAN),
            |m| m.materials[0].emissive_texture = turned(f32::NAN),
            |m| m.materials[0].parallax = Some(ParallaxMap::default()),
        ];
        let path = Path::new("out.glb");
        assert!(check(path, &good).is_ok());
        for breakage in breakages {
            let mut model = good.clone();
            breakage(&mut model);
            assert!(check(path, &model).unwrap_err().to_string().starts_with("out.glb"));
        }
    }
}
