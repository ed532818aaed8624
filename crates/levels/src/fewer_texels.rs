//! A model's own maps with fewer texels: how much each may lose is found by pictures.
//!
//! Each map is reduced by itself, step by step, until that shows; of all together the errors add up, nearly enough. Of all choices
//! within a number of texels, the one with the fewest is taken at which pictures look the same. Where there is none, maps are reduced
//! further, and the choice is taken whose pictures are closest.
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
/// A map that alone costs so many times the error that all may have is not reduced further. A factor is not tried where halving costs so
/// many times what may be lost.
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
    let reductions_of = |place: usize| match maps.get(place) {
        Some(map) => map.reductions.clone(),
        None => (0..=HALVINGS).map(|times| Reduction::Halved([times; 2])).collect(),
    };
    let reduced = |choice: &[usize]| -> Model {
        let reductions: Vec<Reduction> = maps.iter().zip(choice).map(|(map, &k)| map.reductions[k]).collect();
        let reduced = with_reductions(model, &maps, &reductions);
        with_halved_extensions(reduced, halvings_of_others(choice))
    };
    let unreduced = psnr(model)?;
    let whole = error_of(unreduced);
    let allowed = error_of((unreduced - UNSEEN).min(INVISIBLE));
    let cost = |place: usize, reduction: usize| -> Result<f64, E> {
        let mut choice = vec![0; places];
        choice[place] = reduction;
        Ok((error_of(psnr(&reduced(&choice))?) - whole).max(0.0))
    };
    let mut costs: Vec<Costs> = (0..places).map(|place| Costs::new(reductions_of(place))).collect();
    let measure = |costs: &mut [Costs], most: f64| -> Result<(), E> {
        for (some, first) in costs.chunks_mut(AT_ONCE).zip((0..).step_by(AT_ONCE)) {
            some.par_iter_mut().enumerate().try_for_each(|(k, own)| {
                own.measure(most, is_over, |reduction| cost(first + k, reduction))
            })?;
        }
        Ok(())
    };
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
    let best = |costs: &[Costs]| {
        let mut best: Option<(Rank, Vec<usize>)> = None;
        for choice in choices(&costs.iter().map(Costs::known).collect::<Vec<_>>()) {
            let of_maps = choice.iter().take(maps.len()).enumerate();
            let texels =
                of_maps.map(|(place, &k)| texels_of(place, k)).sum::<usize>() + texels_of_others(&choice);
            let of_choice = choice.iter().zip(costs).map(|(&k, own)| own.costs[k].unwrap_or(f64::INFINITY));
            let error = whole + of_choice.sum::<f64>();
            let is_seen = error > allowed;
            // Where something is lost anyway, the least; else the fewest texels.
            let rank =
                if is_seen { (true, error, texels as f64) } else { (false, texels.max(FREE) as f64, error) };
            if texels <= most && best.as_ref().is_none_or(|(least, _)| rank < *least) {
                best = Some((rank, choice));
            }
        }
        best
    };
    // What is seen by itself is not needed where enough else is unseen.
    measure(&mut costs, allowed - whole)?;
    let mut found = best(&costs);
    if found.as_ref().is_none_or(|(rank, _)| rank.0) {
        measure(&mut costs, HOPELESS * allowed)?;
        found = best(&costs);
    }
    Ok(found.map(|(_, choice)| reduced(&choice)))
}

/// Orders choices, the best first: whether a loss is seen; then the error where it is, the texels where not; then the other one of both.
type Rank = (bool, f64, f64);

/// What reductions of one map cost by themselves, as mean squared errors; of all maps together about the sum.
struct Costs {
    reductions: Vec<Reduction>,
    /// None where that is not known.
    costs: Vec<Option<f64>>,
}

impl Costs {
    fn new(reductions: Vec<Reduction>) -> Self {
        let costs = (0..reductions.len()).map(|k| (k == 0).then_some(0.0)).collect();
        Self { reductions, costs }
    }

    /// Measures what is not known yet. A reduction that leaves less than one which costs more than `most` is taken to cost more, too, and
    /// is left out. A factor is left out only beyond `HOPELESS` times that: it is the mean of what the surface shows, and may cost
    /// less than halved maps, which bleed from chart to chart.
    fn measure<E>(
        &mut self,
        most: f64,
        is_over: &(dyn Fn() -> bool + Sync),
        cost: impl Fn(usize) -> Result<f64, E>,
    ) -> Result<(), E> {
        for k in 1..self.reductions.len() {
            let limit = if self.reductions[k] == Reduction::Factor { HOPELESS * most } else { most };
            let is_worse = |other: usize| {
                self.costs[other].is_some_and(|cost| cost > limit)
                    && leaves_less(self.reductions[k], self.reductions[other])
            };
            if is_over() {
                break;
            }
            if self.costs[k].is_none() && !(0..k).any(is_worse) {
                self.costs[k] = Some(cost(k)?);
            }
        }
        Ok(())
    }

    /// Reductions whose costs are known.
    fn known(&self) -> Vec<usize> {
        (0..self.costs.len()).filter(|&k| self.costs[k].is_some()).collect()
    }
}

/// Whether a reduction leaves no more texels along either side than another one.
fn leaves_less(reduction: Reduction, than: Reduction) -> bool {
    match (reduction, than) {
        (Reduction::Factor, _) => true,
        (Reduction::Halved(_), Reduction::Factor) => false,
        (Reduction::Halved([u, v]), Reduction::Halved([other_u, other_v])) => u >= other_u && v >= other_v,
    }
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

/// All choices of one of these for each place.
fn choices(places: &[Vec<usize>]) -> Vec<Vec<usize>> {
    places.iter().fold(vec![Vec::new()], |all, some| {
        let longer = |choice: &Vec<usize>| -> Vec<Vec<usize>> {
            some.iter().map(|&k| choice.iter().copied().chain([k]).collect()).collect()
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
        let places = [vec![0, 3], vec![0], vec![0, 1]];
        assert_eq!(choices(&places), [[0, 0, 0], [0, 0, 1], [3, 0, 0], [3, 0, 1]]);
    }

    /// Protects time, and maps that are narrower than high: what leaves less than something that shows is not looked at, and all
    /// else is.
    #[test]
    fn what_is_worse_than_something_seen_is_not_measured() {
        let reductions = [[0, 0], [1, 0], [0, 1], [1, 1], [1, 2]].map(Reduction::Halved).to_vec();
        let mut costs = Costs::new([reductions, vec![Reduction::Factor]].concat());
        // Halving along u shows, along v it does not.
        let cost = |k: usize| -> Result<f64, Infallible> { Ok([0.0, 2.0, 0.1, 3.0, 4.0, 9.0][k]) };
        costs.measure(0.15, &|| false, cost).unwrap();
        assert_eq!(costs.costs, [Some(0.0), Some(2.0), Some(0.1), None, None, None]);
        assert_eq!(costs.known(), [0, 1, 2]);
        costs.measure(3.5, &|| false, cost).unwrap();
        // A factor does not bleed.
        assert_eq!(costs.costs, [0.0, 2.0, 0.1, 3.0, 4.0, 9.0].map(Some));
    }
}
