//! SH cutouts as a file holds them: 8-bit images of the opacity's coefficients, and what
//! turns their numbers back. `docs/parallax_format.md` is the format, the renderer's
//! `cutout.rs` the formula.
//!
//! Packing: the coefficients o₀, o₁, … (one for each function k = l² + l + m) are the
//! channels c = 0, 1, …; channel c is component c mod 3 (R, G, B) of image ⌊c / 3⌋. Its
//! value is `offset[c] + scale[c] · stored / 255`. Components after the last channel are 0.

use crate::Image;
use crate::parallax_fault::{Coefficients, ParallaxFault, check_images};

/// From where a surface is not there: a part of a [`ShParallaxMap`](crate::ShParallaxMap),
/// whose wrap modes go for it too.
///
/// Contract: [`CutoutMap::check`] finds no fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutoutMap {
    /// Highest order of the functions, 0 to 7.
    pub order: usize,
    /// Indices into `Model::images`, as many as [`CutoutMap::image_count`] says, all of one
    /// size, which need not be that of the parallax map's.
    pub images: Vec<usize>,
    /// What a channel's values span; finite, one for each channel.
    pub scale: Vec<f32>,
    /// A channel's value where 0 is stored; finite, one for each channel.
    pub offset: Vec<f32>,
}

impl CutoutMap {
    /// Channels of a cutout of this order: one for each of (order + 1)² functions.
    pub const fn channel_count(order: usize) -> usize {
        (order + 1) * (order + 1)
    }

    /// Images of a cutout of this order: three channels each.
    pub const fn image_count(order: usize) -> usize {
        Self::channel_count(order).div_ceil(3)
    }

    /// Whether order, counts and numbers keep the contract.
    ///
    /// # Errors
    /// The first fault.
    pub fn check_numbers(&self) -> Result<(), ParallaxFault> {
        let Self { order, images, scale, offset } = self;
        Coefficients { order: *order, images, scale, offset }.check_numbers(Self::channel_count)
    }

    /// Whether the cutout keeps its contract, given the model's images.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, images: &[Image]) -> Result<(), ParallaxFault> {
        self.check_numbers()?;
        check_images(&self.images, images)
    }
}
