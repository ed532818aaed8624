//! Coarser copies of a model with its own materials: chosen by their pictures, for use as they are, or by their surface
//! alone.
//!
//! ```text
//! model ─┬ edges collapse in several ways, attributes follow (levels/collapses.rs) ─┬ the one with the closest pictures
//!        └ the copy whose surface is closest (mesh/simplify.rs) ────────────────────┘
//! ```
//!
//! A close surface may still look wrong: rounded edges and stretched textures do not change it.
//!
//! Contract: materials stay as they are, and a rig comes along. Deterministic.

use crate::copies::Copies;
use crate::models::with_tangents;
use parbake_evaluate::EvaluateError;
use parbake_evaluate::screen_size::{BLACK_AND_WHITE, ScreenComparison};
use parbake_levels::collapses::{Judge, MOST_COPIES, best_collapsed};
use parbake_levels::face_frames::with_face_tangents;
use parbake_levels::maps::with_maps_at_most;
use parbake_mesh::parts::{parts_of_materials, with_parted_materials};
use parbake_mesh::rigs::transferred;
use parbake_mesh::simplify::{SimplifyOptions, simplify};
use parbake_model::{Mesh, Model};
use parbake_progress::{Message, Stage, Watcher};

/// Pixels that a model spans in the pictures by which copies are compared.
const PIXELS: f64 = 256.0;
/// Texels along a side of the maps that these pictures show, at most: four for each pixel.
const TEXELS: usize = 1024;

/// A coarser copy of about this many triangles (at least 1) with the closest surface, whatever it looks like; with tangents
/// as [`with_tangents`] makes them.
pub fn simplified(model: &Model, triangles: usize) -> Model {
    let parted = with_parted_materials(model);
    with_tangents(copied(model, &parted, by_shape(&parted.mesh, triangles)))
}

/// A coarser copy whose pictures are as close as can be with the model's own maps, to be used as it is: at most so many triangles,
/// or about as many where seams leave no other way. It has tangents if the model has; else viewers make tangents up for both,
/// in the same way. A model with parallax maps gets the copy of [`simplified`], since such maps hold for vertices that stay in place.
/// A watcher that says stop is heeded between pictures; what was tried by then counts.
pub fn simplified_by_pictures(model: &Model, triangles: usize, watcher: &dyn Watcher) -> Model {
    let parted = with_parted_materials(model);
    let mesh = if model.mesh.triangles.len() <= triangles {
        parted.mesh.clone()
    } else if model.materials.iter().any(|material| material.parallax.is_some()) {
        by_shape(&parted.mesh, triangles)
    } else {
        // Without an extent there are no pictures, and nothing to choose from.
        closest_in_pictures(model, &parted, triangles, watcher)
            .unwrap_or_else(|_| by_shape(&parted.mesh, triangles))
    };
    with_tangents_as(model, copied(model, &parted, mesh))
}

/// The copy with tangents if the model has some.
fn with_tangents_as(model: &Model, copy: Model) -> Model {
    if model.mesh.tangents.is_empty() { copy } else { with_tangents(copy) }
}

/// Of all copies the one whose pictures are closest to the model's, in the mean on black and on white: on grey alone, a
/// bumpy outline of a grey model would cost nothing.
fn closest_in_pictures(
    model: &Model,
    parted: &Model,
    triangles: usize,
    watcher: &dyn Watcher,
) -> Result<Mesh, EvaluateError> {
    let screens = ScreenComparison::new(model);
    let original = screens.place(&with_face_tangents(model))?;
    let pictures = [screens.pictures_on(&original, PIXELS, BLACK_AND_WHITE)?];
    let look = with_maps_at_most(parted, TEXELS);
    let total = MOST_COPIES + 1;
    let mut done = 0;
    let mut finish = |mesh: Mesh| {
        watcher.message(Message::Progress { stage: Stage::Simplify, done, total });
        done += 1;
        with_tangents_as(model, Model { mesh, ..look.clone() })
    };
    let stops = || watcher.stopped();
    let copies = Copies::new(&screens, &pictures, &mut finish);
    let best = best_collapsed(&parted.mesh, triangles, false, &stops, copies)?;
    let by_shape = by_shape(&parted.mesh, triangles);
    let Some((copy, psnr)) = best else { return Ok(by_shape) };
    if by_shape.triangles.len() > triangles {
        return Ok(copy.mesh);
    }
    let (other, of_other) = Copies::new(&screens, &pictures, &mut finish).judged(by_shape)?;
    watcher.message(Message::Progress { stage: Stage::Simplify, done: total, total });
    Ok(if of_other > psnr { other.mesh } else { copy.mesh })
}

