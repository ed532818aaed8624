//! The proof of a model's texture coordinates: one layout for each base colour picture.
//!
//! Triangles of different pictures may have the same coordinates without harm, so each
//! picture's triangles are a layout by themselves, with the coordinates that their
//! material reads it with. A model without any such picture, before its bake, is one
//! layout; in one with pictures, triangles that read none are counted and left out.

use crate::{Layout, UvCheck, check};
use parbake_mesh::material_uvs;
use parbake_model::{Mesh, Model};
use serde::Serialize;
use std::collections::BTreeMap;

/// What [`check_model`] found out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelCheck {
    /// The model's name.
    pub model: String,
    /// Whether there are no problems at all.
    pub sound: bool,
    /// The gutter that was asked for, in texels; 0 for none.
    pub gutter_asked: f64,
    /// Triangles that read no base colour picture in a model where others do. They are
    /// not checked.
    pub triangles_without_picture: usize,
    /// The layouts, in the order of the model's pictures.
    pub layouts: Vec<LayoutCheck>,
    /// What is wrong with the model as a whole, in sentences.
    pub problems: Vec<String>,
}

/// One layout of a model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutCheck {
    /// The base colour picture's name; `None` for a model without pictures.
    pub picture: Option<String>,
    /// Its index among the model's images.
    #[serde(skip)]
    pub picture_index: Option<usize>,
    /// Materials that read the picture, by name.
    pub materials: Vec<String>,
    /// What the check found. Triangles have the model's indices; charts are numbered in
    /// the order of this layout's triangles.
    pub uv: UvCheck,
    /// What is wrong, in sentences: those of the check, and one about the gutter.
    pub problems: Vec<String>,
}

/// Texels along a side in which lengths are given where there is neither a picture nor a wish: the
/// default size of a bake.
pub const DEFAULT_SIZE: usize = 512;

/// Checks the texture coordinates of a model's base colour.
///
/// `texture_size` is the number of texels along either side in which lengths are given;
/// `None` for the shorter side of each picture, and for the default size of a bake where
/// there is none. A gutter between charts below `gutter` texels is a problem, unless
/// that is 0; so are missing texture coordinates.
///
/// Runs on rayon's current thread pool.
pub fn check_model(model: &Model, texture_size: Option<usize>, gutter: f64) -> ModelCheck {
    let mut found = ModelCheck {
        model: model.name.clone(),
        sound: false,
        gutter_asked: gutter,
        triangles_without_picture: 0,
        layouts: Vec::new(),
        problems: Vec::new(),
    };
    if model.mesh.uvs.is_empty() && model.mesh.uvs1.is_empty() {
        found.problems.push("The model has no texture coordinates.".into());
        return found;
    }
    let mut by_picture: BTreeMap<Option<usize>, Vec<u32>> = BTreeMap::new();
    for triangle in 0..model.mesh.triangles.len() {
        by_picture.entry(picture_of(model, triangle)).or_default().push(triangle as u32);
    }
    if by_picture.len() > 1 {
        found.triangles_without_picture = by_picture.remove(&None).map_or(0, |triangles| triangles.len());
    }
    for (picture, triangles) in by_picture {
        let image = picture.and_then(|index| model.images.get(index));
        let own_size = image.map(|image| image.width.min(image.height));
        let size = texture_size.or(own_size).unwrap_or(DEFAULT_SIZE);
        let mut uv = check_mesh(&unshared(model, &triangles), size);
        rename_triangles(&mut uv, &triangles);
        let mut problems = uv.problems();
        problems.extend(narrow_gutter(&uv, gutter));
        found.layouts.push(LayoutCheck {
            picture: image.map(|image| image.name.clone()),
            picture_index: picture,
            materials: material_names(model, &triangles),
            uv,
            problems,
        });
    }
    found.sound = found.layouts.iter().all(|layout| layout.problems.is_empty());
    found
}

