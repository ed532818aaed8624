//! The extension's JSON, version 2: read and checked. A map that breaks a rule is left out as a whole.

use bevy::math::{Affine2, Vec2};
use serde_json::Value;
use std::fmt::{Display, Formatter};

/// The name of the extension.
pub const NAME: &str = "PARBAKE_materials_parallax";
const VERSION: u64 = 2;

/// Layers of the images.
pub(crate) const SHIFT_LAYERS: u32 = 2;
pub(crate) const CUTOUT_LAYERS: u32 = 3;

/// What a map has where the file has no fade: more than any pixel spans.
const NO_FADE: f32 = 1e30;

/// A map as its JSON says.
#[derive(Clone, Debug, PartialEq)]
pub struct ParallaxJson {
    /// Index of the texture with the shift's coefficients.
    pub texture: usize,
    /// Ranges of its channels.
    pub scale: [f32; 8],
    /// Values of its channels where 0 is stored.
    pub offset: [f32; 8],
    /// The least cosine that a shift is divided by.
    pub limit: f32,
    /// The footprint of a pixel at which the maps begin to fade.
    pub fade_footprint: f32,
    /// The cutout's texture, scales and offsets.
    pub cutout: Option<(usize, [f32; 12], [f32; 12])>,
    /// A texture instead of the material's.
    pub base_color_texture: Option<OwnTexture>,
    /// A texture instead of the material's.
    pub normal_texture: Option<OwnTexture>,
}

/// A texture of the extension's own, and where it is fetched.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnTexture {
    /// Index of the texture.
    pub index: usize,
    /// The set of coordinates.
    pub tex_coord: u64,
    /// What is done to the coordinates.
    pub transform: Affine2,
}

/// Why a map is left out.
#[derive(Clone, Debug, PartialEq)]
pub enum ParallaxFault {
    /// Another version than 2.
    Version(Value),
    /// `texture.index` is missing, or no index.
    Texture,
    /// `scale` or `offset` is not this many finite numbers.
    Numbers(usize),
    /// `limit` is not above 0 and at most 1.
    Limit,
    /// `fadeFootprint` is not above 0.
    Fade,
}

impl Display for ParallaxFault {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Version(version) => write!(f, "its version is {version}, and this reads version {VERSION}"),
            Self::Texture => write!(f, "a texture of it is missing"),
            Self::Numbers(count) => write!(f, "it has not {count} scales and offsets"),
            Self::Limit => write!(f, "its limit is not above 0 and at most 1"),
            Self::Fade => write!(f, "the footprint where it fades is not above 0"),
        }
    }
}

impl std::error::Error for ParallaxFault {}

fn index(info: Option<&Value>) -> Option<usize> {
    info?.get("index")?.as_u64().and_then(|index| usize::try_from(index).ok())
}

fn own_texture(info: Option<&Value>) -> Option<OwnTexture> {
    let index = index(info)?;
    let transform = info?.pointer("/extensions/KHR_texture_transform");
    let pair = |key: &str, otherwise: f32| {
        let at =
            |i: usize| transform.and_then(|t| t.get(key)?.get(i)?.as_f64()).map_or(otherwise, |x| x as f32);
        Vec2::new(at(0), at(1))
    };
    let angle = transform.and_then(|t| t.get("rotation")?.as_f64()).unwrap_or_default() as f32;
    let tex_coord = |json: Option<&Value>| json?.get("texCoord")?.as_u64();
    Some(OwnTexture {
        index,
        tex_coord: tex_coord(transform).or(tex_coord(info)).unwrap_or(0),
        transform: Affine2::from_scale_angle_translation(pair("scale", 1.0), -angle, pair("offset", 0.0)),
    })
}

fn numbers<const N: usize>(list: Option<&Value>) -> Result<[f32; N], ParallaxFault> {
    let read = |value: &Value| value.as_f64().map(|x| x as f32).filter(|x| x.is_finite());
    let list: Option<Vec<f32>> =
        list.and_then(Value::as_array).and_then(|list| list.iter().map(read).collect());
    list.and_then(|list| list.try_into().ok()).ok_or(ParallaxFault::Numbers(N))
}

