//! KHR_materials_pbrSpecularGlossiness, converted to metallic-roughness texel by texel.
//!
//! The formula is that of Khronos' converter (the extension's example "convert-between-workflows"):
//! with the diffuse colour d, the specular colour s, 0.04 for the reflection of dielectrics and
//! perceived brightness p(c) = √(0.299 r² + 0.587 g² + 0.114 b²), the metallic value m solves
//! `0.04 m² + b m + 0.04 − p(s) = 0` with `b = p(d)·(1 − max s)/0.96 + p(s) − 2·0.04`, the colour is
//! the mix by m² of what d says, `d·(1 − max s)/(0.96·(1 − m))`, and of what s says,
//! `(s − 0.04·(1 − m))/m`, and roughness is 1 − glossiness.
//!
//! Contract: colours are decoded from sRGB before, and encoded after. Where the two textures are
//! fetched at different coordinates, one texel cannot know the other: each is converted with the
//! mean of the other, and a warning says so.

use super::json_material::SpecularGlossiness;
use super::textures::TextureReader;
use crate::context::Context;
use crate::words::shown;
use crate::{FileError, Place};
use parbake_image::display::{decode_srgb, encode_srgb};
use parbake_model::{Image, Material, TextureSlot};
use rayon::prelude::*;
use std::collections::HashMap;

/// Reflection of a dielectric at normal incidence.
const DIELECTRIC: f32 = 0.04;

/// A material that waits for its pictures.
pub(super) struct Pending {
    material: usize,
    diffuse: [f32; 4],
    specular: [f32; 3],
    glossiness: f32,
    diffuse_slot: Option<TextureSlot>,
    specular_slot: Option<TextureSlot>,
}

/// Reads the extension of a material, which will be number `material`; `here` is its pointer. The
/// material gets its factors, and its textures by [`convert`].
pub(super) fn read(
    out: &mut Material,
    material: usize,
    textures: &mut TextureReader<'_, '_>,
    json: &SpecularGlossiness,
    here: &str,
) -> Result<Option<Pending>, FileError> {
    let here = format!("{here}/extensions/KHR_materials_pbrSpecularGlossiness");
    let share = |x: f32| if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) };
    let pending = Pending {
        material,
        diffuse: json.diffuse_factor.unwrap_or([1.0; 4]).map(share),
        specular: json.specular_factor.unwrap_or([1.0; 3]).map(share),
        glossiness: share(json.glossiness_factor.unwrap_or(1.0)),
        diffuse_slot: match &json.diffuse_texture {
            Some(info) => textures.slot(info, &format!("{here}/diffuseTexture"))?,
            None => None,
        },
        specular_slot: match &json.specular_glossiness_texture {
            Some(info) => textures.slot(info, &format!("{here}/specularGlossinessTexture"))?,
            None => None,
        },
    };
    let [r, g, b, alpha] = pending.diffuse;
    let (color, metallic) = metallic([r, g, b], pending.specular);
    out.base_color = [color[0], color[1], color[2], alpha];
    (out.metallic, out.roughness) = (metallic, 1.0 - pending.glossiness);
    Ok((pending.diffuse_slot.is_some() || pending.specular_slot.is_some()).then_some(pending))
}

fn brightness([r, g, b]: [f32; 3]) -> f32 {
    (0.299 * r * r + 0.587 * g * g + 0.114 * b * b).sqrt()
}

