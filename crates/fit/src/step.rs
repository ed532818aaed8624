//! One Gauss–Newton step of one map, all others held: the same for every kind of map.
//!
//! With J the BRDF's Jacobian of a sample's light by the map ([`Brdf::jacobian`](parbake_render::shade::Brdf::jacobian)), s the slope of the
//! display curve and ω the weights of the robust loss, a sample adds the block `Jᵀ s ω s J` to each
//! pair of its four texels and `−Jᵀ s ω r` to their right-hand sides (r: shown minus wanted). The
//! matrix has nine points a texel (`parbake_solve::stencil`) and is solved by conjugate gradients.
//!
//! What differs between kinds is their domain: values in a box go through an active set
//! (`parbake_solve::boxed`); unit normals take a damped step (Levenberg–Marquardt) of limited length
//! and are put back onto their hemisphere.

use crate::assemble::SampleBlock;
use crate::backend::Backend;
use crate::membrane::{Membrane, add_membrane, mean_pull};
use crate::problem::Problem;
use crate::robust_loss::Loss;
use parbake_image::{Domain, FloatImage, MapKind, MapSet};
use parbake_model::glam::Vec4;
use parbake_solve::boxed::solve_in_box;
use parbake_solve::conjugate_gradient::{Effort, Outcome};
use parbake_solve::free_lanes::FreeLanes;
use parbake_solve::stencil::{Diagonal, Row, Stencil, Symmetric};
use rayon::prelude::*;

/// The longest change of a normal in one step: beyond it the linear model of the
/// cosine says little.
const LONGEST: f32 = 0.3;

/// Textures with longer sides have one matrix at a time: at 2048² texels it takes 0.4 or 0.6 GB.
const LARGE: usize = 1024;

/// How a step is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepOptions {
    /// What holds texels that few views see.
    pub membrane: Membrane,
    /// Limits of the linear solver.
    pub effort: Effort,
    /// Damping of normals, a share of the samples' mean pull on a texel.
    pub damping: f32,
}

/// Room for the matrices of steps, from one to the next. Those of large textures are not kept beside each
/// other: they are the largest things of a bake.
#[derive(Default)]
pub struct Workspace {
    diagonal: Vec<Row<Diagonal>>,
    symmetric: Vec<Row<Symmetric>>,
}

/// One step of the map of this kind, which must be in `maps`. `start` is what unseen texels are held
/// to. Returns the loss before the step and what the linear solver did.
pub fn fit_step<P: Problem>(
    backend: &impl Backend,
    kind: MapKind,
    problem: &P,
    options: &StepOptions,
    maps: &mut MapSet,
    start: &FloatImage<Vec4>,
    workspace: &mut Workspace,
) -> (Loss, Outcome) {
    let size = problem.samples().size;
    let is_large = size > LARGE;
    match kind.spec().domain {
        Domain::Box => {
            if is_large {
                workspace.symmetric = Vec::new();
            }
            let rows = &mut workspace.diagonal;
            let loss = backend.assemble(kind, problem, maps, rows);
            let Some(map) = maps.get_mut(kind) else { return (loss, Outcome::default()) };
            add_membrane(rows, problem.atlas(), map, start, &options.membrane);
            let mut matrix = Stencil { size, rows: std::mem::take(rows) };
            let solve = |matrix: &Stencil<Diagonal>, free: &[FreeLanes]| {
                backend.solve(matrix, Some(free), &options.effort)
            };
            let outcome = solve_in_box(&mut matrix, &mut map.texels, solve);
            *rows = matrix.rows;
            (loss, outcome)
        }
        Domain::Hemisphere if problem.is_coupled(kind) => {
            if is_large {
                workspace.diagonal = Vec::new();
            }
            turn(backend, kind, problem, options, maps, start, &mut workspace.symmetric)
        }
        Domain::Hemisphere => turn(backend, kind, problem, options, maps, start, &mut workspace.diagonal),
    }
}

