//! A model's own maps with fewer texels: how much each may lose is found by pictures.
//!
//! Each map is reduced by itself, step by step; of all together the errors add up, nearly enough. Of all choices within a
//! number of texels, the one with the fewest is taken at which pictures look the same; where none does, the one whose
//! pictures are closest.
//!
//! Contract: the surface stays as it is. What was measured until `is_over` says yes counts.

use crate::maps::{
    HALVINGS, LevelMap, Reduction, images_of_extensions, oblong_level_maps, with_halved_extensions,
    with_reductions,
};
use crate::search::{INVISIBLE, error_of};
use parbake_model::{Image, MaterialExtensions, Model};
use rayon::prelude::*;

/// Decibels that fewer texels may cost.
const UNSEEN: f64 = 0.05;
/// Texels of all maps below which there is nothing to be gained by fewer.
const FREE: usize = 256 * 256;
/// How many maps are reduced at once: each time all of them are in memory once more.
const AT_ONCE: usize = 2;
/// A map that alone costs so many times the error that may not be seen is not reduced further.
const HOPELESS: f64 = 10.0;

/// The model with reduced maps: with the fewest texels at which pictures look the same, at most `most`. `psnr` is the PSNR in dB
/// of the model with any maps; it may be of few pictures, since only differences count. None where no measured choice has at
/// most `most` texels.
///
/// # Errors
/// Those of `psnr`.
pub fn with_fewer_texels<E: Send>(
    model: &Model,
    most: usize,
    is_over: &(dyn Fn() -> bool + Sync),
    psnr: impl Fn(&Model) -> Result<f64, E> + Sync,
) -> Result<Option<Model>, E> {
    let maps = oblong_level_maps(model);
    // The images of extensions are one more place, after all maps, if pictures show what they say; else they keep as many
    // texels as the finest map.
    let others = images_of_extensions(model);
    let are_shown = !others.is_empty() && shows_all_textures(model);
    let halvings_of_others = |choice: &[usize]| match are_shown {
        true => [choice[maps.len()]; 2],
        false => halvings_of_extensions(&maps, choice),
    };
    let places = maps.len() + usize::from(are_shown);
    let reductions_of = |place: usize| maps.get(place).map_or(HALVINGS + 1, |map| map.reductions.len());
    let reduced = |choice: &[usize]| -> Model {
        let reductions: Vec<Reduction> = maps.iter().zip(choice).map(|(map, &k)| map.reductions[k]).collect();
        let reduced = with_reductions(model, &maps, &reductions);
        with_halved_extensions(reduced, halvings_of_others(choice))
    };
    let unreduced = psnr(model)?;
    let whole = error_of(unreduced);
    let allowed = error_of((unreduced - UNSEEN).min(INVISIBLE));
    // What each map costs by itself; of all together about the sum.
    let costs_of = |place: usize| -> Result<Vec<f64>, E> {
        let mut own = vec![0.0];
        for reduction in 1..reductions_of(place) {
            if is_over() || own.iter().any(|cost| *cost > HOPELESS * allowed) {
                break;
            }
            let mut choice = vec![0; places];
            choice[place] = reduction;
            own.push((error_of(psnr(&reduced(&choice))?) - whole).max(0.0));
        }
        Ok(own)
    };
    let mut costs: Vec<Vec<f64>> = Vec::new();
    for some in (0..places).collect::<Vec<_>>().chunks(AT_ONCE) {
        let of_some = some.par_iter().map(|&place| costs_of(place)).collect::<Result<Vec<_>, _>>()?;
        costs.extend(of_some);
    }
    let texels_of = |place: usize, reduction: usize| match maps[place].reductions[reduction] {
        Reduction::Factor => 0,
        Reduction::Halved([u, v]) => {
            let image = &model.images[maps[place].image];
            (image.width >> u).max(1) * (image.height >> v).max(1)
        }
    };
    let texels_of_others = |choice: &[usize]| -> usize {
        let [u, v] = halvings_of_others(choice);
        let texels = |image: &Image| (image.width >> u).max(1) * (image.height >> v).max(1);
        others.iter().map(|(image, _)| texels(&model.images[*image])).sum()
    };
    let mut best: Option<((bool, f64, f64), Vec<usize>)> = None;
    for choice in choices(&costs.iter().map(Vec::len).collect::<Vec<_>>()) {
        let texels =
            choice.iter().take(maps.len()).enumerate().map(|(place, &k)| texels_of(place, k)).sum::<usize>()
                + texels_of_others(&choice);
        let error = whole + choice.iter().enumerate().map(|(place, &k)| costs[place][k]).sum::<f64>();
        let is_seen = error > allowed;
        // Where something is lost anyway, the least; else the fewest texels.
        let rank =
            if is_seen { (true, error, texels as f64) } else { (false, texels.max(FREE) as f64, error) };
        if texels <= most && best.as_ref().is_none_or(|(least, _)| rank < *least) {
            best = Some((rank, choice));
        }
    }
    Ok(best.map(|(_, choice)| reduced(&choice)))
}

