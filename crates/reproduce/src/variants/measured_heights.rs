//! Heights that are measured instead of fitted (Fig. 12): how far below each texel's point of the
//! low-poly the high-poly lies, along the normal.
//!
//! With d that distance and w the widths of the texture that a unit of length spans in the texel's
//! triangle (the root of its area in the texture by that in space), a height is `d w / s`; the scale
//! s is such that the deepest lies at 1.
//!
//! Contract: what lies above the low-poly, or farther than the reach, is at height 0; heights are
//! 0 … 1; the result does not depend on the number of threads.

use parbake_image::FloatImage;
use parbake_mesh::HighSurface;
use parbake_model::glam::Vec3;
use parbake_views::low_poly::LowPoly;
use rayon::prelude::*;

/// Heights, and the texture widths that a height of 1 spans.
#[derive(Clone, Debug)]
pub struct MeasuredHeights {
    /// Below the surface in units of the scale.
    pub heights: FloatImage<[f32; 1]>,
    /// The scale.
    pub scale: f32,
}

/// The least scale: a surface that lies on the other one has no depth to divide by.
const LEAST_SCALE: f32 = 1e-5;

impl MeasuredHeights {
    /// Measures them for a low-poly made ready at the maps' size.
    pub fn new(low: &LowPoly, surface: &HighSurface, reach: f32) -> Self {
        let (mesh, map) = (&low.placed, &low.map);
        let depth = |texel: usize| -> f32 {
            let Some(triangle) = mesh.triangles.get(map.triangle[texel] as usize) else { return 0.0 };
            let corners = triangle.map(|i| i as usize);
            let [second, third] = map.barycentric[texel];
            let weights = [1.0 - second - third, second, third];
            let mix = |of: &[Vec3]| (0..3).map(|k| of[corners[k]] * weights[k]).sum::<Vec3>();
            let (point, normal) = (mix(&mesh.positions), mix(&mesh.normals).normalize_or_zero());
            // From outside, so that a ray that starts on the surface meets it.
            let found = surface.cast(point + normal * reach, -normal, 2.0 * reach);
            let below = found.map_or(0.0, |hit| hit.distance - reach);
            below.max(0.0) * widths(corners.map(|i| mesh.positions[i]), corners.map(|i| mesh.uvs[i]))
        };
        let depths: Vec<f32> = (0..map.size * map.size).into_par_iter().map(depth).collect();
        let scale = depths.iter().copied().fold(LEAST_SCALE, f32::max);
        let texels = depths.into_iter().map(|d| [d / scale]).collect();
        Self { heights: FloatImage { width: map.size, height: map.size, texels }, scale }
    }
}

/// Texture widths that a unit of length spans in a triangle.
fn widths([a, b, c]: [Vec3; 3], [p, q, r]: [parbake_model::glam::Vec2; 3]) -> f32 {
    let in_space = (b - a).cross(c - a).length();
    let in_texture = (q - p).perp_dot(r - p).abs();
    if in_space > 0.0 { (in_texture / in_space).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec2;
    use parbake_model::{Material, Mesh, Model, Placement};

    /// A square of side 2 at a height, with the whole texture on it.
    fn square(height: f32) -> Mesh {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        Mesh {
            positions: corners.map(|[x, y]| Vec3::new(x, y, height)).to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: corners.map(|[x, y]| Vec2::new(x + 1.0, 1.0 - y) * 0.5).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        }
    }

    fn measured(height: f32) -> MeasuredHeights {
        let mesh = square(0.0);
        let model = Model {
            name: "low".into(),
            mesh,
            materials: vec![Material::default()],
            images: Vec::new(),
            ..Model::default()
        };
        let frame = Placement { centre: Vec3::ZERO, scale: 1.0 };
        let low = LowPoly::new(&model, &frame, 8).unwrap();
        MeasuredHeights::new(&low, &HighSurface::new(&square(height)), 0.5)
    }

    /// Protects the unit: a depth of 0.1 on a square 2 wide is 0.05 of the texture's width, and
    /// what lies above is not below.
    #[test]
    fn depths_are_in_texture_widths() {
        let sunk = measured(-0.1);
        assert!((sunk.scale - 0.05).abs() < 1e-5, "{}", sunk.scale);
        assert!(sunk.heights.texels.iter().all(|t| (t[0] - 1.0).abs() < 1e-4));
        let raised = measured(0.1);
        assert!(raised.heights.texels.iter().all(|t| t[0] == 0.0));
    }
}
