//! What one pixel of a training view says of the low-poly's material: where it falls on the low-poly's texture,
//! and which values the high-poly's maps have in its place, packed into 40 bytes.
//!
//! Contract: values are as in [`MapValues`], colours as sRGB; a weight of 0 leaves a pixel out.

use crate::samples::{Fetched, place};
use parbake_image::display::encode_srgb;
use parbake_image::{MapKind, MapValues};
use parbake_model::glam::{Vec2, Vec3, Vec4};

/// One pixel of a training view: 40 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct MaterialSample {
    texel: u32,
    /// Fractions towards the right and lower texels, in 65536ths.
    fraction: [u16; 2],
    /// How much this sample counts, in 65535ths; 0 where only its opacity is known.
    weight: u16,
    /// The same for its opacity.
    opacity_weight: u16,
    /// sRGB of the base colour, and opacity, in 65535ths.
    base_color: [u16; 4],
    /// Occlusion, roughness and metallic, in 65535ths.
    occlusion_roughness_metallic: [u16; 3],
    /// sRGB of the emission, in 65535ths.
    emissive: [u16; 3],
    /// The normal in the low-poly's tangent frame, in 32767ths.
    normal: [i16; 3],
}

fn unit(x: f32) -> u16 {
    (x.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16
}

impl MaterialSample {
    /// A pixel at this coordinate of a texture of `size`² texels that shall have these values; colours
    /// are linear, the normal is in the tangent frame. `weights` are those of its maps and of its
    /// opacity, 0 … 1.
    pub fn new(uv: Vec2, size: usize, values: &MapValues, weights: [f32; 2]) -> Self {
        let (texel, fraction) = place(uv, size);
        let color = values[MapKind::BaseColor];
        let encoded = |v: Vec4| v.truncate().to_array().map(|x| unit(encode_srgb(x.clamp(0.0, 1.0))));
        let [r, g, b] = encoded(color);
        let [_, roughness, metallic, _] = values[MapKind::MetallicRoughness].to_array();
        let signed = |x: f32| (x.clamp(-1.0, 1.0) * 32767.0).round_ties_even() as i16;
        Self {
            texel,
            fraction,
            weight: unit(weights[0]),
            opacity_weight: unit(weights[1]),
            base_color: [r, g, b, unit(color.w)],
            occlusion_roughness_metallic: [values[MapKind::Occlusion].x, roughness, metallic].map(unit),
            emissive: encoded(values[MapKind::Emissive]),
            normal: values[MapKind::Normal].truncate().to_array().map(signed),
        }
    }

    /// What a map shall be here: sRGB values of colours and emission, opacity in the base colour's fourth
    /// lane, all else as in [`MapValues`].
    #[inline]
    pub fn target(&self, kind: MapKind) -> Vec4 {
        let unit = |x: u16| f32::from(x) * (1.0 / 65535.0);
        let [occlusion, roughness, metallic] = self.occlusion_roughness_metallic.map(unit);
        match kind {
            MapKind::BaseColor => Vec4::from(self.base_color.map(unit)),
            MapKind::Emissive => Vec3::from(self.emissive.map(unit)).extend(0.0),
            MapKind::Normal => Vec3::from(self.normal.map(|x| f32::from(x) * (1.0 / 32767.0))).extend(0.0),
            MapKind::MetallicRoughness => Vec4::new(0.0, roughness, metallic, 0.0),
            MapKind::Occlusion => Vec4::new(occlusion, 0.0, 0.0, 0.0),
        }
    }

    /// Asks for another roughness, 0 … 1.
    #[inline]
    pub fn set_roughness(&mut self, roughness: f32) {
        self.occlusion_roughness_metallic[1] = unit(roughness);
    }

    /// How much its opacity counts, 0 … 1.
    #[inline]
    pub fn opacity_weight(&self) -> f32 {
        f32::from(self.opacity_weight) * (1.0 / 65535.0)
    }
}

impl Fetched for MaterialSample {
    #[inline]
    fn texel(&self) -> usize {
        self.texel as usize
    }

    #[inline]
    fn fractions(&self) -> [f32; 2] {
        self.fraction.map(|f| f32::from(f) * (1.0 / 65536.0))
    }

    #[inline]
    fn weight(&self) -> f32 {
        f32::from(self.weight) * (1.0 / 65535.0)
    }
}
