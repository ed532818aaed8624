//! How a parallax map, or the cutout in it, breaks its contract; and the checks that both
//! have in common, for both keep the channels of some functions in images of 8 bits.

use crate::{Basis, Image};
use std::fmt;

/// How a map breaks its contract.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParallaxFault {
    /// The functions are those of another kind of map, or the cutout's go by another frame.
    Basis,
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
    /// The footprint at which the map begins to fade is out of range.
    Fade(f32),
    /// The model does not have this image.
    MissingImage(usize),
    /// This image has no texels, or not as many as its size says.
    BrokenImage(usize),
    /// Two images of coefficients have different sizes: width and height of each.
    Sizes([usize; 2], [usize; 2]),
    /// An image's height, in texels, that is not a multiple of its number of layers.
    Layers(usize, usize),
    /// This is wrong with its cutout.
    Cutout(Box<ParallaxFault>),
}

impl fmt::Display for ParallaxFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Basis => {
                f.write_str("its functions are not those of a shift, or not in its cutout's frame")
            }
            Self::Order(order) => {
                write!(f, "its order is {order}, and the highest is {}", Basis::HIGHEST_ORDER)
            }
            Self::Count { what, found, wanted } => {
                write!(f, "it has {found} {what}, and its functions ask for {wanted}")
            }
            Self::NotFinite => f.write_str("a scale or an offset is not finite"),
            Self::Limit(limit) => write!(f, "its limit is {limit}, and should be above 0 and at most 1"),
            Self::Fade(fade) => write!(f, "its fade begins at {fade}, and should begin above 0"),
            Self::Layers(height, layers) => {
                write!(
                    f,
                    "its image of {layers} layers has a height of {height} texels, which they do not share evenly"
                )
            }
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
    pub basis: Basis,
    pub images: &'a [usize],
    pub scale: &'a [f32],
    pub offset: &'a [f32],
}

impl Coefficients<'_> {
    /// Whether counts and numbers are sound; `channels` of a basis.
    pub fn check_numbers(&self, channels: fn(Basis) -> usize) -> Result<(), ParallaxFault> {
        if let Basis::Harmonics(order @ 8..) = self.basis {
            return Err(ParallaxFault::Order(order));
        }
        let channels = channels(self.basis);
        let counts = [
            ("images of coefficients", self.images.len(), self.basis.image_count(channels)),
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

/// Whether the images of these indices are there, whole, all of one size, and hold so many layers.
pub(crate) fn check_images(indices: &[usize], images: &[Image], layers: usize) -> Result<(), ParallaxFault> {
    let mut first = None;
    for &index in indices {
        let image = images.get(index).ok_or(ParallaxFault::MissingImage(index))?;
        let ([width, height], texels) = ([image.width, image.height], image.pixels.len());
        if texels == 0 || width.checked_mul(height) != Some(texels) {
            return Err(ParallaxFault::BrokenImage(index));
        }
        if height % layers != 0 {
            return Err(ParallaxFault::Layers(height, layers));
        }
        let first = *first.get_or_insert([width, height]);
        if first != [width, height] {
            return Err(ParallaxFault::Sizes(first, [width, height]));
        }
    }
    Ok(())
}
