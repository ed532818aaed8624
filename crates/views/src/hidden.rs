//! Parts of a model that no view from outside shows, such as a motor inside its housing. Levels of detail leave them out: their
//! triangles and texels would show nothing.
//!
//! A part is a connected piece of the mesh. It is seen if one of its triangles is seen at one sample of 64 views around the model,
//! with about a sample for each pixel of the largest level. What is behind glass, a mask or a blended surface is seen, and so is
//! what lies behind the back of a single-sided triangle, which viewers do not draw: rooms without a ceiling, open shells.
//!
//! Contract: only geometry and materials count, no texture is looked at. Parts are left out or kept as wholes, so no hole is torn into a
//! surface. Parts that are smaller than a sample, or deep in a narrow opening, may be missed.

use crate::error::PrepareError;
use crate::frame::common_frame;
use crate::pool::{Rig, view_pool};
use parbake_image::material_maps::transmits;
use parbake_mesh::union_find::UnionFind;
use parbake_mesh::vertices::drop_unused;
use parbake_mesh::weld_by_position;
use parbake_model::glam::Vec3;
use parbake_model::{AlphaMode, Material, Mesh, Model};
use parbake_render::camera::{Camera, Projection};
use parbake_render::on_screen::Raster;
use parbake_render::raster::{NOTHING, ScreenTriangles, Visibility};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Views that look for parts.
const VIEWS: usize = 64;
/// Least and most pixels along a side of a view, and how many for each pixel that the model's longest side spans: it fills 1 / 1.4 of a view.
const SIZES: [f64; 2] = [768.0, 2048.0];
const SIZE_A_PIXEL: f64 = 1.4;
/// Far enough to look into openings about as a player would.
const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };

/// A model without its hidden parts, and what was left out.
pub struct WithoutHidden {
    /// What is seen. Vertices that no triangle has are gone, unless the model has a rig.
    pub model: Model,
    /// Parts that are hidden, and all parts.
    pub parts: [usize; 2],
    /// Triangles that are hidden, and all triangles.
    pub triangles: [usize; 2],
}

/// The model without hidden parts; none where all are seen. `pixels` is how many its longest side spans in the largest picture that
/// it is for; parts that are smaller than a pixel there may be missed.
///
/// # Errors
/// A model without extent.
pub fn without_hidden(model: &Model, pixels: f64) -> Result<Option<WithoutHidden>, PrepareError> {
    let part_of = parts(&model.mesh);
    let all: BTreeSet<u32> = part_of.iter().copied().collect();
    if all.len() < 2 {
        return Ok(None);
    }
    let mut mesh = Mesh {
        positions: model.mesh.positions.clone(),
        triangles: model.mesh.triangles.clone(),
        triangle_materials: model.mesh.triangle_materials.clone(),
        ..Mesh::default()
    };
    common_frame(model)?.apply(&mut mesh);
    let material = |triangle: usize| &model.materials[mesh.triangle_materials[triangle] as usize];
    let lets_through: Vec<bool> = model.materials.iter().map(is_looked_through).collect();
    let is_solid = |triangle: usize| !lets_through[mesh.triangle_materials[triangle] as usize];
    let size = (SIZE_A_PIXEL * pixels).clamp(SIZES[0], SIZES[1]) as usize;
    let views = view_pool(VIEWS, &RIG, 0);
    let found = views.par_iter().map(|view| {
        let drawn = |triangle: &usize| {
            let t = *triangle;
            is_solid(t) && (material(t).double_sided || !shows_its_back(&mesh, &view.camera, t))
        };
        let drawn: Vec<u32> = (0..mesh.triangles.len()).filter(drawn).map(|t| t as u32).collect();
        let corners: Vec<[u32; 3]> = drawn.iter().map(|&t| mesh.triangles[t as usize]).collect();
        let mut seen = Visibility::default();
        let screen = ScreenTriangles::new(&mesh.positions, &corners, &view.camera, size);
        screen.rasterise(size, (0.0, 0.0), None, &mut seen);
        let shown = seen.triangle.iter().filter(|&&t| t != NOTHING);
        shown.map(|&t| part_of[drawn[t as usize] as usize]).collect::<BTreeSet<u32>>()
    });
    let mut seen = found.reduce(BTreeSet::new, |a, b| &a | &b);
    seen.extend((0..mesh.triangles.len()).filter(|&t| !is_solid(t)).map(|t| part_of[t]));
    // Where no part is seen, nothing is known.
    if seen.is_empty() || seen.len() == all.len() {
        return Ok(None);
    }
    let kept: Vec<bool> = part_of.iter().map(|part| seen.contains(part)).collect();
    let mut without = model.clone();
    without.retain_triangles(&kept);
    if without.rig.is_none() {
        drop_unused(&mut without.mesh);
    }
    let hidden = kept.iter().filter(|kept| !**kept).count();
    let parts = [all.len() - seen.len(), all.len()];
    Ok(Some(WithoutHidden { model: without, parts, triangles: [hidden, part_of.len()] }))
}

