//! Points that follow the gradient of their vertices by Adam, on a mesh that stays sane.
//!
//! A step: the adjoint of where vertices are ([`Points`]), a spring that pulls points home, Adam,
//! and what the [`Guard`] leaves of where that leads.
//!
//! Contract: after every step each triangle is as sane as the guard asks, and the values that Adam
//! sees are those of where the points are.

use crate::guard::Guard;
use crate::points::{Motion, Points};
use glam::{Vec3, Vec4};
use parbake_solve::adam::{Adam, AdamOptions};

/// The points on their way.
pub struct MovingPoints<'a> {
    points: &'a Points,
    motion: Motion,
    guard: Guard,
    /// P values of four lanes, as [`Points`] has them.
    values: Vec<Vec4>,
    /// P positions.
    at: Vec<Vec3>,
    adam: Adam,
}

impl<'a> MovingPoints<'a> {
    /// At home; `rate` is how far a point moves in a step at first, at most.
    pub fn new(points: &'a Points, motion: Motion, rate: f32) -> Self {
        Self {
            points,
            motion,
            guard: Guard::new(&points.home, &points.triangles),
            values: vec![Vec4::ZERO; points.home.len()],
            at: points.home.clone(),
            adam: Adam::new(points.home.len(), AdamOptions { rate, ..AdamOptions::default() }),
        }
    }

    /// P positions.
    pub fn at(&self) -> &[Vec3] {
        &self.at
    }

    /// P ways from home.
    pub fn ways(&self) -> Vec<Vec3> {
        self.at.iter().zip(&self.points.home).map(|(at, home)| *at - *home).collect()
    }

    /// Moves against the gradients of the V vertices and, if there are any, of the P points
    /// besides, at `share` of the first rate. The spring weighs the mean of the squared ways from
    /// home, in what the gradients are of.
    pub fn step(&mut self, to_vertices: &[Vec3], to_points: &[Vec3], spring: f32, share: f32) {
        let mut gradient = self.points.adjoint(self.motion, to_vertices);
        let pull = 2.0 * spring / self.values.len().max(1) as f32;
        for (gradient, value) in gradient.iter_mut().zip(&self.values) {
            *gradient += *value * pull;
        }
        for (gradient, further) in gradient.iter_mut().zip(self.points.lanes(self.motion, to_points)) {
            *gradient += further;
        }
        self.adam.step(&mut self.values, &gradient, share);
        let mut next = self.points.displaced(self.motion, &self.values);
        if self.guard.hold(&self.at, &mut next) > 0 {
            self.values = self.points.values(self.motion, &next);
        }
        self.at = next;
    }

    /// Takes all steps back.
    pub fn go_home(&mut self) {
        self.values.fill(Vec4::ZERO);
        self.at.clone_from(&self.points.home);
    }

    /// Mean and longest way from home.
    pub fn moved(&self) -> [f32; 2] {
        let ways = || self.at.iter().zip(&self.points.home).map(|(at, home)| at.distance(*home));
        [ways().sum::<f32>() / self.at.len().max(1) as f32, ways().fold(0.0, f32::max)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Points {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)];
        Points::new(&positions, &[Vec3::Z; 4], &[[0, 1, 2], [1, 3, 2]])
    }

    /// Protects the fit: points go against the gradient, the spring alone brings them back, and
    /// what is taken back is home to the bit.
    #[test]
    fn points_follow_and_the_spring_pulls_them_home() {
        let points = square();
        for motion in [Motion::Normal, Motion::Free] {
            let mut moving = MovingPoints::new(&points, motion, 0.01);
            for _ in 0..20 {
                moving.step(&[-Vec3::Z; 4], &[], 0.0, 1.0);
            }
            let [mean, longest] = moving.moved();
            assert!(mean > 0.1 && longest < 0.3 && moving.ways().iter().all(|way| way.z > 0.1));
            for _ in 0..200 {
                moving.step(&[Vec3::ZERO; 4], &[], 1.0, 0.5);
            }
            assert!(moving.moved()[1] < 0.5 * longest, "{:?}", moving.moved());
            moving.go_home();
            assert_eq!(moving.at(), points.home);
        }
    }

    /// Protects the mesh from a gradient that would turn a triangle over.
    #[test]
    fn no_step_turns_a_triangle_over() {
        let points = square();
        let mut moving = MovingPoints::new(&points, Motion::Free, 0.1);
        for _ in 0..50 {
            moving.step(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ZERO], &[], 0.0, 1.0);
            assert_eq!(moving.guard.spoilt(&moving.at).count(), 0);
        }
    }
}
