//! A layout of the size that a large model has: 50,000 triangles in 500 charts with 20,000 boundary
//! edges, in a texture of 1024 texels.

use glam::{DMat2, dvec2};
use parbake_atlas::Layout;

/// Charts in a row and in a column.
const CHARTS: [usize; 2] = [10, 50];

/// Quads of a chart.
const QUADS: [usize; 2] = [17, 3];

/// A number in [−1, 1] that looks random.
pub fn noise(seed: u64) -> f64 {
    let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Strips of jittered quads, three texels apart.
pub fn layout() -> Layout {
    let mut layout = Layout::default();
    for chart in 0..CHARTS[0] * CHARTS[1] {
        let first = layout.points.len() as u32;
        let room = dvec2(1.0 / CHARTS[0] as f64, 1.0 / CHARTS[1] as f64);
        let corner = room * dvec2((chart % CHARTS[0]) as f64, (chart / CHARTS[0]) as f64);
        let inner = room - 3.0 / 1024.0;
        for row in 0..=QUADS[1] {
            for column in 0..=QUADS[0] {
                let at = dvec2(column as f64 / QUADS[0] as f64, row as f64 / QUADS[1] as f64);
                let seed = 2 * layout.points.len() as u64;
                let jitter = 0.2 / 1024.0 * dvec2(noise(seed), noise(seed + 1));
                layout.points.push(corner + 1.5 / 1024.0 + inner * at + jitter);
            }
        }
        let width = QUADS[0] as u32 + 1;
        for row in 0..QUADS[1] as u32 {
            for column in 0..QUADS[0] as u32 {
                let a = first + row * width + column;
                layout.triangles.push([a, a + 1, a + width + 1]);
                layout.triangles.push([a, a + width + 1, a + width]);
                layout.charts.extend([chart as u32; 2]);
            }
        }
    }
    layout.rest = vec![DMat2::IDENTITY; layout.triangles.len()];
    layout.point_of_vertex = (0..layout.points.len() as u32).collect();
    layout.round();
    layout
}
