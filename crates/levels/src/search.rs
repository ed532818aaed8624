//! The smallest file that reaches a PSNR, over triangles × texels × maps, with few bakes.
//!
//! A bake takes seconds; variants of it are cheap: its maps can be halved, or become factors, and the result be
//! rendered. So bakes are spent on triangles and on the largest texture, and each is followed by measured
//! reductions of its maps. Errors add up:
//!
//! ```text
//! error(triangles, choice) ≈ error of the bake · (triangles' share falls by a power law) + Σ errors of reduced maps
//! bytes(triangles, choice) ≈ bytes of the mesh (a part for each triangle)              + Σ bytes of reduced maps
//! ```
//!
//! The next bake has the triangles at which the choice with the least bytes is expected to reach the target. What was
//! measured corrects the power law, and tells which bytes of the mesh are always there.
//!
//! Contract: at most [`MOST_BAKES`] bakes; only what was measured is ever taken. Deterministic.

use serde::{Deserialize, Serialize};

/// Bakes of a level, at most.
pub const MOST_BAKES: usize = 8;
/// Decibels above the target within which a level is to end.
pub const WINDOW: f64 = 0.5;
/// Decibels above the target that bakes are planned for.
const AIM: f64 = 0.15;
/// A plan that saves less of the best file is not worth a bake.
const LEAST_GAIN: f64 = 0.03;
/// Of what halved maps add to the error, what a bake of that size adds: charts are laid out and fitted for it.
const DIRECT: f64 = 0.7;
/// Share of the smallest file by which one may be larger that ends within the window, where that does not.
const FOR_WINDOW: f64 = 0.03;
/// Power of the triangles with which their error falls, before two bakes have told it.
const FALL: f64 = 1.4;
/// The same as measured, at least and at most.
const FALLS: [f64; 2] = [0.4, 4.0];
/// Logarithm of the ratio of triangles from which on two bakes tell it.
const APART: f64 = 0.25;
/// Share of a bake's error that its triangles are for, at least.
const LEAST_SHARE: f64 = 0.2;
/// Triangle counts that differ by less give the same.
const SAME: f64 = 0.02;
/// Reductions of a bake that are measured with what they come to together, at most.
const MOST_MEASURED: usize = 8;

/// Triangles and texels along a side of a bake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of the largest map.
    pub texture_size: usize,
}

/// A size that a map may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Texels along a side; 0 where a factor, its mean, stands for it.
    pub size: usize,
    /// Bytes of the map in the file.
    pub bytes: u64,
    /// What that adds to the mean squared error, all other maps as they were baked.
    pub error: f64,
}

/// What came of a bake.
#[derive(Clone, Debug, PartialEq)]
pub struct Baking {
    /// What was asked for.
    pub asked: Plan,
    /// What came of it: it may have fewer triangles, and more texels where its charts did not fit, or fewer
    /// where time was short.
    pub plan: Plan,
    /// Bytes of all but the maps.
    pub mesh_bytes: u64,
    /// Mean squared error with all maps as baked.
    pub error: f64,
    /// Steps of each map; the first is as baked.
    pub maps: Vec<Vec<Step>>,
}

/// A step of each map of a bake.
pub type Choice = Vec<usize>;

/// A choice of a bake that was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Which step of each map.
    pub choice: Choice,
    /// Bytes of the file.
    pub bytes: u64,
    /// PSNR in dB.
    pub psnr: f64,
}

/// The same in a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Of which bake.
    pub bake: usize,
    /// Which step of each map.
    pub choice: Choice,
    /// Bytes of the file.
    pub bytes: u64,
    /// PSNR in dB.
    pub psnr: f64,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The file reaches the target and is at most half a decibel above it.
    Reached,
    /// The smallest file that was found is farther above the target.
    Above,
    /// No file reaches the target.
    Missed,
    /// Time or a signal ended the search before one did.
    Stopped,
}

/// PSNR in dB above which pictures show no difference.
pub(crate) const INVISIBLE: f64 = 60.0;

/// Mean squared error of a PSNR.
pub fn error_of(psnr: f64) -> f64 {
    10f64.powf(-psnr / 10.0)
}

/// All that is known.
#[derive(Clone, Debug)]
pub struct Search {
    target: f64,
    first: Plan,
    least_triangles: usize,
    most: Plan,
    bakings: Vec<Baking>,
    /// All that was measured, in the order in which it was.
    pub outcomes: Vec<Outcome>,
}