/// The base colour and the metallic value of linear diffuse and specular colours.
fn metallic(diffuse: [f32; 3], specular: [f32; 3]) -> ([f32; 3], f32) {
    let rest = 1.0 - specular.into_iter().fold(0.0, f32::max);
    let (d, s) = (brightness(diffuse), brightness(specular));
    let m = if s < DIELECTRIC {
        0.0
    } else {
        let b = d * rest / (1.0 - DIELECTRIC) + s - 2.0 * DIELECTRIC;
        let root = (b * b - 4.0 * DIELECTRIC * (DIELECTRIC - s)).max(0.0).sqrt();
        ((root - b) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
    };
    let color = std::array::from_fn(|c| {
        let by_diffuse = diffuse[c] * rest / (1.0 - DIELECTRIC) / (1.0 - m).max(1e-6);
        let by_specular = (specular[c] - DIELECTRIC * (1.0 - m)) / m.max(1e-6);
        // Limited first: where m is 0, what the other one says is out of all bounds.
        let (a, b) = (by_diffuse.clamp(0.0, 1.0), by_specular.clamp(0.0, 1.0));
        a + (b - a) * m * m
    });
    (color, m)
}

/// sRGB's transfer function for all bytes.
fn linear() -> [f32; 256] {
    std::array::from_fn(|i| decode_srgb(i as f32 / 255.0))
}

fn encoded(x: f32) -> u8 {
    byte(encode_srgb(x))
}

fn byte(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// A texture times a factor, in linear light, at any texel of a picture of another size.
struct Source<'i> {
    image: Option<&'i Image>,
    factor: [f32; 4],
    linear: &'i [f32; 256],
}

impl Source<'_> {
    fn of(&self, [r, g, b, a]: [u8; 4]) -> [f32; 4] {
        let rgb = [r, g, b].map(|x| self.linear[usize::from(x)]);
        let all = [rgb[0], rgb[1], rgb[2], f32::from(a) / 255.0];
        std::array::from_fn(|c| all[c] * self.factor[c])
    }

    fn at(&self, x: usize, y: usize, [width, height]: [usize; 2]) -> [f32; 4] {
        match self.image {
            Some(image) => {
                let (x, y) = (x * image.width / width, y * image.height / height);
                self.of(image.pixels[y * image.width + x])
            }
            None => self.factor,
        }
    }

    fn mean(&self) -> [f32; 4] {
        let Some(image) = self.image else { return self.factor };
        let mut sum = [0.0f64; 4];
        for &pixel in &image.pixels {
            let value = self.of(pixel);
            sum.iter_mut().zip(value).for_each(|(s, v)| *s += f64::from(v));
        }
        sum.map(|s| (s / image.pixels.len() as f64) as f32)
    }
}

/// What a pair of textures became: the base colour's image, and the metallic-roughness map's; where
/// that would be the same everywhere, its metallic and roughness values.
#[derive(Clone, Copy)]
struct Made {
    color: usize,
    metal: Result<usize, [f32; 2]>,
}

/// Gives the materials their converted textures; `images` gets new ones.
pub(super) fn convert(
    pending: &[Pending],
    materials: &mut [Material],
    images: &mut Vec<Image>,
    context: &Context<'_>,
) -> Result<(), FileError> {
    let linear = linear();
    let mut made: HashMap<String, Made> = HashMap::new();
    for one in pending {
        let material = &mut materials[one.material];
        let coordinates = |slot: &TextureSlot| TextureSlot { image: 0, ..*slot };
        let apart = match (&one.diffuse_slot, &one.specular_slot) {
            (Some(a), Some(b)) => coordinates(a) != coordinates(b),
            _ => false,
        };
        if apart {
            context.warn(format!(
                "material {:?}: its diffuse and specular-glossiness textures have different coordinates; \
                 each is converted with the mean of the other",
                material.name
            ));
        }
        let sources = [one.diffuse_slot, one.specular_slot].map(|slot| slot.map(|s| s.image));
        let key = format!("{apart} {sources:?} {:?} {:?} {}", one.diffuse, one.specular, one.glossiness);
        let outcome = match made.get(&key) {
            Some(&outcome) => outcome,
            None => {
                let [color, metal] = pictures(one, images, &linear, apart);
                let constant = metal.pixels.iter().all(|p| *p == metal.pixels[0]);
                let values = metal.pixels[0].map(|x| f32::from(x) / 255.0);
                images.push(color);
                let color = images.len() - 1;
                if !constant {
                    images.push(metal);
                }
                let texels = images.iter().map(|i| i.pixels.len() as u64).sum();
                let place = Place::Image(shown(&material.name));
                let limit = context.limits.max_total_pixels;
                context.within(place, "texels of all images together", texels, limit)?;
                let metal = if constant { Err([values[2], values[1]]) } else { Ok(images.len() - 1) };
                Made { color, metal }
            }
        };
        made.insert(key, outcome);
        material.base_color = [1.0; 4];
        // Where there is one texture, both maps are fetched as it was.
        let slot = |own: Option<TextureSlot>, other: Option<TextureSlot>, image| {
            own.or(other).map(|slot| TextureSlot { image, ..slot })
        };
        material.base_color_texture = slot(one.diffuse_slot, one.specular_slot, outcome.color);
        match outcome.metal {
            Ok(image) => {
                (material.metallic, material.roughness) = (1.0, 1.0);
                material.metallic_roughness_texture = slot(one.specular_slot, one.diffuse_slot, image);
            }
            Err([metallic, roughness]) => {
                material.metallic = metallic;
                // The factor stands there already, with all its bits, where nothing multiplies it.
                if one.specular_slot.is_some() {
                    material.roughness = roughness;
                }
            }
        }
    }
    if !pending.is_empty() {
        drop_unused(materials, images);
    }
    Ok(())
}

