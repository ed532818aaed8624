//! Which chart each texel serves.
//!
//! A bilinear fetch inside a chart also reads texels just outside of it, so charts
//! are grown by a few texels; where two meet, the one that comes first wins. The
//! membrane (`membrane.rs`) acts inside one label only: nothing leaks from chart to
//! chart.

use parbake_mesh::texel_map::TexelMap;

/// No chart is near.
pub const NO_CHART: u32 = u32::MAX;

/// Chart labels of a square texture.
#[derive(Clone, Debug, Default)]
pub struct Atlas {
    /// Texels along a side.
    pub size: usize,
    /// size² chart indices, [`NO_CHART`] away from all charts.
    pub label: Vec<u32>,
    /// True where the texel's centre lies on the surface.
    pub covered: Vec<bool>,
}

/// Indices of the eight neighbours on a grid that repeats.
#[inline]
pub fn neighbours(texel: usize, size: usize) -> [usize; 8] {
    let (x, row) = (texel % size, texel - texel % size);
    let west = if x == 0 { size - 1 } else { x - 1 };
    let east = if x + 1 == size { 0 } else { x + 1 };
    let above = if row == 0 { size * (size - 1) } else { row - size };
    let below = if row + size == size * size { 0 } else { row + size };
    [row + west, row + east, above + x, below + x, above + west, above + east, below + west, below + east]
}

impl Atlas {
    /// Labels from the texel map and each triangle's chart, grown by `rings` texels.
    pub fn new(map: &TexelMap, charts: &[u32], rings: usize) -> Self {
        let size = map.size;
        let covered: Vec<bool> = map.triangle.iter().map(|&t| t != u32::MAX).collect();
        let mut label: Vec<u32> =
            map.triangle.iter().map(|&t| charts.get(t as usize).copied().unwrap_or(NO_CHART)).collect();
        let mut border: Vec<usize> = (0..label.len()).filter(|&i| label[i] != NO_CHART).collect();
        for _ in 0..rings {
            let mut grown = Vec::new();
            for &texel in &border {
                for n in neighbours(texel, size) {
                    if label[n] == NO_CHART {
                        label[n] = label[texel];
                        grown.push(n);
                    }
                }
            }
            border = grown;
        }
        Self { size, label, covered }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the reach of bilinear fetches, and the border between two charts.
    #[test]
    fn charts_grow_until_they_meet() {
        let mut triangle = vec![u32::MAX; 64];
        triangle[3 * 8 + 2] = 0;
        triangle[3 * 8 + 5] = 1;
        let map = TexelMap { size: 8, triangle, barycentric: vec![[0.0; 2]; 64], overlaps: 0 };
        let atlas = Atlas::new(&map, &[7, 9], 1);
        assert_eq!(atlas.label[2 * 8 + 3], 7);
        assert_eq!(atlas.label[4 * 8 + 4], 9);
        assert_eq!(atlas.label[0], NO_CHART);
        assert_eq!(atlas.covered.iter().filter(|&&c| c).count(), 2);
    }
}
