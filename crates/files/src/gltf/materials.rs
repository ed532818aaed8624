//! Materials (glTF 2.0, 3.9), with KHR_materials_emissive_strength, KHR_materials_unlit, the
//! diffuse part of KHR_materials_pbrSpecularGlossiness and parallax maps (`parallax.rs`); their
//! textures come from `textures.rs`.
//!
//! Factors out of range are clamped; those without a range that are not finite become the default.

use super::buffers::Buffers;
use super::json_material;
use super::parallax;
use super::textures::TextureReader;
use super::uv_sets::UvSets;
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
            None => Material { name: "default".into(), ..Material::gltf_default() },
            Some(index) => material(&mut textures, *index)?,
        });
    }
    let images = textures.decode()?;
    parallax::leave_out(&mut materials, turned, &images, buffers.context);
    Ok((materials, images))
}

fn material(textures: &mut TextureReader<'_, '_>, index: usize) -> Result<Material, FileError> {
    let json = &textures.buffers.document.materials[index];
    textures.uv_sets = UvSets::of(json);
    let here = format!("/materials/{index}");
    let name = if json.name.is_empty() { format!("material {index}") } else { json.name.clone() };
    let mut material = Material { name, ..Material::gltf_default() };
    material.alpha_mode = match json.alpha_mode.as_deref() {
        Some("MASK") => AlphaMode::Mask,
        Some("BLEND") => AlphaMode::Blend,
        _ => AlphaMode::Opaque,
    };
    material.alpha_cutoff = from_zero(json.alpha_cutoff, material.alpha_cutoff);
    material.double_sided = json.double_sided;
    material.unlit = json.extensions.unlit.is_some();
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
    metal_and_roughness(&mut material, textures, json, &here)?;
    if let Some(info) = &json.normal_texture {
        material.normal_texture = textures.slot(info, &format!("{here}/normalTexture"))?;
        material.normal_scale = info.scale.filter(|s| s.is_finite()).unwrap_or(1.0);
    }
    if let Some(info) = &json.occlusion_texture {
        material.occlusion_texture = textures.slot(info, &format!("{here}/occlusionTexture"))?;
        material.occlusion_strength = info.strength.unwrap_or(1.0).clamp(0.0, 1.0);
    }
    material.emissive = json.emissive_factor.unwrap_or([0.0; 3]).map(|x| x.clamp(0.0, 1.0));
    if let Some(info) = &json.emissive_texture {
        material.emissive_texture = textures.slot(info, &format!("{here}/emissiveTexture"))?;
    }
    let strength = json.extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength);
    material.emissive_strength = from_zero(strength, material.emissive_strength);
    if let Some(json) = &json.extensions.parallax_sh {
        material.parallax = parallax::read(textures, json, &here, &material.name);
    }
    Ok(material)
}

fn metal_and_roughness(
    material: &mut Material,
    textures: &mut TextureReader<'_, '_>,
    json: &json_material::Material,
    here: &str,
) -> Result<(), FileError> {
    if let Some(glossy) = &json.extensions.specular_glossiness {
        material.metallic = 0.0;
        // The factor means little without its texture, which is no roughness map.
        if glossy.specular_glossiness_texture.is_none() {
            material.roughness = 1.0 - glossy.glossiness_factor.unwrap_or(1.0).clamp(0.0, 1.0);
        }
    } else if let Some(pbr) = &json.pbr_metallic_roughness {
        material.metallic = pbr.metallic_factor.unwrap_or(1.0).clamp(0.0, 1.0);
        material.roughness = pbr.roughness_factor.unwrap_or(1.0).clamp(0.0, 1.0);
        if let Some(info) = &pbr.metallic_roughness_texture {
            let here = format!("{here}/pbrMetallicRoughness/metallicRoughnessTexture");
            material.metallic_roughness_texture = textures.slot(info, &here)?;
        }
    }
    Ok(())
}

/// A number without an upper limit; `otherwise` where it is not there, or not finite in single
/// precision.
fn from_zero(value: Option<f32>, otherwise: f32) -> f32 {
    value.filter(|x| x.is_finite()).map_or(otherwise, |x| x.max(0.0))
}
