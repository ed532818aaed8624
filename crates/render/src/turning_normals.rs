//! How much rougher surfaces look to viewers that widen highlights where vertex normals turn from sample to sample.
//!
//! Where a normal turns by much from pixel to pixel, a narrow highlight would flicker. So three.js adds to the roughness
//! how far the interpolated vertex normal turns from one pixel to the next, in the component in which it turns most
//! (`geometryRoughness` in its shader of lights; cf. Kaplanyan et al., "Filtering Distributions of Normals for Shading
//! Antialiasing", 2016). Normal maps are not looked at. A faceted model keeps its highlights, and the same facets in a
//! normal map over smooth vertex normals lose them: up to 5 dB where triangles are a few pixels large.
//!
//! Per sample of the picture: with 2 × 2 samples a pixel half of what three.js adds with multisampling, and what it adds when
//! a larger picture is scaled down, as `tools/compare_gltfpack` does.
//!
//! Forward only: pictures are compared by it, nothing is fitted through it.

use crate::camera::Camera;
use crate::interpolate::{Barycentrics, interpolate};
use glam::Vec3;

/// What is added to glTF's roughness at a point of a triangle with these vertex normals: for small angles those in radians
/// by which the normal turns over one step of the derivatives of `at`; 0 where it does not turn, not bounded above.
pub fn added_roughness(camera: &Camera, normals: [Vec3; 3], at: &Barycentrics) -> f32 {
    let normal = interpolate(normals, at.weights);
    let inverse = 1.0 / normal.length().max(1e-6);
    let normal = normal * inverse;
    // The derivative of n / |n|.
    let turn = |per_step: [f32; 3]| {
        let step: Vec3 = interpolate(normals, per_step) * inverse;
        let step = step - normal * normal.dot(step);
        [camera.right, camera.up, camera.back]
            .map(|axis| axis.dot(step).abs())
            .into_iter()
            .fold(0.0, f32::max)
    };
    turn(at.per_x).max(turn(at.per_y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::interpolate::barycentrics;
    use crate::raster::ScreenTriangles;

    /// Protects the judgement of faceted models: flat triangles keep their roughness, and a normal that turns by an angle
    /// over a number of pixels adds that angle for each pixel.
    #[test]
    fn roughness_grows_by_the_angle_from_pixel_to_pixel() {
        let camera = Camera::towards_origin(Vec3::Z, 3.0, Projection::Orthographic(1.0));
        let positions = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let screen = ScreenTriangles::new(&positions, &[[0, 1, 2]], &camera, 64);
        let at = barycentrics(&screen.triangles[0], 20.0, 40.0);
        assert_eq!(added_roughness(&camera, [Vec3::Z; 3], &at), 0.0);
        let turned = |angle: f32| Vec3::new(angle.sin(), 0.0, angle.cos());
        let angle = 0.2;
        let added = added_roughness(&camera, [turned(0.0), turned(angle), turned(0.0)], &at);
        assert!((added - angle / 64.0).abs() < 0.05 * angle / 64.0, "{added}");
    }
}
