//! The signal on a surface: what its texture shall show, as samples whose places on
//! their triangles stay while texture coordinates move.
//!
//! A picture on a plane, a model's own texture and a detailed model projected on a
//! coarse one are all such signals; everything in this crate works on them alone.

use glam::{DMat2, Vec4};

/// One sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The colour wanted, as the texture stores it, in up to four channels.
    pub target: Vec4,
    /// Barycentric weights of the triangle's second and third point.
    pub barycentric: [f32; 2],
    /// How much it counts, ≥ 0.
    pub weight: f32,
}

/// Samples sorted by triangle.
///
/// Contract: `first` ascends from 0 to the number of samples; all numbers are finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signal {
    /// F + 1 entries: triangle `t` has the samples `first[t]..first[t + 1]`.
    pub first: Vec<u32>,
    /// S samples.
    pub samples: Vec<Sample>,
    /// What a pixel is on each triangle, which decides on mip levels.
    pub pixels: Pixels,
}

/// What a pixel is on triangles: how the barycentric weights of the second and the third point
/// (rows) change from one pixel to the next along x and y (columns).
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Pixels {
    /// Without a size, for what never minifies.
    #[default]
    Sizeless,
    /// One kind on even triangles, another on odd ones, as on a plane of cells, where F entries would
    /// be a third of all that a pass over the samples reads.
    ByTurns([DMat2; 2]),
    /// F entries.
    Each(Vec<DMat2>),
}

impl Pixels {
    /// That of a triangle, if it has a size.
    #[inline]
    pub fn of(&self, triangle: usize) -> Option<&DMat2> {
        match self {
            Self::Sizeless => None,
            Self::ByTurns(pair) => Some(&pair[triangle % 2]),
            Self::Each(all) => all.get(triangle),
        }
    }
}

impl Signal {
    /// Sorts samples by their triangles, of which there are `triangles`; those of one
    /// triangle keep their order.
    pub fn new(triangles: usize, samples: &[(u32, Sample)]) -> Self {
        let mut first = vec![0u32; triangles + 1];
        for (triangle, _) in samples {
            first[*triangle as usize + 1] += 1;
        }
        for t in 0..triangles {
            first[t + 1] += first[t];
        }
        let mut next = first.clone();
        let mut sorted = vec![Sample::default(); samples.len()];
        for (triangle, sample) in samples {
            let place = &mut next[*triangle as usize];
            sorted[*place as usize] = *sample;
            *place += 1;
        }
        Self { first, samples: sorted, pixels: Pixels::Sizeless }
    }

    /// The samples of a triangle.
    #[inline]
    pub fn of(&self, triangle: usize) -> &[Sample] {
        &self.samples[self.first[triangle] as usize..self.first[triangle + 1] as usize]
    }

    /// Sum of all weights.
    pub fn weight(&self) -> f64 {
        self.samples.iter().map(|s| f64::from(s.weight)).sum()
    }
}
