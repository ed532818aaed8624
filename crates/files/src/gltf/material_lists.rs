//! The lists of a document that make up its materials, as they grow: materials, textures, samplers, and the images that
//! these are of (glTF 2.0, 3.8); coordinates are transformed by KHR_texture_transform.
//!
//! Contract: what is the same is listed once.

use parbake_model::{TextureSlot, UvTransform, Wrap};
use serde_json::{Value, json};

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
    pub used: Vec<(usize, Option<u32>)>,
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

    /// One use of a texture.
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
pub(super) fn place<T: PartialEq>(values: &mut Vec<T>, value: T) -> usize {
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