/// Whether pictures that are compared show what every texture of an extension says (`render/material_layers.rs`).
fn shows_all_textures(model: &Model) -> bool {
    let shows = |e: &MaterialExtensions| {
        e.diffuse_transmission.is_none() && e.iridescence.is_none() && e.anisotropy.is_none()
    };
    model.materials.iter().all(|material| shows(&material.extensions))
}

/// How often the maps of extensions are halved: as the finest of the others.
fn halvings_of_extensions(maps: &[LevelMap], choice: &[usize]) -> [usize; 2] {
    let halved = maps.iter().zip(choice).filter_map(|(map, &k)| match map.reductions[k] {
        Reduction::Halved(times) => Some(times),
        Reduction::Factor => None,
    });
    halved.min_by_key(|[u, v]| u + v).unwrap_or([2; 2])
}

/// All choices of one of so many for each place.
fn choices(counts: &[usize]) -> Vec<Vec<usize>> {
    counts.iter().fold(vec![Vec::new()], |all, &count| {
        let longer = |choice: &Vec<usize>| -> Vec<Vec<usize>> {
            (0..count).map(|k| choice.iter().copied().chain([k]).collect()).collect()
        };
        all.iter().flat_map(longer).collect()
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::{Clearcoat, Iridescence, Material, TextureSlot};
    use std::convert::Infallible;

    /// Protects textures of varnish and glass: where pictures show them they lose what nobody sees by themselves; where pictures
    /// do not show all of them, they keep as many texels as the finest map.
    #[test]
    fn images_of_extensions_are_reduced_by_what_pictures_show() {
        let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
        let mut material = Material { base_color_texture: slot(0), ..Material::default() };
        let coat = Clearcoat { factor: 1.0, texture: slot(1), ..Clearcoat::default() };
        material.extensions.clearcoat = Some(coat);
        let image = || Image::solid("map", 512, 512, [200; 4]);
        let mut model =
            Model { materials: vec![material], images: vec![image(), image()], ..Model::default() };
        // Every texel of the colours shows, and nothing of the coat.
        let psnr = |model: &Model| -> Result<f64, Infallible> {
            let colors =
                model.materials[0].base_color_texture.map_or(0, |slot| model.images[slot.image].width);
            Ok(if colors == 512 { 45.0 } else { 20.0 })
        };
        let sides = |model: &Model| {
            let reduced = with_fewer_texels(model, usize::MAX, &|| false, psnr).unwrap().unwrap();
            reduced.images.iter().map(|image| image.width).collect::<Vec<_>>()
        };
        assert_eq!(sides(&model), [512, 64]);
        let film = Iridescence { factor: 1.0, texture: slot(1), ..Iridescence::default() };
        model.materials[0].extensions.iridescence = Some(film);
        assert_eq!(sides(&model), [512, 512]);
    }

    /// Protects from choices that are forgotten.
    #[test]
    fn all_choices_are_weighed() {
        assert_eq!(choices(&[2, 1, 2]), [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 0, 1]]);
    }
}
