//! Models under random lights (the paper's Figure 14): each view has a light of its own, the same for every model.
//!
//! A light is a dim even part, one lamp far away and one soft lamp, in random directions and colours near white.
//!
//! Contract: lights depend on their number alone (SplitMix64, Steele et al. 2014), views on the options. Whole
//! materials are shown by glTF's BRDF; both models stand in the frame of the first.

use parbake::{BakeError, EvaluateOptions, PlacedModel, Renderer, Shading};
use parbake_metric::{Rgb, mean_squared_error, ms_ssim, psnr_from_mse};
use parbake_model::Model;
use parbake_model::glam::Vec3;
use parbake_render::camera::fibonacci_sphere;
use parbake_render::lighting::{DirectionalLight, Lighting, SoftLight};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Dark grey, linear light.
const BACKGROUND: [f32; 3] = [0.04; 3];
/// Views that are shown.
pub const SHOWN: usize = 3;

/// How a model agrees with the high-poly under random lights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Relit {
    /// What it is.
    pub name: String,
    /// Mean over the views, in decibels.
    pub psnr: f64,
    /// The same, 0 … 1; none for small pictures.
    pub ms_ssim: Option<f64>,
}

/// Figures of all models, and pictures to look at.
pub struct Relighting {
    /// In the order of the models.
    pub figures: Vec<Relit>,
    /// Pictures of the high-poly, then of each model; [`SHOWN`] of each, or as many as there are views.
    pub pictures: Vec<Vec<Rgb>>,
}

/// PSNR and MS-SSIM of a view.
type Figures = (f64, Option<f64>);

/// Numbers between 0 and 1 by SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 24) as f32
    }

    fn direction(&mut self) -> Vec3 {
        let (up, turn) = (2.0 * self.next() - 1.0, std::f32::consts::TAU * self.next());
        let aside = (1.0 - up * up).max(0.0).sqrt();
        Vec3::new(aside * turn.cos(), up, aside * turn.sin())
    }

    fn color(&mut self) -> Vec3 {
        Vec3::new(0.7 + 0.3 * self.next(), 0.7 + 0.3 * self.next(), 0.7 + 0.3 * self.next())
    }
}

/// The light with this number.
pub fn random_light(number: usize) -> Lighting {
    let mut random = Random(number as u64);
    let directional = DirectionalLight { direction: random.direction(), color: random.color() * 2.0 };
    let sharpness = 4.0 + 36.0 * random.next();
    // A soft lamp lights a surface that faces it about as much, whatever its width.
    let soft = SoftLight::new(random.direction(), sharpness, random.color() * (0.3 * sharpness));
    Lighting { ambient: Vec3::splat(0.08), soft: vec![soft], directional: vec![directional] }
}

/// Compares models with the high-poly. Runs on rayon's current thread pool.
///
/// # Errors
/// As of [`Renderer::new`].
pub fn relight(
    high: &Model,
    models: &[(&str, &Model)],
    options: &EvaluateOptions,
) -> Result<Relighting, BakeError> {
    let (views, resolution) = (options.views, options.resolution);
    let options = EvaluateOptions { views, resolution, shading: Shading::Pbr, ..EvaluateOptions::default() };
    let renderer = Renderer::new(high, &options)?;
    let placed: Vec<PlacedModel> =
        std::iter::once(high).chain(models.iter().map(|(_, m)| *m)).map(|m| renderer.place(m)).collect();
    // Every so many are shown, none of them from straight above.
    let is_shown = |view: usize| view % (views / SHOWN).max(1) == (views / SHOWN / 2).min(views - 1);
    let view = |(view, direction): (usize, Vec3)| {
        let renderer = renderer.clone().under(random_light(view));
        let taken = |model: &PlacedModel| renderer.tonemap(&renderer.render(model, direction), BACKGROUND);
        let pictures: Vec<Rgb> = placed.iter().map(taken).collect();
        let figures: Vec<Figures> = pictures[1..]
            .iter()
            .map(|low| {
                let error = mean_squared_error(&pictures[0], low).unwrap_or(f64::NAN);
                (psnr_from_mse(error), ms_ssim(&pictures[0], low).ok().flatten())
            })
            .collect();
        (figures, if is_shown(view) { pictures } else { Vec::new() })
    };
    let all = fibonacci_sphere(views, 0.0).into_par_iter().enumerate().map(view);
    let all: Vec<(Vec<Figures>, Vec<Rgb>)> = all.collect();
    let of = |(k, (name, _)): (usize, &(&str, &Model))| {
        let count = all.len().max(1) as f64;
        let ssim: Option<Vec<f64>> = all.iter().map(|(figures, _)| figures[k].1).collect();
        Relit {
            name: (*name).into(),
            psnr: all.iter().map(|(figures, _)| figures[k].0).sum::<f64>() / count,
            ms_ssim: ssim.map(|ssim| ssim.iter().sum::<f64>() / count),
        }
    };
    let figures = models.iter().enumerate().map(of).collect();
    let shown: Vec<&Vec<Rgb>> =
        all.iter().map(|(_, pictures)| pictures).filter(|p| !p.is_empty()).take(SHOWN).collect();
    let pictures =
        (0..=models.len()).map(|k| shown.iter().map(|pictures| pictures[k].clone()).collect()).collect();
    Ok(Relighting { figures, pictures })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake::demo_pair;

    /// Protects the figure's claim: a model without its metal is told from one with it, the model itself is found
    /// equal, and the same lights come again.
    #[test]
    fn metal_is_told_from_paint() {
        let (mut high, _) = demo_pair();
        let matte = high.clone();
        for material in &mut high.materials {
            (material.metallic, material.roughness) = (1.0, 0.3);
        }
        let options = EvaluateOptions { views: 5, resolution: 48, ..EvaluateOptions::default() };
        let models = [("itself", &high), ("matte", &matte)];
        let found = relight(&high, &models, &options).unwrap();
        assert_eq!(found.figures[0].psnr, 100.0);
        assert!(found.figures[1].psnr < 30.0, "{:?}", found.figures[1]);
        assert_eq!(found.pictures.len(), 3);
        assert_eq!(found.pictures[0].len(), SHOWN);
        assert_eq!(random_light(7), random_light(7));
        assert!(
            random_light(7).directional[0].direction.dot(random_light(8).directional[0].direction) < 0.99
        );
    }
}
