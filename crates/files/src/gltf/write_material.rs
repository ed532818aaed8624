//! Materials for a GLB file (glTF 2.0, 3.9), with KHR_materials_emissive_strength and KHR_materials_unlit; other
//! extensions are in `write_extensions.rs`, textures in `material_lists.rs`.
//!
//! What is glTF's default is left out; metallic and roughness factor are both written or both left
//! out. Factors out of range are clamped. What has no effect is not kept: an alpha cutoff without
//! [`AlphaMode::Mask`], the strength of emission that is black or of an unlit material.

use super::factors::{from_zero, in_range, short};
use super::material_lists::{Materials, place};
use super::write_extensions;
use parbake_model::{AlphaMode, Material, Model};
use serde_json::{Value, json};

pub(super) const EMISSIVE_STRENGTH: &str = "KHR_materials_emissive_strength";
pub(super) const UNLIT: &str = "KHR_materials_unlit";

impl Materials {
    /// The place of a model's material on a mesh whose unit is this long in the model; it is added where it is not there
    /// yet.
    pub fn place_of(&mut self, model: &Model, index: usize, unit: f32) -> usize {
        // Thickness alone is a length.
        let is_thick = model.materials[index].extensions.volume.is_some();
        let place = place(&mut self.used, (index, is_thick.then(|| unit.to_bits())));
        if place == self.json.len() {
            let json = self.material(&model.materials[index], unit);
            self.json.push(json);
        }
        place
    }

    fn material(&mut self, material: &Material, unit: f32) -> Value {
        let pbr = self.metallic_roughness(material);
        let mut json = json!({ "name": material.name });
        if pbr != json!({}) {
            json["pbrMetallicRoughness"] = pbr;
        }
        if material.double_sided {
            json["doubleSided"] = true.into();
        }
        if let Some(slot) = &material.normal_texture {
            let mut info = self.texture_info(slot);
            if material.normal_scale != 1.0 && material.normal_scale.is_finite() {
                info["scale"] = f64::from(material.normal_scale).into();
            }
            json["normalTexture"] = info;
        }
        if let Some(slot) = &material.occlusion_texture {
            let mut info = self.texture_info(slot);
            let strength = in_range(material.occlusion_strength, 1.0);
            if strength != 1.0 {
                info["strength"] = strength.into();
            }
            json["occlusionTexture"] = info;
        }
        self.add_emission(material, &mut json);
        match material.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Mask => {
                json["alphaMode"] = "MASK".into();
                if let Some(cutoff) = from_zero(material.alpha_cutoff, 0.5) {
                    json["alphaCutoff"] = cutoff.into();
                }
            }
            AlphaMode::Blend => json["alphaMode"] = "BLEND".into(),
        }
        if material.unlit {
            json["extensions"][UNLIT] = json!({});
            self.uses_unlit = true;
        }
        write_extensions::add(self, material, unit, &mut json);
        self.add_parallax(material, &mut json);
        json
    }

    fn metallic_roughness(&mut self, material: &Material) -> Value {
        let mut pbr = json!({});
        let factor = material.base_color.map(|x| in_range(x, 1.0));
        if factor != [1.0; 4] {
            pbr["baseColorFactor"] = json!(factor);
        }
        if let Some(slot) = &material.base_color_texture {
            pbr["baseColorTexture"] = self.texture_info(slot);
        }
        let (metallic, roughness) = (in_range(material.metallic, 1.0), in_range(material.roughness, 1.0));
        if (metallic, roughness) != (1.0, 1.0) {
            pbr["metallicFactor"] = short(metallic);
            pbr["roughnessFactor"] = short(roughness);
        }
        if let Some(slot) = &material.metallic_roughness_texture {
            pbr["metallicRoughnessTexture"] = self.texture_info(slot);
        }
        pbr
    }

    fn add_emission(&mut self, material: &Material, json: &mut Value) {
        if let Some(slot) = &material.emissive_texture {
            json["emissiveTexture"] = self.texture_info(slot);
        }
        let factor = material.emissive.map(|x| in_range(x, 0.0));
        if factor == [0.0; 3] {
            return;
        }
        json["emissiveFactor"] = json!(factor);
        // The validator warns of unlit materials with another extension; nothing of them is emitted.
        if let Some(strength) = from_zero(material.emissive_strength, 1.0).filter(|_| !material.unlit) {
            json["extensions"][EMISSIVE_STRENGTH] = json!({ "emissiveStrength": strength });
            self.uses_emissive_strength = true;
        }
    }
}
