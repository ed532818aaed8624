//! Parallax maps and their cutouts in: the material extensions `PARBAKE_materials_parallax`, as
//! `docs/parallax_format.md` has it, and `PARBAKE_materials_parallax_sh` (`docs/parallax_sh_format.md`).
//!
//! Contract: a model looks right without its parallax maps. So a map that breaks the format
//! is left out with a warning that says why, whatever is wrong with it; only JSON of the
//! wrong types and pictures that cannot be decoded are errors, as everywhere in a document.

use super::buffers::pointer;
use super::json_material::{CutoutSh, MaterialExtensions, ParallaxSh, ParallaxTangent};
use super::json_texture::TextureInfo;
use super::textures::TextureReader;
use crate::FileError;
use crate::context::{Context, Textures};
use parbake_model::glam::{DMat3, Vec3};
use parbake_model::{Basis, CutoutMap, DepthMap, Image, Material, Mesh, ParallaxMap, TextureSlot, Wrap};

/// The name in a document of maps in the tangent frame.
pub(super) const NAME: &str = "PARBAKE_materials_parallax";
/// That of spherical harmonics.
pub(super) const NAME_SH: &str = "PARBAKE_materials_parallax_sh";
/// The vertex attribute that readers of either add to positions.
pub(super) const OFFSETS: &str = "_PARALLAX_OFFSET";
/// The version of the format in the tangent frame.
pub(super) const VERSION: usize = 2;

/// The map that a material's extensions describe, its images yet to be decoded; `None` where there is
/// none or pictures are not wanted, or with a warning. A map in the tangent frame goes before harmonics.
pub(super) fn read(
    reader: &mut TextureReader<'_, '_>,
    extensions: &MaterialExtensions,
    here: &str,
    material: &str,
) -> Option<ParallaxMap> {
    let context = reader.buffers.context;
    if context.textures == Textures::Skip {
        return None;
    }
    let warn = |error| left_out(context, material, &reason(error));
    if let Some(json) = &extensions.parallax {
        return tangent(reader, json, &format!("{here}/extensions/{NAME}")).map_err(warn).ok();
    }
    let json = extensions.parallax_sh.as_ref()?;
    harmonics(reader, json, &format!("{here}/extensions/{NAME_SH}")).map_err(warn).ok()
}

fn tangent(
    reader: &mut TextureReader<'_, '_>,
    json: &ParallaxTangent,
    here: &str,
) -> Result<ParallaxMap, FileError> {
    let context = reader.buffers.context;
    let refuse = |reason: String| context.invalid(pointer(here.into()), reason);
    match json.version {
        Some(VERSION) => {}
        Some(version) => {
            return Err(refuse(format!("its version is {version}, and this reads version {VERSION}")));
        }
        None => return Err(refuse("it has no version".into())),
    }
    let default = ParallaxMap::default();
    let cutout = json.cutout.as_ref().map(|json| CutoutMap {
        basis: Basis::TangentCutout,
        images: vec![0],
        scale: json.scale.clone(),
        offset: json.offset.clone(),
    });
    let mut map = ParallaxMap {
        basis: Basis::TangentShift,
        images: vec![0],
        scale: json.scale.clone(),
        offset: json.offset.clone(),
        limit: json.limit.unwrap_or(default.limit),
        fade: json.fade_footprint.unwrap_or(default.fade),
        cutout,
        ..default
    };
    map.check_numbers().map_err(|fault| refuse(fault.to_string()))?;
    let missing = || refuse("a texture of it is missing".into());
    let shift = json.texture.as_ref().ok_or_else(missing)?;
    map.images[0] = slot(reader, shift, &format!("{here}/texture"))?.image;
    if let (Some(map), Some(json)) = (&mut map.cutout, &json.cutout) {
        let info = json.texture.as_ref().ok_or_else(missing)?;
        map.images[0] = slot(reader, info, &format!("{here}/cutout/texture"))?.image;
    }
    [map.base_color_texture, map.normal_texture] =
        own_textures(reader, [&json.base_color_texture, &json.normal_texture], here)?;
    Ok(map)
}

/// The textures that a map has instead of the material's: base colour and normal.
fn own_textures(
    reader: &mut TextureReader<'_, '_>,
    [color, normal]: [&Option<TextureInfo>; 2],
    here: &str,
) -> Result<[Option<TextureSlot>; 2], FileError> {
    let mut own = |info: &Option<TextureInfo>, name: &str| {
        info.as_ref().map(|info| slot(reader, info, &format!("{here}/{name}"))).transpose()
    };
    Ok([own(color, "baseColorTexture")?, own(normal, "normalTexture")?])
}

fn left_out(context: &Context<'_>, material: &str, reason: &str) {
    context.warn(format!("the parallax map of material {material:?} was left out: {reason}"));
}

/// An error without the file's name, which goes without saying in a warning.
fn reason(error: FileError) -> String {
    match error {
        FileError::Invalid { place, reason, .. } => format!("{reason}{place}"),
        other => other.to_string(),
    }
}

