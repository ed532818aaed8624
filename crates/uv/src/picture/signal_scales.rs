//! A picture as signals on its plane: at full size, half and a quarter, as a viewer sees it
//! from near and from far.

use super::plane::Plane;
use crate::signal::{Sample, Signal};
use parbake_model::Image;
use parbake_model::glam::Vec4;
use rayon::prelude::*;

/// A picture of four channels from 0 to 1, row 0 on top.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// width × height pixels.
    pub pixels: Vec<Vec4>,
}

impl Picture {
    /// The stored values of an image.
    pub fn new(image: &Image) -> Self {
        let pixels = image.pixels.par_iter().map(|p| Vec4::from_array(p.map(|x| f32::from(x) / 255.0)));
        Self { width: image.width, height: image.height, pixels: pixels.collect() }
    }

    /// Half as wide and high, odd sides rounded down, each pixel the mean of the area that it covers; sides
    /// of one pixel stay.
    pub fn halved(&self) -> Self {
        let (columns, rows) = (halving(self.width), halving(self.height));
        let (width, height) = (columns.len(), rows.len());
        let pixels = (0..width * height).into_par_iter().map(|i| {
            let ((x, across), (y, down)) = (columns[i % width], rows[i / width]);
            let row = |y: usize| {
                let own = &self.pixels[y * self.width..];
                (0..3).map(|k| across[k] * own[(x + k).min(self.width - 1)]).sum::<Vec4>()
            };
            (0..3).map(|k| down[k] * row((y + k).min(self.height - 1))).sum()
        });
        Self { width, height, pixels: pixels.collect() }
    }
}

/// For each pixel of half a side of so many: the first that it covers, and the weights of three from
/// there on. With an odd number each covers two and a bit.
fn halving(side: usize) -> Vec<(usize, [f32; 3])> {
    let half = (side / 2).max(1);
    let share = 1.0 / side as f32;
    let weights = |i: usize| match side % 2 {
        1 => [half - i, half, i + 1].map(|covered| covered as f32 * share),
        _ => [0.5, 0.5, 0.0],
    };
    (0..half).map(|i| (2 * i, if side == 1 { [1.0, 0.0, 0.0] } else { weights(i) })).collect()
}

/// Sizes at which a picture is shown, relative to its own: 1, ½, ¼.
const SIZES: usize = 3;

/// The picture at its three sizes, as samples of the plane; each scale's weights sum
/// to 1. Sizes with more than `most` samples are sampled at a lower resolution, but
/// minified as their own size says.
pub fn signal_scales(picture: &Picture, plane: Plane, most: usize) -> Vec<Signal> {
    let mut sizes = vec![picture.clone()];
    while sizes.len() < SIZES {
        let next = sizes[sizes.len() - 1].halved();
        sizes.push(next);
    }
    (0..SIZES)
        .map(|k| {
            let mut sampled = sizes[k].clone();
            while sampled.width * sampled.height > most {
                sampled = sampled.halved();
            }
            let mut signal = samples(&sampled, plane);
            signal.pixels = plane.pixels(sizes[k].width, sizes[k].height);
            signal
        })
        .collect()
}

/// One sample a pixel.
fn samples(picture: &Picture, plane: Plane) -> Signal {
    let (width, height) = (picture.width, picture.height);
    let weight = 1.0 / (width * height) as f32;
    let samples: Vec<(u32, Sample)> = (picture.pixels.par_iter().enumerate())
        .map(|(i, target)| {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            let (triangle, barycentric) = plane.locate(x / width as f64, y / height as f64);
            (triangle, Sample { target: *target, barycentric, weight })
        })
        .collect();
    Signal::new(2 * plane.cells * plane.cells, &samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects where things are in halves of pictures with odd sides: a ramp stays the same ramp, and
    /// the mean of all pixels stays.
    #[test]
    fn halves_of_odd_sides_show_the_same_places() {
        for (width, height) in [(7, 5), (8, 3), (1, 9), (2, 2), (1, 1)] {
            let ramp = |x: usize, y: usize| {
                Vec4::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32, 1.0, 0.25)
            };
            let pixels = (0..width * height).map(|i| ramp(i % width, i / width)).collect();
            let half = Picture { width, height, pixels }.halved();
            assert_eq!((half.width, half.height), ((width / 2).max(1), (height / 2).max(1)));
            for (i, pixel) in half.pixels.iter().enumerate() {
                let [x, y] = [(i % half.width, half.width), (i / half.width, half.height)]
                    .map(|(at, of)| (at as f32 + 0.5) / of as f32);
                // Pixels that two share are split evenly, which moves a mean by less than a tenth of a pixel.
                let off = (*pixel - Vec4::new(x, y, 1.0, 0.25)).abs();
                assert!(off.x < 0.1 / half.width as f32 && off.y < 0.1 / half.height as f32, "{pixel}");
                assert!(off.z.max(off.w) < 1e-6);
            }
        }
    }
}
