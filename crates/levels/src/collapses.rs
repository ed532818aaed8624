//! A coarser copy of a mesh with its own layout: of many ways to collapse its edges, the one whose pictures are closest.
//!
//! How far seams may move, and how much normals and texture coordinates count beside positions, has no best answer for
//! all models. So a few ways are tried, each judged by pictures, and what lies beside the best ones.
//!
//! Contract: no more triangles than were asked for. Deterministic, as long as `is_over` says no; what was tried until it says
//! yes counts.

use crate::missed::{Lost, missed};
use crate::search::INVISIBLE;
use parbake_mesh::{Collapses, Seams, simplify_in_layout};
use parbake_model::Mesh;
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
/// How large meshes are collapsed first.
const BEGIN: Collapses = way(Seams::OfTextures, 0.5, 0.5, false, false);
const fn way(seams: Seams, normal_weight: f32, uv_weight: f32, moves: bool, evens: bool) -> Collapses {
    Collapses { seams, normal_weight, uv_weight, moves, evens }
}

/// Weights of normals and of texture coordinates that are tried around the best of these.
const NORMAL_WEIGHTS: [f32; 6] = [0.03, 0.1, 0.2, 0.3, 0.5, 1.0];
const UV_WEIGHTS: [f32; 4] = [0.05, 0.2, 0.5, 1.0];
/// Ways that are tried around the best one with the same seams, at most; only where that is at most so many decibels below
/// the best one of all, and that still shows what it lacks.
const MOST_SEARCHED: usize = 8;
const PROMISING: f64 = 2.0;
/// Vertices that are favoured at once, for each triangle; and how often more are, at most, without and with a search.
const FAVOURED_SHARE: f64 = 0.015;
const MOST_FAVOURED: [usize; 2] = [10, 16];
/// How many copies are judged without a search, at most.
pub const MOST_COPIES: usize = FIRST_WAYS + MOST_FAVOURED[0];

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

    /// Where pictures of a copy of `finer` differ from those of the original.
    fn lost(&mut self, made: &Self::Made, finer: &Mesh) -> Vec<Lost>;

    /// The mesh of a copy.
    fn mesh(made: &Self::Made) -> &Mesh;
}

/// The best copy so far, and what is known of others.
struct Search<'m, J: Judge> {
    judge: J,
    mesh: &'m Mesh,
    triangles: usize,
    most_favoured: usize,
    best: Option<Tried<J::Made>>,
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
    /// The copy that a way makes; none where it leaves too many triangles.
    fn copy(&self, way: Collapses, favoured: &[u32]) -> Option<Mesh> {
        let copy = simplify_in_layout(self.mesh, self.triangles, way, favoured);
        (!copy.triangles.is_empty() && copy.triangles.len() <= self.triangles).then_some(copy)
    }

    /// Tries a way.
    fn weigh(&mut self, way: Collapses) -> Result<(), J::Error> {
        let Some(copy) = self.copy(way, &[]) else {
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
        self.keep(Tried { made, way, favoured: Vec::new(), psnr });
        Ok(())
    }

    fn keep(&mut self, other: Tried<J::Made>) {
        if self.best.as_ref().is_none_or(|best| other.psnr > best.psnr) {
            self.best = Some(other);
        }
    }

    /// A copy of the same way that shows more: with vertices favoured that it misses most, a few more each time; where that shows
    /// less, half as many.
    fn favoured(
        &mut self,
        mut at: Tried<J::Made>,
        is_over: &dyn Fn() -> bool,
    ) -> Result<Tried<J::Made>, J::Error> {
        let missed_by = |judge: &mut J, mesh: &Mesh, at: &Tried<J::Made>| {
            missed(mesh, J::mesh(&at.made), &judge.lost(&at.made, mesh), &at.favoured)
        };
        let mut missing = missed_by(&mut self.judge, self.mesh, &at);
        let mut count = (self.triangles as f64 * FAVOURED_SHARE).ceil() as usize;
        for _ in 0..self.most_favoured {
            count = count.min(missing.len());
            if count == 0 || at.psnr >= INVISIBLE || is_over() {
                break;
            }
            let favoured: Vec<u32> = at.favoured.iter().chain(&missing[..count]).copied().collect();
            let copy = self.copy(at.way, &favoured).map(|copy| (fingerprint(&copy), copy));
            if let Some((fingerprint, copy)) = copy
                && !self.known.contains_key(&fingerprint)
            {
                let (made, psnr) = self.judge.judged(copy)?;
                self.known.insert(fingerprint, psnr);
                if psnr > at.psnr {
                    at = Tried { made, favoured, psnr, ..at };
                    missing = missed_by(&mut self.judge, self.mesh, &at);
                    continue;
                }
            }
            count /= 2;
        }
        Ok(at)
    }
}

