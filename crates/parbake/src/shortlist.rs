//! Which of several low-polys of a model is best once it is baked: each is baked briefly, and pictures decide.
//!
//! Choosing triangles compares surfaces without a texture, in which what a texture can hide counts as much as what it
//! cannot. With few triangles, attempts that look alike without one differ by half a decibel once they are baked.
//!
//! Contract: deterministic. Needs time: not for bakes with a budget. A watcher that says stop is heeded between bakes.

use crate::bake::bake_as;
use crate::error::BakeError;
use crate::options::{BakeOptions, GREY, Parallax, Preset};
use crate::work::Work;
use parbake_evaluate::few_views::FewViews;
use parbake_evaluate::options::EvaluateOptions;
use parbake_model::Model;
use parbake_progress::{Muted, Portion, Stage, Watcher};
use parbake_simplify::LayerReport;
use parbake_views::high_poly::HighPoly;

/// Texels along a side of a brief bake, at most, and its training views. They order low-polys as whole bakes do.
const TEXELS: usize = 128;
const TRAINING_VIEWS: usize = 96;
/// Views that decide, and pixels along a side of each.
const VIEWS: usize = 24;
const RESOLUTION: usize = 256;
/// What is behind the model, in linear light.
const BACKGROUNDS: [[f32; 3]; 3] = [[0.0; 3], [GREY; 3], [1.0; 3]];

/// Share of the time for triangles that attempts take where brief bakes follow, about.
pub(crate) const ATTEMPTS: f64 = 0.5;

/// A low-poly, and how the triangles of each layer were found.
pub type CoarseModel = (Model, Vec<LayerReport>);

/// The low-poly whose brief bake comes closest to `model` in pictures: PSNR in dB, the mean over views and backgrounds. The first
/// one where there is no other, and where importances weigh the surface, which these pictures do not; the best so far where the
/// watcher says stop. `low_polys` is not empty.
///
/// # Errors
/// An option out of range; a model without extent. A brief bake that fails only leaves its low-poly out.
pub(crate) fn best_baked(
    high: &HighPoly,
    model: &Model,
    mut low_polys: Vec<CoarseModel>,
    options: &BakeOptions,
    watcher: &dyn Watcher,
) -> Result<CoarseModel, BakeError> {
    let mut best = 0;
    if low_polys.len() > 1 && high.importances.is_empty() {
        let brief = brief(options);
        let pictures = EvaluateOptions {
            views: VIEWS,
            resolution: RESOLUTION,
            convention: options.convention,
            shading: options.shading,
            ..EvaluateOptions::default()
        };
        let score = FewViews::new(model, &pictures, &BACKGROUNDS)?;
        let mut most = f64::NEG_INFINITY;
        let rest = Portion::new(watcher, ATTEMPTS..1.0);
        for (k, (low, _)) in low_polys.iter().enumerate() {
            rest.progress(Stage::Simplify, k, low_polys.len());
            // Charts that have no room in fewer texels may have it in all.
            let Ok(baked) = bake_as(Work::Level, high, low, &brief, &Muted(watcher)) else { continue };
            if watcher.stopped() {
                break;
            }
            let psnr = score.psnr(&baked.model);
            if psnr > most {
                (best, most) = (k, psnr);
            }
        }
    }
    Ok(low_polys.swap_remove(best))
}

/// The options of a brief bake.
fn brief(options: &BakeOptions) -> BakeOptions {
    BakeOptions {
        preset: Preset::Fast,
        texture_size: options.texture_size.min(TEXELS),
        parallax: Parallax::None,
        gutter: None,
        smallest_mip: None,
        uv_steps: None,
        views: Some(TRAINING_VIEWS),
        rounds: None,
        time_budget: None,
        ..options.clone()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::bake::prepare_high_poly;
    use crate::options::{ShapeMode, UvMode};
    use parbake_model::glam::Vec3;
    use parbake_model::{Material, Mesh};

    /// A sphere of 8 · 4^`times` triangles.
    fn sphere(times: usize) -> Model {
        let axes = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y];
        let mut mesh = Mesh { positions: vec![Vec3::Z, Vec3::NEG_Z], ..Mesh::default() };
        mesh.positions.extend(axes);
        let ring = (0..4u32).map(|k| [2 + k, 2 + (k + 1) % 4]);
        mesh.triangles = ring.flat_map(|[a, b]| [[0, a, b], [1, b, a]]).collect();
        mesh.triangle_materials = vec![0; 8];
        for _ in 0..times {
            mesh = parbake_mesh::subdivide(&mesh);
            mesh.positions.iter_mut().for_each(|p| *p = p.normalize());
        }
        mesh.normals = mesh.positions.clone();
        Model { name: "sphere".into(), mesh, materials: vec![Material::default()], ..Model::default() }
    }

    struct Stopped;

    impl Watcher for Stopped {
        fn stopped(&self) -> bool {
            true
        }
    }

    /// Protects the choice: pictures of bakes decide, wherever a low-poly stands; a signal ends it, and leaves a low-poly.
    #[test]
    fn pictures_of_bakes_decide() {
        let model = sphere(3);
        let options = BakeOptions {
            texture_size: 32,
            view_size: Some(32),
            uv: UvMode::Repair,
            shape: ShapeMode::Keep,
            ..BakeOptions::default()
        };
        let high = prepare_high_poly(&model, &options).unwrap();
        let found = |counts: [usize; 2], watcher: &dyn Watcher| {
            let low_polys = counts.map(|times| (sphere(times), Vec::new())).to_vec();
            best_baked(&high, &model, low_polys, &options, watcher).unwrap().0.mesh.triangles.len()
        };
        assert_eq!([found([0, 1], &()), found([1, 0], &())], [32; 2]);
        assert_eq!(found([0, 1], &Stopped), 8);
    }
}