/// A step of unit normals.
fn turn<P: Problem, B: SampleBlock>(
    backend: &impl Backend,
    kind: MapKind,
    problem: &P,
    options: &StepOptions,
    maps: &mut MapSet,
    start: &FloatImage<Vec4>,
    rows: &mut Vec<Row<B>>,
) -> (Loss, Outcome) {
    let loss = backend.assemble(kind, problem, maps, rows);
    let Some(map) = maps.get_mut(kind) else { return (loss, Outcome::default()) };
    let extra = options.damping * mean_pull(rows);
    add_membrane(rows, problem.atlas(), map, start, &options.membrane);
    rows.par_iter_mut().filter(|r| r.centre.trace() > 0.0).for_each(|r| r.centre.add(&B::identity(extra)));
    let matrix = Stencil { size: problem.samples().size, rows: std::mem::take(rows) };
    let (step, outcome) = backend.solve(&matrix, None, &options.effort);
    map.texels.par_iter_mut().zip(&step).for_each(|(m, step)| {
        let limit = (LONGEST / step.length().max(1e-9)).min(1.0);
        *m = Domain::Hemisphere.clamp(*m + *step * limit);
    });
    *rows = matrix.rows;
    (loss, outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::Cpu;
    use crate::problem::ShadedProblem;
    use crate::robust_loss::Cauchy;
    use parbake_image::display::{Curve, Display};
    use parbake_image::display_table::DisplayTable;
    use parbake_render::shade::Lambert;
    use parbake_views::chart_labels::Atlas;
    use parbake_views::samples::{Sample, SampleSet};

    const SIZE: usize = 8;
    const OPTIONS: StepOptions = StepOptions {
        membrane: Membrane { stiffness: 1e-6, least: 0.0, tether: 1e-6 },
        effort: Effort { steps: 50, tolerance: 1e-6 },
        damping: 0.1,
    };

    fn atlas() -> Atlas {
        Atlas { size: SIZE, label: vec![0; SIZE * SIZE], covered: vec![true; SIZE * SIZE] }
    }

    fn samples(first_band: Vec<Sample>) -> SampleSet {
        SampleSet::new(SIZE, &[first_band])
    }

    fn linear() -> DisplayTable {
        DisplayTable::new(&Display { gain: 1.0, curve: Curve::Linear })
    }

    /// Protects clean surfaces: where one view of ten shows something else, squares settle on the
    /// mean, and Cauchy's loss on what nine of them show.
    #[test]
    fn a_stray_pixel_hardly_counts() {
        let mut band = vec![Sample::facing(0, 0.8); 9];
        band.push(Sample::facing(0, 0.0));
        let (samples, atlas, display) = (samples(band), atlas(), linear());
        let start = FloatImage::solid(SIZE, Vec4::splat(0.5));
        for (scale, wanted) in [(f32::INFINITY, 0.72), (0.1, 0.8)] {
            let problem = ShadedProblem {
                samples: &samples,
                atlas: &atlas,
                display: &display,
                brdf: &Lambert,
                robust: Cauchy::new(scale),
            };
            let mut maps = MapSet::of(start.clone(), FloatImage::solid(SIZE, Vec4::Z));
            let mut workspace = Workspace::default();
            let before = problem.loss(&maps);
            for _ in 0..20 {
                fit_step(&Cpu, MapKind::BaseColor, &problem, &OPTIONS, &mut maps, &start, &mut workspace);
            }
            let found = maps.get(MapKind::BaseColor).expect("it was put there").texels[0].x;
            assert!((found - wanted).abs() < 3e-3, "{scale}: {found}");
            assert!(problem.loss(&maps).minimised < before.minimised);
        }
    }

    /// Protects the normal's step: a grey surface that shows half of its light is asked to tilt until
    /// the cosine at the headlight is a half.
    #[test]
    fn a_normal_tilts_until_the_cosine_fits() {
        let (samples, atlas, display) = (samples(vec![Sample::facing(0, 0.5); 4]), atlas(), linear());
        let problem = ShadedProblem {
            samples: &samples,
            atlas: &atlas,
            display: &display,
            brdf: &Lambert,
            robust: Cauchy::new(f32::INFINITY),
        };
        let tilted = Domain::Hemisphere.clamp(Vec4::new(0.3, 0.0, 1.0, 0.0));
        let start = FloatImage::solid(SIZE, tilted);
        let mut maps = MapSet::of(FloatImage::solid(SIZE, Vec4::ONE), start.clone());
        let mut workspace = Workspace::default();
        for _ in 0..40 {
            fit_step(&Cpu, MapKind::Normal, &problem, &OPTIONS, &mut maps, &start, &mut workspace);
        }
        let found = maps.get(MapKind::Normal).expect("it was put there").texels[0];
        assert!((found.z - 0.5).abs() < 0.01 && (found.length() - 1.0).abs() < 1e-5, "{found}");
    }

    /// Protects emission, and that it needs no solve of its own: what the lit colour leaves of the
    /// wanted light is emitted.
    #[test]
    fn emission_is_what_the_lit_colour_leaves() {
        let (samples, atlas, display) = (samples(vec![Sample::facing(0, 0.8); 4]), atlas(), linear());
        let problem = ShadedProblem {
            samples: &samples,
            atlas: &atlas,
            display: &display,
            brdf: &Lambert,
            robust: Cauchy::new(f32::INFINITY),
        };
        let start = FloatImage::solid(SIZE, Vec4::ZERO);
        let mut maps =
            MapSet::of(FloatImage::solid(SIZE, Vec4::splat(0.5)), FloatImage::solid(SIZE, Vec4::Z));
        maps.insert(MapKind::Emissive, start.clone());
        let mut workspace = Workspace::default();
        for _ in 0..5 {
            fit_step(&Cpu, MapKind::Emissive, &problem, &OPTIONS, &mut maps, &start, &mut workspace);
        }
        let found = maps.get(MapKind::Emissive).expect("it was put there").texels[0];
        assert!((found.truncate() - parbake_model::glam::Vec3::splat(0.3)).length() < 3e-3, "{found}");
    }
}
