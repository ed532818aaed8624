//! A picture as signals on its plane: at full size, half and a quarter, as a viewer sees it
//! from near and from far.

use super::plane::Plane;
use parbake_model::Image;
use parbake_model::glam::Vec4;
use parbake_uv::signal::{Sample, Signal};
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

    /// Half as wide and high, each pixel the mean of four; sides of one pixel stay.
    pub fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let at =
            |x: usize, y: usize| self.pixels[y.min(self.height - 1) * self.width + x.min(self.width - 1)];
        let pixels = (0..width * height).into_par_iter().map(|i| {
            let (x, y) = (2 * (i % width), 2 * (i / width));
            0.25 * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1))
        });
        Self { width, height, pixels: pixels.collect() }
    }
}

/// Sizes at which a picture is shown, relative to its own: 1, ½, ¼.
const SIZES: usize = 3;

/// The picture at its three sizes, as samples of the plane; each showing's weights sum
/// to 1. Sizes with more than `most` samples are sampled at a lower resolution, but
/// minified as their own size says.
pub fn showings(picture: &Picture, plane: Plane, most: usize) -> Vec<Signal> {
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
