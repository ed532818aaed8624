//! The pool of training views: well spread, the same for the same seed, and in an
//! order whose every prefix is well spread too, so that a run that must end early
//! has seen all sides.
//!
//! A Fibonacci lattice (Swinbank and Purser 2006) walked with a stride close to
//! the golden section of its length; the seed turns it about +Y. Each view shifts
//! its pixel grid by its own fraction of a pixel, so that the samples of many
//! small views fall between one another like those of one large view.

use parbake_model::glam::Vec3;
use parbake_render::camera::{Camera, Projection, fibonacci_sphere};
use parbake_solve::random::unit_interval;

/// Where the cameras of a pool stand. Lengths in the common frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// Distance from the origin, > √3 to stay outside of the model.
    pub radius: f32,
    /// Field of view, or width of an orthographic view.
    pub projection: Projection,
}

/// One training view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Shift of the sample grid in pixels, each within ±0.5.
    pub jitter: [f32; 2],
}

/// A stride coprime to `count`, near its golden section.
fn stride(count: usize) -> usize {
    let coprime = |a: usize| {
        let (mut a, mut b) = (a, count);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a == 1
    };
    let golden = (count as f64 * 0.618_033_988_75) as usize;
    (golden.max(1)..golden.max(1) + count).find(|&s| coprime(s)).unwrap_or(1)
}

/// `count` views around the model.
pub fn view_pool(count: usize, rig: &Rig, seed: u64) -> Vec<View> {
    // Half a radian off, so that the default lattice is not an evaluation's.
    let turn = 0.5 + unit_interval(seed) * std::f64::consts::TAU;
    let directions: Vec<Vec3> = fibonacci_sphere(count, turn);
    let stride = stride(count);
    (0..count)
        .map(|i| {
            let jitter =
                [0, 1].map(|k| unit_interval(seed ^ (0x5EED << 32) ^ (2 * i as u64 + k)) as f32 - 0.5);
            let direction = directions[i * stride % count];
            View { camera: Camera::towards_origin(direction, rig.radius, rig.projection), jitter }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };

    /// Protects runs that are cut short: the first dozen views see all sides.
    #[test]
    fn every_prefix_is_spread() {
        for count in [24, 64, 192] {
            let pool = view_pool(count, &RIG, 7);
            for prefix in [12, 24] {
                let mean: Vec3 = pool[..prefix].iter().map(|v| v.camera.back).sum::<Vec3>() / prefix as f32;
                assert!(mean.length() < 0.25, "{count} {prefix} {mean}");
            }
        }
    }

    /// Protects reproducibility, and that the stride visits every direction once.
    #[test]
    fn a_pool_is_a_permutation_and_repeats() {
        let pool = view_pool(60, &RIG, 3);
        assert_eq!(pool, view_pool(60, &RIG, 3));
        let mut heights: Vec<i64> = pool.iter().map(|v| (v.camera.back.y * 1e6) as i64).collect();
        heights.sort_unstable();
        heights.dedup();
        assert_eq!(heights.len(), 60);
    }
}
