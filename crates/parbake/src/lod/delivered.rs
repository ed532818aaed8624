//! A level that starts from its model's own vertices, and keeps its layout and, where it can, its maps.
//!
//! Where a level keeps a good part of its model's triangles, a new layout has to repeat what an artist did: seams along
//! edges that are sharp or change colour, texels on the texels of the original. So two other ways compete:
//!
//! ```text
//! model ─ edges collapse, attributes follow (simplify_in_layout) ─┬ its maps, with fewer texels (scaled.rs) ─ Scaled
//!                                                                 └ layout repaired, maps fitted (a bake) ─── Delivered
//! ```
//!
//! Both compete with a new layout, and by pictures, in `ways.rs`.
//!
//! Contract: no level has more triangles than were asked for. A watcher that says stop is heeded between pictures.

use super::candidate::Way;
use super::chain::Chain;
use super::maker::{Draft, Maker};
use super::picture_score::PictureScore;
use crate::error::BakeError;
use crate::options::ShapeMode;
use parbake_levels::collapses::best_collapsed;
use parbake_levels::maps::with_maps_at_most;
use parbake_mesh::rigs::transferred;
use parbake_model::{Mesh, Model};
use std::time::Instant;

/// Texels of a map along a line for each pixel that the surface covers, at most.
const DENSITY: f64 = 4.0;

/// Whether levels may have the model's own vertices: it has a layout or needs none, and no option says where triangles have
/// to go.
pub(crate) fn may_keep_vertices(maker: &Maker) -> bool {
    let model = maker.model;
    let is_steered = model.parts.is_some() || !maker.high.importances.is_empty();
    // Without a layout nothing is lost by other vertices, and those of a rig that are chosen anew bend better.
    let has_layout = !model.mesh.uvs.is_empty() || (model.images.is_empty() && model.rig.is_none());
    !is_steered && has_layout
}

/// A bake of the model onto its own vertices, fewer of them; the texture's size follows the level's where none is given.
pub(crate) fn baked_draft(
    maker: &Maker,
    chain: &mut Chain,
    level: usize,
    own: &Coarser,
    texture_size: Option<usize>,
) -> Result<Draft, BakeError> {
    let begin = Instant::now();
    let mut low = Model { images: Vec::new(), ..own.model.clone() };
    low.mesh.tangents.clear();
    let watcher = chain.bake(level, 0, None);
    let baked = maker.baked(&low, (level, texture_size), Some(ShapeMode::Keep), None, &watcher)?;
    let seconds = [0.0, begin.elapsed().as_secs_f64(), 0.0];
    Ok(Draft {
        low: surface_of(&low),
        layers: Vec::new(),
        baked,
        way: Way::Delivered,
        candidates: Vec::new(),
        seconds,
    })
}

/// What a coarser level may start from.
pub(crate) fn surface_of(low: &Model) -> Model {
    let Mesh { positions, triangles, triangle_materials, .. } = &low.mesh;
    let mesh = Mesh {
        positions: positions.clone(),
        triangles: triangles.clone(),
        triangle_materials: triangle_materials.clone(),
        ..Mesh::default()
    };
    Model { mesh, materials: low.materials.clone(), ..Model::default() }
}

/// A model's own vertices, fewer of them, with its own materials.
pub(crate) struct Coarser {
    pub model: Model,
    /// PSNR in dB with maps that are finer than the level's.
    pub psnr: f64,
}

/// The model with at most `triangles` triangles and its own layout, by those collapses whose pictures show most
/// ([`best_collapsed`]). None where seams leave too many triangles. `side` is how many texels along a line its surface needs.
/// Without `searches` only a few ways are tried.
pub(crate) fn coarser(
    maker: &Maker,
    score: &PictureScore,
    triangles: usize,
    side: f64,
    searches: bool,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Coarser>, BakeError> {
    let model = maker.model;
    let look = with_maps_at_most(model, maker.power_of_two(DENSITY * side));
    let copies = score.copies(|mesh| Model { mesh, ..look.clone() });
    let best = best_collapsed(&model.mesh, triangles, searches, is_over, copies)?;
    // Pictures are of the model at rest.
    Ok(best.map(|(copy, psnr)| {
        let rig = transferred(model, &copy.mesh, &[]);
        Coarser { model: Model { mesh: copy.mesh, rig, ..look }, psnr }
    }))
}
