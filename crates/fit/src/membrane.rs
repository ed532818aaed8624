//! What texels do where few views or none have a say: keep the start's detail and
//! let its level follow their neighbours in the chart (a membrane in the gradient
//! domain, Pérez et al. 2003, "Poisson Image Editing").
//!
//! Energy: `λ Σ_edges |(xᵢ − xⱼ) − (pᵢ − pⱼ)|² + μ Σ |xᵢ − pᵢ|²`, p the start, edges
//! between side neighbours of the same chart. Quadratic, so its Hessian and its
//! gradient at x are exact: both are added to the solver's rows.

use parbake_image::FloatImage;
use parbake_model::glam::Vec4;
use parbake_solve::stencil::{Block, Row};
use parbake_views::chart_labels::{Atlas, NO_CHART, neighbours};
use rayon::prelude::*;

/// Strengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Membrane {
    /// λ: of differences between neighbours, as a share of the samples' mean pull on a texel.
    pub stiffness: f32,
    /// λ at least, 0 or more: where texels have few samples each, the neighbours outvote one that shows something else. A
    /// sample in the middle of a texel pulls 1 in maps that are compared as they are, and in colours, which are compared as
    /// sRGB, from 0.2 (white) to 41 (black).
    pub least: f32,
    /// μ: of the value itself, as a share of the samples' mean pull.
    pub tether: f32,
}

/// The samples' mean pull: trace of the centre block over the texels that have one.
pub fn mean_pull<B: Block>(rows: &[Row<B>]) -> f32 {
    let (sum, count) = rows
        .iter()
        .map(|r| f64::from(r.centre.trace()))
        .filter(|&t| t > 0.0)
        .fold((0.0, 0usize), |(s, n), t| (s + t, n + 1));
    if count == 0 { 1.0 } else { (sum / (3 * count) as f64) as f32 }
}