impl ParallaxJson {
    /// Reads the value of the extension in a material.
    pub fn read(json: &Value) -> Result<Self, ParallaxFault> {
        let version = json.get("version").unwrap_or(&Value::Null);
        if version.as_f64() != Some(VERSION as f64) {
            return Err(ParallaxFault::Version(version.clone()));
        }
        let or = |key: &str, otherwise: f32| {
            json.get(key).map_or(Some(otherwise), |x| x.as_f64().map(|x| x as f32))
        };
        let cutout = match json.get("cutout") {
            Some(part) => Some((
                index(part.get("texture")).ok_or(ParallaxFault::Texture)?,
                numbers(part.get("scale"))?,
                numbers(part.get("offset"))?,
            )),
            None => None,
        };
        Ok(Self {
            texture: index(json.get("texture")).ok_or(ParallaxFault::Texture)?,
            scale: numbers(json.get("scale"))?,
            offset: numbers(json.get("offset"))?,
            limit: or("limit", 0.25).filter(|&x| x > 0.0 && x <= 1.0).ok_or(ParallaxFault::Limit)?,
            fade_footprint: or("fadeFootprint", NO_FADE).filter(|&x| x > 0.0).ok_or(ParallaxFault::Fade)?,
            cutout,
            base_color_texture: own_texture(json.get("baseColorTexture")),
            normal_texture: own_texture(json.get("normalTexture")),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn example() -> Value {
        json!({
            "version": 2, "texture": { "index": 2 }, "scale": [1, 2, 3, 4, 5, 6, 7, 8], "offset": [0, 0, 0, 0, 0, 0, 0, 1],
            "cutout": { "texture": { "index": 3 }, "scale": vec![1.0; 12], "offset": vec![0.5; 12] },
        })
    }

    /// Protects readers of files that leave out what has a default.
    #[test]
    fn defaults_are_those_of_the_format() {
        let map = ParallaxJson::read(&example()).unwrap();
        assert_eq!((map.texture, map.limit, map.scale[7], map.offset[7]), (2, 0.25, 8.0, 1.0));
        assert_eq!(map.fade_footprint, NO_FADE);
        assert_eq!(map.cutout, Some((3, [1.0; 12], [0.5; 12])));
    }

    /// Protects files whose own textures lie elsewhere than the material's.
    #[test]
    fn own_textures_have_their_own_coordinates() {
        let mut json = example();
        json["normalTexture"] = json!({ "index": 5 });
        json["baseColorTexture"] = json!({ "index": 4, "texCoord": 1, "extensions": {
            "KHR_texture_transform": { "scale": [2, 4], "offset": [0.5, 0.25] },
        } });
        let map = ParallaxJson::read(&json).unwrap();
        let (color, normal) = (map.base_color_texture.unwrap(), map.normal_texture.unwrap());
        assert_eq!((color.index, color.tex_coord), (4, 1));
        assert_eq!(color.transform.transform_point2(Vec2::new(0.25, 0.5)), Vec2::new(1.0, 2.25));
        assert_eq!(normal, OwnTexture { index: 5, tex_coord: 0, transform: Affine2::IDENTITY });
    }

    /// Protects viewers from maps that they would show wrong.
    #[test]
    fn maps_that_break_a_rule_are_left_out() {
        let cases = [
            ("/version", json!(1), ParallaxFault::Version(json!(1))),
            ("/texture/index", json!(-1), ParallaxFault::Texture),
            ("/cutout/texture", json!({}), ParallaxFault::Texture),
            ("/scale", json!([1, 2]), ParallaxFault::Numbers(8)),
            ("/cutout/offset/3", json!("x"), ParallaxFault::Numbers(12)),
        ];
        for (place, value, fault) in cases {
            let mut json = example();
            *json.pointer_mut(place).unwrap() = value;
            assert_eq!(ParallaxJson::read(&json), Err(fault), "{place}");
        }
        for (key, value, fault) in [
            ("limit", 0.0, ParallaxFault::Limit),
            ("limit", 1.5, ParallaxFault::Limit),
            ("fadeFootprint", 0.0, ParallaxFault::Fade),
        ] {
            let mut json = example();
            json[key] = json!(value);
            assert_eq!(ParallaxJson::read(&json), Err(fault), "{key}");
        }
    }
}
