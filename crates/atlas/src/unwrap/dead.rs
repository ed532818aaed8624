//! Places for triangles without area in space, which nobody sees: on an edge of a
//! neighbour, where they have no area in the texture either.

use super::corners::{Corners, NONE, Surface};
use glam::DVec2;

impl Surface<'_> {
    /// Gives triangles without area in space a place on an edge of a neighbour, where
    /// they have no area in the texture either; those without neighbours one point.
    pub fn place_dead(&self, corners: &mut Corners) {
        let mut edges: Vec<([u32; 2], u32, u8)> = Vec::new();
        for t in 0..corners.chart.len() {
            let p = self.positions(t);
            for k in 0..3 {
                let (a, b) = (p[k], p[(k + 1) % 3]);
                if a != b {
                    edges.push(([a.min(b), a.max(b)], t as u32, k as u8));
                }
            }
        }
        edges.sort_unstable();
        let mut waiting: Vec<u32> =
            (0..corners.chart.len() as u32).filter(|&t| corners.chart[t as usize] == NONE).collect();
        if waiting.is_empty() {
            return;
        }
        let anywhere = (0..corners.chart.len()).find(|&t| corners.chart[t] != NONE);
        let anywhere = anywhere.map_or(DVec2::splat(0.5), |t| corners.uv[t][0]);
        // Neighbours of neighbours wait for another round.
        loop {
            let mut placed = Vec::new();
            for &t in &waiting {
                if let Some((uv, chart)) = self.on_neighbour(corners, &edges, t as usize) {
                    placed.push((t, uv, chart));
                }
            }
            if placed.is_empty() {
                break;
            }
            for (t, uv, chart) in placed {
                corners.uv[t as usize] = uv;
                corners.chart[t as usize] = chart;
            }
            waiting.retain(|&t| corners.chart[t as usize] == NONE);
        }
        for t in waiting {
            corners.uv[t as usize] = [anywhere; 3];
        }
    }

    fn on_neighbour(
        &self,
        corners: &Corners,
        edges: &[([u32; 2], u32, u8)],
        t: usize,
    ) -> Option<([DVec2; 3], u32)> {
        let p = self.positions(t);
        for k in 0..3 {
            let (a, b) = (p[k], p[(k + 1) % 3]);
            let edge = [a.min(b), a.max(b)];
            let start = edges.partition_point(|e| e.0 < edge);
            for &(_, other, side) in edges[start..].iter().take_while(|e| e.0 == edge) {
                let (o, side) = (other as usize, side as usize);
                if corners.chart[o] == NONE {
                    continue;
                }
                let (mut from, mut to) = (corners.uv[o][side], corners.uv[o][(side + 1) % 3]);
                if self.positions(o)[side] != a {
                    std::mem::swap(&mut from, &mut to);
                }
                let mut uv = [from; 3];
                uv[(k + 1) % 3] = to;
                // The third corner falls on the end at its own position, or on any.
                if p[(k + 2) % 3] == b {
                    uv[(k + 2) % 3] = to;
                }
                return Some((uv, corners.chart[o]));
            }
        }
        None
    }
}