impl Baking {
    /// Whether this is what would come of a plan: from what was asked for to what came, all gives the same.
    fn is_of(&self, plan: Plan) -> bool {
        let [asked, came] = [self.asked, self.plan].map(|own| own.triangles as f64);
        let same = (1.0 - SAME) * came.min(asked)..=(1.0 + SAME) * came.max(asked);
        let sizes = [self.asked, self.plan].map(|own| own.texture_size);
        sizes.contains(&plan.texture_size) && same.contains(&(plan.triangles as f64))
    }

    /// Bytes of the maps and what their reduction adds to the error.
    fn cost(&self, choice: &[usize]) -> (u64, f64) {
        let steps = self.maps.iter().zip(choice).map(|(steps, &step)| steps[step]);
        steps.fold((0, 0.0), |(bytes, error), step| (bytes + step.bytes, error + step.error))
    }

    /// The largest map of a choice.
    fn size(&self, choice: &[usize]) -> usize {
        self.maps.iter().zip(choice).map(|(steps, &step)| steps[step].size).max().unwrap_or(0)
    }

    /// Every step of every map with every other.
    fn choices(&self) -> Vec<Choice> {
        self.maps.iter().fold(vec![Vec::new()], |all, steps| {
            all.iter()
                .flat_map(|choice| (0..steps.len()).map(move |step| [&choice[..], &[step]].concat()))
                .collect()
        })
    }

    /// Choices that no other beats in bytes and in error, from few bytes to many.
    fn frontier(&self) -> Vec<(Choice, f64)> {
        let mut all: Vec<(u64, f64, Choice)> = self
            .choices()
            .into_iter()
            .map(|choice| {
                let (bytes, error) = self.cost(&choice);
                (bytes, error, choice)
            })
            .collect();
        all.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut best = f64::INFINITY;
        let mut frontier = Vec::new();
        for (_, error, choice) in all {
            if error < best {
                best = error;
                frontier.push((choice, self.error + error));
            }
        }
        frontier
    }

    /// Measures the choices around the one with the fewest bytes that should reach the target: those with more until
    /// one does, then those with less as long as they do. `measure` gives bytes and PSNR.
    pub fn measured<E>(
        &self,
        target: f64,
        mut measure: impl FnMut(&Choice) -> Result<(u64, f64), E>,
    ) -> Result<Vec<Measured>, E> {
        let frontier = self.frontier();
        let wanted = error_of(target);
        let first = frontier.iter().position(|(_, error)| *error <= wanted).unwrap_or(frontier.len() - 1);
        let mut found = Vec::new();
        let mut reaches = |place: usize, found: &mut Vec<Measured>| {
            let choice = &frontier[place].0;
            let (bytes, psnr) = measure(choice)?;
            found.push(Measured { choice: choice.clone(), bytes, psnr });
            Ok(psnr >= target)
        };
        let mut place = first;
        let mut is_reached = reaches(place, &mut found)?;
        while !is_reached && place + 1 < frontier.len() && found.len() < MOST_MEASURED {
            // What is far off is left in larger steps.
            let missing = target - found.last().map_or(target, |last| last.psnr);
            let stride = if missing > 1.0 { 1 + (frontier.len() - place) / 4 } else { 1 };
            place = (place + stride).min(frontier.len() - 1);
            is_reached = reaches(place, &mut found)?;
        }
        if is_reached && place == first {
            while place > 0 && found.len() < MOST_MEASURED && is_reached {
                place -= 1;
                is_reached = reaches(place, &mut found)?;
            }
        }
        Ok(found)
    }
}

impl Search {
    /// Looks for `target` dB between `least_triangles` and `most`, from `first` on.
    pub fn new(target: f64, first: Plan, least_triangles: usize, most: Plan) -> Self {
        let triangles = first.triangles.clamp(least_triangles.min(most.triangles), most.triangles);
        let texture_size = first.texture_size.min(most.texture_size);
        let first = Plan { triangles, texture_size };
        Self { target, first, least_triangles, most, bakings: Vec::new(), outcomes: Vec::new() }
    }

    /// How many bakes there were.
    pub fn bakes(&self) -> usize {
        self.bakings.len()
    }

    /// Takes note of a bake and of what was measured of it.
    pub fn note(&mut self, baking: Baking, measured: Vec<Measured>) {
        let bake = self.bakings.len();
        let outcome = |Measured { choice, bytes, psnr }| Outcome { bake, choice, bytes, psnr };
        self.outcomes.extend(measured.into_iter().map(outcome));
        self.bakings.push(baking);
    }

