//! Charts in other tiles of a repeated texture, brought home.
//!
//! A texture that repeats shows the same in every unit square of the plane, so a chart may move by
//! whole tiles and shows what it showed, texel by texel.

use crate::layout::Layout;
use glam::DVec2;
use parbake_model::Mesh;
use parbake_model::glam::Vec2;

/// Texture coordinates whose charts were moved by whole tiles into [0, 1]²; None where one reaches
/// across a tile's border, and where there are none or some that are not finite.
pub fn in_one_tile(mesh: &Mesh) -> Option<Vec<Vec2>> {
    if mesh.uvs.is_empty() || !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        return None;
    }
    let layout = Layout::new(mesh);
    let count = layout.charts.iter().max().map_or(0, |last| *last as usize + 1);
    let mut boxes = vec![[DVec2::MAX, DVec2::MIN]; count];
    for (t, chart) in layout.charts.iter().enumerate() {
        let [low, high] = &mut boxes[*chart as usize];
        for p in layout.corners(t) {
            (*low, *high) = (low.min(p), high.max(p));
        }
    }
    let tiles: Vec<DVec2> = boxes
        .iter()
        .map(|[low, high]| {
            let tile = low.floor();
            ((*high - tile).max_element() <= 1.0).then_some(tile)
        })
        .collect::<Option<_>>()?;
    let mut uvs = mesh.uvs.clone();
    for (t, chart) in layout.charts.iter().enumerate() {
        for vertex in mesh.triangles[t] {
            let home = mesh.uvs[vertex as usize].as_dvec2() - tiles[*chart as usize];
            uvs[vertex as usize] = home.as_vec2();
        }
    }
    Some(uvs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec3, vec2};

    /// A square of two triangles from `low` to `high`.
    fn add(mesh: &mut Mesh, low: Vec2, high: Vec2) {
        let first = mesh.positions.len() as u32;
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            mesh.positions.push(Vec3::new(x, y, first as f32));
            mesh.uvs.push(low + vec2(x, y) * (high - low));
        }
        mesh.triangles.extend([[first, first + 3, first + 1], [first + 1, first + 3, first + 2]]);
        mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    }

    /// Protects what a chart shows: it moves by whole tiles only, those at home stay to the bit, and
    /// one that reaches across a border is not cut.
    #[test]
    fn charts_move_by_whole_tiles() {
        let mut mesh = Mesh::default();
        add(&mut mesh, vec2(0.1, 0.0), vec2(0.4, 1.0));
        add(&mut mesh, vec2(-1.0, 3.25), vec2(0.0, 3.5));
        let uvs = in_one_tile(&mesh).expect("no chart crosses a border");
        assert_eq!(uvs[..4], mesh.uvs[..4]);
        assert_eq!(uvs[4..], [vec2(0.0, 0.25), vec2(1.0, 0.25), vec2(1.0, 0.5), vec2(0.0, 0.5)]);
        add(&mut mesh, vec2(0.9, 0.1), vec2(1.1, 0.2));
        assert_eq!(in_one_tile(&mesh), None);
        assert_eq!(in_one_tile(&Mesh::default()), None);
    }
}
