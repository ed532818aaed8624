//! Cutouts as a file holds them: 8-bit images of the opacity's coefficients, and what
//! turns their numbers back. The renderer's `cutout.rs` is the formula.
//!
//! The coefficients o₀, o₁, … (one for each function of the [`Basis`]) are the channels c = 0, 1, …, packed as
//! those of a [`ParallaxMap`](crate::ParallaxMap) are.

use crate::parallax_fault::{Coefficients, ParallaxFault, check_images};
use crate::{Basis, Image};

/// From where a surface is not there: a part of a [`ParallaxMap`](crate::ParallaxMap),
/// whose wrap modes go for it too.
///
/// Contract: [`CutoutMap::check`] finds no fault.
#[derive(Clone, Debug, PartialEq)]
pub struct CutoutMap {
    /// The functions: harmonics, or [`Basis::TangentCutout`].
    pub basis: Basis,
    /// Indices into `Model::images`, as many as the basis says, all of one
    /// size, which need not be that of the parallax map's.
    pub images: Vec<usize>,
    /// What a channel's values span; finite, one for each channel.
    pub scale: Vec<f32>,
    /// A channel's value where 0 is stored; finite, one for each channel.
    pub offset: Vec<f32>,
}

impl CutoutMap {
    /// Whether basis, counts and numbers keep the contract.
    ///
    /// # Errors
    /// The first fault.
    pub fn check_numbers(&self) -> Result<(), ParallaxFault> {
        let Self { basis, images, scale, offset } = self;
        if *basis == Basis::TangentShift {
            return Err(ParallaxFault::Basis);
        }
        Coefficients { basis: *basis, images, scale, offset }.check_numbers(Basis::count)
    }

    /// Whether the cutout keeps its contract, given the model's images.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, images: &[Image]) -> Result<(), ParallaxFault> {
        self.check_numbers()?;
        check_images(&self.images, images, self.basis.layers(self.basis.count()))
    }
}
