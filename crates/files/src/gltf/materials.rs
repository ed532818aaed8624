//! Materials (glTF 2.0, 3.9), with KHR_materials_emissive_strength, KHR_materials_unlit,
//! KHR_materials_pbrSpecularGlossiness (`specular_glossiness.rs`), other extensions
//! (`material_extensions.rs`) and parallax maps (`parallax.rs`); their textures come from
//! `textures.rs`.
//!
//! Factors out of range are clamped; those without a range that are not finite become the default.

use super::buffers::Buffers;
use super::json_material;
use super::material_extensions;
use super::parallax;
use super::specular_glossiness::{self, Pending};
use super::textures::TextureReader;
use super::uv_sets::UvSets;
use crate::FileError;
use parbake_model::{AlphaMode, Image, Material};

/// Extensions that say nothing of a material's look.
const SILENT: [&str; 2] = ["KHR_xmp", "KHR_xmp_json_ld"];

/// The document's materials of these indices (`None`: the default), and their images.
/// `scales` says of each by how much nodes enlarge what has it, `turned` whether a node turns or
/// stretches it.
pub(super) fn build(
    buffers: &Buffers<'_>,
    indices: &[Option<usize>],
    scales: &[f32],
    turned: &[bool],
) -> Result<(Vec<Material>, Vec<Image>), FileError> {
    let mut textures = TextureReader::new(buffers);
    let mut materials = Vec::with_capacity(indices.len());
    let mut pending = Vec::new();
    for (index, &scale) in indices.iter().zip(scales) {
        let number = materials.len();
        materials.push(match index {
            None => Material { name: "default".into(), ..Material::gltf_default() },
            Some(index) => material(&mut textures, *index, scale, number, &mut pending)?,
        });
    }
    let mut images = textures.decode()?;
    specular_glossiness::convert(&pending, &mut materials, &mut images, buffers.context)?;
    parallax::leave_out(&mut materials, turned, &images, buffers.context);
    Ok((materials, images))
}

/// Material `index` of the document, number `number` of ours.
fn material(
    textures: &mut TextureReader<'_, '_>,
    index: usize,
    scale: f32,
    number: usize,
    pending: &mut Vec<Pending>,
) -> Result<Material, FileError> {
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
    match &json.extensions.specular_glossiness {
        Some(glossy) => {
            pending.extend(specular_glossiness::read(&mut material, number, textures, glossy, &here)?);
        }
        None => metallic_roughness(&mut material, textures, json, &here)?,
    }
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
    material.extensions = material_extensions::read(textures, &json.extensions, &here, scale)?;
    for name in json.extensions.others.keys().filter(|name| !SILENT.contains(&name.as_str())) {
        let text = "is not known: what it adds to the look of materials is left out";
        textures.buffers.context.warn(format!("the extension {name} {text}"));
    }
    material.parallax = parallax::read(textures, &json.extensions, &here, &material.name);
    Ok(material)
}

fn metallic_roughness(
    material: &mut Material,
    textures: &mut TextureReader<'_, '_>,
    json: &json_material::Material,
    here: &str,
) -> Result<(), FileError> {
    let Some(pbr) = &json.pbr_metallic_roughness else { return Ok(()) };
    let here = format!("{here}/pbrMetallicRoughness");
    material.base_color = pbr.base_color_factor.unwrap_or([1.0; 4]).map(|x| x.clamp(0.0, 1.0));
    material.metallic = pbr.metallic_factor.unwrap_or(1.0).clamp(0.0, 1.0);
    material.roughness = pbr.roughness_factor.unwrap_or(1.0).clamp(0.0, 1.0);
    if let Some(info) = &pbr.base_color_texture {
        material.base_color_texture = textures.slot(info, &format!("{here}/baseColorTexture"))?;
    }
    if let Some(info) = &pbr.metallic_roughness_texture {
        material.metallic_roughness_texture =
            textures.slot(info, &format!("{here}/metallicRoughnessTexture"))?;
    }
    Ok(())
}

/// A number without an upper limit; `otherwise` where it is not there, or not finite in single
/// precision.
fn from_zero(value: Option<f32>, otherwise: f32) -> f32 {
    value.filter(|x| x.is_finite()).map_or(otherwise, |x| x.max(0.0))
}