fn harmonics(
    reader: &mut TextureReader<'_, '_>,
    json: &ParallaxSh,
    here: &str,
) -> Result<ParallaxMap, FileError> {
    let context = reader.buffers.context;
    let refuse = |reason: String| context.invalid(pointer(here.into()), reason);
    let default = ParallaxMap::default();
    let depth = json.depth_texture.as_ref().map(|_| DepthMap {
        image: 0,
        scale: json.depth_scale.unwrap_or(1.0),
        offset: json.depth_offset.unwrap_or(0.0),
    });
    let mut map = ParallaxMap {
        basis: Basis::Harmonics(json.order.ok_or_else(|| refuse("it has no order".into()))?),
        images: vec![0; json.coefficient_textures.len()],
        scale: json.scale.clone(),
        offset: json.offset.clone(),
        limit: json.limit.unwrap_or(default.limit),
        depth,
        cutout: json.cutout.as_ref().map(|json| cutout(json, refuse)).transpose()?,
        ..default
    };
    // Before any picture is asked for: there may be a million of them.
    map.check_numbers().map_err(|fault| refuse(fault.to_string()))?;
    let mut wrap: Option<[Wrap; 2]> = None;
    let mut image = |reader: &mut TextureReader<'_, '_>, info: &TextureInfo, name: String| {
        let slot = slot(reader, info, &format!("{here}/{name}"))?;
        if *wrap.get_or_insert(slot.wrap) != slot.wrap {
            return Err(refuse("its textures differ in their wrap modes".into()));
        }
        Ok(slot.image)
    };
    for (i, info) in json.coefficient_textures.iter().enumerate() {
        map.images[i] = image(reader, info, format!("coefficientTextures/{i}"))?;
    }
    if let (Some(depth), Some(info)) = (&mut map.depth, &json.depth_texture) {
        depth.image = image(reader, info, "depthTexture".into())?;
    }
    if let (Some(cutout), Some(json)) = (&mut map.cutout, &json.cutout) {
        for (i, info) in json.coefficient_textures.iter().enumerate() {
            cutout.images[i] = image(reader, info, format!("cutout/coefficientTextures/{i}"))?;
        }
    }
    map.wrap = wrap.unwrap_or(map.wrap);
    [map.base_color_texture, map.normal_texture] =
        own_textures(reader, [&json.base_color_texture, &json.normal_texture], here)?;
    Ok(map)
}

/// The cutout's numbers; its images are yet to be found.
fn cutout(json: &CutoutSh, refuse: impl Fn(String) -> FileError) -> Result<CutoutMap, FileError> {
    Ok(CutoutMap {
        basis: Basis::Harmonics(json.order.ok_or_else(|| refuse("its cutout has no order".into()))?),
        images: vec![0; json.coefficient_textures.len()],
        scale: json.scale.clone(),
        offset: json.offset.clone(),
    })
}

/// A texture that must be there.
fn slot(
    reader: &mut TextureReader<'_, '_>,
    info: &TextureInfo,
    here: &str,
) -> Result<TextureSlot, FileError> {
    let slot = reader.slot(info, here)?;
    slot.ok_or_else(|| reader.buffers.context.invalid(pointer(here.into()), "its picture is not there"))
}

/// Leaves out the maps that cannot be shown, now that the pictures are there. `turned` says
/// of each material whether a node turns or stretches what has it.
pub(super) fn leave_out(
    materials: &mut [Material],
    turned: &[bool],
    images: &[Image],
    context: &Context<'_>,
) {
    // Pictures may serve many maps, each of which is unpacked into memory of its own.
    let mut texels = 0u64;
    let limit = context.limits.max_total_pixels;
    for (i, material) in materials.iter_mut().enumerate() {
        let Some(map) = &material.parallax else { continue };
        let fault = map.check(images).err().map(|fault| fault.to_string()).or_else(|| {
            texels = map
                .data_images()
                .filter_map(|i| images.get(i))
                .fold(texels, |sum, image| sum.saturating_add(image.pixels.len() as u64));
            if !map.basis.is_tangent() && turned.get(i) == Some(&true) {
                Some("a node turns or stretches a mesh that has it, which is not supported".into())
            } else {
                (texels > limit).then(|| format!("all maps together have more than {limit} texels"))
            }
        });
        if let Some(fault) = fault {
            left_out(context, &material.name, &fault);
            material.parallax = None;
        }
    }
}

/// Leaves out offsets of vertices whose material has no map that is shown.
pub(super) fn leave_out_offsets(mesh: &mut Mesh, materials: &[Material]) {
    if mesh.parallax_offsets.is_empty() {
        return;
    }
    let has_map = |material: u32| materials.get(material as usize).is_some_and(|m| m.parallax.is_some());
    let without = mesh.triangles.iter().zip(&mesh.triangle_materials).filter(|&(_, &m)| !has_map(m));
    for &vertex in without.flat_map(|(triangle, _)| triangle) {
        mesh.parallax_offsets[vertex as usize] = Vec3::ZERO;
    }
    if mesh.parallax_offsets.iter().all(|&offset| offset == Vec3::ZERO) {
        mesh.parallax_offsets.clear();
    }
}

/// Whether a matrix does anything but scale, all axes alike.
pub(super) fn turns(m: &DMat3) -> bool {
    let scale = m.x_axis.x;
    // Also where the scale is no number.
    !(scale > 0.0 && m.abs_diff_eq(DMat3::IDENTITY * scale, 1e-6 * scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::DVec3;

    /// Protects what is said in a mesh's own axes from being taken for the scene's.
    #[test]
    fn only_even_scales_keep_directions() {
        let still = [DMat3::IDENTITY, DMat3::IDENTITY * 1e-9, DMat3::from_diagonal(DVec3::splat(3e7))];
        assert!(!still.iter().any(turns));
        let stretched = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.1));
        for m in [DMat3::from_rotation_y(0.1), stretched, -DMat3::IDENTITY, DMat3::ZERO, DMat3::NAN] {
            assert!(turns(&m), "{m}");
        }
    }
}
