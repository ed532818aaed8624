//! The texture layout as line drawing: chart borders, and the edges inside.
//!
//! An edge that one triangle has for itself in the texture is a border, one that
//! two share lies inside. Triangles outside [0, 1] are drawn where their centre
//! repeats into it, as a renderer reads them.
//!
//! Contract: all coordinates are finite integers; at most [`MOST_EDGES`] edges are
//! drawn, borders first, so that a page of a dense mesh stays small.

use parbake_model::Mesh;
use parbake_model::glam::Vec2;
use std::fmt::Write;

/// Units along a side: an eighth of a texel at 512, a texel at 4096.
const UNITS: f32 = 4096.0;
/// More edges than that are nothing but a blot.
const MOST_EDGES: usize = 30_000;
/// Coordinates beyond this many repeats have no texel precision left.
const FARTHEST: f32 = 1000.0;

/// A drawing over a square texture.
pub struct UvLayout {
    /// An `<svg>` with the class `uv`; its lines have the classes `inside`, and `border`
    /// with a `halo` behind, so that they show on any colour.
    pub svg: String,
    /// What was left out, if anything, in words.
    pub left_out: Option<&'static str>,
}

/// Draws the layout; None when there is nothing to draw. `id` names it among the page's elements.
pub fn uv_layout(mesh: &Mesh, id: &str) -> Option<UvLayout> {
    let mut edges: Vec<[[i32; 2]; 2]> = Vec::with_capacity(3 * mesh.triangles.len());
    for triangle in 0..mesh.triangles.len() {
        let uvs = mesh.corner_uvs(triangle);
        if !uvs.iter().all(|uv| uv.abs().max_element() < FARTHEST) {
            continue;
        }
        let tile = ((uvs[0] + uvs[1] + uvs[2]) / 3.0).floor();
        let corners = uvs.map(|uv| grid(uv - tile));
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if a != b {
                edges.push(if a < b { [a, b] } else { [b, a] });
            }
        }
    }
    if edges.is_empty() {
        return None;
    }
    edges.sort_unstable();
    let (mut borders, mut inside) = (Vec::new(), Vec::new());
    for run in edges.chunk_by(|a, b| a == b) {
        if run.len() == 1 { borders.push(run[0]) } else { inside.push(run[0]) }
    }
    let mut left_out = None;
    if borders.len() + inside.len() > MOST_EDGES {
        inside.clear();
        left_out = Some("Only the charts' borders are drawn: the mesh is too dense for all edges.");
    }
    if borders.len() > MOST_EDGES {
        borders.truncate(MOST_EDGES);
        left_out = Some("Only a part of the charts' borders is drawn: there are too many.");
    }
    let svg = format!(
        concat!(
            r#"<svg class="uv" viewBox="0 0 {units} {units}" aria-hidden="true">"#,
            r##"<path class="inside" d="{inside}"/><defs><path id="{id}" d="{borders}" fill="none"/></defs>"##,
            r##"<use class="halo" href="#{id}"/><use class="border" href="#{id}"/></svg>"##
        ),
        units = UNITS,
        id = id,
        inside = path(&inside),
        borders = path(&borders)
    );
    Some(UvLayout { svg, left_out })
}

fn grid(uv: Vec2) -> [i32; 2] {
    (uv * UNITS).to_array().map(|x| x.round() as i32)
}

/// Edges that follow each other are drawn in one stroke, which halves the text.
fn path(edges: &[[[i32; 2]; 2]]) -> String {
    let mut out = String::new();
    let mut pen = None;
    for [a, b] in edges {
        if pen != Some(*a) {
            let _ = write!(out, "M{} {}", a[0], a[1]);
        }
        let _ = write!(out, "l{} {}", b[0] - a[0], b[1] - a[1]);
        pen = Some(*b);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(uvs: &[[f32; 2]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh {
            uvs: uvs.iter().map(|&uv| uv.into()).collect(),
            triangles: triangles.to_vec(),
            ..Mesh::default()
        }
    }

    /// Protects the difference between a chart's border and what lies inside.
    #[test]
    fn a_square_has_four_borders_and_a_diagonal() {
        let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let svg = uv_layout(&mesh(&uvs, &[[0, 1, 2], [0, 2, 3]]), "borders").unwrap().svg;
        assert!(svg.contains(r#"class="inside" d="M0 0l4096 4096""#), "{svg}");
        let borders = "M0 0l0 4096M0 0l4096 0M0 4096l4096 0M4096 0l0 4096";
        assert!(svg.contains(&format!(r#"id="borders" d="{borders}""#)), "{svg}");
    }

    /// Protects the page from coordinates without measure.
    #[test]
    fn odd_coordinates_stay_finite() {
        let uvs =
            [[f32::NAN, 0.0], [f32::INFINITY, 1.0], [1e30, 0.5], [2.5, -3.5], [2.75, -3.5], [2.5, -3.25]];
        let layout =
            uv_layout(&mesh(&uvs, &[[0, 1, 2], [0, 3, 4], [2, 3, 4], [3, 4, 5]]), "borders").unwrap();
        assert!(!layout.svg.contains("NaN") && !layout.svg.contains("inf\""), "{}", layout.svg);
        assert!(layout.svg.contains("M2048 2048"), "repeats into the texture: {}", layout.svg);
        assert!(uv_layout(&mesh(&uvs, &[[0, 1, 2], [3, 3, 3]]), "borders").is_none());
        assert!(uv_layout(&Mesh::default(), "borders").is_none());
    }

    /// Protects the page's size.
    #[test]
    fn dense_meshes_keep_only_borders() {
        let side = 120u32;
        let at = |x: u32, y: u32| [x as f32 / side as f32, y as f32 / side as f32];
        let uvs: Vec<[f32; 2]> = (0..=side).flat_map(|y| (0..=side).map(move |x| at(x, y))).collect();
        let index = |x, y| y * (side + 1) + x;
        let triangles: Vec<[u32; 3]> = (0..side * side)
            .flat_map(|i| {
                let (x, y) = (i % side, i / side);
                let (a, b, c, d) = (index(x, y), index(x + 1, y), index(x + 1, y + 1), index(x, y + 1));
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let layout = uv_layout(&mesh(&uvs, &triangles), "borders").unwrap();
        assert!(layout.left_out.is_some() && layout.svg.len() < 20_000);
    }
}