/// Adds the membrane's Hessian and its pull at the state `x` towards `start`. The fourth lane, opacity, is the samples' alone.
pub fn add_membrane<B: Block>(
    rows: &mut [Row<B>],
    atlas: &Atlas,
    x: &FloatImage<Vec4>,
    start: &FloatImage<Vec4>,
    membrane: &Membrane,
) {
    let scale = mean_pull(rows);
    let stiffness = (membrane.stiffness * scale).max(membrane.least);
    let tether = membrane.tether * scale;
    let size = atlas.size;
    rows.par_iter_mut().enumerate().for_each(|(i, row)| {
        let label = atlas.label[i];
        let offset = |j: usize| -> Vec4 { x.texels[j] - start.texels[j] };
        let mut edges = 0.0;
        let mut pull = offset(i) * tether;
        if label != NO_CHART {
            let sides = neighbours(i, size);
            for (k, &j) in sides[..4].iter().enumerate() {
                if atlas.label[j] != label {
                    continue;
                }
                edges += 1.0;
                pull += (offset(i) - offset(j)) * stiffness;
                // West, east, above, below: the row keeps east and south.
                match k {
                    1 => row.east.add(&B::identity(-stiffness)),
                    3 => row.south.add(&B::identity(-stiffness)),
                    _ => {}
                }
            }
        }
        if label != NO_CHART || row.centre.trace() > 0.0 {
            row.centre.add(&B::identity(edges * stiffness + tether));
            row.right -= pull.with_w(0.0);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_solve::conjugate_gradient::{Effort, solve};
    use parbake_solve::stencil::{Diagonal, Stencil};

    /// Protects the seamless fill: an unseen stretch between two fixed ends keeps
    /// the start's detail and blends the ends' levels.
    #[test]
    fn unseen_texels_keep_detail_and_blend_levels() {
        let size = 8;
        let label = (0..64).map(|i| if i / 8 == 2 && i % 8 < 7 { 0 } else { NO_CHART }).collect();
        let atlas = Atlas { size, label, covered: vec![true; 64] };
        let mut start = FloatImage::solid(size, Vec4::ZERO);
        start.texels[16 + 3] = Vec4::splat(0.5);
        let x = start.clone();
        let mut rows = vec![Row::<Diagonal>::default(); 64];
        for (end, target) in [(16, 1.0), (22, 2.0)] {
            rows[end].centre = Diagonal::identity(1e4);
            rows[end].right = Vec4::new(1e4 * target, 1e4 * target, 1e4 * target, 0.0);
        }
        let membrane = Membrane { stiffness: 1e-3, least: 0.0, tether: 0.0 };
        add_membrane(&mut rows, &atlas, &x, &start, &membrane);
        let matrix = Stencil { size, rows };
        let (step, _) = solve(&matrix, None, &Effort { steps: 200, tolerance: 1e-9 });
        let value = |i: usize| start.texels[16 + i].x + step[16 + i].x;
        for i in 0..7 {
            let level = 1.0 + i as f32 / 6.0 + if i == 3 { 0.5 } else { 0.0 };
            assert!((value(i) - level).abs() < 0.02, "{i} {} {level}", value(i));
        }
    }

    /// Protects texels of few samples from being alone, and those of many from being smoothed: the larger of both
    /// stiffnesses holds, and opacity is held by none.
    #[test]
    fn stiffness_has_a_floor() {
        let atlas = Atlas { size: 4, label: vec![0; 16], covered: vec![true; 16] };
        let start = FloatImage::solid(4, Vec4::ZERO);
        let mut x = start.clone();
        x.texels[0] = Vec4::ONE;
        for (least, expected) in [(1.0, 1.0), (0.1, 0.25), (0.0, 0.25)] {
            let mut rows = vec![Row { centre: Diagonal::identity(1.0), ..Row::default() }; 16];
            add_membrane(&mut rows, &atlas, &x, &start, &Membrane { stiffness: 0.25, least, tether: 0.0 });
            let pulled = Vec4::new(expected, expected, expected, 0.0);
            assert_eq!((rows[0].east.trace() / -3.0, rows[1].right), (expected, pulled));
        }
    }

    /// Protects charts from each other, and a state that is the start: there is no edge between charts, texels
    /// of no chart that nothing is known of have no equation, and nothing pulls.
    #[test]
    fn charts_are_apart_and_the_start_is_at_rest() {
        let label = (0..16).map(|i| if i < 8 { (i % 4 / 2) as u32 } else { NO_CHART }).collect();
        let atlas = Atlas { size: 4, label, covered: vec![true; 16] };
        let mut start = FloatImage::solid(4, Vec4::ZERO);
        start.texels.iter_mut().enumerate().for_each(|(i, texel)| *texel = Vec4::splat(i as f32));
        let membrane = Membrane { stiffness: 0.5, least: 0.0, tether: 0.25 };
        let mut rows = vec![Row::<Diagonal>::default(); 16];
        add_membrane(&mut rows, &atlas, &start, &start, &membrane);
        assert!(rows.iter().all(|row| row.right == Vec4::ZERO));
        let east: Vec<f32> = rows.iter().map(|row| row.east.trace() / 3.0).collect();
        assert_eq!(east[..8], [-0.5, 0.0, -0.5, 0.0, -0.5, 0.0, -0.5, 0.0]);
        let centre: Vec<f32> = rows.iter().map(|row| row.centre.trace() / 3.0).collect();
        // Two neighbours in the chart and the tether.
        assert!(
            centre[..8].iter().all(|&c| (c - 1.25).abs() < 1e-6) && centre[8..].iter().all(|&c| c == 0.0)
        );
        // One texel off the start is pulled back, and its neighbours follow it.
        let mut x = start.clone();
        x.texels[1] += Vec4::ONE;
        let mut rows = vec![Row::<Diagonal>::default(); 16];
        add_membrane(&mut rows, &atlas, &x, &start, &membrane);
        assert_eq!([0, 1, 2, 5].map(|i| rows[i].right.x), [0.5, -1.25, 0.0, 0.5]);
    }
}
