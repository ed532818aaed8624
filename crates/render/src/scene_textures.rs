//! A scene's materials, ready to be fetched from: every image unpacked once for each
//! meaning and wrap mode that it is used with, and parallax maps and cutouts with their
//! coefficients.
//!
//! Contract: one interpretation goes for all of them; parallax maps that it leaves out, or
//! that break their contract, are not there.

use crate::cutout::ShCutout;
use crate::display::{decode_srgb, encode_srgb};
use crate::interpolate::interpolate;
use crate::interpretation::Interpretation;
use crate::parallax::{ShParallax, Sight};
use crate::texture::{Level, Pyramid};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Image, Material, Mesh, TextureSlot, Wrap};
use rayon::prelude::*;

/// One use of a texture, with what moves its coordinates.
pub(crate) struct Map {
    slot: TextureSlot,
    /// Index into the scene's pyramids.
    pub pyramid: usize,
    moved: bool,
}

impl Map {
    /// The texture coordinates at three vertices.
    pub fn uvs(&self, mesh: &Mesh, corners: [usize; 3]) -> [Vec2; 3] {
        let set = if self.slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
        let uvs = corners.map(|i| set.get(i).copied().unwrap_or_default());
        if self.moved { uvs.map(|uv| self.slot.transform.apply(uv)) } else { uvs }
    }
}

/// The textures of a look.
pub(crate) struct Textures {
    pub color: Option<Map>,
    pub normal: Option<Map>,
}

/// A look whose coordinates shift, by what, and what is left out of it.
pub(crate) struct Shifted {
    pub textures: Textures,
    pub parallax: ShParallax,
    pub cutout: Option<ShCutout>,
}

impl Shifted {
    /// Where the maps are fetched at a point of a triangle: at the base colour's coordinate,
    /// or at the normal's where there is no colour.
    fn anchor(&self, mesh: &Mesh, corners: [usize; 3], weights: [f32; 3]) -> Option<Vec2> {
        let Textures { color, normal } = &self.textures;
        let map = color.as_ref().or(normal.as_ref())?;
        Some(interpolate(map.uvs(mesh, corners), weights))
    }

    /// How far coordinates move at a point of a triangle, seen from there.
    pub fn at(&self, mesh: &Mesh, corners: [usize; 3], weights: [f32; 3], sight: &Sight) -> Vec2 {
        self.anchor(mesh, corners, weights).map_or(Vec2::ZERO, |uv| self.parallax.shift(uv, sight))
    }

    /// Whether a point of a triangle is there, seen along this direction to the viewer.
    pub fn is_opaque(&self, mesh: &Mesh, corners: [usize; 3], weights: [f32; 3], direction: Vec3) -> bool {
        let Some(cutout) = &self.cutout else { return true };
        self.anchor(mesh, corners, weights).is_none_or(|uv| cutout.opacity(uv, direction) >= 0.0)
    }
}

/// One material.
pub(crate) struct Surface {
    pub factor: Vec3,
    pub normal_scale: f32,
    /// As viewers see it that know no parallax.
    pub plain: Textures,
    /// As all others do.
    pub shifted: Option<Shifted>,
}

/// An image's RGB as numbers, each channel through `decode`.
fn unpack(image: &Image, decode: impl Fn(f32) -> f32) -> Level<3> {
    let table: Vec<f32> = (0..=255u32).map(|i| decode(i as f32 / 255.0)).collect();
    let texels = image.pixels.par_iter().map(|p| [0, 1, 2].map(|k| table[p[k] as usize])).collect();
    Level { width: image.width, height: image.height, texels }
}

/// Base colour texels as shading sees them.
pub fn unpack_color(image: &Image, decode: bool) -> Level<3> {
    unpack(image, |x| if decode { decode_srgb(x) } else { x })
}

/// Tangent-space normals, not normalised.
pub fn unpack_normal(image: &Image) -> Level<3> {
    unpack(image, |x| 2.0 * x - 1.0)
}

/// Makes surfaces, and keeps the pyramids that they fetch from.
pub(crate) struct Builder<'a> {
    images: &'a [Image],
    interpretation: Interpretation,
    pub pyramids: Vec<Pyramid<3>>,
    /// Image, whether it is a colour, and wrap modes of each pyramid.
    built: Vec<(usize, bool, [Wrap; 2])>,
}

impl<'a> Builder<'a> {
    pub fn new(images: &'a [Image], interpretation: Interpretation) -> Self {
        Self { images, interpretation, pyramids: Vec::new(), built: Vec::new() }
    }

    pub fn surface(&mut self, material: &Material) -> Surface {
        let linear = Vec4::from(material.base_color).truncate();
        let plain = [material.base_color_texture, material.normal_texture];
        Surface {
            factor: if self.interpretation.decode_srgb {
                linear
            } else {
                Vec3::from(linear.to_array().map(encode_srgb))
            },
            // The strength is the material's normal texture's; others have none of their own.
            normal_scale: material.normal_texture.map_or(1.0, |_| material.normal_scale),
            plain: self.textures(plain),
            shifted: self.shifted(material, plain),
        }
    }

    fn shifted(&mut self, material: &Material, plain: [Option<TextureSlot>; 2]) -> Option<Shifted> {
        let map = material.parallax.as_ref().filter(|_| self.interpretation.parallax)?;
        let parallax = ShParallax::unpack(map, self.images)?;
        let cutout = map.cutout.as_ref().and_then(|c| ShCutout::unpack(c, map.wrap, self.images));
        let own = [map.base_color_texture, map.normal_texture];
        let textures = self.textures([own[0].or(plain[0]), own[1].or(plain[1])]);
        Some(Shifted { textures, parallax, cutout })
    }

    fn textures(&mut self, [color, normal]: [Option<TextureSlot>; 2]) -> Textures {
        Textures { color: self.map(color, true), normal: self.map(normal, false) }
    }

    fn map(&mut self, slot: Option<TextureSlot>, is_color: bool) -> Option<Map> {
        let slot = slot?;
        let image = self.images.get(slot.image)?;
        let key = (slot.image, is_color, slot.wrap);
        let pyramid = self.built.iter().position(|b| *b == key).unwrap_or_else(|| {
            let base = match is_color {
                true => unpack_color(image, self.interpretation.decode_srgb),
                false => unpack_normal(image),
            };
            let mut pyramid = match self.interpretation.trilinear {
                true => Pyramid::from_base(base),
                false => Pyramid::single(base),
            };
            pyramid.wrap = slot.wrap;
            self.pyramids.push(pyramid);
            self.built.push(key);
            self.pyramids.len() - 1
        });
        Some(Map { slot, pyramid, moved: slot.transform != Default::default() })
    }
}
