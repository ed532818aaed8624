//! Parallax maps and their cutouts out: the material extensions `PARBAKE_materials_parallax`, as
//! `docs/parallax_format.md` has it, and `PARBAKE_materials_parallax_sh` (`docs/parallax_sh_format.md`).
//! Numbers are written so that reading gives the same bits.
//!
//! Contract: the map passes its check.

use super::material_lists::{Filter, Materials};
use super::parallax::{NAME, NAME_SH, VERSION};
use parbake_model::{Basis, Material, ParallaxMap};
use serde_json::{Value, json};

fn exact(numbers: &[f32]) -> Vec<f64> {
    numbers.iter().map(|&x| x.into()).collect()
}

impl Materials {
    /// Adds the extension to a material that has a map.
    pub fn add_parallax(&mut self, material: &Material, json: &mut Value) {
        let Some(map) = &material.parallax else { return };
        let (name, mut extension) = match map.basis {
            Basis::Harmonics(order) => {
                self.uses_harmonics = true;
                (NAME_SH, self.harmonics(map, order))
            }
            Basis::TangentShift | Basis::TangentCutout => {
                self.uses_parallax = true;
                (NAME, self.tangent(map))
            }
        };
        let own = [("baseColorTexture", &map.base_color_texture), ("normalTexture", &map.normal_texture)];
        for (name, slot) in own {
            if let Some(slot) = slot {
                extension[name] = self.texture_info(slot);
            }
        }
        json["extensions"][name] = extension;
    }

    fn tangent(&mut self, map: &ParallaxMap) -> Value {
        let mut data = |image| json!({ "index": self.texture(image, map.wrap, Filter::Linear) });
        let mut json = json!({
            "version": VERSION,
            "texture": data(map.images[0]),
            "scale": exact(&map.scale),
            "offset": exact(&map.offset),
            "limit": f64::from(map.limit),
        });
        if map.fade.is_finite() {
            json["fadeFootprint"] = f64::from(map.fade).into();
        }
        if let Some(cutout) = &map.cutout {
            json["cutout"] = json!({
                "texture": data(cutout.images[0]),
                "scale": exact(&cutout.scale),
                "offset": exact(&cutout.offset),
            });
        }
        json
    }

    fn harmonics(&mut self, map: &ParallaxMap, order: usize) -> Value {
        let mut data = |image| json!({ "index": self.texture(image, map.wrap, Filter::Linear) });
        let mut json = json!({
            "order": order,
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
                "order": order_of(cutout.basis),
                "coefficientTextures": cutout.images.iter().map(|&i| data(i)).collect::<Vec<_>>(),
                "scale": exact(&cutout.scale),
                "offset": exact(&cutout.offset),
            });
        }
        json
    }
}

/// The order of harmonics; of other functions, which the check of maps keeps away, 0.
fn order_of(basis: Basis) -> usize {
    if let Basis::Harmonics(order) = basis { order } else { 0 }
}
