//! From an OBJ file's separate lists to a mesh of split vertices.
//!
//! A vertex is made for each distinct triple of position, texture coordinate and
//! normal, in order of first use. Texture coordinates are turned to v down:
//! `(u, 1 − v)`. Where some corners have a normal and others none, the latter get
//! their triangle's.

use super::corner::{Corner, NONE};
use super::statements::Statements;
use crate::FileError;
use crate::Place;
use crate::context::Context;
use crate::words::count;
use parbake_model::Mesh;
use parbake_model::glam::{Vec2, Vec4};
use std::collections::HashMap;

/// Vertices at one position are looked for one by one up to here, then by hash:
/// a file whose every corner shares one position must not take quadratic time.
const LONGEST_CHAIN: usize = 16;

/// Builds the mesh. Material indices are those of `Statements::material_names`.
pub(super) fn assemble(mut statements: Statements, context: &Context<'_>) -> Result<Mesh, FileError> {
    let (with_texture, with_normal, all) = uses(&statements);
    if with_texture > 0 && with_texture < all {
        let corners = count(all - with_texture, "face corner");
        context.warn(format!("took (0, 0) for {corners} without a texture coordinate"));
    }
    if with_normal > 0 && with_normal < all {
        fill_normals(&mut statements);
    }
    let (triangles, corners) = split(&statements, context)?;
    let positions = corners.iter().map(|c| statements.positions[c[0] as usize]).collect();
    let (mut normals, mut uvs, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    if with_normal > 0 {
        normals = corners.iter().map(|c| statements.normals[c[2] as usize]).collect();
    }
    if with_texture > 0 {
        let uv = |c: &Corner| statements.texcoords.get(c[1] as usize);
        let turned = |c: &Corner| uv(c).map_or(Vec2::ZERO, |t| Vec2::new(t.x as f32, (1.0 - t.y) as f32));
        uvs = corners.iter().map(turned).collect();
    }
    if !statements.colors.is_empty() {
        let linear = linear_colors(&statements.colors, context);
        colors = corners.iter().map(|c| linear.get(c[0] as usize).copied().unwrap_or(Vec4::ONE)).collect();
    }
    let triangle_materials = statements.triangle_materials;
    Ok(Mesh { positions, normals, uvs, colors, triangles, triangle_materials, ..Mesh::default() })
}

/// How many corners have a texture coordinate, how many a normal, how many there are.
fn uses(statements: &Statements) -> (usize, usize, usize) {
    let mut counts = (0, 0, 0);
    for corner in statements.triangles.iter().flatten() {
        counts.0 += usize::from(corner[1] != NONE);
        counts.1 += usize::from(corner[2] != NONE);
        counts.2 += 1;
    }
    counts
}

fn fill_normals(statements: &mut Statements) {
    for triangle in &mut statements.triangles {
        if triangle.iter().all(|c| c[2] != NONE) {
            continue;
        }
        let [a, b, c] = triangle.map(|c| statements.positions[c[0] as usize].as_dvec3());
        let index = statements.normals.len() as u32;
        statements.normals.push((b - a).cross(c - a).normalize_or_zero().as_vec3());
        for corner in triangle.iter_mut().filter(|c| c[2] == NONE) {
            corner[2] = index;
        }
    }
}

/// Vertices as corners of the file, and triangles of them.
#[allow(clippy::type_complexity)]
fn split(statements: &Statements, context: &Context<'_>) -> Result<(Vec<[u32; 3]>, Vec<Corner>), FileError> {
    let mut finder = Finder {
        heads: vec![NONE; statements.positions.len()],
        nexts: Vec::new(),
        corners: Vec::new(),
        crowded: HashMap::new(),
    };
    let mut triangles = Vec::with_capacity(statements.triangles.len());
    for triangle in &statements.triangles {
        triangles.push(triangle.map(|corner| finder.find(corner)));
    }
    let limit = context.limits.max_vertices as u64;
    context.within(Place::File, "vertices", finder.corners.len() as u64, limit)?;
    Ok((triangles, finder.corners))
}

/// Finds the vertex of a corner: a chain of vertices hangs on each position.
struct Finder {
    heads: Vec<u32>,
    nexts: Vec<u32>,
    corners: Vec<Corner>,
    crowded: HashMap<Corner, u32>,
}

impl Finder {
    #[inline]
    fn find(&mut self, corner: Corner) -> u32 {
        let mut vertex = self.heads[corner[0] as usize];
        let mut length = 0;
        while vertex != NONE && length < LONGEST_CHAIN {
            if self.corners[vertex as usize] == corner {
                return vertex;
            }
            vertex = self.nexts[vertex as usize];
            length += 1;
        }
        // `Statements` holds at most 2³⁰ triangles: their corners fit below NONE.
        let new = self.corners.len() as u32;
        if length == LONGEST_CHAIN {
            // Chains do not grow past their longest: the rest is found by hash.
            if let Some(&vertex) = self.crowded.get(&corner) {
                return vertex;
            }
            self.crowded.insert(corner, new);
            self.nexts.push(NONE);
        } else {
            self.nexts.push(std::mem::replace(&mut self.heads[corner[0] as usize], new));
        }
        self.corners.push(corner);
        new
    }
}

/// From colours as written to linear ones.
///
/// Programs that write colours after positions write what they show: sRGB, from
/// 0 to 1 (MeshLab, ZBrush) or, in a few, to 255.
fn linear_colors(colors: &[Vec4], context: &Context<'_>) -> Vec<Vec4> {
    let largest = colors.iter().map(|c| c.truncate().max_element()).fold(0.0, f32::max);
    let scale = if largest > 1.0 { 1.0 / 255.0 } else { 1.0 };
    if largest > 1.0 {
        context.warn("vertex colours go beyond 1 and are taken to go up to 255");
    }
    let convert = |&c: &Vec4| {
        if c == Vec4::NEG_ONE {
            return Vec4::ONE;
        }
        let channel = |x: f32| super::srgb::decode(f64::from(x * scale).clamp(0.0, 1.0)) as f32;
        Vec4::new(
            channel(c.x),
            channel(c.y),
            channel(c.z),
            if c.w > 1.0 { c.w * scale } else { c.w.max(0.0) },
        )
    };
    colors.iter().map(convert).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Textures;
    use crate::obj::statements;
    use crate::{Limits, NoResources};
    use parbake_model::glam::Vec3;
    use std::path::Path;

    fn run(text: &str) -> (Mesh, Vec<crate::Warning>) {
        let limits = Limits::default();
        let context = Context::new(Path::new("a.obj"), &NoResources, &limits, Textures::Decode);
        let statements = statements::read(text.as_bytes(), &context).unwrap();
        (assemble(statements, &context).unwrap(), context.into_warnings())
    }

    const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";

    /// Protects the split by triples in order of first use, and the flip of v.
    #[test]
    fn vertices_split_in_order_of_first_use() {
        let (mesh, _) = run(&format!("{CORNERS}vt 0 0.25\nvt 1 0\nf 3/1 1/1 2/1\nf 3/1 2/2 1/1"));
        assert_eq!(mesh.positions, [Vec3::Y, Vec3::ZERO, Vec3::X, Vec3::X]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 1]]);
        assert_eq!(mesh.uvs[0], Vec2::new(0.0, 0.75));
        assert_eq!(mesh.uvs[3], Vec2::new(1.0, 1.0));
        assert!(mesh.normals.is_empty() && mesh.colors.is_empty());
    }

    /// Protects partly given attributes: face normals, zero coordinates and a warning.
    #[test]
    fn missing_attributes_are_filled() {
        let text = format!("{CORNERS}vt 1 0\nvn 1 0 0\nf 1/1/1 2/1/1 3/1/1\nf 2 4 3");
        let (mesh, warnings) = run(&text);
        assert_eq!(mesh.normals[0], Vec3::X);
        assert_eq!(mesh.normals[mesh.triangles[1][0] as usize], Vec3::Z);
        assert_eq!(mesh.uvs[mesh.triangles[1][0] as usize], Vec2::ZERO);
        assert!(warnings[0].text.contains("3 face corners"), "{warnings:?}");
    }

    /// Protects speed and correctness where one position has thousands of vertices.
    #[test]
    fn crowded_positions_are_found() {
        let mut text = CORNERS.to_string();
        for i in 0..3000 {
            text += &format!("vt {i} 0\n");
        }
        for _ in 0..2 {
            for i in 1..=3000 {
                text += &format!("f 1/{i} 2 3\n");
            }
        }
        let (mesh, _) = run(&text);
        assert_eq!(mesh.positions.len(), 3002);
        assert_eq!(mesh.triangles[17], mesh.triangles[3017]);
    }

    /// Protects the meaning of vertex colours: sRGB, to 1 or to 255, white if absent.
    #[test]
    fn vertex_colours_become_linear() {
        let (mesh, _) = run("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0\nf 1 2 3");
        assert!((mesh.colors[0] - Vec4::new(1.0, 0.214_041, 0.0, 1.0)).length() < 1e-5);
        assert_eq!(mesh.colors[2], Vec4::ONE);
        let (mesh, warnings) = run("v 0 0 0 255 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3");
        assert_eq!(mesh.colors[0], Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(warnings.len(), 1);
    }
}
