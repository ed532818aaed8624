//! Parts that show one value each, moved to a few texels of their own in an otherwise unchanged layout.
//!
//! A material without textures needs no layout. What a file says of its texture coordinates is often left over from
//! modelling, and lies on those of other materials, whose texels it would blur in a common texture.
//!
//! ```text
//! triangles of such a material ─ their box ─ scaled to half of a square of 8 texels ─ the square put into free space
//! ```
//!
//! Triangles keep their shapes in the texture, and tangent frames with them. They are so small there that viewers read no mip level but the
//! first, as long as a part covers more pixels than the texels it has.
//!
//! Contract: coordinates of all other triangles stay to the bit.

use crate::pack::free_space::place;
use crate::{Layout, PackOptions};
use glam::{DMat2, DVec2, dvec2};
use parbake_model::Mesh;
use parbake_model::glam::Vec2;

/// Texels along a side of a square, before [`place`] makes it smaller.
const SIDE: f64 = 8.0;
/// Texels of the texture that a layout may lie outside of it.
const SLACK: f64 = 0.5;

/// The V texture coordinates of a mesh in which all triangles of the same group share a square that nothing else lies
/// on. `groups` has one entry for each triangle; those without a group stay where they are.
///
/// None where there is no group or nothing else, where a vertex belongs to two groups or to a group and a triangle without, where
/// other triangles lie outside of the texture, and where a square finds no free space.
pub fn with_own_squares(mesh: &Mesh, groups: &[Option<usize>], texture_size: usize) -> Option<Vec<Vec2>> {
    let count = groups.iter().flatten().max()? + 1;
    if mesh.uvs.is_empty() || !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        return None;
    }
    let mut owner: Vec<Option<Option<usize>>> = vec![None; mesh.uvs.len()];
    for (triangle, group) in mesh.triangles.iter().zip(groups) {
        if triangle.iter().any(|&v| *owner[v as usize].get_or_insert(*group) != *group) {
            return None;
        }
    }
    let squares = free_squares(mesh, groups, count, texture_size)?;
    let mut boxes = vec![[DVec2::MAX, DVec2::MIN]; count];
    let group_of = |v: usize| owner[v].flatten();
    for (v, uv) in mesh.uvs.iter().enumerate() {
        if let Some(group) = group_of(v) {
            let [low, high] = boxes[group];
            boxes[group] = [low.min(uv.as_dvec2()), high.max(uv.as_dvec2())];
        }
    }
    let moved = |(v, uv): (usize, &Vec2)| {
        let Some(group) = group_of(v) else { return *uv };
        let ([low, high], [from, to]) = (boxes[group], squares[group]);
        let longest = (high - low).max_element();
        let scale = if longest > 0.0 { 0.5 * (to - from).min_element() / longest } else { 0.0 };
        (0.5 * (from + to) + (uv.as_dvec2() - 0.5 * (low + high)) * scale).as_vec2()
    };
    Some(mesh.uvs.iter().enumerate().map(moved).collect())
}

