//! Charts in other tiles of a repeated texture, moved back into the square.
//!
//! A texture that repeats shows the same in every unit square of the plane, so a chart may move by
//! whole tiles and shows what it showed, texel by texel.

use crate::layout::Layout;
use glam::DVec2;
use parbake_model::Mesh;
use parbake_model::glam::Vec2;

/// The V texture coordinates of a mesh whose charts are moved by whole tiles into [0, 1]², give or take
/// `slack` (in tiles). None where a chart reaches across a tile's border by more than that, where a
/// vertex belongs to charts of different tiles, and where there are no coordinates or some that are not
/// finite.
pub fn in_one_tile(mesh: &Mesh, slack: f64) -> Option<Vec<Vec2>> {
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
    let tile = |[low, high]: &[DVec2; 2]| {
        let tile = (*low + slack).floor();
        ((*high - tile).max_element() <= 1.0 + slack).then_some(tile)
    };
    let tiles: Vec<DVec2> = boxes.iter().map(tile).collect::<Option<_>>()?;
    let mut own: Vec<Option<DVec2>> = vec![None; mesh.uvs.len()];
    for (t, chart) in layout.charts.iter().enumerate() {
        let tile = tiles[*chart as usize];
        for vertex in mesh.triangles[t] {
            if *own[vertex as usize].get_or_insert(tile) != tile {
                return None;
            }
        }
    }
    let home = |(uv, tile): (&Vec2, &Option<DVec2>)| (uv.as_dvec2() - tile.unwrap_or_default()).as_vec2();
    Some(mesh.uvs.iter().zip(&own).map(home).collect())
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
        let uvs = in_one_tile(&mesh, 0.0).expect("no chart crosses a border");
        assert_eq!(uvs[..4], mesh.uvs[..4]);
        assert_eq!(uvs[4..], [vec2(0.0, 0.25), vec2(1.0, 0.25), vec2(1.0, 0.5), vec2(0.0, 0.5)]);
        // Two charts that share a vertex on the border of their tiles stay together or not at all.
        let mut touching = mesh.clone();
        add(&mut touching, vec2(0.0, 0.0), vec2(1.0, 1.0));
        add(&mut touching, vec2(1.0, 1.0), vec2(2.0, 2.0));
        touching.positions[12] = touching.positions[10];
        touching.triangles.iter_mut().flatten().filter(|v| **v == 12).for_each(|v| *v = 10);
        assert_eq!(in_one_tile(&touching, 0.0), None);
        add(&mut mesh, vec2(0.9, 0.1), vec2(1.1, 0.2));
        assert!(in_one_tile(&mesh, 0.11).is_some());
        assert_eq!(in_one_tile(&mesh, 0.0), None);
        assert_eq!(in_one_tile(&Mesh::default(), 0.0), None);
    }
}