/// The mesh with at most `triangles` triangles whose pictures are closest to the original's, as `judge` made it, with
/// its PSNR in dB. The best of six first ways, or with `searches` what a search from there finds, goes on with vertices where
/// pictures miss them. None where seams leave too many triangles.
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
    let most_favoured = MOST_FAVOURED[usize::from(searches)];
    let mut search = Search { judge, mesh: &fine, triangles, most_favoured, best: None, tried, known };
    // With all triangles there is nothing to choose.
    let has_choice = mesh.triangles.len() > triangles;
    for way in COLLAPSES.into_iter().take(if has_choice { COLLAPSES.len() } else { 1 }) {
        if is_over() {
            break;
        }
        search.weigh(way)?;
    }
    for seams in
        [Seams::Kept, Seams::OfTextures, Seams::Crossed].into_iter().filter(|_| has_choice && searches)
    {
        for _ in 0..MOST_SEARCHED {
            let Some(next) = next(&search.tried, seams).filter(|_| !is_over()) else { break };
            search.weigh(next)?;
        }
    }
    if has_choice && let Some(best) = search.best.take() {
        let other = searches.then(|| best_unlike(&search.tried, best.way, best.psnr)).flatten();
        search.best = Some(search.favoured(best, is_over)?);
        if let Some(way) = other.filter(|_| !is_over())
            && let Some(copy) = search.copy(way, &[])
        {
            let (made, psnr) = search.judge.judged(copy)?;
            let other = search.favoured(Tried { made, way, favoured: Vec::new(), psnr }, is_over)?;
            search.keep(other);
        }
    }
    Ok(search.best.map(|best| (best.made, best.psnr)))
}

/// The best way that was tried whose triangles are even where those of `way` are not, or the other way round; none where it is far
/// below `psnr`.
fn best_unlike(tried: &[(Collapses, f64)], way: Collapses, psnr: f64) -> Option<Collapses> {
    let unlike = tried.iter().filter(|(other, _)| other.evens != way.evens);
    unlike
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, own)| *own >= psnr - PROMISING)
        .map(|(other, _)| *other)
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
mod tests {
    use super::*;
    use parbake_model::glam::{vec2, vec3};

    /// Protects the search: it goes on from the best with the same seams, tries nothing twice, and leaves seams alone that show far
    /// less; it ends.
    #[test]
    fn the_search_climbs_from_the_best_with_the_same_seams() {
        let of = |seams| COLLAPSES.into_iter().find(|own| own.seams == seams).unwrap_or(BEGIN);
        let [kept, of_textures, crossed] = [Seams::Kept, Seams::OfTextures, Seams::Crossed].map(of);
        let mut tried = vec![(kept, 40.0), (of_textures, 45.0), (crossed, 44.0)];
        assert_eq!(next(&tried, Seams::Kept), None);
        assert_eq!(next(&[(kept, f64::NEG_INFINITY)], Seams::Kept), None);
        for (seams, best) in [(Seams::OfTextures, of_textures), (Seams::Crossed, crossed)] {
            let mut steps = 0;
            while let Some(found) = next(&tried, seams) {
                assert!(found.seams == seams && tried.iter().all(|(known, _)| *known != found));
                assert!(neighbours(best).contains(&found));
                tried.push((found, 43.5));
                steps += 1;
            }
            assert_eq!(steps, neighbours(best).len());
        }
        tried.push((Collapses { normal_weight: 1.0, ..crossed }, 46.0));
        assert_eq!(next(&tried, Seams::Crossed).map(|own| own.normal_weight), Some(1.0));
        tried.push((Collapses { normal_weight: 1.0, ..of_textures }, 61.0));
        assert_eq!(next(&tried, Seams::OfTextures), None);
    }