fn by_shape(mesh: &Mesh, triangles: usize) -> Mesh {
    simplify(mesh, SimplifyOptions { target_triangles: triangles, ..SimplifyOptions::default() })
}

/// The model with a coarser mesh of `parted`, which is the model with materials that tell its parts apart.
fn copied(model: &Model, parted: &Model, mut mesh: Mesh) -> Model {
    let rig = transferred(parted, &mesh, &parts_of_materials(parted));
    if parted.materials.len() > model.materials.len() {
        let mut original = vec![0; parted.materials.len()];
        for (&own, &before) in parted.mesh.triangle_materials.iter().zip(&model.mesh.triangle_materials) {
            original[own as usize] = before;
        }
        mesh.triangle_materials.iter_mut().for_each(|material| *material = original[*material as usize]);
    }
    Model { mesh, rig, nodes: None, painted: Vec::new(), parts: None, ..model.clone() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::models::demo_pair;
    use parbake_model::glam::{Vec3, vec2, vec4};
    use parbake_model::{Material, MaterialExtensions, TextureSlot, Transmission};

    /// Protects materials and what viewers need to show them.
    #[test]
    fn simplified_models_keep_their_materials() {
        let mut glass = Material { normal_texture: Some(TextureSlot::default()), ..Material::default() };
        let transmission = Some(Transmission { factor: 0.5, texture: None });
        glass.extensions = MaterialExtensions { transmission, ..MaterialExtensions::default() };
        let mut model = demo_pair().0;
        model.materials = vec![glass; model.materials.len()];
        let coarse = simplified(&model, 500);
        assert_eq!(coarse.materials, model.materials);
        assert_eq!(coarse.mesh.tangents.len(), coarse.mesh.positions.len());
    }

    const CELLS: u32 = 20;

    /// A flat sheet with a disc in the middle, both told apart by the colours of vertices: no collapse moves the surface, and
    /// most move the disc's edge.
    fn painted_sheet() -> Model {
        let mut mesh = Mesh::default();
        for (row, column) in (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| (row, column))) {
            let at = vec2(column as f32, row as f32) / CELLS as f32;
            mesh.positions.push((2.0 * at - 1.0).extend(0.0));
            mesh.normals.push(Vec3::Z);
            mesh.uvs.push(at);
            let is_inside = (at - 0.5).length() < 0.3;
            mesh.colors.push(if is_inside { vec4(0.9, 0.1, 0.1, 1.0) } else { vec4(0.1, 0.2, 0.8, 1.0) });
        }
        for (row, column) in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column))) {
            let a = row * (CELLS + 1) + column;
            mesh.triangles.extend([[a, a + 1, a + CELLS + 2], [a, a + CELLS + 2, a + CELLS + 1]]);
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        let materials = vec![Material { double_sided: true, ..Material::default() }];
        Model { name: "sheet".into(), mesh, materials, ..Model::default() }
    }

    fn psnr(model: &Model, copy: &Model) -> f64 {
        let screens = ScreenComparison::new(model);
        let pictures = screens.pictures(&screens.place(model).unwrap(), 128.0).unwrap();
        screens.psnr(&pictures, &screens.place(copy).unwrap())
    }

    /// Protects what a copy looks like: of surfaces that are equally close, the one is taken whose pictures are; it has no more
    /// triangles than were asked for.
    #[test]
    fn copies_by_pictures_look_like_their_model() {
        let model = painted_sheet();
        let (copy, by_shape) = (simplified_by_pictures(&model, 150, &()), simplified(&model, 150));
        assert!((50..=150).contains(&copy.mesh.triangles.len()), "{}", copy.mesh.triangles.len());
        let (own, other) = (psnr(&model, &copy), psnr(&model, &by_shape));
        assert!(own > other + 3.0, "{own} {other}");
    }

    /// Protects models that have no more triangles than were asked for: nothing of them changes.
    #[test]
    fn small_models_stay_as_they_are() {
        let model = painted_sheet();
        assert_eq!(simplified_by_pictures(&model, model.mesh.triangles.len(), &()), model);
    }

    /// Protects models of which there is no picture: nothing at all, and a surface without extent.
    #[test]
    fn models_without_extent_are_copied() {
        assert!(simplified_by_pictures(&Model::default(), 10, &()).mesh.triangles.is_empty());
        let mut point = painted_sheet();
        point.mesh.positions.fill(Vec3::ONE);
        let coarse = simplified_by_pictures(&point, 10, &());
        assert_eq!(coarse.mesh.triangles.len(), point.mesh.triangles.len());
    }
}
