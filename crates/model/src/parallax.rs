//! SH parallax maps as a file holds them: 8-bit images of coefficients, and what turns
//! their numbers back into shifts. `docs/parallax_format.md` is the format, the renderer's
//! `parallax.rs` the formula.
//!
//! Packing: the coefficients u₀, v₀, u₁, v₁, … (a pair for each function, in texture
//! widths, v down; function k = l² + l + m) are the channels c = 0, 1, 2, …; channel c is
//! component c mod 3 (R, G, B) of image ⌊c / 3⌋. Its value is
//! `offset[c] + scale[c] · stored / 255`. Components after the last channel are 0, alpha
//! says nothing: browsers multiply colours with it, and block compression is made for RGB.

use crate::{Image, TextureSlot, Wrap};
use std::fmt;

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
    /// Wrap modes along u and v of all images of the map.
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

    /// All images of the map itself: coefficients, then depth.
    pub fn data_images(&self) -> impl Iterator<Item = usize> {
        self.images.iter().copied().chain(self.depth.map(|d| d.image))
    }

    /// Whether order, counts and numbers keep the contract.
    ///
    /// # Errors
    /// The first fault.
    pub fn check_numbers(&self) -> Result<(), ParallaxFault> {
        if self.order > Self::HIGHEST_ORDER {
            return Err(ParallaxFault::Order(self.order));
        }
        let channels = Self::channel_count(self.order);
        let counts = [
            ("images of coefficients", self.images.len(), Self::image_count(self.order)),
            ("scales", self.scale.len(), channels),
            ("offsets", self.offset.len(), channels),
        ];
        if let Some(&(what, found, wanted)) = counts.iter().find(|(_, found, wanted)| found != wanted) {
            return Err(ParallaxFault::Count { what, found, wanted });
        }
        let depth = self.depth.iter().flat_map(|d| [d.scale, d.offset]);
        if !self.scale.iter().chain(&self.offset).copied().chain(depth).all(f32::is_finite) {
            return Err(ParallaxFault::NotFinite);
        }
        if !(self.limit > 0.0 && self.limit <= 1.0) {
            return Err(ParallaxFault::Limit(self.limit));
        }
        Ok(())
    }

    /// Whether the map keeps its contract, given the model's images.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, images: &[Image]) -> Result<(), ParallaxFault> {
        self.check_numbers()?;
        let own = [self.base_color_texture, self.normal_texture].into_iter().flatten().map(|s| s.image);
        if let Some(image) = self.data_images().chain(own).find(|&i| i >= images.len()) {
            return Err(ParallaxFault::MissingImage(image));
        }
        let size = |i: usize| [images[i].width, images[i].height];
        for image in self.data_images() {
            let ([width, height], texels) = (size(image), images[image].pixels.len());
            if texels == 0 || width.checked_mul(height) != Some(texels) {
                return Err(ParallaxFault::BrokenImage(image));
            }
        }
        let first = size(self.images[0]);
        match self.images.iter().map(|&i| size(i)).find(|&other| other != first) {
            Some(other) => Err(ParallaxFault::Sizes(first, other)),
            None => Ok(()),
        }
    }
}

/// How a map breaks its contract.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParallaxFault {
    /// The order is too high.
    Order(usize),
    /// There are too many or too few of something.
    Count {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many the order asks for.
        wanted: usize,
    },
    /// A scale or an offset is not a finite number.
    NotFinite,
    /// The limit is out of range.
    Limit(f32),
    /// The model does not have this image.
    MissingImage(usize),
    /// This image has no texels, or not as many as its size says.
    BrokenImage(usize),
    /// Two images of coefficients have different sizes: width and height of each.
    Sizes([usize; 2], [usize; 2]),
}

impl fmt::Display for ParallaxFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order(order) => {
                write!(f, "its order is {order}, and the highest is {}", ShParallaxMap::HIGHEST_ORDER)
            }
            Self::Count { what, found, wanted } => {
                write!(f, "it has {found} {what}, and its order asks for {wanted}")
            }
            Self::NotFinite => f.write_str("a scale or an offset is not finite"),
            Self::Limit(limit) => write!(f, "its limit is {limit}, and should be above 0 and at most 1"),
            Self::MissingImage(image) => write!(f, "image {image} is not there"),
            Self::BrokenImage(image) => write!(f, "image {image} does not have the texels of its size"),
            Self::Sizes([a, b], [c, d]) => {
                write!(f, "its images differ in size: {a} × {b} and {c} × {d} texels")
            }
        }
    }
}

impl std::error::Error for ParallaxFault {}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects readers, writers and renderers, who all rely on this check: every way to
    /// break a map is found.
    #[test]
    fn faults_are_found() {
        let images = [Image::solid("a", 4, 2, [0; 4]), Image::solid("b", 2, 4, [0; 4]), Image::default()];
        let depth = Some(DepthMap { image: 1, scale: 1.0, offset: 0.0 });
        let (scale, offset) = (vec![1.0; 8], vec![0.0; 8]);
        let good = ShParallaxMap { order: 1, images: vec![0; 3], scale, offset, depth, ..Default::default() };
        assert_eq!(good.check(&images), Ok(()));
        type Breakage = fn(&mut ShParallaxMap);
        let breakages: [(Breakage, &str); 11] = [
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
