//! SH parallax maps as a file holds them: 8-bit images of coefficients, and what turns
//! their numbers back into shifts. `docs/parallax_format.md` is the format, the renderer's
//! `parallax.rs` the formula.
//!
//! Packing: the coefficients u₀, v₀, u₁, v₁, … (a pair for each function, in texture
//! widths, v down; function k = l² + l + m) are the channels c = 0, 1, 2, …; channel c is
//! component c mod 3 (R, G, B) of image ⌊c / 3⌋. Its value is
//! `offset[c] + scale[c] · stored / 255`. Components after the last channel are 0, alpha
//! says nothing: browsers multiply colours with it, and block compression is made for RGB.

use crate::parallax_fault::{Coefficients, ParallaxFault, check_images};
use crate::{CutoutMap, Image, TextureSlot, Wrap};

/// A material's parallax map.
///
/// Contract: [`ShParallaxMap::check`] finds no fault.
#[derive(Clone, Debug, PartialEq)]
pub struct ShParallaxMap {
    /// Highest order of the functions, 0 to [`ShParallaxMap::HIGHEST_ORDER`].
    pub order: usize,
    /// Indices into `Model::images`, as many as [`ShParallaxMap::image_count`] says, all
    /// of one size.
    pub images: Vec<usize>,
    /// What a channel's values span, in texture widths; finite, one for each channel.
    pub scale: Vec<f32>,
    /// A channel's value where 0 is stored, in texture widths; finite, one for each channel.
    pub offset: Vec<f32>,
    /// The least |n·d| that a shift is divided by, above 0 and at most 1.
    pub limit: f32,
    /// Multiplies the shift; 1 everywhere where there is none.
    pub depth: Option<DepthMap>,
    /// Where the surface is left out; nowhere where there is none.
    pub cutout: Option<CutoutMap>,
    /// Wrap modes along u and v of all images of the map, the cutout's too.
    pub wrap: [Wrap; 2],
    /// Base colour to be fetched at the shifted coordinate, instead of the material's own,
    /// which is then for viewers that know no parallax.
    pub base_color_texture: Option<TextureSlot>,
    /// Normals to be fetched at the shifted coordinate, instead of the material's own. The
    /// material's `normal_scale` goes for them too, if the material has a normal texture.
    pub normal_texture: Option<TextureSlot>,
}

/// An image whose red channel is a depth: `offset + scale · stored / 255`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthMap {
    /// Index into `Model::images`; of any size.
    pub image: usize,
    /// What the values span; finite.
    pub scale: f32,
    /// The value where 0 is stored; finite.
    pub offset: f32,
}

impl Default for ShParallaxMap {
    /// Order 0 with limit 0.25, clamped; without images, so not yet a sound map.
    fn default() -> Self {
        Self {
            order: 0,
            images: Vec::new(),
            scale: Vec::new(),
            offset: Vec::new(),
            limit: 0.25,
            depth: None,
            cutout: None,
            wrap: [Wrap::Clamp; 2],
            base_color_texture: None,
            normal_texture: None,
        }
    }
}

impl ShParallaxMap {
    /// The highest order there is.
    pub const HIGHEST_ORDER: usize = 7;

    /// Channels of a map of this order: a pair for each of (order + 1)² functions.
    pub const fn channel_count(order: usize) -> usize {
        2 * (order + 1) * (order + 1)
    }

    /// Images of a map of this order: three channels each.
    pub const fn image_count(order: usize) -> usize {
        Self::channel_count(order).div_ceil(3)
    }

    /// All images of the map itself: coefficients, depth, the cutout's.
    pub fn data_images(&self) -> impl Iterator<Item = usize> {
        let cutout = self.cutout.iter().flat_map(|c| &c.images);
        self.images.iter().copied().chain(self.depth.map(|d| d.image)).chain(cutout.copied())
    }