    /// Protects time: ways to collapse a large mesh share what they begin with, which still leaves much to choose from.
    #[test]
    fn large_meshes_are_collapsed_once_for_all_ways() {
        let (cells, mut mesh) = (40u32, Mesh::default());
        for (row, column) in (0..=cells).flat_map(|row| (0..=cells).map(move |column| (row, column))) {
            let (x, y) = (column as f32 / cells as f32, row as f32 / cells as f32);
            mesh.positions.push(vec3(x, y, 0.1 * (9.0 * x).sin() * (7.0 * y).cos()));
            mesh.uvs.push(vec2(x, y));
        }
        for (row, column) in (0..cells).flat_map(|row| (0..cells).map(move |column| (row, column))) {
            let a = row * (cells + 1) + column;
            mesh.triangles.extend([[a, a + 1, a + cells + 2], [a, a + cells + 2, a + cells + 1]]);
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        mesh.normals = parbake_mesh::smooth_normals(&mesh);
        assert!(matches!(begun(&mesh, mesh.triangles.len().div_ceil(MANY)), Cow::Borrowed(_)));
        let few = begun(&mesh, 10).triangles.len();
        assert!((320..=640).contains(&few), "{few}");
    }

    /// Finds all copies alike and lists them.
    struct Looks<'l>(&'l mut Vec<u64>);

    impl Judge for Looks<'_> {
        type Made = Mesh;
        type Error = ();

        fn judged(&mut self, copy: Mesh) -> Result<(Mesh, f64), ()> {
            self.0.push(fingerprint(&copy));
            Ok((copy, 30.0))
        }

        fn lost(&mut self, _: &Mesh, finer: &Mesh) -> Vec<Lost> {
            (0..finer.triangles.len() as u32)
                .map(|of_finer| Lost { of_copy: 0, of_finer, error: 1.0 })
                .collect()
        }

        fn mesh(made: &Mesh) -> &Mesh {
            made
        }
    }

    /// Protects time: a mesh that several ways make is looked at once, and one that is anyhow different is not taken for it.
    #[test]
    fn the_same_mesh_is_looked_at_once() {
        let mesh = Mesh {
            positions: vec![
                vec3(0.0, 0.0, 0.0),
                vec3(1.0, 0.0, 0.0),
                vec3(0.0, 1.0, 0.0),
                vec3(1.0, 1.0, 0.0),
            ],
            normals: vec![vec3(0.0, 0.0, 1.0); 4],
            uvs: vec![vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(1.0, 1.0)],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        let mut looked = Vec::new();
        let best = best_collapsed(&mesh, 1, true, &|| false, Looks(&mut looked));
        looked.sort_unstable();
        let count = looked.len();
        looked.dedup();
        assert!(
            count == looked.len() && count < FIRST_WAYS && best.is_ok_and(|best| best.is_some()),
            "{count}"
        );
        let mut other = mesh.clone();
        other.uvs[3].y += 1e-7;
        assert_ne!(fingerprint(&other), fingerprint(&mesh));
    }

    /// Protects it from weights that lie beside none.
    #[test]
    fn first_ways_have_weights_that_are_searched() {
        for own in COLLAPSES {
            assert!(NORMAL_WEIGHTS.contains(&own.normal_weight) && UV_WEIGHTS.contains(&own.uv_weight));
        }
    }
}