/// Checks the first set of texture coordinates of a mesh, as one layout.
pub fn check_mesh(mesh: &Mesh, texture_size: usize) -> UvCheck {
    check(&Layout::new(mesh), texture_size)
}

/// The picture that a triangle's base colour is read from.
fn picture_of(model: &Model, triangle: usize) -> Option<usize> {
    let material = model.materials.get(*model.mesh.triangle_materials.get(triangle)? as usize)?;
    material.base_color_texture.map(|slot| slot.image).filter(|&image| image < model.images.len())
}

/// These triangles alone, each with corners of its own: materials that move the same
/// vertex to different places of a picture do not meet. A [`Layout`] welds them.
fn unshared(model: &Model, triangles: &[u32]) -> Mesh {
    let mesh = &model.mesh;
    let corners: Vec<usize> =
        triangles.iter().flat_map(|&t| mesh.triangles[t as usize]).map(|v| v as usize).collect();
    let taken = |uvs: &[_]| match uvs {
        [] => Vec::new(),
        uvs => corners.iter().map(|&v| uvs[v]).collect(),
    };
    let mut alone = Mesh {
        positions: corners.iter().map(|&v| mesh.positions[v]).collect(),
        uvs: taken(&mesh.uvs),
        uvs1: taken(&mesh.uvs1),
        triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        triangle_materials: triangles.iter().map(|&t| mesh.triangle_materials[t as usize]).collect(),
        ..Mesh::default()
    };
    alone.uvs = material_uvs(&alone, &model.materials);
    alone
}

/// Gives the triangles that a check names their indices in the model.
fn rename_triangles(uv: &mut UvCheck, triangles: &[u32]) {
    let o = &mut uv.orientations;
    let lists =
        [&mut o.flipped, &mut o.degenerate, &mut o.without_surface, &mut o.outside, &mut o.not_finite];
    let named = lists.into_iter().flat_map(|found| &mut found.first);
    for index in named.chain(uv.overlaps.first.iter_mut().flat_map(|overlap| &mut overlap.triangles)) {
        *index = triangles[*index as usize];
    }
}

fn material_names(model: &Model, triangles: &[u32]) -> Vec<String> {
    let mut materials: Vec<u32> =
        triangles.iter().map(|&t| model.mesh.triangle_materials[t as usize]).collect();
    materials.sort_unstable();
    materials.dedup();
    materials.iter().filter_map(|&m| model.materials.get(m as usize)).map(|m| m.name.clone()).collect()
}

