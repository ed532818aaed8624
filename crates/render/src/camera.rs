//! Cameras: world space to homogeneous pixel coordinates.
//!
//! Forward: with `c = Rᵀ(p − eye)` in camera axes (right, up, back) a point
//! becomes `(X, Y, W) = (h·W + h·f·c_x, h·W − h·f·c_y, W)`, `W = −c_z` for a
//! perspective and `1` for an orthographic camera, `h = size / 2`. The pixel is
//! `(X/W, Y/W)`, y down, pixel centres at half-integers.
//! Adjoint: the map is linear in p, so its adjoint is its transpose.
//!
//! Contract: images are square; the camera looks along −back; lengths are in the
//! common frame (see `parbake_model::Placement`).

use glam::{DVec3, Vec3};

/// How depth becomes size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Half the image's width at unit depth: tan(fov / 2), > 0.
    Perspective(f32),
    /// Half the image's width in world units, > 0.
    Orthographic(f32),
}

/// A square view of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Unit vector to the right of the image.
    pub right: Vec3,
    /// Unit vector to its top.
    pub up: Vec3,
    /// Unit vector from the scene towards the viewer.
    pub back: Vec3,
    /// Where the viewer (and the headlight) is.
    pub eye: Vec3,
    /// How depth becomes size.
    pub projection: Projection,
}

/// A point in homogeneous pixel coordinates, and how near it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScreenPoint {
    /// X, Y and W: the pixel is (X/W, Y/W).
    pub homogeneous: DVec3,
    /// Distance along the viewing axis (equals W for a perspective camera).
    pub depth: f64,
}

impl Camera {
    /// A camera at `radius` from the origin in this direction, looking at the
    /// origin, +Y up (+Z where the direction is within 2.6° of ±Y).
    pub fn towards_origin(direction: Vec3, radius: f32, projection: Projection) -> Self {
        let back = direction.as_dvec3().normalize_or(DVec3::Z);
        let reference = if back.y.abs() < 0.999 { DVec3::Y } else { DVec3::Z };
        let right = reference.cross(back).normalize();
        let up = back.cross(right);
        let (right, up, back) = (right.as_vec3(), up.as_vec3(), back.as_vec3());
        Self { right, up, back, eye: back * radius, projection }
    }

    /// The unit vector from a surface point towards the viewer: also where the
    /// headlight shines from.
    #[inline]
    pub fn view_direction(&self, point: Vec3) -> Vec3 {
        match self.projection {
            Projection::Perspective(_) => (self.eye - point).normalize_or(self.back),
            Projection::Orthographic(_) => self.back,
        }
    }

    /// World to homogeneous pixels of an image `size` pixels wide.
    #[inline]
    pub fn project(&self, point: Vec3, size: usize) -> ScreenPoint {
        let half = 0.5 * size as f64;
        let c = point.as_dvec3() - self.eye.as_dvec3();
        let (x, y) = (c.dot(self.right.as_dvec3()), c.dot(self.up.as_dvec3()));
        let depth = -c.dot(self.back.as_dvec3());
        let (w, scale) = match self.projection {
            Projection::Perspective(half_width) => (depth, half / f64::from(half_width)),
            Projection::Orthographic(half_width) => (1.0, half / f64::from(half_width)),
        };
        ScreenPoint { homogeneous: DVec3::new(half * w + scale * x, half * w - scale * y, w), depth }
    }

    /// Adjoint of [`Camera::project`]: a gradient with respect to (X, Y, W)
    /// becomes one with respect to the world position.
    #[inline]
    pub fn project_adjoint(&self, gradient: DVec3, size: usize) -> Vec3 {
        let half = 0.5 * size as f64;
        let (half_width, perspective) = match self.projection {
            Projection::Perspective(h) => (f64::from(h), true),
            Projection::Orthographic(h) => (f64::from(h), false),
        };
        let scale = half / half_width;
        let mut g = self.right.as_dvec3() * (scale * gradient.x) - self.up.as_dvec3() * (scale * gradient.y);
        if perspective {
            g -= self.back.as_dvec3() * (half * (gradient.x + gradient.y) + gradient.z);
        }
        g.as_vec3()
    }
}

/// `count` directions spread evenly over the sphere (Fibonacci lattice).
///
/// `turn` rotates the lattice about +Y, in radians: two lattices of different
/// turn and count share no direction, so one can be fitted and the other tested.
pub fn fibonacci_sphere(count: usize, turn: f64) -> Vec<Vec3> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let y = 1.0 - (2 * i + 1) as f64 / count as f64;
            let r = (1.0 - y * y).max(0.0).sqrt();
            let phi = i as f64 * golden + turn;
            DVec3::new(r * phi.cos(), y, r * phi.sin()).as_vec3()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the vertices' gradient: the last link of the adjoint chain.
    #[test]
    fn project_adjoint_matches_central_differences() {
        for projection in [Projection::Perspective(0.4), Projection::Orthographic(1.2)] {
            let camera = Camera::towards_origin(Vec3::new(0.3, -0.8, 0.5), 3.5, projection);
            let p = Vec3::new(0.2, 0.4, -0.3);
            let g = DVec3::new(0.7, -0.2, 1.3);
            let value = |q: Vec3| camera.project(q, 64).homogeneous.dot(g);
            let analytic = camera.project_adjoint(g, 64);
            for axis in 0..3 {
                let mut e = Vec3::ZERO;
                e[axis] = 1e-2;
                let numeric = (value(p + e) - value(p - e)) / 2e-2;
                assert!((numeric - f64::from(analytic[axis])).abs() < 1e-2 * numeric.abs().max(1.0));
            }
        }
    }

    /// Protects the agreement with other tools on where the image's top is.
    #[test]
    fn up_is_up_and_right_is_right() {
        let camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Perspective(0.4));
        let s = camera.project(Vec3::new(0.5, 0.25, 0.0), 100).homogeneous;
        assert!(s.x / s.z > 50.0 && s.y / s.z < 50.0);
    }

    /// Protects the spread of training and test views.
    #[test]
    fn directions_are_spread() {
        let mean = fibonacci_sphere(97, 0.3).into_iter().sum::<Vec3>() / 97.0;
        assert!(mean.length() < 0.02, "{mean}");
    }
}
