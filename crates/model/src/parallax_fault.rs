//! How a parallax map, or the cutout in it, breaks its contract; and the checks that both
//! have in common, for both keep the channels of some functions in images of 8 bits.

use crate::{Image, ShParallaxMap};
use std::fmt;

/// How a map breaks its contract.
#[derive(Clone, Debug, PartialEq)]
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
    /// This is wrong with its cutout.
    Cutout(Box<ParallaxFault>),
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
            Self::Cutout(fault) => write!(f, "its cutout is broken: {fault}"),
        }
    }
}

impl std::error::Error for ParallaxFault {}

/// Coefficients as a file holds them.
pub(crate) struct Coefficients<'a> {
    pub order: usize,
    pub images: &'a [usize],
    pub scale: &'a [f32],
    pub offset: &'a [f32],
}

impl Coefficients<'_> {
    /// Whether order, counts and numbers are sound; `channels` of an order, three an image.
    pub fn check_numbers(&self, channels: fn(usize) -> usize) -> Result<(), ParallaxFault> {
        if self.order > ShParallaxMap::HIGHEST_ORDER {
            return Err(ParallaxFault::Order(self.order));
        }
        let channels = channels(self.order);
        let counts = [
            ("images of coefficients", self.images.len(), channels.div_ceil(3)),
            ("scales", self.scale.len(), channels),
            ("offsets", self.offset.len(), channels),
        ];
        if let Some(&(what, found, wanted)) = counts.iter().find(|(_, found, wanted)| found != wanted) {
            return Err(ParallaxFault::Count { what, found, wanted });
        }
        match self.scale.iter().chain(self.offset).all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(ParallaxFault::NotFinite),
        }
    }
}

/// Whether the images of these indices are there, whole, and all of one size.
pub(crate) fn check_images(indices: &[usize], images: &[Image]) -> Result<(), ParallaxFault> {
    let mut first = None;
    for &index in indices {
        let image = images.get(index).ok_or(ParallaxFault::MissingImage(index))?;
        let ([width, height], texels) = ([image.width, image.height], image.pixels.len());
        if texels == 0 || width.checked_mul(height) != Some(texels) {
            return Err(ParallaxFault::BrokenImage(index));
        }
        let first = *first.get_or_insert([width, height]);
        if first != [width, height] {
            return Err(ParallaxFault::Sizes(first, [width, height]));
        }
    }
    Ok(())
}