/// A sentence about a gutter that is smaller than asked for.
fn narrow_gutter(uv: &UvCheck, asked: f64) -> Option<String> {
    let gutter = uv.gutter.as_ref().filter(|gutter| gutter.texels < asked)?;
    let ([a, b], [x, y]) = (gutter.charts, gutter.place);
    let least = if gutter.complete { "" } else { "perhaps only " };
    Some(format!(
        "Charts {a} and {b} are {least}{:.2} texels apart near ({x:.4}, {y:.4}); {asked} are asked for.",
        gutter.texels
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec2, Vec3, vec2};
    use parbake_model::{Image, Material, TextureSlot, UvTransform};

    /// Squares of two triangles beside each other in space, each with the whole texture
    /// for its own in set 0, and a material that reads this picture through a transform.
    fn squares(slots: &[Option<(usize, UvTransform)>]) -> Model {
        let mut model = Model { name: "squares".into(), ..Model::default() };
        for (i, slot) in slots.iter().enumerate() {
            let first = 4 * i as u32;
            for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                model.mesh.positions.push(Vec3::new(x + 2.0 * i as f32, y, 0.0));
                model.mesh.uvs.push(vec2(x, 1.0 - y));
            }
            model.mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            model.mesh.triangle_materials.extend([i as u32; 2]);
            let slot =
                slot.map(|(image, transform)| TextureSlot { image, transform, ..TextureSlot::default() });
            let material = Material { base_color_texture: slot, ..Material::default() };
            model.materials.push(Material { name: format!("material {i}"), ..material });
        }
        model.images = vec![Image::solid("red", 64, 32, [0; 4]), Image::solid("blue", 8, 16, [0; 4])];
        model
    }

    fn half(offset: f32) -> UvTransform {
        UvTransform { offset: vec2(offset, 0.0), scale: vec2(0.4, 0.8), ..UvTransform::default() }
    }

    /// Protects models of several pictures, in which the same coordinates do no harm.
    #[test]
    fn each_picture_is_a_layout() {
        let whole = UvTransform::default();
        let found = check_model(&squares(&[Some((1, whole)), None, Some((0, whole))]), None, 2.0);
        assert!(found.sound, "{found:?}");
        let of = |i: usize| (found.layouts[i].picture.as_deref(), found.layouts[i].uv.texture_size);
        assert_eq!((of(0), of(1)), ((Some("red"), 32), (Some("blue"), 8)));
        assert_eq!(found.layouts[0].materials, ["material 2"]);
        assert_eq!((found.layouts.len(), found.triangles_without_picture), (2, 2));
    }

    /// Protects the other side: on one picture they do, and triangles keep their names.
    #[test]
    fn two_materials_of_one_picture_can_overlap() {
        let whole = UvTransform::default();
        let found = check_model(&squares(&[Some((1, whole)), Some((0, whole)), Some((0, whole))]), None, 0.0);
        assert!(!found.sound && found.layouts[1].problems.is_empty());
        let overlaps = &found.layouts[0].uv.overlaps;
        assert_eq!(overlaps.first[0].triangles, [2, 4]);
        assert!(found.layouts[0].problems[0].contains("2 and 4"), "{:?}", found.layouts[0].problems);
    }

    /// Protects the coordinates as materials read them, and the gutter that was asked for.
    #[test]
    fn transforms_and_gutters_count() {
        let model = squares(&[Some((0, half(0.0))), Some((0, half(0.5)))]);
        let found = check_model(&model, Some(100), 9.0);
        assert!(found.sound, "{found:?}");
        assert!((found.layouts[0].uv.gutter.as_ref().unwrap().texels - 10.0).abs() < 1e-4);
        let found = check_model(&model, Some(100), 11.0);
        assert!(!found.sound && found.layouts[0].uv.is_bijective());
        assert_eq!(
            found.layouts[0].problems,
            ["Charts 0 and 1 are 10.00 texels apart near (0.4500, 0.8000); 11 are asked for."]
        );
    }

    /// Protects vertices that two materials move to different places.
    #[test]
    fn shared_vertices_are_read_by_each_material() {
        let mut model = squares(&[Some((0, half(0.0)))]);
        model.materials.push(Material {
            base_color_texture: Some(TextureSlot { transform: half(0.5), ..TextureSlot::default() }),
            ..Material::default()
        });
        model.mesh.triangle_materials[1] = 1;
        let found = check_model(&model, None, 0.0);
        assert!(found.sound, "{found:?}");
        assert_eq!(found.layouts[0].uv.charts, 2);
    }

    /// Protects models before their bake, and those without texture coordinates.
    #[test]
    fn models_without_pictures_or_coordinates() {
        let mut model = squares(&[None]);
        let found = check_model(&model, None, 0.0);
        assert!(found.sound && found.layouts[0].picture.is_none());
        assert_eq!(found.layouts[0].uv.texture_size, DEFAULT_SIZE);
        model.mesh.uvs1 = vec![Vec2::ZERO; 4];
        model.mesh.uvs.clear();
        assert!(!check_model(&model, None, 0.0).sound);
        model.mesh.uvs1.clear();
        let found = check_model(&model, None, 0.0);
        assert!(!found.sound && found.layouts.is_empty() && found.problems.len() == 1);
    }
}
