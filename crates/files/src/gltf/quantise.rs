//! Vertices in integers (`KHR_mesh_quantization`): positions on a grid of 65535 steps along the box's
//! longest side, which a node places, or the inverse bind matrices of joints; unit vectors in signed bytes.

use parbake_model::glam::{DAffine3, DQuat, DVec3, Vec3};
use serde_json::{Value, json};

/// Steps of the grid along the longest side.
const STEPS: f32 = 65_535.0;

/// The grid: a position is `origin + step * integers`. One step for all axes, so that the node's
/// scale leaves normals as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    origin: Vec3,
    step: f32,
}

impl Grid {
    /// The grid of finite positions, of which there are some.
    pub fn of(positions: &[Vec3]) -> Self {
        let low = positions.iter().fold(Vec3::INFINITY, |a, &b| a.min(b));
        let high = positions.iter().fold(Vec3::NEG_INFINITY, |a, &b| a.max(b));
        let step = (high - low).max_element() / STEPS;
        // A single point has a box of no size; a span beyond floats has none that can be said.
        Self { origin: low, step: if step.is_normal() { step } else { 1.0 } }
    }

    /// The length of one step, the unit of what the integers say.
    pub fn unit(&self) -> f32 {
        self.step
    }

    /// The nearest point of the grid.
    pub fn integers(&self, position: Vec3) -> [u16; 3] {
        // Casts of floats saturate.
        ((position - self.origin) / self.step).round().to_array().map(|x| x as u16)
    }

    /// Where viewers show a point of the grid.
    pub fn position(&self, integers: [u16; 3]) -> Vec3 {
        self.origin + self.step * Vec3::from_array(integers.map(f32::from))
    }

    /// Adds the transform that brings integers back to a node.
    pub fn place(&self, node: &mut Value) {
        node["translation"] = json!(self.origin.to_array().map(f64::from));
        node["scale"] = json!(Vec3::splat(self.step).to_array().map(f64::from));
    }

    /// From the grid to the mesh.
    pub fn as_transform(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(self.step.into()),
            DQuat::IDENTITY,
            self.origin.as_dvec3(),
        )
    }

    /// The largest distance of a position from where it is shown.
    pub fn error(&self, positions: &[Vec3]) -> f64 {
        let distance = |&p: &Vec3| (self.position(self.integers(p)).as_dvec3() - p.as_dvec3()).length();
        positions.iter().map(distance).fold(0.0, f64::max)
    }
}

/// A channel from −1 to 1 as a normalised signed byte.
pub fn signed_byte(x: f32) -> u8 {
    ((x.clamp(-1.0, 1.0) * 127.0).round() as i8) as u8
}

/// A channel from 0 to 1 as a normalised byte.
pub fn byte(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects shapes: no position moves by more than half a step a channel, flat and far ones included.
    #[test]
    fn positions_stay_within_half_a_step() {
        let clouds = [
            vec![Vec3::new(1.0, -2.0, 3.0), Vec3::new(4.0, 0.1, 3.0), Vec3::new(2.2, 5.5, 3.0)],
            vec![Vec3::splat(7.0)],
            vec![Vec3::ZERO, Vec3::new(1e-12, 0.0, 2e-12)],
        ];
        for cloud in clouds {
            let grid = Grid::of(&cloud);
            assert!(grid.error(&cloud) <= f64::from(grid.step) * 0.87, "{grid:?}");
        }
    }

    /// Protects the ends of the ranges.
    #[test]
    fn bytes_reach_their_ends() {
        assert_eq!([signed_byte(-1.0), signed_byte(0.0), signed_byte(1.0)], [129, 0, 127]);
        assert_eq!([byte(0.0), byte(2.0), byte(0.5)], [0, 255, 128]);
    }
}
