//! Material extensions beyond the metallic-roughness material in a GLB file, as their specifications
//! say.
//!
//! What is an extension's default is left out; numbers are clamped to its range.

use super::factors::{from_zero, in_range};
use super::material_lists::Materials;
use parbake_model::{Material, MaterialExtensions, TextureSlot};
use serde_json::{Map, Value, json};

/// The object of one extension, key by key.
struct Object<'m> {
    materials: &'m mut Materials,
    keys: Map<String, Value>,
}

impl Object<'_> {
    /// A factor from 0 to 1.
    fn share(&mut self, key: &str, value: f32, default: f32) {
        if value != default {
            self.keys.insert(key.into(), in_range(value, f64::from(default)).into());
        }
    }

    /// A factor from `low` on.
    fn number(&mut self, key: &str, value: f32, default: f32, low: f64) {
        if let Some(value) = from_zero(value, default) {
            self.keys.insert(key.into(), value.max(low).into());
        }
    }

    fn color(&mut self, key: &str, value: [f32; 3], default: f32, most: f32) {
        if value != [default; 3] {
            let value = value.map(|x| if x.is_finite() { x.clamp(0.0, most) } else { default });
            self.keys.insert(key.into(), json!(value.map(f64::from)));
        }
    }

    fn texture(&mut self, key: &str, slot: Option<TextureSlot>) {
        if let Some(slot) = slot {
            let info = self.materials.texture_info(&slot);
            self.keys.insert(key.into(), info);
        }
    }
}

/// Adds the extensions of a material to its JSON. `unit` is the length of the written mesh's own unit.
pub(super) fn add(materials: &mut Materials, material: &Material, unit: f32, json: &mut Value) {
    // The validator warns of unlit materials with another extension, of which nothing would be seen.
    if material.unlit {
        return;
    }
    let MaterialExtensions {
        clearcoat,
        sheen,
        transmission,
        diffuse_transmission,
        volume,
        iridescence,
        anisotropy,
        specular,
        ior,
        dispersion,
    } = &material.extensions;
    // Without tangents, and without a normal map to make them for, glTF has no frame for such normals.
    let has_frame = materials.has_tangents || material.normal_texture.is_some();
    let mut extension = |name: &'static str, fill: &dyn Fn(&mut Object<'_>)| {
        let mut object = Object { materials, keys: Map::new() };
        fill(&mut object);
        json["extensions"][name] = object.keys.into();
        if !materials.extensions.contains(&name) {
            materials.extensions.push(name);
        }
    };
    if let Some(c) = clearcoat {
        let normal_texture = c.normal_texture.filter(|_| has_frame);
        extension("KHR_materials_clearcoat", &|o| {
            o.share("clearcoatFactor", c.factor, 0.0);
            o.texture("clearcoatTexture", c.texture);
            o.share("clearcoatRoughnessFactor", c.roughness, 0.0);
            o.texture("clearcoatRoughnessTexture", c.roughness_texture);
            o.texture("clearcoatNormalTexture", normal_texture);
            if normal_texture.is_some() && c.normal_scale != 1.0 && c.normal_scale.is_finite() {
                o.keys["clearcoatNormalTexture"]["scale"] = f64::from(c.normal_scale).into();
            }
        });
    }
    if let Some(s) = sheen {
        extension("KHR_materials_sheen", &|o| {
            o.color("sheenColorFactor", s.color, 0.0, 1.0);
            o.texture("sheenColorTexture", s.color_texture);
            o.share("sheenRoughnessFactor", s.roughness, 0.0);
            o.texture("sheenRoughnessTexture", s.roughness_texture);
        });
    }
    if let Some(t) = transmission {
        extension("KHR_materials_transmission", &|o| {
            o.share("transmissionFactor", t.factor, 0.0);
            o.texture("transmissionTexture", t.texture);
        });
    }
    if let Some(d) = diffuse_transmission {
        extension("KHR_materials_diffuse_transmission", &|o| {
            o.share("diffuseTransmissionFactor", d.factor, 0.0);
            o.texture("diffuseTransmissionTexture", d.texture);
            o.color("diffuseTransmissionColorFactor", d.color, 1.0, 1.0);
            o.texture("diffuseTransmissionColorTexture", d.color_texture);
        });
    }
    if let Some(v) = volume {
        extension("KHR_materials_volume", &|o| {
            o.number("thicknessFactor", v.thickness / unit, 0.0, 0.0);
            o.texture("thicknessTexture", v.texture);
            if v.attenuation_distance.is_finite() && v.attenuation_distance > 0.0 {
                o.keys.insert("attenuationDistance".into(), f64::from(v.attenuation_distance).into());
            }
            o.color("attenuationColor", v.attenuation_color, 1.0, 1.0);
        });
    }
    if let Some(i) = iridescence {
        extension("KHR_materials_iridescence", &|o| {
            o.share("iridescenceFactor", i.factor, 0.0);
            o.texture("iridescenceTexture", i.texture);
            o.number("iridescenceIor", i.ior, 1.3, 1.0);
            o.number("iridescenceThicknessMinimum", i.thickness[0], 100.0, 0.0);
            o.number("iridescenceThicknessMaximum", i.thickness[1], 400.0, 0.0);
            o.texture("iridescenceThicknessTexture", i.thickness_texture);
        });
    }
    if let Some(a) = anisotropy {
        extension("KHR_materials_anisotropy", &|o| {
            o.share("anisotropyStrength", a.strength, 0.0);
            if a.rotation != 0.0 && a.rotation.is_finite() {
                o.keys.insert("anisotropyRotation".into(), f64::from(a.rotation).into());
            }
            o.texture("anisotropyTexture", a.texture);
        });
    }
    if let Some(s) = specular {
        extension("KHR_materials_specular", &|o| {
            o.share("specularFactor", s.factor, 1.0);
            o.texture("specularTexture", s.texture);
            o.color("specularColorFactor", s.color, 1.0, f32::MAX);
            o.texture("specularColorTexture", s.color_texture);
        });
    }
    if let Some(ior) = ior {
        // 0 stands for an infinite index; between that and 1 there is none.
        extension("KHR_materials_ior", &|o| o.number("ior", *ior, 1.5, if *ior == 0.0 { 0.0 } else { 1.0 }));
    }
    if let Some(dispersion) = dispersion {
        extension("KHR_materials_dispersion", &|o| o.number("dispersion", *dispersion, 0.0, 0.0));
    }
}