    /// The smallest file that reaches the target, or one that is hardly larger and closer to it; else the one that comes closest.
    pub fn best(&self) -> Option<usize> {
        let all = 0..self.outcomes.len();
        let reached = || all.clone().filter(|&k| self.outcomes[k].psnr >= self.target);
        let smallest = |k: &usize| (self.outcomes[*k].bytes, *k);
        if let Some(best) = reached().min_by_key(smallest) {
            let limit = self.outcomes[best].bytes as f64 * (1.0 + FOR_WINDOW);
            let ends_well = |k: &usize| {
                let own = &self.outcomes[*k];
                own.psnr <= self.target + WINDOW && own.bytes as f64 <= limit
            };
            return reached().filter(ends_well).min_by_key(smallest).or(Some(best));
        }
        all.max_by(|&a, &b| self.outcomes[a].psnr.total_cmp(&self.outcomes[b].psnr).then(b.cmp(&a)))
    }

    /// How it ended; `stopped` says that there would have been more to try.
    pub fn verdict(&self, stopped: bool) -> Verdict {
        match self.best().map(|best| self.outcomes[best].psnr - self.target) {
            Some(above) if above > WINDOW => Verdict::Above,
            Some(above) if above >= 0.0 => Verdict::Reached,
            _ if stopped => Verdict::Stopped,
            _ => Verdict::Missed,
        }
    }

    /// What to bake next; none where nothing that is left to try is worth it.
    pub fn next(&self) -> Option<Plan> {
        if self.bakings.is_empty() {
            return Some(self.first);
        }
        if self.bakings.len() == MOST_BAKES {
            return None;
        }
        let best = self.best().map(|best| &self.outcomes[best]).filter(|best| best.psnr >= self.target);
        let limit = match best {
            None => f64::INFINITY,
            Some(best) if best.psnr > self.target + WINDOW => best.bytes as f64 * (1.0 + FOR_WINDOW),
            Some(best) => best.bytes as f64 * (1.0 - LEAST_GAIN),
        };
        let mut plans = self.plans();
        plans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let planned =
            plans.into_iter().take_while(|(bytes, _)| *bytes < limit).find_map(|(_, plan)| self.fresh(plan));
        planned.or_else(|| if best.is_none() { self.more() } else { None })
    }

    /// The plan if it is not what was baked already; a little more where that did not reach the target.
    fn fresh(&self, plan: Plan) -> Option<Plan> {
        let near = |plan: Plan| self.bakings.iter().position(|baking| baking.is_of(plan));
        let Some(bake) = near(plan) else { return Some(plan) };
        let is_reached = self.outcomes.iter().any(|o| o.bake == bake && o.psnr >= self.target);
        let own = self.bakings[bake].asked.triangles as f64;
        let triangles = ((1.0 + 1.5 * SAME) * own).ceil() as usize + 1;
        let more = Plan { triangles: triangles.min(self.most.triangles), ..plan };
        (!is_reached && near(more).is_none()).then_some(more)
    }

    /// Where nothing reaches the target: all triangles, then more texels.
    fn more(&self) -> Option<Plan> {
        let largest = self.bakings.iter().map(|baking| baking.plan.texture_size).max()?;
        let sizes = std::iter::successors(Some(largest), |size| Some(2 * size));
        let all = sizes.take_while(|&size| size <= self.most.texture_size);
        let mut plans = all.map(|texture_size| Plan { triangles: self.most.triangles, texture_size });
        plans.find(|plan| self.bakings.iter().all(|baking| ![baking.asked, baking.plan].contains(plan)))
    }

    /// For each choice of each bake the bytes that it would have with the triangles that it needs.
    fn plans(&self) -> Vec<(f64, Plan)> {
        let wanted = error_of(self.target + AIM);
        let mut plans = Vec::new();
        for (bake, baking) in self.bakings.iter().enumerate() {
            for choice in baking.choices() {
                let size = baking.size(&choice).max(LEAST_TEXTURE);
                let has_own = self.bakings.iter().any(|other| other.plan.texture_size == size);
                if size != baking.plan.texture_size && has_own {
                    continue;
                }
                let (mut bytes, mut error) = baking.cost(&choice);
                if let Some(own) = self.outcomes.iter().find(|o| o.bake == bake && o.choice == choice) {
                    // Errors hardly ever add up exactly.
                    error = error_of(own.psnr) - baking.error;
                    bytes = own.bytes.saturating_sub(baking.mesh_bytes);
                }
                if size != baking.plan.texture_size {
                    error *= DIRECT;
                }
                let Some(triangles) = self.triangles_for(baking, wanted - error) else { continue };
                let plan = Plan { triangles, texture_size: size };
                if self.is_hopeless(plan) {
                    continue;
                }
                let bytes = bytes as f64 + self.mesh_bytes_at(baking, triangles as f64);
                plans.push((bytes, plan));
            }
        }
        plans
    }

