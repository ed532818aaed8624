//! A coarser copy of a mesh with its own layout: of many ways to collapse its edges, the one whose pictures are closest.
//!
//! How far seams may move, and how much normals and texture coordinates count beside positions, has no best answer for
//! all models. So a few ways are tried, each judged by pictures, and what lies beside the best ones. The best one then
//! favours vertices where its pictures are wrong (`missed.rs`).
//!
//! Contract: no more triangles than were asked for. Deterministic, as long as `is_over` says no; what was tried until it says
//! yes counts.

use crate::missed::{Lost, missed};
use crate::search::INVISIBLE;
use parbake_mesh::{Collapses, Seams, simplify_in_layout};
use parbake_model::Mesh;
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// A model with more than so many triangles for each wanted one is first collapsed to a quarter of that number, once for all ways.
/// This saves time. What it costs: from 16 for each wanted one up to half a decibel was lost, from 64 it was not measured.
const MANY: usize = 256;
/// How many ways to collapse edges are tried first.
const FIRST_WAYS: usize = 6;
const COLLAPSES: [Collapses; FIRST_WAYS] = [
    way(Seams::Kept, 0.5, 0.2, true, true),
    way(Seams::OfTextures, 0.1, 0.5, true, false),
    way(Seams::OfTextures, 0.5, 0.5, true, false),
    way(Seams::OfTextures, 0.3, 0.2, false, true),
    way(Seams::Crossed, 0.1, 0.2, true, false),
    way(Seams::Crossed, 0.1, 0.5, true, true),
];
/// How many of these copies are made at once: each takes memory for the whole mesh.
const AT_ONCE: usize = 2;
/// How large meshes are collapsed first.
const BEGIN: Collapses = way(Seams::OfTextures, 0.5, 0.5, false, false);
const fn way(seams: Seams, normal_weight: f32, uv_weight: f32, moves: bool, evens: bool) -> Collapses {
    Collapses { seams, normal_weight, uv_weight, moves, evens }
}

/// Weights of normals and of texture coordinates that are tried around the best of these.
const NORMAL_WEIGHTS: [f32; 6] = [0.03, 0.1, 0.2, 0.3, 0.5, 1.0];
const UV_WEIGHTS: [f32; 4] = [0.05, 0.2, 0.5, 1.0];
/// Around the best way with the same seams others are tried, where it is at most so many decibels below the best one of all, and that
/// still shows what it lacks. Other copies are refined if they are not further below.
const PROMISING: f64 = 2.0;
/// Vertices that are favoured at once, for each triangle.
const FAVOURED_SHARE: f64 = 0.015;
/// Triangles from which on a mesh is large: each collapse of it takes long.
const LARGE: usize = 65_536;
/// How many copies are judged without a search, at most.
pub const MOST_COPIES: usize = FIRST_WAYS + Effort::WITHOUT_SEARCH.favoured;

/// How much is tried, at most.
#[derive(Clone, Copy)]
struct Effort {
    /// Ways around the best one with the same seams.
    searched: usize,
    /// Copies that are refined by favouring vertices.
    starts: usize,
    /// Tries for each of these.
    favoured: usize,
}

impl Effort {
    const WITHOUT_SEARCH: Self = Self { searched: 0, starts: 1, favoured: 10 };
    const WITHOUT_SEARCH_IN_LARGE_MESHES: Self = Self { searched: 0, starts: 1, favoured: 5 };
    const OF_SEARCH: Self = Self { searched: 4, starts: 2, favoured: 16 };
    const OF_SEARCH_IN_LARGE_MESHES: Self = Self { searched: 4, starts: 1, favoured: 8 };

    fn of(mesh: &Mesh, searches: bool) -> Self {
        match (searches, mesh.triangles.len() < LARGE) {
            (false, true) => Self::WITHOUT_SEARCH,
            (false, false) => Self::WITHOUT_SEARCH_IN_LARGE_MESHES,
            (true, true) => Self::OF_SEARCH,
            (true, false) => Self::OF_SEARCH_IN_LARGE_MESHES,
        }
    }
}

/// What judges copies of a mesh by their pictures.
pub trait Judge {
    /// What becomes of a copy.
    type Made;
    /// Why there are no pictures.
    type Error;

    /// Finishes a copy; with its PSNR in dB.
    ///
    /// # Errors
    /// Where it cannot be judged.
    fn judged(&mut self, copy: Mesh) -> Result<(Self::Made, f64), Self::Error>;

    /// Where pictures of a copy of `finer` differ from those of the original, by triangles of both; `finer` is the same each time.
    fn lost(&mut self, made: &Self::Made, finer: &Mesh) -> Vec<Lost>;