fn pictures(one: &Pending, images: &[Image], linear: &[f32; 256], apart: bool) -> [Image; 2] {
    let [r, g, b] = one.specular;
    let source =
        |slot: Option<TextureSlot>, factor| Source { image: slot.map(|s| &images[s.image]), factor, linear };
    let diffuse = source(one.diffuse_slot, one.diffuse);
    let specular = source(one.specular_slot, [r, g, b, one.glossiness]);
    if !apart {
        return pair(&diffuse, &specular);
    }
    let [color, _] = pair(&diffuse, &source(None, specular.mean()));
    let [_, metal] = pair(&source(None, diffuse.mean()), &specular);
    [color, metal]
}

/// Takes out what was only the source of a conversion.
fn drop_unused(materials: &mut [Material], images: &mut Vec<Image>) {
    // A parallax map names images in ways of its own.
    if materials.iter().any(|m| m.parallax.is_some()) {
        return;
    }
    let mut used = vec![false; images.len()];
    materials.iter().flat_map(Material::all_texture_slots).for_each(|slot| used[slot.image] = true);
    let mut kept = 0usize;
    let mut places = Vec::with_capacity(used.len());
    for &used in &used {
        places.push(kept);
        kept += usize::from(used);
    }
    for material in materials {
        let slots = [
            &mut material.base_color_texture,
            &mut material.normal_texture,
            &mut material.metallic_roughness_texture,
            &mut material.occlusion_texture,
            &mut material.emissive_texture,
        ];
        let extensions = material.extensions.textures_mut().into_iter().map(|(slot, _)| slot);
        slots.into_iter().chain(extensions).flatten().for_each(|slot| slot.image = places[slot.image]);
    }
    let mut used = used.into_iter();
    images.retain(|_| used.next().unwrap_or(false));
}

/// The base colour, and the metallic-roughness map, at the larger size of the two.
fn pair(diffuse: &Source<'_>, specular: &Source<'_>) -> [Image; 2] {
    let size = |axis: fn(&Image) -> usize| diffuse.image.map_or(1, axis).max(specular.image.map_or(1, axis));
    let size = [size(|i| i.width), size(|i| i.height)];
    let texels: Vec<[[u8; 4]; 2]> = (0..size[0] * size[1])
        .into_par_iter()
        .map(|i| {
            let (x, y) = (i % size[0], i / size[0]);
            let [r, g, b, alpha] = diffuse.at(x, y, size);
            let [sr, sg, sb, gloss] = specular.at(x, y, size);
            let (color, metal) = metallic([r, g, b], [sr, sg, sb]);
            let [r, g, b] = color.map(encoded);
            [[r, g, b, byte(alpha)], [255, byte(1.0 - gloss), byte(metal), 255]]
        })
        .collect();
    let name = diffuse.image.or(specular.image).map_or("", |i| i.name.as_str());
    let image = |which: usize, kind: &str| Image {
        name: format!("{name} {kind}"),
        width: size[0],
        height: size[1],
        pixels: texels.iter().map(|t| t[which]).collect(),
    };
    [image(0, "base colour"), image(1, "metallic-roughness")]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the two ends, plastic and metal, and what lies between: the converted material has the
    /// diffuse and the specular colour that it came from.
    #[test]
    fn colours_survive_the_conversion() {
        let (color, m) = metallic([0.5, 0.2, 0.1], [0.04; 3]);
        assert!(m < 1e-3 && (color[0] - 0.5).abs() < 2e-3, "{color:?} {m}");
        let gold = [1.0, 0.77, 0.34];
        let (color, m) = metallic([0.0; 3], gold);
        assert!((m - 1.0).abs() < 1e-3 && (0..3).all(|c| (color[c] - gold[c]).abs() < 1e-3), "{color:?} {m}");
        let (diffuse, specular) = ([0.4; 3], [0.5; 3]);
        let (color, m) = metallic(diffuse, specular);
        let back = DIELECTRIC * (1.0 - m) + m * color[0];
        assert!((back - 0.5).abs() < 0.1 && m > 0.3 && m < 1.0, "{color:?} {m} {back}");
    }

    /// Protects bytes: what is decoded and encoded again is the same.
    #[test]
    fn transfer_functions_are_inverse() {
        let linear = linear();
        assert!((0..=255u8).all(|i| encoded(linear[usize::from(i)]) == i));
    }
}
