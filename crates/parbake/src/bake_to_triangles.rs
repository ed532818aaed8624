//! A bake of a high-poly alone: its low-poly is made first (`low_poly.rs`), then both are baked (`bake.rs`).

use crate::bake::{Baked, prepare, run, told_before};
use crate::budget::left_out;
use crate::error::BakeError;
use crate::low_poly::{check_triangles, coarse_surfaces, low_poly};
use crate::options::BakeOptions;
use crate::warnings::for_plain_materials;
use crate::work::Work;
use parbake_mesh::parts::{with_kept_parts, with_parted_materials};
use parbake_model::Model;
use parbake_progress::Watcher;
use std::time::Instant;

/// Makes a low-poly of at most `triangles` triangles, chosen by its pictures, and bakes the high-poly's look onto
/// it. [`Baked::ray_cast`] has the same triangles.
///
/// # Errors
/// An option out of range; a model without extent; charts that do not fit into the texture; parts that are not there, or
/// too many for so few triangles.
pub fn bake_to_triangles(
    high: &Model,
    triangles: usize,
    options: &BakeOptions,
    watcher: &dyn Watcher,
) -> Result<Baked, BakeError> {
    options.check()?;
    let begin = Instant::now();
    let kept = with_kept_parts(high, &options.keep_parts)?;
    let high = &*with_parted_materials(&kept);
    let prepared = prepare(high, options)?;
    check_triangles(&prepared, high, triangles)?;
    let start = coarse_surfaces(&prepared, high);
    let is_whole = prepared.is_whole_material;
    let idle = is_whole.then(|| for_plain_materials(&prepared.name, options)).flatten();
    let told = left_out(options, Work::Bake, is_whole).into_iter().chain(idle).collect();
    told_before(told, watcher, || {
        let (low, _) = low_poly(&prepared, high, &start, None, triangles, options, watcher)?;
        run(&prepared, &low, Work::Level, true, options, watcher, begin)
    })
}