    /// The mesh of a copy.
    fn mesh(made: &Self::Made) -> &Mesh;
}

/// The best copies so far, and what is known of others.
struct Search<'m, J: Judge> {
    judge: J,
    mesh: &'m Mesh,
    triangles: usize,
    effort: Effort,
    /// The best copy whose triangles are as they come, and the best one whose triangles are even.
    best: [Option<Tried<J::Made>>; 2],
    tried: Vec<(Collapses, f64)>,
    /// Of few triangles many ways make the same, whose pictures are known.
    known: BTreeMap<u64, f64>,
}

/// A copy, how it was made, and its PSNR in dB.
struct Tried<T> {
    made: T,
    way: Collapses,
    favoured: Vec<u32>,
    psnr: f64,
}

impl<J: Judge> Search<'_, J> {
    /// Judges the copy that a way makes.
    fn weigh(&mut self, way: Collapses, copy: Option<Mesh>) -> Result<(), J::Error> {
        let Some(copy) = copy else {
            self.tried.push((way, f64::NEG_INFINITY));
            return Ok(());
        };
        let fingerprint = fingerprint(&copy);
        if let Some(&psnr) = self.known.get(&fingerprint) {
            self.tried.push((way, psnr));
            return Ok(());
        }
        let (made, psnr) = self.judge.judged(copy)?;
        self.known.insert(fingerprint, psnr);
        self.tried.push((way, psnr));
        let best = &mut self.best[usize::from(way.evens)];
        if best.as_ref().is_none_or(|best| psnr > best.psnr) {
            *best = Some(Tried { made, way, favoured: Vec::new(), psnr });
        }
        Ok(())
    }

    /// A copy of the same way whose pictures are closer: vertices are favoured that it misses most, a few more each time; where that
    /// shows less, half as many.
    fn refined(
        &mut self,
        mut at: Tried<J::Made>,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Tried<J::Made>, J::Error> {
        let mut count = (self.triangles as f64 * FAVOURED_SHARE).ceil() as usize;
        let mut missing: Option<Vec<u32>> = None;
        for _ in 0..self.effort.favoured {
            if at.psnr >= INVISIBLE || is_over() {
                break;
            }
            let missing_now = match &missing {
                Some(known) => known,
                None => {
                    let lost = self.judge.lost(&at.made, self.mesh);
                    missing.insert(missed(self.mesh, J::mesh(&at.made), &lost, &at.favoured))
                }
            };
            count = count.min(missing_now.len());
            if count == 0 {
                break;
            }
            let favoured: Vec<u32> = at.favoured.iter().chain(&missing_now[..count]).copied().collect();
            let copy = collapsed(self.mesh, self.triangles, at.way, &favoured);
            let copy = copy.map(|copy| (fingerprint(&copy), copy));
            if let Some((fingerprint, copy)) = copy
                && !self.known.contains_key(&fingerprint)
            {
                let (made, psnr) = self.judge.judged(copy)?;
                self.known.insert(fingerprint, psnr);
                if psnr > at.psnr {
                    at = Tried { made, favoured, psnr, ..at };
                    missing = None;
                    continue;
                }
            }
            count /= 2;
        }
        Ok(at)
    }
}

/// The mesh with at most `triangles` triangles whose pictures are closest to the original's, as `judge` made it, with
/// its PSNR in dB. The best of six first ways, or with `searches` the best two that a search from there finds, are refined: vertices are
/// favoured where pictures are wrong. None where seams leave too many triangles.
///
/// # Errors
/// Those of `judge`.
pub fn best_collapsed<J: Judge>(
    mesh: &Mesh,
    triangles: usize,
    searches: bool,
    is_over: &dyn Fn() -> bool,
    judge: J,
) -> Result<Option<(J::Made, f64)>, J::Error> {
    let fine = begun(mesh, triangles);
    let (tried, known) = (Vec::new(), BTreeMap::new());
    let effort = Effort::of(&fine, searches);
    let mut search = Search { judge, mesh: &fine, triangles, effort, best: [None, None], tried, known };
    // With all triangles there is nothing to choose.
    let has_choice = mesh.triangles.len() > triangles;
    let first = if has_choice { &COLLAPSES[..] } else { &COLLAPSES[..1] };
    for ways in first.chunks(AT_ONCE) {
        if is_over() {
            break;
        }
        let copies: Vec<_> = ways.par_iter().map(|&way| collapsed(&fine, triangles, way, &[])).collect();
        for (&way, copy) in ways.iter().zip(copies) {
            if !is_over() {
                search.weigh(way, copy)?;
            }
        }
    }
    for seams in [Seams::Kept, Seams::OfTextures, Seams::Crossed].into_iter().filter(|_| has_choice) {
        for _ in 0..effort.searched {
            let Some(next) = next(&search.tried, seams).filter(|_| !is_over()) else { break };
            let copy = collapsed(&fine, triangles, next, &[]);
            search.weigh(next, copy)?;
        }
    }
    let mut starts: Vec<_> = std::mem::take(&mut search.best).into_iter().flatten().collect();
    starts.sort_by(|a, b| b.psnr.total_cmp(&a.psnr));
    let least = starts.first().map_or(0.0, |best| best.psnr - PROMISING);
    starts.truncate(effort.starts);
    let mut best: Option<Tried<J::Made>> = None;
    for start in starts.into_iter().filter(|start| start.psnr >= least) {
        if best.as_ref().is_some_and(|best| best.psnr >= INVISIBLE) {
            break;
        }
        let other = if has_choice { search.refined(start, is_over)? } else { start };
        if best.as_ref().is_none_or(|best| other.psnr > best.psnr) {
            best = Some(other);
        }
    }
    Ok(best.map(|best| (best.made, best.psnr)))
}