/// For each triangle the part that it belongs to.
fn parts(mesh: &Mesh) -> Vec<u32> {
    let welded = weld_by_position(&mesh.positions);
    let mut sets = UnionFind::new(mesh.positions.len());
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|vertex| welded[vertex as usize]);
        sets.union(a, b);
        sets.union(b, c);
    }
    mesh.triangles.iter().map(|corners| sets.find(welded[corners[0] as usize])).collect()
}

/// Whether something behind a material may show.
fn is_looked_through(material: &Material) -> bool {
    material.alpha_mode != AlphaMode::Opaque || transmits(material) || material.parallax.is_some()
}

fn shows_its_back(mesh: &Mesh, camera: &Camera, triangle: usize) -> bool {
    let corner: Vec3 = mesh.positions[mesh.triangles[triangle][0] as usize];
    camera.view_direction(corner).dot(mesh.area_normal(triangle)) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three cubes, one in the other, each of a material: half-sizes 1, 0.5 and 0.25.
    fn cubes(change: impl Fn(&mut [Material])) -> Model {
        let mut mesh = Mesh::default();
        for (material, half) in [1.0f32, 0.5, 0.25].into_iter().enumerate() {
            let first = mesh.positions.len() as u32;
            let corner =
                |k: u32| Vec3::from([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { half } else { -half }));
            mesh.positions.extend((0..8).map(corner));
            let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
            for [a, b, c, d] in faces.map(|face: [u32; 4]| face.map(|v| v + first)) {
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
            mesh.triangle_materials.resize(mesh.triangles.len(), material as u32);
        }
        let mut materials = vec![Material { double_sided: true, ..Material::default() }; 3];
        change(&mut materials);
        Model { mesh, materials, ..Model::default() }
    }

    fn kept(model: &Model) -> Vec<u32> {
        let found = without_hidden(model, 300.0).expect("it has an extent");
        let mesh = found.map_or(model.mesh.clone(), |found| found.model.mesh);
        let materials: BTreeSet<u32> = mesh.triangle_materials.into_iter().collect();
        materials.into_iter().collect()
    }

    /// Protects triangles from being spent on what nobody sees, and all that is seen through glass, a mask, a blended
    /// surface, the back of a single-sided one, or an opening.
    #[test]
    fn what_is_inside_goes_unless_it_shows() {
        let mut closed = cubes(|_| ());
        closed.painted = [[0.5; 12], [1.0; 12], [0.0; 12]].concat();
        let found = without_hidden(&closed, 300.0).expect("it has an extent").expect("two cubes are hidden");
        assert_eq!((found.parts, found.triangles), ([2, 3], [24, 36]));
        assert_eq!(found.model.mesh.positions, closed.mesh.positions[..8]);
        assert_eq!(found.model.painted, [0.5; 12]);
        assert_eq!(kept(&closed), [0]);
        assert_eq!(kept(&cubes(|m| m[0].alpha_mode = AlphaMode::Blend)), [0, 1]);
        assert_eq!(kept(&cubes(|m| m[0].alpha_mode = AlphaMode::Mask)), [0, 1]);
        let mut inside_out = cubes(|m| m[0].double_sided = false);
        inside_out.mesh.triangles[..12].iter_mut().for_each(|t| t.swap(1, 2));
        assert_eq!(kept(&inside_out), [0, 1], "a room without a ceiling");
        let mut open = closed.clone();
        (open.mesh.triangles, open.mesh.triangle_materials) =
            (closed.mesh.triangles[2..].to_vec(), closed.mesh.triangle_materials[2..].to_vec());
        assert_eq!(kept(&open), [0, 1]);
        let mut alone = closed.clone();
        alone.mesh.triangles.truncate(12);
        alone.mesh.triangle_materials.truncate(12);
        assert!(without_hidden(&alone, 300.0).expect("it has an extent").is_none());
    }
}
