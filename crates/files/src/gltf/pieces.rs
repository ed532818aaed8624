//! What of a model is a mesh of its own in a file: each part that stays apart, in the space of its node, and the rest,
//! in the model's.
//!
//! Where positions are on a grid, all rests share one, so that levels of detail agree where they are alike; each part
//! has its own.
//!
//! Contract: without parts there is one piece for each level, the level itself.

use super::quantise::Grid;
use super::write_mesh::picked;
use parbake_model::glam::{DAffine3, Vec3};
use parbake_model::{Hierarchy, Mesh, Model};
use std::borrow::Cow;

/// A mesh of its own.
pub struct Piece<'m> {
    /// Its triangles, with the materials of its level.
    pub model: Cow<'m, Model>,
    /// Index of its level.
    pub level: usize,
    /// Index of its node among those of the level's parts; none for the rest.
    pub node: Option<usize>,
    /// By how much its node enlarges it.
    pub scale: f32,
    /// The grid of its positions, where they are on one.
    pub grid: Option<Grid>,
}

impl Piece<'_> {
    /// The length of its positions' unit in the model.
    pub fn unit(&self) -> f32 {
        self.scale * self.grid.as_ref().map_or(1.0, Grid::unit)
    }

    /// The largest distance of a position from where it is shown.
    pub fn error(&self) -> f64 {
        let error = self.grid.as_ref().map_or(0.0, |grid| grid.error(&self.model.mesh.positions));
        error * f64::from(self.scale)
    }
}

/// The pieces of all levels, level by level, each level's rest first.
pub fn pieces<'m>(levels: &[&'m Model], on_grids: bool) -> Vec<Piece<'m>> {
    let mut pieces: Vec<Piece<'m>> =
        levels.iter().enumerate().flat_map(|(index, level)| of_level(index, level)).collect();
    if on_grids {
        let rests = || pieces.iter().filter(|piece| piece.node.is_none());
        let all: Vec<Vec3> = rests().flat_map(|rest| rest.model.mesh.positions.iter().copied()).collect();
        let shared = (!all.is_empty()).then(|| Grid::of(&all));
        for piece in &mut pieces {
            piece.grid = match piece.node {
                None => shared,
                Some(_) => Some(Grid::of(&piece.model.mesh.positions)),
            };
        }
    }
    pieces
}

fn of_level(level: usize, model: &Model) -> Vec<Piece<'_>> {
    let whole = |model| Piece { model, level, node: None, scale: 1.0, grid: None };
    let Some(parts) = &model.parts else { return vec![whole(Cow::Borrowed(model))] };
    let piece = |mesh: Mesh| Model {
        name: model.name.clone(),
        mesh,
        materials: model.materials.clone(),
        ..Model::default()
    };
    let rest = chosen(model, parts, Hierarchy::NONE).map(|mesh| whole(Cow::Owned(piece(mesh))));
    let worlds = parts.worlds();
    let of_node = |node: usize| {
        let mut mesh = chosen(model, parts, node as u32)?;
        bring_into(&mut mesh, &worlds[node]);
        let mut model = piece(mesh);
        model.name.clone_from(&parts.nodes[node].name);
        let scale = worlds[node].matrix3.determinant().abs().cbrt() as f32;
        Some(Piece { model: Cow::Owned(model), level, node: Some(node), scale, grid: None })
    };
    rest.into_iter().chain((0..parts.nodes.len()).filter_map(of_node)).collect()
}

/// The triangles that hang on a node, on vertices of their own.
fn chosen(model: &Model, parts: &Hierarchy, node: u32) -> Option<Mesh> {
    let mesh = &model.mesh;
    let is_own = |triangle: &usize| parts.of_triangles.get(*triangle) == Some(&node);
    let own: Vec<usize> = (0..mesh.triangles.len()).filter(is_own).collect();
    let mut vertices: Vec<u32> = own.iter().flat_map(|&triangle| mesh.triangles[triangle]).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut places = vec![0; mesh.positions.len()];
    for (place, &vertex) in (0..).zip(&vertices) {
        places[vertex as usize] = place;
    }
    let triangles = own.iter().map(|&triangle| mesh.triangles[triangle].map(|v| places[v as usize]));
    let triangle_materials = own.iter().map(|&triangle| mesh.triangle_materials[triangle]);
    (!own.is_empty()).then(|| Mesh {
        triangles: triangles.collect(),
        triangle_materials: triangle_materials.collect(),
        ..picked(mesh, &vertices)
    })
}

/// From the model's space into that of a node, which has a size.
fn bring_into(mesh: &mut Mesh, world: &DAffine3) {
    if *world == DAffine3::IDENTITY {
        return;
    }
    let (inverse, turned) = (world.inverse(), world.matrix3.transpose());
    let is_mirrored = world.matrix3.determinant() < 0.0;
    for position in &mut mesh.positions {
        *position = inverse.transform_point3(position.as_dvec3()).as_vec3();
    }
    for offset in &mut mesh.parallax_offsets {
        *offset = inverse.transform_vector3(offset.as_dvec3()).as_vec3();
    }
    for normal in &mut mesh.normals {
        *normal = (turned * normal.as_dvec3()).normalize_or_zero().as_vec3();
    }
    for tangent in &mut mesh.tangents {
        let along = inverse.transform_vector3(tangent.truncate().as_dvec3()).normalize_or_zero().as_vec3();
        *tangent = along.extend(if is_mirrored { -tangent.w } else { tangent.w });
    }
    if is_mirrored {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
}
