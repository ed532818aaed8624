//! A classical bake: the high-poly's materials and shape, projected onto the low-poly by rays. Nothing moves,
//! nothing is fitted.
//!
//! ```text
//! high ─ HighPoly ─────────────────────┐
//! low ─ normals ─ UVs ─ LowPoly ─ maps by rays ─┬ materials ─ Model
//!                                               └ maps of shape ─ pictures
//! ```

use crate::bake::conventions;
use crate::error::BakeError;
use crate::map_images::images;
use crate::options::UvMode;
pub use crate::raycast_options::{Match, RayNormals, RaycastOptions, RaycastUv};
use crate::report::layout_warning;
use crate::warnings::{Warnings, swapped};
use parbake_atlas::{UvCheck, check_mesh};
use parbake_files::NormalY;
use parbake_files::{FileError, Written, encode_png16};
use parbake_fit::baked_materials::Look;
use parbake_image::quantise::to_image;
use parbake_image::{FloatImage, MapKind};
use parbake_mesh::rigs::{carried, rigged};
use parbake_model::glam::Vec4;
use parbake_model::{Material, Model};
use parbake_progress::{Clock, Message, Stage, StageTime, Watcher};
use parbake_raycast::{Encoded, GeometryMap, cast_maps, encode};
use parbake_uv::surface::repair_uvs;
use parbake_views::alpha_layers::layer_kinds;
use parbake_views::high_poly::HighPoly;
use parbake_views::lost::lost;
use parbake_views::low_poly::{LowPoly, lit};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// A finished classical bake.
#[derive(Clone, Debug)]
pub struct Raycast {
    /// The low-poly with its textures.
    pub model: Model,
    /// The maps of shape that were asked for, in the order of [`GeometryMap::ALL`].
    pub pictures: Vec<ShapePicture>,
    /// What the run saw.
    pub report: RaycastReport,
}

/// A map of shape, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapePicture {
    /// Which map.
    pub map: GeometryMap,
    /// Its numbers, with +Y or −Y as the options say.
    pub encoded: Encoded,
}

impl ShapePicture {
    /// The picture as a 16-bit PNG, grey or RGB.
    ///
    /// # Errors
    /// Where it has no texels.
    pub fn png(&self) -> Result<Vec<u8>, FileError> {
        let Encoded { size, channels, samples, .. } = &self.encoded;
        encode_png16(self.map.name(), [*size; 2], *channels, samples)
    }
}

/// Figures of a run.
#[derive(Clone, Debug, Serialize)]
pub struct RaycastReport {
    /// What was asked for.
    pub options: RaycastOptions,
    /// Triangles of the high-poly.
    pub high_triangles: usize,
    /// Triangles of the low-poly.
    pub low_triangles: usize,
    /// Texels of which any sample lies on the surface.
    pub covered_texels: usize,
    /// Texels that several triangles claim.
    pub overlapping_texels: usize,
    /// Texels on the surface for most samples of which rays found nothing within `max_distance`; they took
    /// the closest point.
    pub missed_texels: usize,
    /// The check of the texture coordinates that are written.
    pub uv: UvCheck,
    /// The maps of shape.
    pub maps: Vec<ShapeMapReport>,
    /// What the written GLB file holds; none until it was written.
    pub written: Option<Written>,
    /// Seconds by stage.
    pub stages: Vec<StageTime>,
    /// What the user was warned of.
    pub warnings: Vec<String>,
    /// Peak resident memory of the process in bytes, where the system tells.
    pub peak_memory: Option<u64>,
}

/// A map of shape that was written.
#[derive(Clone, Debug, Serialize)]
pub struct ShapeMapReport {
    /// Which map.
    pub map: GeometryMap,
    /// Where it was written; none until then.
    pub file: Option<String>,
    /// What black stands for in each channel; lengths in the model's unit.
    pub black: Vec<f32>,
    /// What white stands for.
    pub white: Vec<f32>,
}

impl RaycastReport {
    /// Notes where a picture was written.
    pub fn note_file(&mut self, map: GeometryMap, path: &Path) {
        for own in self.maps.iter_mut().filter(|own| own.map == map) {
            own.file = Some(path.display().to_string());
        }
    }
}

