//! Glass in pictures that compare levels: blending stands in for light that passes a surface (`KHR_materials_transmission`).
//!
//! ```text
//! opacity = 1 − 0.91 · factor · texture · (1 − metallic)
//! ```
//!
//! A level may say with textures what its model says with factors, so each texel gets the opacity of its own.
//!
//! Contract: cut-outs stay cut-outs. Textures that are read elsewhere than the base colour count with their mean.

use parbake_image::material_maps::{opacity, transmits};
use parbake_model::{AlphaMode, Image, Material, Model, TextureSlot};
use std::borrow::Cow;

/// The model with blended materials in place of those that light passes.
pub(crate) fn with_blending(model: &Model) -> Cow<'_, Model> {
    let is_seen_through = |material: &Material| material.alpha_mode != AlphaMode::Mask && transmits(material);
    if !model.materials.iter().any(is_seen_through) {
        return Cow::Borrowed(model);
    }
    let mut out = model.clone();
    for index in 0..out.materials.len() {
        if is_seen_through(&out.materials[index]) {
            blend(&mut out, index);
        }
    }
    Cow::Owned(out)
}

fn blend(model: &mut Model, index: usize) {
    let material = &mut model.materials[index];
    let Some(transmission) = material.extensions.transmission.take() else { return };
    let was_opaque = std::mem::replace(&mut material.alpha_mode, AlphaMode::Blend) == AlphaMode::Opaque;
    let base = material.base_color_texture;
    let metal = material.metallic_roughness_texture;
    let Some(slot) = base.or(transmission.texture).or(metal) else {
        let own = if was_opaque { 1.0 } else { material.base_color[3] };
        material.base_color[3] = own * opacity(transmission.factor * (1.0 - material.metallic));
        return;
    };
    let texture = |own: Option<TextureSlot>, channel: usize| Channel::new(&model.images, own, slot, channel);
    let passing = texture(transmission.texture, 0);
    let metallic = texture(metal, 2);
    let alpha = texture(base.filter(|_| !was_opaque), 3);
    let color = base.and_then(|base| model.images.get(base.image));
    let sides = [&passing, &metallic, &alpha].into_iter().filter_map(|channel| channel.image).chain(color);
    let (width, height) = sides.fold((1, 1), |(w, h), image| (w.max(image.width), h.max(image.height)));
    let pixels = (0..width * height).map(|i| {
        let (u, v) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        let at = [u / width as f32, v / height as f32];
        let passes = transmission.factor * passing.at(at) * (1.0 - material.metallic * metallic.at(at));
        let alpha = alpha.at(at) * opacity(passes);
        let [r, g, b, _] = color.map_or([255; 4], |image| texel(image, at));
        [r, g, b, (255.0 * alpha + 0.5) as u8]
    });
    let image = Image { name: "blended".into(), width, height, pixels: pixels.collect() };
    if was_opaque {
        material.base_color[3] = 1.0;
    }
    material.base_color_texture = Some(TextureSlot { image: model.images.len(), ..slot });
    model.images.push(image);
}

/// A channel of a texture.
struct Channel<'a> {
    /// The texture, where it is read as the base colour is.
    image: Option<&'a Image>,
    channel: usize,
    /// What there is otherwise.
    mean: f32,
}

impl<'a> Channel<'a> {
    fn new(images: &'a [Image], own: Option<TextureSlot>, as_read: TextureSlot, channel: usize) -> Self {
        let image = own.and_then(|own| images.get(own.image)).filter(|image| !image.pixels.is_empty());
        let reads_alike =
            own.is_some_and(|own| (own.uv_set, own.transform) == (as_read.uv_set, as_read.transform));
        let mean = image.filter(|_| !reads_alike).map_or(1.0, |image| {
            let sum: f64 = image.pixels.iter().map(|p| f64::from(p[channel])).sum();
            (sum / 255.0 / image.pixels.len() as f64) as f32
        });
        Self { image: image.filter(|_| reads_alike), channel, mean }
    }

    fn at(&self, uv: [f32; 2]) -> f32 {
        self.image.map_or(self.mean, |image| f32::from(texel(image, uv)[self.channel]) / 255.0)
    }
}

fn texel(image: &Image, [u, v]: [f32; 2]) -> [u8; 4] {
    let at = |share: f32, side: usize| ((share * side as f32) as usize).min(side - 1);
    image.pixels[at(v, image.height) * image.width + at(u, image.width)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::{MaterialExtensions, Transmission};

    fn glass(texture: Option<TextureSlot>) -> Material {
        let transmission = Some(Transmission { factor: 0.8, texture });
        Material {
            extensions: MaterialExtensions { transmission, ..MaterialExtensions::default() },
            ..Material::default()
        }
    }

    fn image(pixels: [[u8; 4]; 4]) -> Image {
        Image { name: "image".into(), width: 2, height: 2, pixels: pixels.to_vec() }
    }

    /// Protects the choice between ways: glass looks alike, whether factors or textures say how much light passes it.
    #[test]
    fn factors_and_textures_are_alike() {
        let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
        let images = vec![image([[255; 4]; 4]), image([[255, 0, 0, 255], [0; 4], [0; 4], [0; 4]])];
        let wanted = opacity(0.8);
        let of = |material: Material| {
            let model = Model { materials: vec![material], images: images.clone(), ..Model::default() };
            let out = with_blending(&model).into_owned();
            let [material] = &out.materials[..] else { panic!("one material") };
            assert_eq!(material.alpha_mode, AlphaMode::Blend);
            assert!(material.extensions.is_empty());
            let texels = material.base_color_texture.map(|slot| out.images[slot.image].pixels.clone());
            (material.base_color[3], texels.unwrap_or_default().iter().map(|p| p[3]).collect::<Vec<_>>())
        };
        assert_eq!(of(glass(None)), (wanted, vec![]));
        let stored = (255.0 * wanted + 0.5) as u8;
        assert_eq!(of(glass(slot(0))), (1.0, vec![stored; 4]));
        // What light does not pass is opaque, texel by texel.
        assert_eq!(of(glass(slot(1))), (1.0, vec![stored, 255, 255, 255]));
        let colored = Material { base_color_texture: slot(1), ..glass(None) };
        assert_eq!(of(colored), (1.0, vec![stored; 4]));
    }

    /// Protects all else from being copied and changed.
    #[test]
    fn what_is_not_glass_stays() {
        let cut = Material { alpha_mode: AlphaMode::Mask, ..glass(None) };
        let metal = Material { metallic: 1.0, ..glass(None) };
        let model = Model { materials: vec![cut, metal, Material::default()], ..Model::default() };
        assert!(matches!(with_blending(&model), Cow::Borrowed(_)));
    }
}
