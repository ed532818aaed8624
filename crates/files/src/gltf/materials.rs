//! Materials (glTF 2.0, 3.9), with the diffuse part of KHR_materials_pbrSpecularGlossiness and
//! parallax maps (`parallax.rs`); their textures come from `textures.rs`.

use super::buffers::Buffers;
use super::parallax;
use super::textures::TextureReader;
use crate::FileError;
use parbake_model::{AlphaMode, Image, Material};

/// The document's materials of these indices (`None`: the default), and their images.
/// `turned` says of each whether a node turns or stretches what has it.
pub(super) fn build(
    buffers: &Buffers<'_>,
    indices: &[Option<usize>],
    turned: &[bool],
) -> Result<(Vec<Material>, Vec<Image>), FileError> {
    let mut textures = TextureReader::new(buffers);
    let mut materials = Vec::with_capacity(indices.len());
    for index in indices {
        materials.push(match index {
            None => Material { name: "default".into(), ..Material::default() },
            Some(index) => material(&mut textures, *index)?,
        });
    }
    let images = textures.decode()?;
    parallax::leave_out(&mut materials, turned, &images, buffers.context);
    Ok((materials, images))
}

fn material(textures: &mut TextureReader<'_, '_>, index: usize) -> Result<Material, FileError> {
    let json = &textures.buffers.document.materials[index];
    let here = format!("/materials/{index}");
    let name = if json.name.is_empty() { format!("material {index}") } else { json.name.clone() };
    let mut material = Material { name, ..Material::default() };
    material.alpha_mode = match json.alpha_mode.as_deref() {
        Some("MASK") => AlphaMode::Mask,
        Some("BLEND") => AlphaMode::Blend,
        _ => AlphaMode::Opaque,
    };
    let (factor, texture, part) = match (&json.extensions.specular_glossiness, &json.pbr_metallic_roughness) {
        (Some(s), _) => (
            s.diffuse_factor,
            &s.diffuse_texture,
            "extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture",
        ),
        (None, Some(p)) => {
            (p.base_color_factor, &p.base_color_texture, "pbrMetallicRoughness/baseColorTexture")
        }
        (None, None) => (None, &None, ""),
    };
    material.base_color = factor.unwrap_or([1.0; 4]).map(|x| x.clamp(0.0, 1.0));
    if let Some(info) = texture {
        material.base_color_texture = textures.slot(info, &format!("{here}/{part}"))?;
    }
    if let Some(info) = &json.normal_texture {
        material.normal_texture = textures.slot(info, &format!("{here}/normalTexture"))?;
        material.normal_scale = info.scale.filter(|s| s.is_finite()).unwrap_or(1.0);
    }
    if let Some(json) = &json.extensions.parallax_sh {
        material.parallax = parallax::read(textures, json, &here, &material.name);
    }
    Ok(material)
}