/// Bakes the high-poly's materials, and maps of its shape, onto the low-poly by rays.
///
/// Runs on rayon's current thread pool.
///
/// # Errors
/// An option out of range; a model without extent; texture coordinates that are missing though they are to be
/// kept, have no area, or charts that do not fit into the texture; [`BakeError::Stopped`] where the watcher
/// asked to stop.
pub fn raycast(
    high: &Model,
    low: &Model,
    options: &RaycastOptions,
    watcher: &dyn Watcher,
) -> Result<Raycast, BakeError> {
    options.check()?;
    let mut clock = Clock::new(Instant::now());
    let mut warnings = Warnings::new(watcher);
    let size = options.texture_size;
    watcher.message(Message::Plan(vec![(Stage::Prepare, 1.0), (Stage::Start, 9.0)]));
    let bake = options.as_bake();
    let given = rigged(high, low);
    let high = HighPoly::new(high, conventions(&bake))?;
    warnings.tell(swapped(&high, low));
    let (delivered, of_normals) = lit(low);
    warnings.tell(of_normals);
    let mut low = delivered.clone();
    if options.uv_mode() != UvMode::Keep {
        let repaired = repair_uvs(&delivered, &bake.uv_stage())?;
        warnings.tell(repaired.repaired.iter().map(|done| format!("{}: {done}", low.name)));
        low.mesh = repaired.mesh;
        low.mesh.triangle_materials.fill(0);
        low.materials = vec![Material::default()];
    }
    let prepared = LowPoly::new(&low, &high.frame, size)?;
    warnings.tell(prepared.warnings.iter().cloned());
    let kinds = layer_kinds(&prepared.placed, &delivered, &high);
    clock.lap(Stage::Prepare);

    let cast = cast_maps(&prepared, &high, &options.cast(), watcher).ok_or(BakeError::Stopped)?;
    let look = Look::new(&high, &prepared, kinds, options.keep_sides);
    let mut maps = images(&cast.maps, high.conventions.srgb());
    if options.occlusion_texture {
        let own = cast.geometry.iter().find(|(map, _)| *map == GeometryMap::Occlusion);
        maps.retain(|(kind, _)| *kind != MapKind::Occlusion);
        maps.extend(own.map(|(_, image)| (MapKind::Occlusion, to_image(MapKind::Occlusion, image, true))));
    }
    let mut model = look.textured(&low, &prepared.written, maps, None);
    model.rig = carried(&given, &model.mesh);
    let wanted = options.pictures();
    let pictures: Vec<ShapePicture> = (cast.geometry.iter())
        .filter(|(map, _)| wanted.contains(map))
        .map(|(map, image)| {
            let image = directed(*map, image, options.normal_y);
            ShapePicture { map: *map, encoded: encode(*map, &image, &cast.known, &high.frame) }
        })
        .collect();
    clock.lap(Stage::Start);

    let unfit = match high.is_whole_material {
        true => look.extensions.lost.clone(),
        false => lost(high.extensions.materials()),
    };
    let unfit = unfit.into_iter().chain(high.changed.clone());
    warnings.tell(unfit.map(|text| format!("{}: {text}", high.name)));
    let uv = check_mesh(&prepared.written, size);
    warnings.tell(layout_warning(&low.name, &uv));
    let report = RaycastReport {
        options: options.clone(),
        high_triangles: high.triangles,
        low_triangles: low.mesh.triangles.len(),
        covered_texels: cast.known.iter().filter(|known| **known).count(),
        overlapping_texels: prepared.map.overlaps,
        missed_texels: cast.missed,
        uv,
        maps: pictures.iter().map(described).collect(),
        written: None,
        stages: clock.stages,
        warnings: warnings.told,
        peak_memory: crate::memory::peak_memory(),
    };
    Ok(Raycast { model, pictures, report })
}

fn described(picture: &ShapePicture) -> ShapeMapReport {
    let Encoded { black, white, .. } = &picture.encoded;
    ShapeMapReport { map: picture.map, file: None, black: black.clone(), white: white.clone() }
}

/// A map with its green channel as it is to be written.
fn directed(map: GeometryMap, image: &FloatImage<Vec4>, direction: NormalY) -> FloatImage<Vec4> {
    let mut image = image.clone();
    if map == GeometryMap::BentNormal && direction == NormalY::Down {
        image.texels.iter_mut().for_each(|texel| texel.y = -texel.y);
    }
    image
}
