//! What a surface looks like from all cameras, kept while it changes, and what a change of it would do to the
//! error (`target.rs`).
//!
//! ```text
//! surface ─ view.rs ─ what is seen at each pixel ─┬ growth.rs ─ what a change would do to the error
//!                                                 └ the view after a change
//! ```
//!
//! Contract: [`Pictures::error`] is the sum over all pixels of all views, divided by their number. What
//! [`Pictures::best_of_each`] says of a change is what [`Pictures::apply`] does to it, up to rounding; where a new
//! triangle lies behind the one that it replaces, what may come to light between them is only looked for when it
//! is applied. Views are summed in order, so results do not depend on the number of threads.

use crate::change::Change;
use crate::growth::Scratch;
use crate::surface::Surface;
use crate::target::Target;
use crate::view::{NOTHING, View};
use rayon::prelude::*;

/// Of several changes the best is guessed from one view in so many.
const GUESSED_FROM: usize = 4;
/// Views that are worth a thread's while.
const VIEWS_AT_ONCE: usize = 8;

/// The surface in all views.
#[derive(Clone)]
pub struct Pictures<'a> {
    targets: &'a [Target],
    views: Vec<View>,
    /// The surface that is seen.
    pub surface: Surface,
}

impl<'a> Pictures<'a> {
    /// Draws a surface in the common frame.
    pub fn new(targets: &'a [Target], surface: Surface) -> Self {
        let views = targets.par_iter().map(|target| View::new(target, &surface)).collect();
        Self { targets, views, surface }
    }

    /// Looks at the surface from other cameras from now on.
    pub fn look_from(&mut self, targets: &'a [Target]) {
        if !std::ptr::eq(self.targets, targets) {
            *self = Self::new(targets, std::mem::take(&mut self.surface));
        }
    }

    /// The mean error of a pixel.
    pub fn error(&self) -> f64 {
        let sum: f64 = self.views.iter().map(|view| view.error).sum();
        sum / self.pixels()
    }

    /// Pixels of all views.
    pub fn pixels(&self) -> f64 {
        self.targets.iter().map(|target| target.pixels.len()).sum::<usize>().max(1) as f64
    }

    /// Of the changes that a place may have the one that gains most, and by how much it would lessen the error; negative where
    /// that grows. Where there are several, a few views rule out all but one.
    pub fn best_of(&self, changes: Vec<Change>) -> Option<(f64, Change)> {
        self.best_of_each(vec![changes]).pop().flatten()
    }

    /// The same for many places, all of this state of the surface. View by view, since the memory of one fits into a
    /// processor's cache, and that of all does not.
    pub fn best_of_each(&self, places: Vec<Vec<Change>>) -> Vec<Option<(f64, Change)>> {
        let views = || self.views.par_iter().zip(self.targets);
        let several = || places.iter().filter(|changes| changes.len() > 1).flatten();
        let few = views().step_by(GUESSED_FROM).with_min_len(VIEWS_AT_ONCE / GUESSED_FROM);
        let guesses: Vec<Vec<f64>> = few
            .map_init(Scratch::default, |scratch, (view, target)| {
                view.growths(target, &self.surface, several(), scratch)
            })
            .collect();
        let best = likely_best(places, &guesses);
        let growths: Vec<Vec<f64>> = (views().enumerate().with_min_len(VIEWS_AT_ONCE))
            .map_init(Scratch::default, |scratch, (index, (view, target))| {
                let open = best.iter().flatten().filter(|best| best.known(index).is_none());
                let changes = open.map(|best| &best.change);
                let mut found = view.growths(target, &self.surface, changes, scratch).into_iter();
                let growth = |best: &Option<Best>| match best {
                    Some(best) => best.known(index).or_else(|| found.next()).unwrap_or_default(),
                    None => 0.0,
                };
                best.iter().map(growth).collect()
            })
            .collect();
        let gain = |place: usize| -growths.iter().map(|of_view| of_view[place]).sum::<f64>() / self.pixels();
        let with_gain = |(place, best): (usize, Option<Best>)| best.map(|best| (gain(place), best.change));
        best.into_iter().enumerate().map(with_gain).collect()
    }

    /// Makes a change.
    pub fn apply(&mut self, change: &Change) {
        let removed = change.removed.iter().filter_map(|&t| Some((t, self.surface.get(t)?.corners)));
        let removed: Vec<_> = removed.collect();
        let added = self.surface.apply(change);
        let surface = &self.surface;
        let views = self.views.par_iter_mut().zip(self.targets);
        views.for_each(|(view, target)| view.update(target, surface, &removed, &added, change.moved));
    }

    /// Sum of the errors of the pixels at which each triangle is seen, by the triangles' indices.
    pub fn errors_by_triangle(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.surface.indices()];
        for view in &self.views {
            for shown in view.pixels.iter().filter(|shown| shown.triangle != NOTHING) {
                out[shown.triangle as usize] += f64::from(shown.error);
            }
        }
        out
    }
}

/// A change that is likely to be the best of its place.
struct Best {
    change: Change,
    /// By how much the error grows in every [`GUESSED_FROM`]th view; empty if there was no other change.
    guessed: Vec<f64>,
}

impl Best {
    /// By how much the error grows in this view, if that was guessed from.
    fn known(&self, view: usize) -> Option<f64> {
        self.guessed.get(view / GUESSED_FROM).copied().filter(|_| view.is_multiple_of(GUESSED_FROM))
    }
}

/// Of each place the change under which the error grows least in those views that all were looked at from, the last of
/// those that are alike. `guesses` are of each of these views, and in it of all changes of places with several.
fn likely_best(places: Vec<Vec<Change>>, guesses: &[Vec<f64>]) -> Vec<Option<Best>> {
    let mut begin = 0;
    let best = |mut changes: Vec<Change>| {
        if changes.len() < 2 {
            return changes.pop().map(|change| Best { change, guessed: Vec::new() });
        }
        let own = begin..begin + changes.len();
        begin = own.end;
        let growth = |change: usize| guesses.iter().map(|of_view| of_view[change]).sum::<f64>();
        let least = own.clone().rev().min_by(|&a, &b| growth(a).total_cmp(&growth(b)))?;
        let guessed = guesses.iter().map(|of_view| of_view[least]).collect();
        Some(Best { change: changes.swap_remove(least - own.start), guessed })
    };
    places.into_iter().map(best).collect()
}
