//! Direction of a normal map's green channel in the file that is written.
//!
//! Parbake works with +Y (green grows upwards, against v; glTF 2.0, section 3.9.3). Engines of the
//! DirectX convention read −Y; for them the green channel `g` of 8 bits is written as `255 − g`.
//!
//! Contract: only images that are read as normal maps change, each once, and the materials that use them
//! say so in their names. A file with −Y is not what glTF asks for: viewers and `eval` light it wrongly.

use parbake_model::{Material, Model};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Direction of a normal map's green channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum NormalY {
    /// +Y, as glTF, Blender, Unity, Godot and three.js read normal maps.
    #[default]
    Up,
    /// −Y, for Unreal Engine; glTF viewers and eval show such a file wrongly.
    Down,
}

/// What is added to the names of materials and images whose normal map has −Y.
const MARK: &str = " (normal map -Y)";

/// A model with +Y normal maps as it is to be written; with [`NormalY::Up`] the same model.
pub fn with_normal_y(model: &Model, direction: NormalY) -> Cow<'_, Model> {
    let mut images: Vec<usize> = model.materials.iter().flat_map(normal_images).collect();
    if direction == NormalY::Up || images.is_empty() {
        return Cow::Borrowed(model);
    }
    images.sort_unstable();
    images.dedup();
    let mut written = model.clone();
    for index in images {
        if let Some(image) = written.images.get_mut(index) {
            image.pixels.iter_mut().for_each(|pixel| pixel[1] = 255 - pixel[1]);
            image.name += MARK;
        }
    }
    for material in written.materials.iter_mut().filter(|material| normal_images(material).next().is_some()) {
        material.name += MARK;
    }
    Cow::Owned(written)
}

/// The images that a material reads as normal maps: its own, its parallax map's and its clearcoat's.
fn normal_images(material: &Material) -> impl Iterator<Item = usize> {
    let of_map = material.parallax.as_ref().and_then(|map| map.normal_texture);
    let of_clearcoat = material.extensions.clearcoat.and_then(|clearcoat| clearcoat.normal_texture);
    [material.normal_texture, of_map, of_clearcoat].into_iter().flatten().map(|slot| slot.image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::{Clearcoat, Image, Material, ParallaxMap, TextureSlot};

    /// Protects engines with −Y: the green channel of the normal map is inverted once, however many
    /// materials use it, and nothing else is.
    #[test]
    fn green_is_inverted_once() {
        let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
        let material =
            Material { base_color_texture: slot(0), normal_texture: slot(1), ..Material::default() };
        let images = [[1, 2, 3, 4], [10, 20, 30, 255]].map(|texel| Image::solid("i", 1, 1, texel));
        let model = Model {
            materials: vec![material.clone(), material],
            images: images.to_vec(),
            ..Model::default()
        };
        let down = with_normal_y(&model, NormalY::Down);
        assert_eq!(down.images[0], model.images[0]);
        assert_eq!(down.images[1].pixels, [[10, 235, 30, 255]]);
        assert!(down.materials.iter().all(|material| material.name.ends_with(MARK)));
        assert_eq!(*with_normal_y(&model, NormalY::Up), model);
    }

    /// Protects parallax maps, whose own normals are not those of other viewers, and coats: all normals point one way.
    #[test]
    fn all_normal_maps_point_one_way() {
        let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
        let map = ParallaxMap { normal_texture: slot(1), ..ParallaxMap::default() };
        let mut material = Material { normal_texture: slot(0), parallax: Some(map), ..Material::default() };
        material.extensions.clearcoat = Some(Clearcoat { normal_texture: slot(2), ..Clearcoat::default() });
        let images = vec![Image::solid("i", 1, 1, [10, 20, 30, 255]); 4];
        let model = Model { materials: vec![material], images, ..Model::default() };
        let down = with_normal_y(&model, NormalY::Down);
        let greens: Vec<u8> = down.images.iter().map(|image| image.pixels[0][1]).collect();
        assert_eq!(greens, [235, 235, 235, 20]);
    }
}
