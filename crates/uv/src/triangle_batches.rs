//! Triangles cut into runs, for work that is shared among threads.
//!
//! A run's triangles lie near each other in the texture at the start, so that what a
//! run adds to the texture fits into a small rectangle of its own; rectangles are added
//! up in the order of the runs, whatever the number of threads.

use crate::signal::Signal;
use glam::DVec2;
use rayon::prelude::*;

/// Runs of triangles of about the same number of samples.
#[derive(Clone, Debug, Default)]
pub struct TriangleBatches {
    /// All F triangles, each once.
    pub order: Vec<u32>,
    /// Where each run begins in `order`, and the end.
    pub first: Vec<usize>,
    /// Each run's points.
    own: Vec<OwnPoints>,
}

/// The points of a run's triangles.
#[derive(Clone, Debug, Default)]
pub struct OwnPoints {
    /// Each once, ascending.
    pub points: Vec<u32>,
    /// For each triangle the places of its corners in `points`.
    pub corners: Vec<[u32; 3]>,
}

impl OwnPoints {
    fn new(triangles: impl Iterator<Item = [u32; 3]> + Clone) -> Self {
        let mut points: Vec<u32> = triangles.clone().flatten().collect();
        points.sort_unstable();
        points.dedup();
        let place = |i: u32| points.partition_point(|own| *own < i) as u32;
        let corners = triangles.map(|corners| corners.map(place)).collect();
        Self { points, corners }
    }
}

/// Runs a texture is cut into: enough for many cores, few enough that their rectangles
/// overlap little.
const RUNS: usize = 32;

/// How much larger rectangles, and the memory they take, may be in the triangles' own order than along
/// the curve: samples lie in that order, and to read them as they lie takes a fifth less time.
const OWN_ORDER: f64 = 2.5;

impl TriangleBatches {
    /// Sorts triangles along a Morton curve through their centres, unless their own order is as good.
    pub fn new(points: &[DVec2], triangles: &[[u32; 3]], signal: &Signal) -> Self {
        let mut keyed: Vec<(u32, u32)> = triangles
            .par_iter()
            .enumerate()
            .map(|(t, corners)| {
                let centre = corners.iter().map(|&i| points[i as usize]).sum::<DVec2>() / 3.0;
                (morton(centre), t as u32)
            })
            .collect();
        keyed.par_sort_unstable();
        let along_curve = Self::cut(keyed.into_iter().map(|(_, t)| t).collect(), signal);
        let own = Self::cut((0..triangles.len() as u32).collect(), signal);
        let rectangles = |runs: &Self| runs.rectangles(points, triangles);
        let mut runs =
            if rectangles(&own) <= OWN_ORDER * rectangles(&along_curve) { own } else { along_curve };
        let own = |run: usize| OwnPoints::new(runs.order_of(run).iter().map(|&t| triangles[t as usize]));
        runs.own = (0..runs.count()).into_par_iter().map(own).collect();
        runs
    }

    /// Cuts this order into runs of about as many samples.
    fn cut(order: Vec<u32>, signal: &Signal) -> Self {
        let share = signal.samples.len().div_ceil(RUNS).max(1);
        let (mut first, mut sum) = (vec![0], 0);
        for (place, &t) in order.iter().enumerate() {
            sum += signal.of(t as usize).len();
            if sum >= share {
                first.push(place + 1);
                sum = 0;
            }
        }
        if first.last() != Some(&order.len()) {
            first.push(order.len());
        }
        Self { order, first, own: Vec::new() }
    }

    /// Area of all runs' rectangles together.
    fn rectangles(&self, points: &[DVec2], triangles: &[[u32; 3]]) -> f64 {
        let area = |run: usize| {
            let corners = self.triangles(run).flat_map(|t| triangles[t]).map(|i| points[i as usize]);
            let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            let (low, high) = corners.fold(none, |(low, high), p| (low.min(p), high.max(p)));
            (high - low).max(DVec2::ZERO).element_product()
        };
        (0..self.count()).map(area).sum()
    }

    /// How many runs there are.
    pub fn count(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The triangles of a run.
    pub fn triangles(&self, run: usize) -> impl Iterator<Item = usize> + '_ {
        self.order_of(run).iter().map(|&t| t as usize)
    }

    /// The points of a run's triangles.
    pub fn own_points(&self, run: usize) -> &OwnPoints {
        &self.own[run]
    }

    fn order_of(&self, run: usize) -> &[u32] {
        &self.order[self.first[run]..self.first[run + 1]]
    }
}

/// Interleaved bits of a point of the unit square.
fn morton(p: DVec2) -> u32 {
    let spread = |x: f64| {
        let mut bits = (x.clamp(0.0, 1.0) * 1023.0) as u32;
        bits = (bits | (bits << 8)) & 0x00ff_00ff;
        bits = (bits | (bits << 4)) & 0x0f0f_0f0f;
        bits = (bits | (bits << 2)) & 0x3333_3333;
        (bits | (bits << 1)) & 0x5555_5555
    };
    spread(p.x) | (spread(p.y) << 1)
}
