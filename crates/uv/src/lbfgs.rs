//! What L-BFGS remembers (Nocedal 1980, "Updating Quasi-Newton Matrices with Limited
//! Storage"): pairs s, y of a step and of what it did to the gradient. With them the two
//! loops apply an approximate inverse Hessian H to a vector, beginning from
//! `γ P⁻¹`, P⁻¹ a preconditioner and `γ = sᵀy / yᵀP⁻¹y` of the last pair.
//!
//! Contract: pairs without positive curvature are not taken up, so that H stays positive
//! definite; coordinates that are not free stay zero.

use glam::DVec2;
use rayon::prelude::*;
use std::collections::VecDeque;

/// An approximation of the inverse Hessian that is symmetric and positive definite; shared by
/// threads.
pub trait Preconditioner: Sync {
    /// Applies it in place.
    fn apply(&self, vector: &mut [DVec2]);
}

/// No preconditioner: the identity, as in plain L-BFGS.
#[derive(Clone, Copy, Debug, Default)]
pub struct Identity;

impl Preconditioner for Identity {
    fn apply(&self, _: &mut [DVec2]) {}
}

/// The last pairs.
#[derive(Clone, Debug, Default)]
pub struct Lbfgs {
    changes: VecDeque<Change>,
    capacity: usize,
}

/// A step and what it did to the gradient.
#[derive(Clone, Debug)]
struct Change {
    points: Vec<DVec2>,
    gradient: Vec<DVec2>,
    /// 1 / (sᵀ y).
    scale: f64,
}

impl Lbfgs {
    /// Remembers `capacity` pairs at most; 0 makes it the preconditioned gradient alone.
    pub fn new(capacity: usize) -> Self {
        Self { changes: VecDeque::new(), capacity }
    }

    /// Whether nothing is remembered.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.changes.clear();
    }

    /// Minus the gradient times the approximate inverse Hessian.
    pub fn direction(
        &self,
        gradient: &[DVec2],
        preconditioner: &impl Preconditioner,
        free: &[DVec2],
    ) -> Vec<DVec2> {
        let mut q: Vec<DVec2> = gradient.iter().map(|g| -*g).collect();
        let mut factors = vec![0.0; self.changes.len()];
        for (change, factor) in self.changes.iter().zip(&mut factors).rev() {
            *factor = change.scale * dot(&change.points, &q);
            add(&mut q, &change.gradient, -*factor);
        }
        let Some(last) = self.changes.back() else {
            preconditioner.apply(&mut q);
            mask(&mut q, free);
            return q;
        };
        // The preconditioner's own scale, from the last step.
        let mut y = last.gradient.clone();
        rayon::join(|| preconditioner.apply(&mut q), || preconditioner.apply(&mut y));
        mask(&mut q, free);
        mask(&mut y, free);
        let gamma = 1.0 / (last.scale * dot(&last.gradient, &y)).max(f64::MIN_POSITIVE);
        for q in &mut q {
            *q *= gamma;
        }
        for (change, factor) in self.changes.iter().zip(&factors) {
            let back = change.scale * dot(&change.gradient, &q);
            add(&mut q, &change.points, factor - back);
        }
        q
    }

    /// Takes up a step from `from` to `to`, with the gradients there, of one and the same
    /// objective; forgets the oldest when there are too many.
    pub fn remember(&mut self, from: &[DVec2], to: &[DVec2], old: &[DVec2], new: &[DVec2]) {
        self.changes.extend(Change::between(from, to, old, new));
        if self.changes.len() > self.capacity {
            self.changes.pop_front();
        }
    }
}

impl Change {
    /// None where the curvature along the step is not positive.
    fn between(from: &[DVec2], to: &[DVec2], old: &[DVec2], new: &[DVec2]) -> Option<Self> {
        let points: Vec<DVec2> = to.iter().zip(from).map(|(a, b)| *a - *b).collect();
        let gradient: Vec<DVec2> = new.iter().zip(old).map(|(a, b)| *a - *b).collect();
        let curvature = dot(&points, &gradient);
        let noise = 1e-10 * (dot(&points, &points) * dot(&gradient, &gradient)).sqrt();
        (curvature > noise).then(|| Self { points, gradient, scale: 1.0 / curvature })
    }
}

/// Points that one task looks at.
const BAND: usize = 1 << 14;

/// Sets what is not free to zero.
pub(crate) fn mask(vector: &mut [DVec2], free: &[DVec2]) {
    for (v, f) in vector.iter_mut().zip(free) {
        *v *= *f;
    }
}

fn add(to: &mut [DVec2], what: &[DVec2], scale: f64) {
    to.par_chunks_mut(BAND).zip(what.par_chunks(BAND)).for_each(|(to, what)| {
        to.iter_mut().zip(what).for_each(|(a, b)| *a += *b * scale);
    });
}

/// The scalar product of two lists of vectors.
pub(crate) fn dot(a: &[DVec2], b: &[DVec2]) -> f64 {
    let band = |(a, b): (&[DVec2], &[DVec2])| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
    if a.len() <= BAND {
        return band((a, b));
    }
    let bands: Vec<f64> = a.par_chunks(BAND).zip(b.par_chunks(BAND)).map(band).collect();
    bands.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// Protects the secant condition: what was learnt from the last step is repeated, H y = s.
    #[test]
    fn the_last_pair_is_met() {
        let mut memory = Lbfgs::new(2);
        let (zero, free) = ([DVec2::ZERO; 2], [DVec2::ONE; 2]);
        memory.remember(
            &zero,
            &[dvec2(1.0, 0.5), dvec2(0.0, 1.0)],
            &zero,
            &[dvec2(3.0, 1.0), dvec2(0.5, 2.0)],
        );
        let (s, y) = ([dvec2(0.2, 0.1), dvec2(-0.3, 0.4)], [dvec2(1.0, 0.3), dvec2(-2.0, 1.0)]);
        memory.remember(&zero, &s, &zero, &y);
        for (got, want) in memory.direction(&y, &Identity, &free).iter().zip(&s) {
            assert!((*got + *want).length() < 1e-12);
        }
    }

    /// Protects definiteness: a pair without positive curvature leaves no trace.
    #[test]
    fn negative_curvature_is_refused() {
        let mut memory = Lbfgs::new(2);
        memory.remember(&[DVec2::ZERO], &[DVec2::ONE], &[DVec2::ZERO], &[-DVec2::ONE]);
        assert!(memory.is_empty());
    }
}
