//! The feasible set: no triangle that was upright turns over, no two charts come nearer
//! than the gutter, no chart crosses itself, nothing leaves the square.

use crate::contact::{Contact, ContactOptions};
use crate::descent::Region;
use crate::inversion;
use glam::DVec2;
use parbake_atlas::Layout;

/// Layouts that are as sound as the one it was made from.
pub struct Feasible {
    upright: Vec<[u32; 3]>,
    contact: Contact,
}

impl Feasible {
    /// From the layout that a descent starts with.
    pub fn new(layout: &Layout, options: &ContactOptions) -> Self {
        Self { upright: inversion::upright(layout), contact: Contact::new(layout, options) }
    }

    /// The barrier between charts.
    pub fn contact(&self) -> &Contact {
        &self.contact
    }
}

impl Region for Feasible {
    fn free(&self) -> &[DVec2] {
        &self.contact.constraints().masks
    }

    fn max_step(&self, points: &[DVec2], direction: &[DVec2], limit: f64) -> f64 {
        let limit = inversion::max_step(&self.upright, points, direction, limit);
        self.contact.max_step(points, direction, limit)
    }

    fn slow_down(&self, points: &[DVec2], direction: &mut [DVec2], limit: f64) {
        inversion::slow_down(&self.upright, points, direction, limit);
    }

    fn is_feasible(&self, points: &[DVec2]) -> bool {
        inversion::all_upright(&self.upright, points) && self.contact.is_feasible(points)
    }
}