/// The copy that a way makes; none where it leaves too many triangles.
fn collapsed(mesh: &Mesh, triangles: usize, way: Collapses, favoured: &[u32]) -> Option<Mesh> {
    let copy = simplify_in_layout(mesh, triangles, way, favoured);
    (!copy.triangles.is_empty() && copy.triangles.len() <= triangles).then_some(copy)
}

/// A number that meshes share whose triangles and vertices are the same to the bit.
fn fingerprint(mesh: &Mesh) -> u64 {
    let Mesh {
        positions,
        normals,
        tangents,
        uvs,
        uvs1,
        colors,
        parallax_offsets,
        triangles,
        triangle_materials,
    } = mesh;
    let mut hasher = DefaultHasher::new();
    for values in [positions, normals, parallax_offsets] {
        values.iter().for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    for values in [tangents, colors] {
        values.iter().for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    for values in [uvs, uvs1] {
        values.iter().for_each(|v| v.to_array().map(f32::to_bits).hash(&mut hasher));
    }
    (triangles, triangle_materials).hash(&mut hasher);
    hasher.finish()
}

/// The mesh that all ways to collapse to so many triangles begin with: `mesh`, or a coarser one ([`MANY`]).
fn begun(mesh: &Mesh, triangles: usize) -> Cow<'_, Mesh> {
    if mesh.triangles.len() <= MANY * triangles {
        return Cow::Borrowed(mesh);
    }
    let coarser = simplify_in_layout(mesh, MANY / 4 * triangles, BEGIN, &[]);
    if coarser.triangles.is_empty() { Cow::Borrowed(mesh) } else { Cow::Owned(coarser) }
}

/// What to try after all that was, with these seams: what is beside the best one. None where others are far better, nothing is left
/// to be gained, or all beside it were tried.
fn next(tried: &[(Collapses, f64)], seams: Seams) -> Option<Collapses> {
    let best =
        |own: &mut dyn Iterator<Item = &(Collapses, f64)>| own.copied().max_by(|a, b| a.1.total_cmp(&b.1));
    let (_, most) = best(&mut tried.iter())?;
    let (own, psnr) = best(&mut tried.iter().filter(|(own, _)| own.seams == seams))?;
    let is_known = |other: &Collapses| tried.iter().any(|(known, _)| known == other);
    (psnr.is_finite() && psnr >= most - PROMISING && most < INVISIBLE)
        .then(|| neighbours(own).into_iter().find(|other| !is_known(other)))
        .flatten()
}

/// Collapses with the same seams that differ in one thing, by a step.
fn neighbours(own: Collapses) -> Vec<Collapses> {
    let moved = Collapses { moves: !own.moves, ..own };
    let evened = Collapses { evens: !own.evens, ..own };
    let normals = beside(&NORMAL_WEIGHTS, own.normal_weight).into_iter();
    let uvs = beside(&UV_WEIGHTS, own.uv_weight).into_iter();
    (uvs.map(|uv_weight| Collapses { uv_weight, ..own }))
        .chain(normals.map(|normal_weight| Collapses { normal_weight, ..own }))
        .chain([moved, evened])
        .collect()
}

/// The weights beside one of `weights`.
fn beside(weights: &[f32], own: f32) -> Vec<f32> {
    let place = weights.iter().position(|&weight| weight == own).unwrap_or(0);
    (0..weights.len()).filter(|k| k.abs_diff(place) == 1).map(|k| weights[k]).collect()
}

#[cfg(test)]
#[path = "collapses_tests.rs"]
mod tests;
