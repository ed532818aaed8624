//! Materials for a GLB file (glTF 2.0, 3.9), with KHR_materials_emissive_strength,
//! KHR_materials_unlit and KHR_texture_transform; other extensions are in `write_extensions.rs`.
//!
//! What is glTF's default is left out; metallic and roughness factor are both written or both left
//! out. Factors out of range are clamped. What has no effect is not kept: an alpha cutoff without
//! [`AlphaMode::Mask`], the strength of emission that is black or of an unlit material.

use super::write_extensions;
use crate::ktx2_out::Content;
use crate::texture_out::{Purpose, Use};
use parbake_model::{AlphaMode, Material, Model, ParallaxMap, TextureSlot, UvTransform, Wrap};
use serde_json::{Value, json};

pub(super) const EMISSIVE_STRENGTH: &str = "KHR_materials_emissive_strength";
pub(super) const UNLIT: &str = "KHR_materials_unlit";

/// The document's material part. Indices into it are those of its own lists.
#[derive(Default)]
pub(super) struct Materials {
    /// Indices of the model's images that those materials use, in order of use.
    pub images: Vec<usize>,
    /// The materials themselves.
    pub json: Vec<Value>,
    pub textures: Vec<Value>,
    pub samplers: Vec<Value>,
    pub uses_transforms: bool,
    pub uses_parallax: bool,
    /// Parallax maps of spherical harmonics.
    pub uses_harmonics: bool,
    pub uses_emissive_strength: bool,
    pub uses_unlit: bool,
    /// Whether the mesh says which way its tangent frames look.
    pub has_tangents: bool,
    /// The names of the other material extensions in use.
    pub extensions: Vec<&'static str>,
    /// Indices of the model's materials, and the unit that they are written for where it matters.
    used: Vec<(usize, Option<u32>)>,
    texture_keys: Vec<(usize, [Wrap; 2], Filter)>,
    sampler_keys: Vec<([Wrap; 2], Filter)>,
}

/// How a texture is fetched.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Filter {
    /// Linear, and linear between mip levels: pictures.
    Trilinear,
    /// Linear, and no mip levels: data.
    Linear,
}

impl Materials {
    /// None yet.
    pub fn new(has_tangents: bool) -> Self {
        Self { has_tangents, ..Self::default() }
    }

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

    pub fn texture_info(&mut self, slot: &TextureSlot) -> Value {
        let mut info = json!({ "index": self.texture(slot.image, slot.wrap, Filter::Trilinear) });
        if slot.uv_set != 0 {
            info["texCoord"] = slot.uv_set.into();
        }
        let UvTransform { offset, rotation, scale } = slot.transform;
        if slot.transform != UvTransform::default() {
            self.uses_transforms = true;
            let pair = |v: [f32; 2]| json!(v.map(f64::from));
            info["extensions"] = json!({ "KHR_texture_transform": {
                "offset": pair(offset.to_array()),
                "rotation": f64::from(rotation),
                "scale": pair(scale.to_array()),
            }});
        }
        info
    }

    /// The index of a texture, which is added where it is not there yet.
    pub fn texture(&mut self, image: usize, wrap: [Wrap; 2], filter: Filter) -> usize {
        let source = place(&mut self.images, image);
        let key = (image, wrap, filter);
        let index = place(&mut self.texture_keys, key);
        if index == self.textures.len() {
            let sampler = place(&mut self.sampler_keys, (wrap, filter));
            if sampler == self.samplers.len() {
                let [s, t] = wrap.map(code);
                let min = if filter == Filter::Trilinear { 9987 } else { 9729 };
                self.samplers.push(json!({ "magFilter": 9729, "minFilter": min, "wrapS": s, "wrapT": t }));
            }
            self.textures.push(json!({ "source": source, "sampler": sampler }));
        }
        index
    }
}

