//! Parallax maps as a file holds them: 8-bit images of coefficients, and what turns
//! their numbers back into shifts. `docs/parallax_format.md` is the format of maps in the tangent frame,
//! `docs/parallax_sh_format.md` that of spherical harmonics, the renderer's `parallax.rs` the formula.
//!
//! The coefficients u₀, v₀, u₁, v₁, … (a pair for each function of the [`Basis`], in texture widths, v down)
//! are the channels c = 0, 1, 2, …, with the value `offset[c] + scale[c] · stored / 255`.
//! Packing of harmonics: channel c is component c mod 3 (R, G, B) of image ⌊c / 3⌋; components after the last
//! channel are 0, and alpha says nothing. In the tangent frame there is one image, whose layers are one below
//! the other: channel c is component c mod 4 (R, G, B, A) of layer ⌊c / 4⌋.

use crate::parallax_fault::{Coefficients, ParallaxFault, check_images};
use crate::{Basis, CutoutMap, Image, TextureSlot, Wrap};

/// A material's parallax map.
///
/// Contract: [`ParallaxMap::check`] finds no fault.
#[derive(Clone, Debug, PartialEq)]
pub struct ParallaxMap {
    /// The functions: harmonics, or [`Basis::TangentShift`].
    pub basis: Basis,
    /// Indices into `Model::images`, as many as the basis says, all of one size.
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
    /// Wrap modes along u and v of all images of the map, the cutout's too. Maps in the tangent frame are
    /// clamped.
    pub wrap: [Wrap; 2],
    /// From which footprint of a pixel on the texture the map begins to fade, in texture widths; at twice that
    /// nothing is left of it. Above 0; infinite for maps that never fade, as harmonics do not.
    pub fade: f32,
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

impl Default for ParallaxMap {
    /// Harmonics of order 0 with limit 0.25, clamped; without images, so not yet a sound map.
    fn default() -> Self {
        Self {
            basis: Basis::Harmonics(0),
            images: Vec::new(),
            scale: Vec::new(),
            offset: Vec::new(),
            limit: 0.25,
            depth: None,
            cutout: None,
            wrap: [Wrap::Clamp; 2],
            fade: f32::INFINITY,
            base_color_texture: None,
            normal_texture: None,
        }
    }
}

impl ParallaxMap {
    /// Channels of a map: a pair for each function.
    pub const fn channel_count(basis: Basis) -> usize {
        2 * basis.count()
    }

    /// All images of the map itself: coefficients, depth, the cutout's.
    pub fn data_images(&self) -> impl Iterator<Item = usize> {
        let cutout = self.cutout.iter().flat_map(|c| &c.images);
        self.images.iter().copied().chain(self.depth.map(|d| d.image)).chain(cutout.copied())
    }

    /// Whether basis, counts and numbers keep the contract, the cutout's too.
    ///
    /// # Errors
    /// The first fault.
    pub fn check_numbers(&self) -> Result<(), ParallaxFault> {
        let Self { basis, images, scale, offset, .. } = self;
        Coefficients { basis: *basis, images, scale, offset }.check_numbers(Self::channel_count)?;
        let is_other = |cutout: &CutoutMap| cutout.basis.is_tangent() != basis.is_tangent();
        if *basis == Basis::TangentCutout || self.cutout.as_ref().is_some_and(is_other) {
            return Err(ParallaxFault::Basis);
        }
        if !self.depth.iter().flat_map(|d| [d.scale, d.offset]).all(f32::is_finite) {
            return Err(ParallaxFault::NotFinite);
        }
        if !(self.limit > 0.0 && self.limit <= 1.0) {
            return Err(ParallaxFault::Limit(self.limit));
        }
        if self.fade.is_nan() || self.fade <= 0.0 {
            return Err(ParallaxFault::Fade(self.fade));
        }
        self.cutout.as_ref().map_or(Ok(()), CutoutMap::check_numbers).map_err(in_cutout)
    }

    /// Whether the map keeps its contract, given the model's images.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, images: &[Image]) -> Result<(), ParallaxFault> {
        self.check_numbers()?;
        check_images(&self.images, images, self.basis.layers(Self::channel_count(self.basis)))?;
        if let Some(depth) = &self.depth {
            check_images(&[depth.image], images, 1)?;
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

    fn cut(map: &mut ParallaxMap) -> &mut CutoutMap {
        map.cutout.as_mut().unwrap()
    }

    /// Protects readers, writers and renderers, who all rely on this check: every way to
    /// break a map is found.
    #[test]
    fn faults_are_found() {
        let images = [Image::solid("a", 4, 2, [0; 4]), Image::solid("b", 2, 4, [0; 4]), Image::default()];
        let depth = Some(DepthMap { image: 1, scale: 1.0, offset: 0.0 });
        let (scale, offset) = (vec![1.0; 8], vec![0.0; 8]);
        let cutout = Some(CutoutMap {
            basis: Basis::Harmonics(1),
            images: vec![1; 2],
            scale: vec![0.0; 4],
            offset: vec![2.0; 4],
        });
        let (basis, images_of_map) = (Basis::Harmonics(1), vec![0; 3]);
        let good =
            ParallaxMap { basis, images: images_of_map, scale, offset, depth, cutout, ..Default::default() };
        assert_eq!(good.check(&images), Ok(()));
        type Breakage = fn(&mut ParallaxMap);
        let breakages: [(Breakage, &str); 20] = [
            (|m| cut(m).basis = Basis::TangentCutout, "its functions are not those"),
            (|m| m.fade = 0.0, "its fade begins at 0"),
            (|m| m.fade = f32::NAN, "its fade begins at NaN"),
            (|m| m.basis = Basis::Harmonics(8), "its order is 8"),
            (|m| m.basis = Basis::Harmonics(usize::MAX), "its order is"),
            (|m| m.basis = Basis::Harmonics(2), "3 images of coefficients, and its functions ask for 6"),
            (|m| m.scale.truncate(7), "7 scales"),
            (|m| m.offset.push(0.0), "9 offsets"),
            (|m| m.offset[3] = f32::NAN, "not finite"),
            (|m| m.limit = 0.0, "its limit is 0"),
            (|m| m.limit = f32::NAN, "its limit is NaN"),
            (|m| m.images[1] = 3, "image 3 is not there"),
            (|m| m.images[2] = 1, "4 × 2 and 2 × 4"),
            (|m| m.depth.iter_mut().for_each(|d| d.image = 2), "image 2 does not have"),
            (|m| cut(m).basis = Basis::Harmonics(8), "its cutout is broken: its order is 8"),
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
        assert!(ParallaxMap::default().check(&images).is_err());
    }
}
