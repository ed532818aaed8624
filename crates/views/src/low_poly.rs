//! The low-poly made ready for a bake: its tangent frames, and its texture's map.

use crate::chart_labels::Atlas;
use crate::error::PrepareError;
use parbake_mesh::{
    TexelMap, charts, compute_tangents, ensure_normals, face_outwards, material_uvs, texel_map,
};
use parbake_model::{Bounds, Mesh, Model, Placement};

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

/// A copy of a model without its images, whose vertex normals are of unit length and look to no face's
/// back, and what the user should know of it.
pub fn lit(model: &Model) -> (Model, Vec<String>) {
    let Model { name, mesh, materials, .. } = model;
    let mut model =
        Model { name: name.clone(), mesh: mesh.clone(), materials: materials.clone(), ..Model::default() };
    // They belong to maps of an earlier bake.
    model.mesh.parallax_offsets.clear();
    let had = !model.mesh.normals.is_empty();
    let repaired = ensure_normals(&mut model.mesh);
    let turned = face_outwards(&mut model.mesh);
    let mut warnings = Vec::new();
    if had && repaired > 0 {
        warnings.push(format!("{}: repaired {repaired} unusable normals", model.name));
    }
    if had && turned > 0 {
        warnings.push(format!(
            "{}: {turned} of {} triangles had a vertex normal that points to their back side, which renders \
             black; it was turned",
            model.name,
            model.mesh.triangles.len()
        ));
    }
    (model, warnings)
}

impl LowPoly {
    /// Prepares a model for a texture of `size`² texels.
    pub fn new(model: &Model, frame: &Placement, size: usize) -> Result<Self, PrepareError> {
        let mut written = model.mesh.clone();
        written.uvs = material_uvs(&model.mesh, &model.materials);
        if written.uvs.is_empty() {
            return Err(PrepareError::NoTextureCoordinates { model: model.name.clone() });
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
        warnings.extend(misplaced(model, &placed));
        let map = texel_map(&placed, size);
        let atlas = Atlas::new(&map, &charts(&placed), CHART_RINGS);
        if !atlas.covered.contains(&true) {
            return Err(PrepareError::FlatTextureCoordinates { model: model.name.clone() });
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

    /// The same as parallax maps show it: vertices with their offsets. Normals and tangents stay, for a file has one set.
    ///
    /// # Errors
    /// As of [`LowPoly::new`].
    pub fn for_parallax(model: &Model, frame: &Placement, size: usize) -> Result<Self, PrepareError> {
        let mut low = Self::new(model, frame, size)?;
        low.placed.apply_parallax_offsets();
        Ok(low)
    }
}

/// A low-poly is as large as its high-poly within this factor, and its centre lies
/// within half of the high-poly's box.
const SIZE_FACTOR: f32 = 1.5;

/// A word about a low-poly that is not where its high-poly is: in the common frame
/// the high-poly's longest side is 2 and its centre the origin.
fn misplaced(model: &Model, placed: &Mesh) -> Option<String> {
    let bounds = Bounds::of(placed)?;
    let factor = bounds.size().max_element() / 2.0;
    let away = ((bounds.min + bounds.max) * 0.5).length();
    let fits = (1.0 / SIZE_FACTOR..=SIZE_FACTOR).contains(&factor) && away <= 0.5;
    (!fits).then(|| {
        format!(
            "{}: it is {factor:.3} times as large as the high-poly and lies {:.0} % of its length away; \
             both should have the same unit, origin and axes",
            model.name,
            50.0 * away
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects low-polys of other tools: what would be black is turned and told of, and what is sound
    /// or was never given is not worth a word.
    #[test]
    fn normals_that_look_back_are_turned() {
        let mesh = parbake_mesh::demo_low(&parbake_mesh::demo_model());
        let sound = Model { mesh, ..Model::default() };
        assert!(lit(&sound).1.is_empty());
        let mut turned = sound.clone();
        ensure_normals(&mut turned.mesh);
        turned.mesh.normals.iter_mut().for_each(|n| *n = -*n);
        turned.mesh.parallax_offsets = turned.mesh.positions.clone();
        let (repaired, warnings) = lit(&turned);
        assert!(warnings.len() == 1 && warnings[0].contains("points to their back side"), "{warnings:?}");
        assert!(repaired.mesh.parallax_offsets.is_empty(), "an earlier bake's");
        for (index, triangle) in repaired.mesh.triangles.iter().enumerate() {
            let face = repaired.mesh.area_normal(index);
            let looks_back = |&v: &u32| repaired.mesh.normals[v as usize].dot(face) < 0.0;
            assert!(!triangle.iter().any(looks_back), "triangle {index}");
        }
    }
}
