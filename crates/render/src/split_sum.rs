//! What a rough surface reflects of even light: the second factor of the split sum (Karis, Real Shading in
//! Unreal Engine 4, SIGGRAPH 2013), as glTF's viewers tabulate it.
//!
//! For a surface with GGX's distribution D, Smith's height-correlated visibility V and Schlick's Fresnel term F,
//! `∫ D V F (n·l) dl = F₀ a + b` with `a = ∫ D V (1 − (1 − v·h)⁵) (n·l) dl` and `b = ∫ D V (1 − v·h)⁵ (n·l) dl`,
//! which depend on n·v and on roughness alone. Half vectors are drawn by D at the points of a Hammersley set.
//!
//! Contract: a table of [`NODES`]² nodes, made once for the process, the same on each run; between nodes bilinear.

use crate::real::Real;
use std::f32::consts::PI;
use std::sync::OnceLock;

/// Smoother surfaces are shaded as if they had this roughness, so that small lamps do not flicker (three.js).
pub const LEAST_ROUGHNESS: f32 = 0.0525;
/// The least cosine to the viewer.
pub(crate) const LEAST_COSINE: f32 = 1e-4;
/// Nodes along each side.
const NODES: usize = 32;
/// Half vectors for a node.
const SAMPLES: u32 = 512;

/// `[a, b]` at cosines (fast) and roughnesses of i / (NODES − 1).
static TABLE: OnceLock<Vec<[f32; 2]>> = OnceLock::new();

fn table() -> &'static [[f32; 2]] {
    TABLE.get_or_init(|| {
        let along = |i: usize| i as f32 / (NODES - 1) as f32;
        (0..NODES * NODES).map(|i| integral(along(i % NODES), along(i / NODES))).collect()
    })
}

/// Both integrals at a cosine n·v and a roughness, 0 to 1.
fn integral(cosine: f32, roughness: f32) -> [f32; 2] {
    let (cosine, alpha) = (cosine.max(1e-3), roughness.max(0.02).powi(2));
    let square = alpha * alpha;
    let viewer = [(1.0 - cosine * cosine).max(0.0).sqrt(), cosine];
    let mut sums = [0.0f64; 2];
    for i in 0..SAMPLES {
        let azimuth = 2.0 * PI * (i as f32 + 0.5) / SAMPLES as f32;
        // The bits of i in reverse, as a fraction.
        let share = i.reverse_bits() as f32 / 4_294_967_296.0;
        let up = ((1.0 - share) / (1.0 + (square - 1.0) * share)).sqrt();
        let half = [(1.0 - up * up).max(0.0).sqrt() * azimuth.cos(), up];
        let vh = viewer[0] * half[0] + viewer[1] * half[1];
        let nl = 2.0 * vh * half[1] - viewer[1];
        if nl <= 0.0 || vh <= 0.0 {
            continue;
        }
        let masked = |a: f32, b: f32| a * (b * b * (1.0 - square) + square).sqrt();
        let visibility = 0.5 / (masked(nl, cosine) + masked(cosine, nl));
        // D (n·h) / (4 v·h) is the density of l.
        let weight = visibility * nl * 4.0 * vh / half[1];
        let grazing = (1.0 - vh).powi(5);
        sums[0] += f64::from((1.0 - grazing) * weight);
        sums[1] += f64::from(grazing * weight);
    }
    sums.map(|sum| (sum / f64::from(SAMPLES)) as f32)
}

/// Schlick's power.
pub(crate) fn fifth<T: Real>(x: T) -> T {
    let square = x * x;
    square * square * x
}

/// `[a, b]` at a cosine n·v and a roughness, both within 0 to 1.
pub(crate) fn scale_and_bias<T: Real>(cosine: T, roughness: T) -> [T; 2] {
    let table = table();
    let place = |x: T| {
        let x = x.at_least(0.0).at_most(1.0) * (NODES - 1) as f32;
        let node = (x.value() as usize).min(NODES - 2);
        (node, x + -(node as f32))
    };
    let ((column, right), (row, down)) = (place(cosine), place(roughness));
    std::array::from_fn(|k| {
        let at = |c: usize, r: usize| T::constant(table[(row + r) * NODES + column + c][k]);
        at(0, 0).mix(at(1, 0), right).mix(at(0, 1).mix(at(1, 1), right), down)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects metal's brightness: a smooth mirror reflects all light, a rough one loses the light that one
    /// bounce loses, and nothing reflects more than it gets. Looked at from above, α = 1 leaves
    /// `∫ n·l / (1 + n·l) d(n·l) = 1 − ln 2` and Schlick's part next to nothing.
    #[test]
    fn white_mirrors_reflect_what_they_should() {
        for cosine in [0.2f32, 0.5, 0.9] {
            let [a, b] = scale_and_bias(cosine, 0.1);
            assert!((a + b - 1.0).abs() < 0.02, "{cosine} {a} {b}");
        }
        let [a, b] = scale_and_bias(1.0f32, 1.0);
        assert!((a + b - (1.0 - 2f32.ln())).abs() < 0.005, "{a} {b}");
        for i in 0..100 {
            let [a, b] = scale_and_bias((i % 10) as f32 / 9.0, (i / 10) as f32 / 9.0);
            assert!(a >= 0.0 && b >= 0.0 && a + b < 1.02, "{i} {a} {b}");
        }
        // Grazing light is reflected by anything.
        let [_, grazing] = scale_and_bias(0.02f32, 0.2);
        assert!(grazing > 0.4, "{grazing}");
    }
}
