//! Points that follow the gradient of their vertices by Adam, on a mesh that stays sane.
//!
//! A step: the adjoint of where vertices are ([`Points`]), a spring that pulls points back to rest, Adam,
//! and what the [`TriangleQuality`] leaves of where that leads.
//!
//! Contract: after every step each triangle is as sane as the guard asks, and the values that Adam
//! sees are those of where the points are.

use crate::points::{Motion, Points};
use crate::triangle_quality::TriangleQuality;
use glam::{Vec3, Vec4};
use parbake_solve::adam::{Adam, AdamOptions};

/// The points on their way.
#[derive(Clone)]
pub struct MovingPoints<'a> {
    points: &'a Points,
    motion: Motion,
    quality: TriangleQuality,
    /// P values of four lanes, as [`Points`] has them.
    values: Vec<Vec4>,
    /// P positions.
    at: Vec<Vec3>,
    adam: Adam,
}

impl<'a> MovingPoints<'a> {
    /// At rest; `rate` is how far a point moves in a step at first, at most.
    pub fn new(points: &'a Points, motion: Motion, rate: f32) -> Self {
        Self {
            points,
            motion,
            quality: TriangleQuality::new(&points.rest, &points.triangles),
            values: vec![Vec4::ZERO; points.rest.len()],
            at: points.rest.clone(),
            adam: Adam::new(points.rest.len(), AdamOptions { rate, ..AdamOptions::default() }),
        }
    }

    /// P positions.
    pub fn at(&self) -> &[Vec3] {
        &self.at
    }

    /// P displacements from the rest positions.
    pub fn ways(&self) -> Vec<Vec3> {
        self.at.iter().zip(&self.points.rest).map(|(at, rest)| *at - *rest).collect()
    }

    /// Moves against the gradients of the V vertices and, if there are any, of the P points
    /// besides, at `share` of the first rate. The spring weighs the mean of the squared ways from
    /// the rest positions, in what the gradients are of.
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
        if self.quality.revert(&self.at, &mut next) > 0 {
            self.values = self.points.values(self.motion, &next);
        }
        self.at = next;
    }

    /// Takes the steps of some points back, and of those whose triangles would not be sane beside them. Returns how many
    /// there were that had moved.
    pub fn put_back(&mut self, which: &[u32]) -> usize {
        let mut next = self.at.clone();
        let (mut to_do, mut count) = (which.to_vec(), 0);
        while !to_do.is_empty() {
            for point in to_do.drain(..).map(|point| point as usize) {
                count += usize::from(next[point] != self.points.rest[point]);
                next[point] = self.points.rest[point];
            }
            let spoilt = self.quality.invalid(&next).flat_map(|t| self.points.triangles[t]);
            to_do =
                spoilt.filter(|&point| next[point as usize] != self.points.rest[point as usize]).collect();
        }
        self.values = self.points.values(self.motion, &next);
        self.at = next;
        count
    }

    /// Takes all steps back.
    pub fn reset(&mut self) {
        self.values.fill(Vec4::ZERO);
        self.at.clone_from(&self.points.rest);
    }

    /// Mean and greatest distance from the rest positions.
    pub fn moved(&self) -> [f32; 2] {
        let ways = || self.at.iter().zip(&self.points.rest).map(|(at, rest)| at.distance(*rest));
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
    /// what is taken back is at rest to the bit.
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
            moving.reset();
            assert_eq!(moving.at(), points.rest);
        }
    }

    /// Protects walls that crossed: what is put back lies at rest, with what would be spoilt beside it, and stays in step
    /// with the values.
    #[test]
    fn points_are_put_back() {
        let points = square();
        let mut moving = MovingPoints::new(&points, Motion::Free, 0.1);
        for _ in 0..3 {
            moving.step(&[-Vec3::Z; 4], &[], 0.0, 1.0);
        }
        assert_eq!(moving.put_back(&[1]), 1);
        assert_eq!((moving.at[1], moving.put_back(&[1])), (points.rest[1], 0));
        assert!(moving.at[0].z > 0.1 && moving.quality.invalid(&moving.at).count() == 0);
        assert_eq!(points.displaced(Motion::Free, &moving.values), moving.at);
    }

    /// Protects the mesh from a gradient that would turn a triangle over.
    #[test]
    fn no_step_turns_a_triangle_over() {
        let points = square();
        let mut moving = MovingPoints::new(&points, Motion::Free, 0.1);
        for _ in 0..50 {
            moving.step(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ZERO], &[], 0.0, 1.0);
            assert_eq!(moving.quality.invalid(&moving.at).count(), 0);
        }
    }
}
