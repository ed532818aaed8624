//! SH parallax maps and their cutouts out: the material extension `PARBAKE_materials_parallax_sh`, as
//! `docs/parallax_format.md` has it. Numbers are written so that reading gives the same bits.
//!
//! Contract: the map passes its check.

use super::write_material::{Filter, Materials};
use parbake_model::{Material, ShParallaxMap};
use serde_json::{Value, json};

impl Materials {
    /// Adds the extension to a material that has a map.
    pub fn add_parallax(&mut self, material: &Material, json: &mut Value) {
        if let Some(map) = &material.parallax {
            let extension = self.parallax(map);
            json["extensions"][super::parallax::NAME] = extension;
            self.uses_parallax = true;
        }
    }

    fn parallax(&mut self, map: &ShParallaxMap) -> Value {
        let mut data = |image| json!({ "index": self.texture(image, map.wrap, Filter::Linear) });
        let exact = |numbers: &[f32]| -> Vec<f64> { numbers.iter().map(|&x| x.into()).collect() };
        let mut json = json!({
            "order": map.order,
            "limit": f64::from(map.limit),
            "coefficientTextures": map.images.iter().map(|&i| data(i)).collect::<Vec<_>>(),
            "scale": exact(&map.scale),
            "offset": exact(&map.offset),
        });
        if let Some(depth) = &map.depth {
            json["depthTexture"] = data(depth.image);
            json["depthScale"] = f64::from(depth.scale).into();
            json["depthOffset"] = f64::from(depth.offset).into();
        }
        if let Some(cutout) = &map.cutout {
            json["cutout"] = json!({
                "order": cutout.order,
                "coefficientTextures": cutout.images.iter().map(|&i| data(i)).collect::<Vec<_>>(),
                "scale": exact(&cutout.scale),
                "offset": exact(&cutout.offset),
            });
        }
        let own = [("baseColorTexture", &map.base_color_texture), ("normalTexture", &map.normal_texture)];
        for (name, slot) in own {
            if let Some(slot) = slot {
                json[name] = self.texture_info(slot);
            }
        }
        json
    }
}
