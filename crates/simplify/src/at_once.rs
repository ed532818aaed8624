//! Fewer triangles where there is no time to compare pictures: edge collapses by quadrics alone.
//!
//! Contract: at most the wanted number of triangles, unless parts have to keep more; each part keeps what it has to.

use crate::shares::shares;
use crate::start::{CoarseSurfaces, append, counts_of_parts, only};
use parbake_model::Mesh;

/// A surface with `target` triangles at most. Each part, as of [`crate::surface::Surface::in_parts`], keeps `least` or all that
/// it has; with 0, small parts go first.
pub(crate) fn collapsed_at_once(surface: &Mesh, target: usize, parts: &[u32], least: usize) -> Mesh {
    if least == 0 {
        return CoarseSurfaces::new(surface, parts).collapsed_to(target);
    }
    let (parts_found, begun): (Vec<u32>, Vec<usize>) = counts_of_parts(surface, parts).into_iter().unzip();
    let floors: Vec<usize> = begun.iter().map(|&count| count.min(least)).collect();
    let mut out = Mesh::default();
    for (part, (share, floor)) in
        parts_found.into_iter().zip(shares(target, &begun, &floors).into_iter().zip(floors))
    {
        let own = only(surface, |material| parts.get(material as usize).copied().unwrap_or(0) == part);
        let few = CoarseSurfaces::unpruned(&own).collapsed_to(share);
        let own = if few.triangles.len() < floor { own } else { few };
        append(&mut out, own);
    }
    out
}
