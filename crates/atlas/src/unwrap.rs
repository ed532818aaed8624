//! Unwrapping: a new layout for any mesh, with or without texture coordinates.
//!
//! `unwrap/flatten.rs` cuts the surface into charts and lays them flat, `unwrap/long.rs` cuts those
//! that are too long for the square, `unwrap/sound.rs` takes out what is at fault, decided exactly, and packs.

pub(crate) mod corners;
mod dead;
pub(crate) mod flatten;
pub(crate) mod long;
pub(crate) mod sound;

use crate::{AtlasError, ChartScale, PackOptions};
use corners::{Corners, NONE, Surface};
use glam::DVec2;
use parbake_model::Mesh;

/// What [`unwrap()`] aims at.
#[derive(Clone, Debug, PartialEq)]
pub struct UnwrapOptions {
    /// Texture size, gutter and packing. All charts get the same number of texels per
    /// unit of surface; `chart_scale` is not looked at.
    pub pack: PackOptions,
    /// The largest angle between a triangle's normal and its chart's mean normal, in
    /// degrees, between 0 and 90. Less means flatter charts and more seams.
    pub max_chart_angle: f32,
}

impl Default for UnwrapOptions {
    fn default() -> Self {
        Self { pack: PackOptions::default(), max_chart_angle: 70.0 }
    }
}

/// A mesh with a new layout.
#[derive(Clone, Debug, PartialEq)]
pub struct UnwrappedMesh {
    /// The triangles in their order; vertices are split where seams run and those that no
    /// triangle uses are gone. All attributes are carried along but the tangents, which
    /// belonged to the layout before: there are none.
    pub mesh: Mesh,
    /// For each of the mesh's V vertices the index of the vertex that it was.
    pub source: Vec<u32>,
}

/// Makes a layout without mirrored or overlapping triangles for any mesh, however
/// degenerate its triangles, non-manifold its edges or many its pieces.
///
/// Triangles without area in space get none in the texture and lie on an edge of a
/// neighbour; if they have none, on a corner of some triangle.
///
/// # Errors
///
/// [`AtlasError::InvalidOption`], and [`AtlasError::NoRoom`] where the charts' gutters
/// need more than the whole texture.
pub fn unwrap(mesh: &Mesh, options: &UnwrapOptions) -> Result<UnwrappedMesh, AtlasError> {
    if !(options.max_chart_angle > 0.0 && options.max_chart_angle < 90.0) {
        return Err(AtlasError::InvalidOption { name: "max_chart_angle", wanted: "between 0 and 90" });
    }
    let surface = Surface::new(mesh);
    let count = mesh.triangles.len();
    let mut corners = Corners { uv: vec![[DVec2::ZERO; 3]; count], chart: vec![NONE; count], next: 0 };
    let live: Vec<u32> = (0..count as u32).filter(|&t| surface.is_live(t as usize)).collect();
    flatten::flatten(&surface, &mut corners, &live, options.max_chart_angle);
    let pack = PackOptions { chart_scale: ChartScale::Equal, ..options.pack.clone() };
    long::cut_across(&surface, &mut corners, &pack.chart_scale);
    let corners = sound::settled(&surface, corners, &pack)?;
    let (mesh, source) = surface.mesh_with(&corners);
    Ok(UnwrappedMesh { mesh, source })
}
