//! Weights of morph targets: what several nodes do, as one track of all targets.
//!
//! Tracks of the same times are put side by side. Tracks of different times are sampled at the union of these, which is
//! exact for straight lines and for steps; for splines, or where interpolations differ, `RATE` times a second as well.

use parbake_model::{Interpolation, Property, Track};
use std::sync::Arc;

/// Samples a second where no key times are enough.
const RATE: f32 = 30.0;
/// Samples that this may come to.
pub(super) const MOST_SAMPLES: usize = 20_000;

/// What some of the targets do.
pub(super) struct WeightTrack {
    /// Targets of the merged mesh, one for each number of a value.
    pub targets: Vec<usize>,
    pub interpolation: Interpolation,
    pub times: Arc<Vec<f32>>,
    pub values: Arc<Vec<f32>>,
}

/// One track of all; `rest` are the weights of what no track has. Also whether it does the same to the letter.
pub(super) fn together(tracks: Vec<WeightTrack>, rest: &[f32]) -> Option<(Track, bool)> {
    let first = tracks.first()?;
    let is_same = |t: &WeightTrack| t.times == first.times && t.interpolation == first.interpolation;
    if tracks.iter().all(is_same) {
        return Some((side_by_side(&tracks, rest), true));
    }
    let is_exact = tracks.iter().all(|t| t.interpolation == first.interpolation)
        && first.interpolation != Interpolation::CubicSpline;
    let mut times: Vec<f32> = tracks.iter().flat_map(|t| t.times.iter().copied()).collect();
    let end = times.iter().copied().fold(0.0, f32::max);
    if !is_exact {
        let samples = ((end * RATE).ceil() as usize).min(MOST_SAMPLES);
        times.extend((0..samples).map(|k| end * k as f32 / samples as f32));
    }
    times.sort_by(f32::total_cmp);
    times.dedup();
    let mut values = Vec::with_capacity(times.len() * rest.len());
    for &time in &times {
        let mut row = rest.to_vec();
        for track in &tracks {
            for (k, &target) in track.targets.iter().enumerate() {
                if let Some(value) = row.get_mut(target) {
                    *value = track.at(time, k);
                }
            }
        }
        values.extend(row);
    }
    let interpolation = if is_exact { first.interpolation } else { Interpolation::Linear };
    let (times, values) = (Arc::new(times), Arc::new(values));
    Some((Track { property: Property::MorphWeights, interpolation, times, values }, is_exact))
}

/// Tracks of the same times and interpolation.
fn side_by_side(tracks: &[WeightTrack], rest: &[f32]) -> Track {
    let WeightTrack { interpolation, times, .. } = &tracks[0];
    let parts = if *interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let mut values = Vec::with_capacity(parts * times.len() * rest.len());
    for row in 0..parts * times.len() {
        let is_tangent = parts == 3 && row % 3 != 1;
        let mut all = if is_tangent { vec![0.0; rest.len()] } else { rest.to_vec() };
        for track in tracks {
            let width = track.targets.len();
            for (k, &target) in track.targets.iter().enumerate() {
                if let (Some(to), Some(&from)) = (all.get_mut(target), track.values.get(row * width + k)) {
                    *to = from;
                }
            }
        }
        values.extend(all);
    }
    let (interpolation, times) = (*interpolation, times.clone());
    Track { property: Property::MorphWeights, interpolation, times, values: Arc::new(values) }
}

impl WeightTrack {
    /// The k-th number of the value at a time.
    fn at(&self, time: f32, k: usize) -> f32 {
        let (width, last) = (self.targets.len(), self.times.len() - 1);
        let parts = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let number = |key: usize, part: usize| {
            self.values.get((key * parts + part) * width + k).copied().unwrap_or_default()
        };
        let value = |key: usize| number(key, if parts == 3 { 1 } else { 0 });
        let next = self.times.partition_point(|&t| t <= time);
        if next == 0 {
            return value(0);
        }
        if next > last {
            return value(last);
        }
        let span = self.times[next] - self.times[next - 1];
        let s = (time - self.times[next - 1]) / span;
        let (from, to) = (value(next - 1), value(next));
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear => from + (to - from) * s,
            Interpolation::CubicSpline => {
                let (out, into) = (span * number(next - 1, 2), span * number(next, 0));
                let (s2, s3) = (s * s, s * s * s);
                (2.0 * s3 - 3.0 * s2 + 1.0) * from
                    + (s3 - 2.0 * s2 + s) * out
                    + (3.0 * s2 - 2.0 * s3) * to
                    + (s3 - s2) * into
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(targets: &[usize], interpolation: Interpolation, times: &[f32], values: &[f32]) -> WeightTrack {
        let (times, values) = (Arc::new(times.to_vec()), Arc::new(values.to_vec()));
        WeightTrack { targets: targets.to_vec(), interpolation, times, values }
    }

    /// Protects faces of several meshes: each keeps its own weights at its own times, and what nothing animates rests.
    #[test]
    fn tracks_of_nodes_become_one() {
        let linear = Interpolation::Linear;
        let a = track(&[0], linear, &[0.0, 2.0], &[0.0, 1.0]);
        let b = track(&[2], linear, &[1.0, 2.0], &[0.5, 0.0]);
        let (both, is_exact) = together(vec![a, b], &[0.0, 0.25, 0.0]).unwrap();
        assert!(is_exact);
        assert_eq!(*both.times, [0.0, 1.0, 2.0]);
        assert_eq!(*both.values, [0.0, 0.25, 0.5, 0.5, 0.25, 0.5, 1.0, 0.25, 0.0]);
        let spline = track(&[1], Interpolation::CubicSpline, &[0.5], &[7.0, 0.5, 8.0]);
        let (one, is_exact) = together(vec![spline], &[0.25, 0.0]).unwrap();
        assert!(is_exact);
        assert_eq!(*one.values, [0.0, 7.0, 0.25, 0.5, 0.0, 8.0]);
        let step = track(&[0], Interpolation::Step, &[0.0, 1.0], &[1.0, 0.0]);
        let line = track(&[1], linear, &[0.0, 1.0], &[0.0, 1.0]);
        let (mixed, is_exact) = together(vec![step, line], &[0.0, 0.0]).unwrap();
        assert!(!is_exact && mixed.times.len() == 31);
        assert!(together(Vec::new(), &[]).is_none());
    }
}
