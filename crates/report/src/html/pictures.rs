//! The pictures to look at: four sides of the model, each as the high-poly,
//! ray-cast, baked, and what is left between them.
//!
//! Contract: display-referred; the camera comes as near as the shapes allow. The
//! directions belong to no lattice of training or evaluation.

use super::scenes::Scenes;
use crate::page::amplified_difference;
use parbake::PlacedModel;
use parbake_metric::{Rgb, mean_squared_error, psnr_from_mse};
use parbake_model::glam::Vec3;
use parbake_render::camera::{Camera, Projection};

/// Sides to look at.
pub const SIDES: usize = 4;
/// Side of a picture in pixels.
pub const PIXELS: usize = 384;
/// Differences are shown so many times as strong.
pub const AMPLIFIED: f32 = 4.0;
/// A dark grey, as in most 3D applications' viewports: black would swallow the
/// outline and white would outshine the model. Linear light.
pub const BACKGROUND: [f32; 3] = [0.04; 3];

/// Samples along a side of each pixel.
pub const SUPERSAMPLE: usize = 2;
/// Azimuth from +Z towards +X and height, in degrees: the usual front and the back
/// as a photographer would take them, then one from above and one from below on
/// the sides in between.
const DIRECTIONS: [[f32; 2]; SIDES] = [[25.0, 12.0], [-155.0, 12.0], [-65.0, 48.0], [115.0, -48.0]];
/// Distance of the camera, as in training.
const RADIUS: f32 = 3.5;

/// One side of the model.
pub struct Side {
    /// Where the camera stands, in words.
    pub name: String,
    /// The high-poly.
    pub high: Rgb,
    /// What a ray-cast baker delivers.
    pub ray_cast: Rgb,
    /// The low-poly with baked textures.
    pub baked: Rgb,
    /// Ray-cast against high, amplified.
    pub ray_cast_difference: Rgb,
    /// Baked against high, amplified.
    pub baked_difference: Rgb,
    /// Decibels of the ray-cast picture.
    pub ray_cast_psnr: f64,
    /// Decibels of the baked picture.
    pub baked_psnr: f64,
}

/// Renders all sides; `tick` is called after each.
pub fn sides(scenes: &Scenes, tick: impl Fn()) -> Vec<Side> {
    DIRECTIONS
        .map(|angles| {
            let side = side(scenes, direction(angles));
            tick();
            side
        })
        .into()
}

fn direction(angles: [f32; 2]) -> Vec3 {
    let [azimuth, height] = angles.map(f32::to_radians);
    Vec3::new(height.cos() * azimuth.sin(), height.sin(), height.cos() * azimuth.cos())
}

fn side(scenes: &Scenes, direction: Vec3) -> Side {
    let camera = framed(&scenes.all(), direction);
    let picture = |model: &PlacedModel| {
        let view = scenes.renderer.render_from(model, &camera, (PIXELS, SUPERSAMPLE), false);
        scenes.renderer.tonemap(&view, BACKGROUND)
    };
    let (high, ray_cast, baked) = (picture(&scenes.high), picture(&scenes.ray_cast), picture(&scenes.baked));
    let psnr = |low| psnr_from_mse(mean_squared_error(&high, low).unwrap_or(f64::NAN));
    Side {
        name: name(direction),
        ray_cast_psnr: psnr(&ray_cast),
        baked_psnr: psnr(&baked),
        ray_cast_difference: amplified_difference(&high, &ray_cast, AMPLIFIED),
        baked_difference: amplified_difference(&high, &baked, AMPLIFIED),
        high,
        ray_cast,
        baked,
    }
}

/// The camera of the first side, whose picture all models just fit into.
pub fn front(models: &[&PlacedModel]) -> Camera {
    framed(models, direction(DIRECTIONS[0]))
}

/// Where it stands, of unit length.
pub fn front_direction() -> Vec3 {
    direction(DIRECTIONS[0])
}

/// A camera whose picture all shapes just fit into.
fn framed(models: &[&PlacedModel], direction: Vec3) -> Camera {
    let wide = Camera::towards_origin(direction, RADIUS, Projection::Perspective(1.0));
    let reach = models
        .iter()
        .flat_map(|model| {
            let scene = model.scene();
            scene.mesh().triangles.iter().flatten().map(|&i| scene.mesh().positions[i as usize])
        })
        .map(|p| {
            let c = p - wide.eye;
            // The box's corners are nearer than √3, so nothing lies behind the camera;
            // a low-poly far outside of it is cut off rather than followed.
            (c.dot(wide.right).abs().max(c.dot(wide.up).abs())) / (-c.dot(wide.back)).max(0.5)
        })
        .fold(0.0f32, f32::max);
    Camera { projection: Projection::Perspective((reach * 1.06).clamp(0.05, 0.7)), ..wide }
}

/// Where a direction is, if +Z is the front and +Y the top.
fn name(direction: Vec3) -> String {
    let height = match direction.y {
        y if y > 0.5 => ", from above",
        y if y < -0.5 => ", from below",
        _ => "",
    };
    let turn = direction.x.atan2(direction.z).to_degrees();
    let side = match turn.abs() {
        a if a < 30.0 => "front",
        a if a > 150.0 => "back",
        a if a < 60.0 && turn > 0.0 => "front right",
        a if a < 60.0 => "front left",
        a if a < 120.0 && turn > 0.0 => "right",
        a if a < 120.0 => "left",
        _ if turn > 0.0 => "back right",
        _ => "back left",
    };
    format!("{side}{height}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the choice of sides: none is like another, and their names say so.
    #[test]
    fn sides_are_spread() {
        let all = DIRECTIONS.map(direction);
        assert_eq!(all.map(name), ["front", "back", "left, from above", "right, from below"]);
        for (i, a) in all.iter().enumerate() {
            for b in &all[i + 1..] {
                assert!(a.dot(*b) < 0.5, "{a} {b}");
            }
        }
    }
}
