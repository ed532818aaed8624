//! A low-poly for a high-poly: triangles chosen by its pictures (`parbake-simplify`). Of several attempts at few triangles brief
//! bakes tell the best (`shortlist.rs`).

use crate::error::BakeError;
use crate::options::{BakeOptions, Preset};
use crate::shortlist::{ATTEMPTS, CoarseModel, best_baked};
use crate::snapshots::of_surface;
use parbake_mesh::parts::{kept_parts_of, parts_of_materials};
use parbake_mesh::rigs::transferred;
use parbake_model::{AlphaMode, Material, MaterialExtensions, Model};
use parbake_progress::{Portion, Showing, Watcher};
use parbake_simplify::polish::PolishOptions;
use parbake_simplify::{ChooseOptions, Chosen, CoarseSurfaces, choose_triangles, least_triangles};
use parbake_views::high_poly::HighPoly;

/// Triangles that a part which stays apart keeps at least, in each layer.
const LEAST_OF_PART: usize = 4;

/// The fewest triangles that a low-poly of a model may have: with nodes that stay apart none of them vanishes.
pub fn least_of(high: &HighPoly, model: &Model) -> usize {
    match model.parts {
        None => 4,
        Some(_) => least_triangles(high, &parts_of_materials(model), LEAST_OF_PART).max(4),
    }
}

/// Refuses fewer triangles than all parts of a model need.
///
/// # Errors
/// [`BakeError::FewTriangles`].
pub fn check_triangles(high: &HighPoly, model: &Model, triangles: usize) -> Result<(), BakeError> {
    let least = least_of(high, model);
    match model.parts.is_some() && triangles < least {
        true => Err(BakeError::FewTriangles { triangles, model: model.name.clone(), least }),
        false => Ok(()),
    }
}

/// What low-polys of a model begin with.
pub fn coarse_surfaces(high: &HighPoly, model: &Model) -> CoarseSurfaces {
    CoarseSurfaces::new(high.scene.mesh(), &parts_of_materials(model))
}

/// A low-poly of at most so many triangles, without texture coordinates, in the high-poly's own space; it moves as the
/// model does, and has its parts. `model` is what the high-poly was prepared from, `start` is what `coarse_surfaces` makes of
/// both; `before` is a finer low-poly that it may start from; `options` are those of the bake that it is for.
///
/// # Errors
/// An option out of range; a model without extent.
pub fn low_poly(
    high: &HighPoly,
    model: &Model,
    start: &CoarseSurfaces,
    before: Option<&Model>,
    triangles: usize,
    options: &BakeOptions,
    watcher: &dyn Watcher,
) -> Result<CoarseModel, BakeError> {
    let attempts = attempts(high, model, start, before, triangles, options.preset, watcher);
    best_baked(high, model, attempts, options, watcher)
}

/// Low-polys by several attempts, the best first as far as that can be told without a texture.
fn attempts(
    high: &HighPoly,
    model: &Model,
    start: &CoarseSurfaces,
    before: Option<&Model>,
    triangles: usize,
    preset: Preset,
    watcher: &dyn Watcher,
) -> Vec<CoarseModel> {
    let before = before.map(|low| {
        let mut mesh = low.mesh.clone();
        high.frame.apply(&mut mesh);
        mesh
    });
    let mut options = choose_options(triangles, preset, watcher.seconds_left().is_some());
    if !high.importances.is_empty() {
        // Quadrics do not know what counts: there must be something to choose from.
        options.room = options.room.max(2);
    }
    if model.parts.is_some() {
        options.least = LEAST_OF_PART;
    }
    let parts = &start.parts;
    let watcher = &Showing::new(watcher, |snapshot| Some(of_surface(&model.name, high, snapshot)));
    let share = if options.attempts > 1 { ATTEMPTS } else { 1.0 };
    let watcher = &Portion::new(watcher, 0.0..share);
    let chosen = choose_triangles(high, before.as_ref(), start, &options, watcher);
    let materials: Vec<Material> = model.materials.iter().map(layer_only).collect();
    let coarse = |Chosen { mut mesh, layers }: Chosen| {
        for point in &mut mesh.positions {
            *point = *point / high.frame.scale + high.frame.centre;
        }
        let rig = transferred(model, &mesh, parts);
        let parts = kept_parts_of(model, &mesh, parts);
        let (name, materials) = (model.name.clone(), materials.clone());
        (Model { name, mesh, materials, rig, parts, ..Model::default() }, layers)
    };
    chosen.into_iter().map(coarse).collect()
}