/// What an image is used for: by the strictest of the materials' slots that have it, and as colours if any slot
/// reads them as such.
pub(super) fn purpose_of(model: &Model, image: usize) -> Purpose {
    let is = |slot: &Option<TextureSlot>| slot.is_some_and(|s| s.image == image);
    let materials = || model.materials.iter();
    let maps = || materials().filter_map(|m| m.parallax.as_ref());
    let is_exact = |map: &ParallaxMap| {
        map.images.contains(&image)
            || map.depth.as_ref().is_some_and(|depth| depth.image == image)
            || map.cutout.as_ref().is_some_and(|cutout| cutout.images.contains(&image))
    };
    let extensions = || materials().flat_map(|m| m.extensions.textures()).filter(|(s, _)| s.image == image);
    let is_normal = materials().any(|m| {
        is(&m.normal_texture) || m.extensions.clearcoat.is_some_and(|coat| is(&coat.normal_texture))
    }) || maps().any(|map| is(&map.normal_texture));
    let is_data = is_normal
        || materials().any(|m| is(&m.metallic_roughness_texture) || is(&m.occlusion_texture))
        || extensions().any(|(_, is_color)| !is_color);
    let base_color = |m: &Material| {
        is(&m.base_color_texture) || m.parallax.as_ref().is_some_and(|map| is(&map.base_color_texture))
    };
    let is_color = materials().any(|m| base_color(m) || is(&m.emissive_texture))
        || extensions().any(|(_, is_color)| is_color);
    // Where a parallax map has a texture of its own, only viewers that do not know the map see the material's.
    let stands_in = |m: &Material| {
        let of_maps = m.parallax.as_ref().map(|map| [map.base_color_texture, map.normal_texture]);
        let own = [m.base_color_texture, m.normal_texture];
        own.iter().zip(of_maps.into_iter().flatten()).any(|(own, of_map)| is(own) && of_map.is_some())
    };
    let is_shown = |m: &Material| {
        let of_maps = m.parallax.iter().flat_map(|map| [map.base_color_texture, map.normal_texture]);
        let own = [m.metallic_roughness_texture, m.occlusion_texture, m.emissive_texture];
        of_maps.chain(own).any(|slot| is(&slot))
            || (m.parallax.is_none() && m.texture_slots().any(|s| s.image == image))
    };
    let is_fallback =
        materials().any(stands_in) && !materials().any(is_shown) && extensions().next().is_none();
    let masked = |m: &&Material| m.alpha_mode == AlphaMode::Mask && base_color(m) && m.base_color[3] > 0.0;
    Purpose {
        of: match () {
            () if maps().any(is_exact) => Use::Exact,
            () if is_fallback => Use::Fallback,
            () if is_data => Use::Data,
            () => Use::Color,
        },
        content: match () {
            () if is_color => Content::Color,
            () if is_normal => Content::Normal,
            () => Content::Values,
        },
        cutoff: materials().find(masked).map(|m| m.alpha_cutoff / m.base_color[3]),
    }
}

/// From 0 to 1; `otherwise` where it is no number.
pub(super) fn in_range(x: f32, otherwise: f64) -> f64 {
    if x.is_nan() { otherwise } else { f64::from(x).clamp(0.0, 1.0) }
}

/// A number without an upper limit; `None` where it is the default, or not finite.
pub(super) fn from_zero(x: f32, default: f32) -> Option<f64> {
    (x.is_finite() && x != default).then(|| f64::from(x.max(0.0)))
}

/// 0 and 1 without a decimal point.
fn short(x: f64) -> Value {
    if x == 0.0 || x == 1.0 { json!(x as u8) } else { x.into() }
}

/// Where `value` is in `values`; at the end, if it was not there before.
fn place<T: PartialEq>(values: &mut Vec<T>, value: T) -> usize {
    values.iter().position(|v| *v == value).unwrap_or_else(|| {
        values.push(value);
        values.len() - 1
    })
}

fn code(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    }
}