/// The low and the high corner of a free square for each group.
fn free_squares(
    mesh: &Mesh,
    groups: &[Option<usize>],
    count: usize,
    texture_size: usize,
) -> Option<Vec<[DVec2; 2]>> {
    let own = Layout::new(mesh);
    let mut layout = Layout { points: own.points, ..Layout::default() };
    let slack = SLACK / texture_size as f64;
    for (triangle, _) in own.triangles.iter().zip(groups).filter(|(_, group)| group.is_none()) {
        let is_inside = |p: DVec2| p.min_element() >= -slack && p.max_element() <= 1.0 + slack;
        if !triangle.iter().all(|&i| is_inside(layout.points[i as usize])) {
            return None;
        }
        layout.triangles.push(*triangle);
    }
    if layout.triangles.is_empty() {
        return None;
    }
    layout.charts = vec![0; layout.triangles.len()];
    let first = layout.points.len();
    let side = SIDE / texture_size as f64;
    for square in 0..count {
        let corner = layout.points.len() as u32;
        layout.points.extend([(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| dvec2(x, y)));
        layout.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| corner + k)));
        layout.charts.extend([square as u32 + 1; 2]);
    }
    layout.rest = vec![DMat2::ZERO; layout.triangles.len()];
    let free: Vec<bool> = (0..=count).map(|chart| chart > 0).collect();
    let pack = PackOptions { texture_size, gutter_texels: 1.0, ..PackOptions::default() };
    let placed = place(&layout, &free, &pack)?.layout.points;
    let corners = placed[first..].chunks_exact(4);
    let bounds = |square: &[DVec2]| {
        let low = square.iter().copied().reduce(DVec2::min).unwrap_or_default();
        [low, square.iter().copied().reduce(DVec2::max).unwrap_or_default()]
    };
    Some(corners.map(bounds).collect())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec3, vec2};

    /// Squares of two triangles, each a part of its own.
    fn squares(corners: &[[Vec2; 2]]) -> Mesh {
        let mut mesh = Mesh::default();
        for [low, high] in corners {
            let first = mesh.positions.len() as u32;
            for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                mesh.positions.push(Vec3::new(x, y, first as f32));
                mesh.uvs.push(*low + vec2(x, y) * (*high - *low));
            }
            mesh.triangles.extend([[first, first + 3, first + 1], [first + 1, first + 3, first + 2]]);
            mesh.triangle_materials.resize(mesh.triangles.len(), 0);
        }
        mesh
    }

    const HALF: [Vec2; 2] = [Vec2::ZERO, vec2(1.0, 0.5)];
    const ON_IT: [Vec2; 2] = [vec2(0.1, 0.1), vec2(0.3, 0.2)];

    /// Protects drawings: what shows them stays, what shows one value lies beside them, in its own shape, also on one point or
    /// far outside.
    #[test]
    fn plain_parts_have_texels_of_their_own() {
        let far = [vec2(-30.0, 4.0), vec2(50.0, 5.0)];
        let mesh = squares(&[HALF, ON_IT, [vec2(0.2, 0.2); 2], far]);
        let groups = [None, None, Some(0), Some(0), Some(1), Some(1), Some(2), Some(2)];
        for size in [64, 1024, 4096] {
            let uvs = with_own_squares(&mesh, &groups, size).unwrap();
            assert_eq!(uvs[..4], mesh.uvs[..4]);
            let texels = |uv: Vec2| uv * size as f32;
            assert!(
                uvs[4..].iter().all(|&uv| texels(uv).y > 0.5 * size as f32 + 1.5
                    && texels(uv).max_element() < size as f32 - 1.5)
            );
            let (own, before) = (uvs[6] - uvs[4], mesh.uvs[6] - mesh.uvs[4]);
            assert!((own.x / own.y - before.x / before.y).abs() < 0.01 && texels(own).max_element() > 1.5);
            assert!(uvs[8..12].iter().all(|uv| *uv == uvs[8]));
            for (a, b) in [(4, 8), (4, 12), (8, 12)] {
                assert!(texels(uvs[a]).distance(texels(uvs[b])) > 4.0, "{size} {a} {b}");
            }
        }
    }

    /// Protects layouts that are full, and those that cannot be told apart.
    #[test]
    fn without_room_nothing_moves() {
        let groups = [None, None, Some(0), Some(0)];
        let full = squares(&[[Vec2::ZERO, Vec2::ONE], ON_IT]);
        assert_eq!(with_own_squares(&full, &groups, 256), None);
        let mut shared = squares(&[HALF, ON_IT]);
        assert!(with_own_squares(&shared, &groups, 256).is_some());
        assert_eq!(with_own_squares(&shared, &[None; 4], 256), None);
        assert_eq!(with_own_squares(&shared, &[Some(0); 4], 256), None);
        shared.triangles[2][0] = 0;
        assert_eq!(with_own_squares(&shared, &groups, 256), None);
        let outside = squares(&[[Vec2::ZERO, vec2(2.0, 0.5)], ON_IT]);
        assert_eq!(with_own_squares(&outside, &groups, 256), None);
    }
}
