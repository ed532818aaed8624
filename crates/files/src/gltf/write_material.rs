//! Materials for a GLB file: fully rough and not metallic, seen from both sides,
//! for a baked look has its shading from nowhere else.

use parbake_model::{AlphaMode, Material, Model, TextureSlot, UvTransform, Wrap};
use serde_json::{Value, json};

/// The document's material part. Indices into it are those of its own lists.
#[derive(Default)]
pub(super) struct Materials {
    /// Indices of the model's materials that triangles have, increasing.
    pub used: Vec<usize>,
    /// Indices of the model's images that those materials use, in order of use.
    pub images: Vec<usize>,
    /// The materials themselves.
    pub json: Vec<Value>,
    pub textures: Vec<Value>,
    pub samplers: Vec<Value>,
    pub uses_transforms: bool,
    pub uses_parallax: bool,
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
    pub fn of(model: &Model) -> Self {
        let mut out = Self::default();
        let mut is_used = vec![false; model.materials.len()];
        for &material in &model.mesh.triangle_materials {
            is_used[material as usize] = true;
        }
        out.used = (0..is_used.len()).filter(|&i| is_used[i]).collect();
        for i in out.used.clone() {
            let json = out.material(&model.materials[i]);
            out.json.push(json);
        }
        out
    }

    fn material(&mut self, material: &Material) -> Value {
        let factor = material.base_color.map(|x| f64::from(if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) }));
        let mut pbr = json!({ "metallicFactor": 0, "roughnessFactor": 1 });
        if factor != [1.0; 4] {
            pbr["baseColorFactor"] = json!(factor);
        }
        if let Some(slot) = &material.base_color_texture {
            pbr["baseColorTexture"] = self.texture_info(slot);
        }
        let mut json = json!({ "name": material.name, "pbrMetallicRoughness": pbr, "doubleSided": true });
        if let Some(slot) = &material.normal_texture {
            let mut info = self.texture_info(slot);
            if material.normal_scale != 1.0 && material.normal_scale.is_finite() {
                info["scale"] = f64::from(material.normal_scale).into();
            }
            json["normalTexture"] = info;
        }
        match material.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Mask => json["alphaMode"] = "MASK".into(),
            AlphaMode::Blend => json["alphaMode"] = "BLEND".into(),
        }
        self.add_parallax(material, &mut json);
        json
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
