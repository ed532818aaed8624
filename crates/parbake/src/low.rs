//! The low-poly made ready for a bake: its tangent frames, and its texture's map.

use crate::error::BakeError;
use parbake_fit::atlas::Atlas;
use parbake_mesh::{TexelMap, charts, compute_tangents, ensure_normals, texel_map};
use parbake_model::{Mesh, Model, Placement};

/// Charts are grown by so many texels: bilinear fetches reach one, the rest is for
/// the borders of thin triangles.
const CHART_RINGS: usize = 2;

/// Texels that several triangles share are worth a word from this share on.
const OVERLAP_WORTH_A_WORD: f64 = 0.02;

/// A low-poly ready for a bake.
pub struct LowPoly {
    /// As it will be written: with unit normals and MikkTSpace tangents.
    pub written: Mesh,
    /// The same in the common frame.
    pub placed: Mesh,
    /// Which point of the surface each texel shows.
    pub map: TexelMap,
    /// Which texels belong together.
    pub atlas: Atlas,
    /// What the user should know of it.
    pub warnings: Vec<String>,
}

impl LowPoly {
    /// Prepares a model for a texture of `size`² texels.
    pub fn new(model: &Model, frame: &Placement, size: usize) -> Result<Self, BakeError> {
        let mut written = model.mesh.clone();
        if written.uvs.is_empty() {
            return Err(BakeError::NoTextureCoordinates { model: model.name.clone() });
        }
        let mut warnings = Vec::new();
        let repaired = ensure_normals(&mut written);
        if repaired > 0 && !model.mesh.normals.is_empty() {
            warnings.push(format!("{}: repaired {repaired} unusable normals", model.name));
        }
        // Tangents of the file may follow another convention than its future readers.
        compute_tangents(&mut written);
        let mut placed = written.clone();
        frame.apply(&mut placed);
        let map = texel_map(&placed, size);
        let atlas = Atlas::new(&map, &charts(&placed), CHART_RINGS);
        if !atlas.covered.contains(&true) {
            return Err(BakeError::FlatTextureCoordinates { model: model.name.clone() });
        }
        if map.overlaps as f64 > OVERLAP_WORTH_A_WORD * (size * size) as f64 {
            warnings.push(format!(
                "{}: {} texels are shared by several triangles and show a compromise; \
                 unwrap without overlaps to avoid that",
                model.name, map.overlaps
            ));
        }
        Ok(Self { written, placed, map, atlas, warnings })
    }
}
