//! The pyramids that a scene fetches from: every image unpacked once for each meaning and wrap mode that it is used with.
//!
//! Contract: one interpretation goes for all of them.

use crate::interpretation::Interpretation;
use parbake_image::pyramid::Pyramid;
use parbake_image::quantise::decoded;
use parbake_image::{Encoding, FloatImage, MapKind};
use parbake_model::glam::Vec2;
use parbake_model::{Image, Mesh, TextureSlot, UvTransform, Wrap};
use rayon::prelude::*;

/// One use of a texture, with what moves its coordinates.
#[derive(Clone)]
pub(crate) struct Map {
    slot: TextureSlot,
    /// Index into the scene's pyramids.
    pub pyramid: usize,
    moved: bool,
    /// Maps with the same number have the same UV set and transform, as most maps of a material do.
    pub coordinates: usize,
}

impl Map {
    /// The texture coordinates at three vertices.
    pub fn uvs(&self, mesh: &Mesh, corners: [usize; 3]) -> [Vec2; 3] {
        let set = if self.slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
        let uvs = corners.map(|i| set.get(i).copied().unwrap_or_default());
        if self.moved { uvs.map(|uv| self.slot.transform.apply(uv)) } else { uvs }
    }
}

/// An image's RGB as the values of a map; `srgb` tells whether colours are decoded.
pub fn unpack(kind: MapKind, image: &Image, srgb: bool) -> FloatImage<[f32; 3]> {
    let table = decoded(kind, srgb);
    let texels = image.pixels.par_iter().map(|p| [0, 1, 2].map(|k| table[p[k] as usize])).collect();
    FloatImage { width: image.width, height: image.height, texels }
}

/// An image's alpha, three times.
fn opacity(image: &Image) -> FloatImage<[f32; 3]> {
    let texels = image.pixels.par_iter().map(|p| [f32::from(p[3]) / 255.0; 3]).collect();
    FloatImage { width: image.width, height: image.height, texels }
}

/// What an image is read for.
#[derive(Clone, Copy)]
pub(crate) enum Use {
    Map(MapKind),
    Opacity,
}

/// Makes pyramids, and keeps them.
pub(crate) struct Pyramids<'a> {
    pub images: &'a [Image],
    pub interpretation: Interpretation,
    pub all: Vec<Pyramid<3>>,
    /// Image, encoding (none of opacity) and wrap modes of each pyramid.
    built: Vec<(usize, Option<Encoding>, [Wrap; 2])>,
    /// UV set and transform that each number of [`Map::coordinates`] stands for.
    coordinates: Vec<(u8, UvTransform)>,
}

impl<'a> Pyramids<'a> {
    pub fn new(images: &'a [Image], interpretation: Interpretation) -> Self {
        Self { images, interpretation, all: Vec::new(), built: Vec::new(), coordinates: Vec::new() }
    }

    /// The use of a texture for a map.
    pub fn map(&mut self, kind: MapKind, slot: Option<TextureSlot>) -> Option<Map> {
        self.pyramid(slot, Use::Map(kind))
    }

    /// The use of a texture.
    pub fn pyramid(&mut self, slot: Option<TextureSlot>, purpose: Use) -> Option<Map> {
        let slot = slot?;
        let image = self.images.get(slot.image)?;
        let encoding = match purpose {
            Use::Map(kind) => Some(kind.spec().encoding),
            Use::Opacity => None,
        };
        let key = (slot.image, encoding, slot.wrap);
        let pyramid = self.built.iter().position(|b| *b == key).unwrap_or_else(|| {
            let base = match purpose {
                Use::Map(kind) => unpack(kind, image, self.interpretation.decode_srgb),
                Use::Opacity => opacity(image),
            };
            let mut pyramid = match self.interpretation.trilinear {
                true => Pyramid::from_base(base),
                false => Pyramid::single(base),
            };
            pyramid.wrap = slot.wrap;
            self.all.push(pyramid);
            self.built.push(key);
            self.all.len() - 1
        });
        let read_at = (slot.uv_set, slot.transform);
        let coordinates = self.coordinates.iter().position(|c| *c == read_at).unwrap_or_else(|| {
            self.coordinates.push(read_at);
            self.coordinates.len() - 1
        });
        Some(Map { slot, pyramid, moved: slot.transform != Default::default(), coordinates })
    }
}
