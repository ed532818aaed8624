//! Fewer triangles where there is no time to compare pictures: edge collapses by quadrics alone.
//!
//! Contract: at most the wanted number of triangles, unless parts have to keep more or quadrics find nothing to collapse; each
//! part keeps what it has to.

use crate::shares::shares;
use crate::start::{CoarseSurfaces, append, counts_of_parts, only};
use parbake_model::Mesh;

/// A surface with `target` triangles at most. Each part, as of [`crate::surface::Surface::in_parts`], keeps `least` or all that
/// it has; with 0, small parts go first.
pub(crate) fn collapsed_at_once(surface: &Mesh, target: usize, parts: &[u32], least: usize) -> Mesh {
    if least == 0 {
        return CoarseSurfaces::new(surface, parts).collapsed_to(target);
    }
    let (found, begun): (Vec<u32>, Vec<usize>) = counts_of_parts(surface, parts).into_iter().unzip();
    let floors: Vec<usize> = begun.iter().map(|&count| count.min(least)).collect();
    let shares = shares(target, &begun, &floors);
    // Larger parts make up for smaller ones that cannot become as coarse as their share.
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by_key(|&index| shares[index]);
    let (mut out, mut excess) = (Mesh::default(), 0);
    for index in order {
        let own =
            only(surface, |material| parts.get(material as usize).copied().unwrap_or(0) == found[index]);
        let wanted = shares[index].saturating_sub(excess).max(floors[index]);
        let few = CoarseSurfaces::unpruned(&own).collapsed_to(wanted);
        let own = if few.triangles.len() < floors[index] { own } else { few };
        excess = (excess + own.triangles.len()).saturating_sub(shares[index]);
        append(&mut out, own);
    }
    out
}