    /// The triangles with which bakes of this one's texture should have such an error.
    fn triangles_for(&self, baking: &Baking, error: f64) -> Option<usize> {
        let [least, most] = [self.least_triangles as f64, self.most.triangles as f64];
        if self.error_at(baking, most) > error {
            return None;
        }
        let (mut low, mut high) = (least.ln(), most.ln());
        if self.error_at(baking, least) <= error {
            high = low;
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.error_at(baking, middle.exp()) <= error { high = middle } else { low = middle }
        }
        Some((high.exp().ceil() as usize).clamp(self.least_triangles, self.most.triangles))
    }

    /// The error of a bake with this one's texture and so many triangles: its triangles' part falls by a power of them,
    /// which the bakes next to there tell.
    fn error_at(&self, baking: &Baking, triangles: f64) -> f64 {
        let own = self.error_of_triangles(baking);
        let at = baking.plan.triangles as f64;
        let fall = self.beside(baking, triangles).map_or(FALL, |other| {
            let fallen = (self.error_of_triangles(other) / own).ln();
            (-fallen / (other.plan.triangles as f64 / at).ln()).clamp(FALLS[0], FALLS[1])
        });
        baking.error - own + own * (triangles / at).powf(-fall)
    }

    /// Bytes of all but the maps with so many triangles: a part of them, as skeletons and animations, is always there.
    fn mesh_bytes_at(&self, baking: &Baking, triangles: f64) -> f64 {
        let (at, own) = (baking.plan.triangles as f64, baking.mesh_bytes as f64);
        let of_one = self.beside(baking, triangles).map_or(own / at, |other| {
            let slope = (own - other.mesh_bytes as f64) / (at - other.plan.triangles as f64);
            slope.clamp(0.0, own / at)
        });
        // The less of both guesses: a bake in vain costs seconds, and a file that is never tried is not found.
        (own + of_one * (triangles - at)).min(own * triangles / at)
    }

    /// The bake that tells, with this one, what so many triangles do: the nearest to there of those that are far enough
    /// from this one.
    fn beside(&self, baking: &Baking, triangles: f64) -> Option<&Baking> {
        let far = |from: f64, other: &Baking| (other.plan.triangles as f64 / from).ln().abs();
        let at = baking.plan.triangles as f64;
        let others = self.bakings.iter().filter(|other| far(at, other) > APART);
        others.min_by(|a, b| far(triangles, a).total_cmp(&far(triangles, b)))
    }

    /// What of a bake's error its triangles are for: what a bake of as many texels as there were in any would have left.
    fn error_of_triangles(&self, baking: &Baking) -> f64 {
        let finest = self.bakings.iter().rev().max_by_key(|b| b.plan.texture_size).unwrap_or(baking);
        let size = baking.plan.texture_size;
        let of_map = |steps: &Vec<Step>| {
            let halved = steps.iter().take_while(|step| step.size > 0);
            halved.take_while(|step| step.size >= size).last().map_or(0.0, |step| step.error)
        };
        let of_texels = DIRECT * finest.maps.iter().map(of_map).sum::<f64>();
        (baking.error - of_texels).max(LEAST_SHARE * baking.error)
    }

    /// Whether a bake with no less of anything did not reach the target.
    fn is_hopeless(&self, plan: Plan) -> bool {
        let wanted = error_of(self.target);
        let has_more = |own: Plan| {
            own.texture_size >= plan.texture_size
                && own.triangles as f64 >= (1.0 - SAME) * plan.triangles as f64
        };
        self.bakings.iter().any(|baking| has_more(baking.plan) && baking.error > wanted)
    }
}

/// Texels along a side of a bake, at least.
pub const LEAST_TEXTURE: usize = 16;

#[cfg(test)]
#[path = "search_tests.rs"]
mod tests;