/// Of a material what says in which layer it is drawn.
fn layer_only(material: &Material) -> Material {
    let transmission =
        material.extensions.transmission.map(|t| parbake_model::Transmission { texture: None, ..t });
    Material {
        name: material.name.clone(),
        alpha_mode: material.alpha_mode,
        alpha_cutoff: if material.alpha_mode == AlphaMode::Mask { material.alpha_cutoff } else { 0.5 },
        double_sided: material.double_sided,
        extensions: MaterialExtensions { transmission, ..MaterialExtensions::default() },
        ..Material::default()
    }
}

/// Side in pixels of the views that many triangles are chosen in, for each root of their number: some six pixels for each
/// triangle of a start that is seen.
const VIEW_SIZE: f64 = 4.6;
/// Triangles up to which they are polished.
pub(crate) const POLISHED: usize = 2500;
/// Triangles from which on views would have to be larger than is worth the time.
pub(crate) const TOO_MANY: usize = 12_000;

/// Views follow the number of triangles: few large ones need many directions, many small ones need pixels. What one
/// triangle is worth falls with their number, what it costs does not: many are not polished, and very many are chosen by
/// quadrics alone. So are many where the time is limited, since collapses go on without a look at the clock.
fn choose_options(triangles: usize, preset: Preset, is_time_limited: bool) -> ChooseOptions {
    let own = PolishOptions::default();
    let (room, views, view_size, rounds, sweeps) = match triangles {
        0..=150 => (3, 64, 128, 2 * own.rounds, own.sweeps),
        151..=400 => (3, 48, 128, own.rounds, own.sweeps),
        401..=1000 => (3, 32, 160, own.rounds / 2, own.sweeps),
        1001..=POLISHED if is_time_limited => (2, 24, 192, own.rounds / 4, 1),
        1001..=POLISHED => (3, 24, 256, own.rounds / 4, 1),
        _ if triangles < TOO_MANY && !is_time_limited => {
            (2, 24, (VIEW_SIZE * (triangles as f64).sqrt()).max(256.0) as usize, 0, 0)
        }
        _ => (1, 16, 160, 0, 0),
    };
    let rounds = match preset {
        Preset::Fast => rounds / 2,
        Preset::Balanced => rounds,
        Preset::Best => 2 * rounds,
    };
    // Many small triangles are no better for it.
    let sets = if triangles <= 400 { 4 } else { 1 };
    let attempts = if preset == Preset::Fast || is_time_limited { 1 } else { sets };
    let polish = PolishOptions { rounds, sweeps, ..own };
    ChooseOptions { triangles, least: 0, room, views, sets, attempts, view_size, polish, seed: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects triangles that are small from views that do not show them, and time: very many are left to quadrics, and so are
    /// many where the time is limited.
    #[test]
    fn more_triangles_have_larger_views() {
        let of = |triangles, is_limited| {
            let own = choose_options(triangles, Preset::Balanced, is_limited);
            (own.view_size, own.room)
        };
        let sizes: Vec<usize> = [100, 1000, 2500, 2501, 5000, 11_999].map(|count| of(count, false).0).into();
        assert!(sizes.is_sorted() && sizes[5] > 500, "{sizes:?}");
        assert!([100, 2500, 11_999].iter().all(|&count| of(count, false).1 > 1));
        assert_eq!([of(TOO_MANY, false), of(3000, true)], [(160, 1); 2]);
        assert_eq!(choose_options(100, Preset::Balanced, true).attempts, 1);
    }
}
