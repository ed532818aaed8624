//! Channels of numbers to and from images of 8 bits a channel, packed as a [`Basis`] says: three an image, or
//! four in each layer of one image. What parallax maps and cutouts are kept in.
//!
//! Forward (pack): `stored = round(255 (value − offset) / scale)`. A channel spans its least
//! to its greatest value; one that has a single value has scale 0 and stores 0. Back
//! (unpack): `value = offset + scale · stored / 255`.
//!
//! Contract: the rounding error is at most half a step, scale / 510, up to the precision of
//! floats. Values are finite, and so is their span; where they are not, the checks of the
//! maps refuse what comes of them.

use parbake_model::{Basis, Image};

/// What the stored numbers of a channel stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    /// The value where 0 is stored.
    pub offset: f32,
    /// What the values span.
    pub scale: f32,
}

impl Span {
    /// From the least to the greatest value.
    pub fn of(values: impl Iterator<Item = f32>) -> Self {
        let (low, high) =
            values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        // A channel of one value, or of none.
        Self { offset: low, scale: if low >= high { 0.0 } else { high - low } }
    }

    /// The same, a little wider, so that `kept`, which lies within, is one of the numbers that
    /// can be stored: exactly where it is 0, otherwise to the precision of floats.
    pub fn keeping(self, kept: f32) -> Self {
        let below = 255.0 * ((kept - self.offset) / self.scale);
        // At an end there is nothing to do, nor where the span is none.
        if !(below > 0.0 && below < 255.0) {
            return self;
        }
        // The longer side has the steps that it had, or nearly; the shorter one some to spare.
        let (stored, widening) = match below < 127.5 {
            true => (below.ceil(), (255.0 - below) / (255.0 - below.ceil())),
            false => (below.floor(), below / below.floor()),
        };
        let scale = self.scale * widening;
        Self { offset: kept - scale * (stored / 255.0), scale }
    }

    fn stored(self, value: f32) -> u8 {
        // The cast saturates, and makes NaN 0.
        if self.scale > 0.0 { (255.0 * ((value - self.offset) / self.scale)).round() as u8 } else { 0 }
    }

    /// What each stored number stands for.
    pub fn values(self) -> [f32; 256] {
        std::array::from_fn(|stored| self.offset + self.scale * (stored as f32 / 255.0))
    }
}

/// Adds the images of these channels, all of one size, to `images` and returns their places.
/// `value` is asked with a texel and a channel, `name` with the number of an image.
pub(crate) fn pack(
    basis: Basis,
    spans: &[Span],
    [width, height]: [usize; 2],
    name: impl Fn(usize) -> String,
    images: &mut Vec<Image>,
    value: impl Fn(usize, usize) -> f32,
) -> Vec<usize> {
    let (first, side_by_side) = (images.len(), basis.channels_of_image());
    let layers = spans.chunks(side_by_side).enumerate().map(|(layer, of_layer)| {
        let texel = |texel: usize| {
            let mut pixel = [0, 0, 0, 255];
            for (k, span) in of_layer.iter().enumerate() {
                pixel[k] = span.stored(value(texel, side_by_side * layer + k));
            }
            pixel
        };
        (0..width * height).map(texel).collect::<Vec<_>>()
    });
    let mut image = |pixels: Vec<[u8; 4]>| {
        let name = name(images.len() - first);
        images.push(Image { name, width, height: pixels.len() / width.max(1), pixels });
    };
    match basis.is_tangent() {
        true => image(layers.flatten().collect()),
        false => layers.for_each(image),
    }
    (first..images.len()).collect()
}

/// Hands over all values of the channels in these images, which hold them as the basis says: texel, channel,
/// value. `texels` is the number of those of a channel.
pub(crate) fn unpack<'a>(
    basis: Basis,
    texels: usize,
    spans: impl Iterator<Item = Span>,
    image: impl Fn(usize) -> &'a Image,
    mut each: impl FnMut(usize, usize, f32),
) {
    for (channel, span) in spans.enumerate() {
        let values = span.values();
        let (place, component) = (channel / basis.channels_of_image(), channel % basis.channels_of_image());
        let (number, first) = if basis.is_tangent() { (0, place * texels) } else { (place, 0) };
        for (texel, pixel) in image(number).pixels[first..first + texels].iter().enumerate() {
            each(texel, channel, values[pixel[component] as usize]);
        }
    }
}

/// Scales and offsets, as a file lists them.
pub(crate) fn listed(spans: &[Span]) -> [Vec<f32>; 2] {
    [spans.iter().map(|s| s.scale).collect(), spans.iter().map(|s| s.offset).collect()]
}

/// Back from those lists.
pub(crate) fn spans<'a>(scale: &'a [f32], offset: &'a [f32]) -> impl Iterator<Item = Span> + 'a {
    scale.iter().zip(offset).map(|(&scale, &offset)| Span { offset, scale })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects what must not change by rounding, wherever in the span it lies, and the rest
    /// from growing much coarser for its sake.
    #[test]
    fn a_kept_value_is_stored_exactly() {
        for low in [-1e-6, -0.004, -0.01, -0.3, -1.0, -1.7, -250.0, -1e6_f32] {
            for high in [1e-5, 0.003, 1.0, 1.9, 640.0_f32] {
                let span = Span::of([low, 0.0, high].into_iter());
                let kept = span.keeping(0.0);
                assert_eq!(kept.values()[kept.stored(0.0) as usize], 0.0, "{low} {high}");
                assert!(kept.scale >= span.scale && kept.scale <= 1.009 * span.scale, "{low} {high}");
                for value in [low, high] {
                    let error = (kept.values()[kept.stored(value) as usize] - value).abs();
                    assert!(error <= 0.501 * kept.scale / 255.0, "{low} {high}: {error}");
                }
            }
        }
        for ends in [[0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]] {
            let span = Span::of(ends.into_iter());
            assert_eq!(span.keeping(0.0), span);
            assert_eq!(span.values()[span.stored(0.0) as usize], 0.0);
        }
    }
}
