//! Gutters: every texel that no chart claims gets the colour of the nearest chart,
//! ring by ring until the picture is full, so that every mip level averages the
//! chart's own colours.

use crate::chart_labels::neighbours;
use parbake_image::FloatImage;
use parbake_model::glam::Vec4;

/// Fills all texels that are not `known` outwards from those that are. Each ring
/// is the mean of its neighbours in the ring before.
pub fn fill(canvas: &mut FloatImage<Vec4>, known: &[bool]) {
    let size = canvas.width;
    // 0: unknown, 1: queued for this ring, 2: known.
    let mut state: Vec<u8> = known.iter().map(|&k| if k { 2 } else { 0 }).collect();
    let mut border: Vec<usize> = (0..state.len()).filter(|&i| state[i] == 2).collect();
    while !border.is_empty() {
        let mut ring = Vec::new();
        for &texel in &border {
            for n in neighbours(texel, size) {
                if state[n] == 0 {
                    state[n] = 1;
                    ring.push(n);
                }
            }
        }
        for &texel in &ring {
            let (sum, count) = neighbours(texel, size)
                .into_iter()
                .filter(|&n| state[n] == 2)
                .fold((Vec4::ZERO, 0.0), |(s, c), n| (s + canvas.texels[n], c + 1.0));
            canvas.texels[texel] = sum / count;
        }
        for &texel in &ring {
            state[texel] = 2;
        }
        border = ring;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects mip levels: no texel stays empty, and near ones match their chart.
    #[test]
    fn everything_is_filled_from_the_nearest() {
        let mut canvas = FloatImage::solid(16, Vec4::ZERO);
        let mut known = vec![false; 256];
        for (texel, value) in [(4 * 16 + 4, 1.0), (12 * 16 + 12, 3.0)] {
            known[texel] = true;
            canvas.texels[texel] = Vec4::splat(value);
        }
        fill(&mut canvas, &known);
        assert!(canvas.texels.iter().all(|t| t.x >= 1.0 && t.x <= 3.0));
        assert_eq!(canvas.texels[5 * 16 + 5].x, 1.0);
        assert_eq!(canvas.texels[11 * 16 + 13].x, 3.0);
    }
}
