//! From maps to the factors and textures of a material.
//!
//! A map that has one value all over becomes a factor and costs no texture. Occlusion, roughness and
//! metallic share one image, in its red, green and blue channel (glTF 2.0, 3.9).

use crate::display::decode_srgb;
use crate::maps::MapKind;
use crate::material_maps::set_texture;
use parbake_model::{Image, Material, TextureSlot};

/// Gives a material these maps, whose images are added to the model's. `emissive_strength` is what emission was divided by;
/// a material that `is_unlit` shows no map but its base colour.
pub fn add_maps(
    material: &mut Material,
    images: &mut Vec<Image>,
    maps: Vec<(MapKind, Image)>,
    emissive_strength: f32,
    is_unlit: bool,
) {
    let mut add = |material: &mut Material, kind: MapKind, image: Image| {
        set_texture(material, kind, slot(images.len()));
        images.push(image);
    };
    let (mut roughness, mut occlusion) = (None, None);
    material.unlit = is_unlit;
    for (kind, image) in maps {
        let value = constant(&image);
        let linear = value.map(|v| v.map(|x| f32::from(x) / 255.0));
        match (kind, linear) {
            // What is not lit shows nothing else.
            (MapKind::Normal | MapKind::MetallicRoughness | MapKind::Occlusion | MapKind::Emissive, _)
                if is_unlit => {}
            (MapKind::BaseColor, Some([r, g, b, a])) => {
                material.base_color = [decode_srgb(r), decode_srgb(g), decode_srgb(b), a];
            }
            (MapKind::Emissive, Some([r, g, b, _])) => {
                material.emissive = [r, g, b].map(decode_srgb);
                material.emissive_strength = emissive_strength;
            }
            (MapKind::Emissive, None) => {
                add(material, kind, image);
                material.emissive_strength = emissive_strength;
            }
            (MapKind::MetallicRoughness, _) => roughness = Some((image, linear)),
            (MapKind::Occlusion, Some(_)) => {}
            (MapKind::Occlusion, None) => occlusion = Some(image),
            (MapKind::Normal, Some([x, y, ..])) if (x - 0.5).abs() < 0.01 && (y - 0.5).abs() < 0.01 => {}
            (MapKind::BaseColor | MapKind::Normal, _) => add(material, kind, image),
        }
    }
    let factors = roughness.as_ref().and_then(|(_, value)| *value);
    let mut packed = match (roughness, factors) {
        (Some((image, _)), None) => Some(image),
        _ => None,
    };
    if let Some([_, roughness, metallic, _]) = factors {
        (material.roughness, material.metallic) = (roughness, metallic);
    }
    if let Some(occlusion) = occlusion {
        match &mut packed {
            Some(image) => {
                let pairs = image.pixels.iter_mut().zip(&occlusion.pixels);
                pairs.for_each(|(to, from)| to[0] = from[0]);
            }
            None => {
                let whitened = occlusion.pixels.iter().map(|p| [p[0], 255, 255, 255]).collect();
                packed = Some(Image { pixels: whitened, ..occlusion });
            }
        }
        material.occlusion_texture = Some(slot(images.len()));
    }
    if let Some(image) = packed {
        if factors.is_none() {
            (material.roughness, material.metallic) = (1.0, 1.0);
            material.metallic_roughness_texture = Some(slot(images.len()));
        }
        let name = "occlusion roughness metallic".into();
        images.push(Image { name, ..image });
    }
}

fn slot(image: usize) -> TextureSlot {
    TextureSlot { image, ..TextureSlot::default() }
}

/// The mean value of an image that has about one value all over, give or take rounding.
fn constant(image: &Image) -> Option<[u8; 4]> {
    let (mut low, mut high) = ([255u8; 4], [0u8; 4]);
    for pixel in &image.pixels {
        for k in 0..4 {
            (low[k], high[k]) = (low[k].min(pixel[k]), high[k].max(pixel[k]));
        }
    }
    let is_constant = low.iter().zip(&high).all(|(l, h)| h.saturating_sub(*l) <= 2);
    is_constant.then(|| std::array::from_fn(|k| u8::midpoint(low[k], high[k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: [[u8; 4]; 2]) -> Image {
        Image { name: "map".into(), width: 2, height: 1, pixels: pixels.to_vec() }
    }

    fn written(maps: Vec<(MapKind, Image)>) -> (Material, Vec<Image>) {
        let (mut material, mut images) = (Material::default(), Vec::new());
        add_maps(&mut material, &mut images, maps, 3.0, false);
        (material, images)
    }

    /// Protects small files: maps of one value become factors.
    #[test]
    fn constant_maps_are_factors() {
        let maps = vec![
            (MapKind::BaseColor, image([[255, 188, 0, 255]; 2])),
            (MapKind::Normal, image([[128, 128, 255, 255]; 2])),
            (MapKind::MetallicRoughness, image([[0, 51, 255, 255], [0, 52, 255, 255]])),
            (MapKind::Emissive, image([[255, 255, 255, 255]; 2])),
            (MapKind::Occlusion, image([[255, 0, 0, 255]; 2])),
        ];
        let (material, images) = written(maps);
        assert!(images.is_empty() && material.all_texture_slots().next().is_none());
        assert_eq!((material.metallic, material.emissive_strength), (1.0, 3.0));
        assert!((material.roughness - 0.2).abs() < 0.01 && (material.base_color[1] - 0.5).abs() < 0.01);
    }

    /// Protects the number of textures: occlusion, roughness and metallic are one image.
    #[test]
    fn occlusion_roughness_and_metallic_share_an_image() {
        let maps = vec![
            (MapKind::BaseColor, image([[255, 188, 0, 255], [0, 0, 0, 255]])),
            (MapKind::MetallicRoughness, image([[0, 51, 255, 255], [0, 99, 255, 255]])),
            (MapKind::Occlusion, image([[255, 0, 0, 255], [40, 0, 0, 255]])),
        ];
        let (material, images) = written(maps);
        let slots = (material.metallic_roughness_texture, material.occlusion_texture);
        assert_eq!(slots.0.map(|s| s.image), slots.1.map(|s| s.image));
        assert_eq!(images.len(), 2);
        assert_eq!(images[1].pixels, [[255, 51, 255, 255], [40, 99, 255, 255]]);
    }
}