    /// Whether order, counts and numbers keep the contract, the cutout's too.
    ///
    /// # Errors
    /// The first fault.
    pub fn check_numbers(&self) -> Result<(), ParallaxFault> {
        let Self { order, images, scale, offset, .. } = self;
        Coefficients { order: *order, images, scale, offset }.check_numbers(Self::channel_count)?;
        if !self.depth.iter().flat_map(|d| [d.scale, d.offset]).all(f32::is_finite) {
            return Err(ParallaxFault::NotFinite);
        }
        if !(self.limit > 0.0 && self.limit <= 1.0) {
            return Err(ParallaxFault::Limit(self.limit));
        }
        self.cutout.as_ref().map_or(Ok(()), CutoutMap::check_numbers).map_err(in_cutout)
    }

    /// Whether the map keeps its contract, given the model's images.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, images: &[Image]) -> Result<(), ParallaxFault> {
        self.check_numbers()?;
        check_images(&self.images, images)?;
        if let Some(depth) = &self.depth {
            check_images(&[depth.image], images)?;
        }
        let own = [self.base_color_texture, self.normal_texture].into_iter().flatten().map(|s| s.image);
        if let Some(image) = own.into_iter().find(|&i| i >= images.len()) {
            return Err(ParallaxFault::MissingImage(image));
        }
        self.cutout.as_ref().map_or(Ok(()), |cutout| cutout.check(images)).map_err(in_cutout)
    }
}

fn in_cutout(fault: ParallaxFault) -> ParallaxFault {
    ParallaxFault::Cutout(Box::new(fault))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(map: &mut ShParallaxMap) -> &mut CutoutMap {
        map.cutout.as_mut().unwrap()
    }

    /// Protects readers, writers and renderers, who all rely on this check: every way to
    /// break a map is found.
    #[test]
    fn faults_are_found() {
        let images = [Image::solid("a", 4, 2, [0; 4]), Image::solid("b", 2, 4, [0; 4]), Image::default()];
        let depth = Some(DepthMap { image: 1, scale: 1.0, offset: 0.0 });
        let (scale, offset) = (vec![1.0; 8], vec![0.0; 8]);
        let cutout =
            Some(CutoutMap { order: 1, images: vec![1; 2], scale: vec![0.0; 4], offset: vec![2.0; 4] });
        let (order, images_of_map) = (1, vec![0; 3]);
        let good = ShParallaxMap {
            order,
            images: images_of_map,
            scale,
            offset,
            depth,
            cutout,
            ..Default::default()
        };
        assert_eq!(good.check(&images), Ok(()));
        type Breakage = fn(&mut ShParallaxMap);
        let breakages: [(Breakage, &str); 17] = [
            (|m| m.order = 8, "its order is 8"),
            (|m| m.order = usize::MAX, "its order is"),
            (|m| m.order = 2, "3 images of coefficients, and its order asks for 6"),
            (|m| m.scale.truncate(7), "7 scales"),
            (|m| m.offset.push(0.0), "9 offsets"),
            (|m| m.offset[3] = f32::NAN, "not finite"),
            (|m| m.limit = 0.0, "its limit is 0"),
            (|m| m.limit = f32::NAN, "its limit is NaN"),
            (|m| m.images[1] = 3, "image 3 is not there"),
            (|m| m.images[2] = 1, "4 × 2 and 2 × 4"),
            (|m| m.depth.iter_mut().for_each(|d| d.image = 2), "image 2 does not have"),
            (|m| cut(m).order = 8, "its cutout is broken: its order is 8"),
            (|m| cut(m).images.truncate(1), "its cutout is broken: it has 1 images"),
            (|m| cut(m).scale.push(1.0), "its cutout is broken: it has 5 scales"),
            (|m| cut(m).offset[3] = f32::INFINITY, "its cutout is broken: a scale or"),
            (|m| cut(m).images[0] = 9, "its cutout is broken: image 9 is not there"),
            (|m| cut(m).images[0] = 0, "its cutout is broken: its images differ in size"),
        ];
        for (breakage, expected) in breakages {
            let mut map = good.clone();
            breakage(&mut map);
            let fault = map.check(&images).unwrap_err().to_string();
            assert!(fault.contains(expected), "{expected}: {fault}");
        }
        assert!(ShParallaxMap::default().check(&images).is_err());
    }
}
