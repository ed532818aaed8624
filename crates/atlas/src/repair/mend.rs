//! Faults mended where they are: only what is faulty gets other coordinates.
//!
//! ```text
//! charts in other tiles               moved by whole tiles
//! all charts mirrored                 the whole layout mirrored
//! charts mirrored, or folded in half  mirrored back, on the spot or in free space
//! charts across the border            moved inside
//! slivers without area                opened by a part of a texel (points.rs)
//! faulty triangles, a few of a chart  laid out afresh in free space
//! charts on others                    the smaller one moved aside or into free space
//! ```
//!
//! That goes on until nothing is wrong, since coordinates are rounded. Free space is found by
//! `pack/free_space.rs`.
//!
//! Contract: what comes out has passed the exact check; what had no fault, and nothing on it that had to
//! make way, keeps its coordinates to the bit. None where too much is wrong, or no place is left.

mod points;

use super::corners_of;
use super::faults::{MOST_FAULTS, MOST_PIECES};
use crate::conflicts;
use crate::pack::free_space::place;
use crate::predicates::orientation;
use crate::unwrap::corners::{Corners, NONE, Surface};
use crate::unwrap::flatten::flatten;
use crate::unwrap::sound::{at_fault, by_chart};
use crate::{Layout, PackOptions, check};
use glam::DVec2;
use parbake_model::Mesh;

/// Rounds of finding faults and mending them.
const ROUNDS: usize = 5;
/// Where more than this share of the area that charts cover would move, all may as well be packed again.
const MOST_MOVED: f64 = 0.5;
/// Texels that a corner may lie outside the square to be drawn onto its border.
const HAIR: f64 = 0.02;

/// What is asked for.
pub(crate) struct MendOptions<'a> {
    /// Texture size and gutter; what moves keeps it.
    pub pack: &'a PackOptions,
    /// Whether what does not move must have that gutter too.
    pub gutter_required: bool,
    /// As in [`crate::UnwrapOptions`].
    pub max_chart_angle: f32,
}

/// What was done.
#[derive(Clone, Default)]
struct Told {
    tiles: bool,
    outside: usize,
    whole_mirrored: bool,
    mirrored: usize,
    folded: usize,
    slivers: usize,
    fresh: usize,
    moved: usize,
    smaller: usize,
}

/// The layout with each triangle's part: what keeps its place, and what looks for one.
#[derive(Clone)]
struct Work {
    corners: Corners,
    /// One flag for each triangle: whether it still needs a place.
    free: Vec<bool>,
    told: Told,
}

/// The mesh with its layout mended, and what was done, in sentences.
pub(crate) fn mended(surface: &Surface, options: &MendOptions) -> Option<(Mesh, Vec<String>)> {
    // Whole charts make way if there is room for them; else only their triangles that lie on others.
    [false, true].into_iter().find_map(|in_parts| attempt(surface, options, in_parts))
}

fn attempt(surface: &Surface, options: &MendOptions, in_parts: bool) -> Option<(Mesh, Vec<String>)> {
    let count = surface.mesh.triangles.len();
    let mut work = Work { corners: corners_of(surface), free: vec![false; count], told: Told::default() };
    work.bring_home(surface, options)?;
    for round in 0..ROUNDS {
        work.turn_over(surface)?;
        work.lay_afresh(surface, options)?;
        work.make_way(surface, options, in_parts)?;
        if !work.free.iter().any(|free| *free) {
            return work.finished(surface, options, round);
        }
        work.place(surface, options)?;
    }
    work.finished(surface, options, ROUNDS)
}

impl Work {
    /// Charts in other tiles are moved back by whole tiles, those across a border by less. None where one
    /// is longer than the square.
    fn bring_home(&mut self, surface: &Surface, options: &MendOptions) -> Option<()> {
        let slack = HAIR / options.pack.texture_size as f64;
        for triangles in by_chart(&surface.delivered) {
            let corners = || triangles.iter().flat_map(|&t| surface.delivered.corners(t as usize));
            let low = corners().fold(DVec2::INFINITY, DVec2::min);
            let high = corners().fold(DVec2::NEG_INFINITY, DVec2::max);
            if !(low.is_finite() && high.is_finite()) || (high - low).max_element() > 1.0 + 2.0 * slack {
                return None;
            }
            let tile = (low + slack).floor();
            let across = (high - tile).max_element() > 1.0 + slack;
            // The place in the square that is nearest to its own.
            let nearest = (-tile).max(-low).min(DVec2::ONE - high);
            let by = if across { nearest } else { -tile };
            self.told.tiles |= !across && tile != DVec2::ZERO;
            let is_live = triangles.iter().any(|&t| self.corners.chart[t as usize] != NONE);
            self.told.outside += usize::from(across && is_live);
            for &t in &triangles {
                let t = t as usize;
                for p in &mut self.corners.uv[t] {
                    *p = (*p + by).clamp(DVec2::ZERO, DVec2::ONE).as_vec2().as_dvec2();
                }
                self.free[t] = across && self.corners.chart[t] != NONE;
            }
        }
        Some(())
    }

    fn live(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.free.len()).filter(|&t| self.corners.chart[t] != NONE)
    }

    fn sign(&self, t: usize) -> f64 {
        let [a, b, c] = self.corners.uv[t];
        orientation(a, b, c)
    }

    /// The live triangles of each label.
    fn by_label(&self) -> Vec<Vec<usize>> {
        let mut labelled: Vec<(u32, usize)> = self.live().map(|t| (self.corners.chart[t], t)).collect();
        labelled.sort_unstable();
        labelled.chunk_by(|a, b| a.0 == b.0).map(|run| run.iter().map(|(_, t)| *t).collect()).collect()
    }

    /// Mirrored charts are mirrored back, folded ones cut along the fold.
    fn turn_over(&mut self, surface: &Surface) -> Option<()> {
        let charts = self.by_label();
        let area = |sign: f64, chart: &[usize]| -> f64 {
            let own = chart.iter().filter(|&&t| self.sign(t) * sign > 0.0);
            own.map(|&t| surface.delivered.rest_area(t)).sum()
        };
        let areas: Vec<[f64; 2]> = charts.iter().map(|c| [area(1.0, c), area(-1.0, c)]).collect();
        let is_mirrored = |[front, back]: &[f64; 2]| front < back;
        let is_folded = |[front, back]: &[f64; 2]| front.min(*back) > MOST_FAULTS * (front + back);
        let turned = areas.iter().filter(|a| is_mirrored(a)).count();
        if turned > 0 && areas.iter().all(|a| (is_mirrored(a) || a[0] + a[1] == 0.0) && !is_folded(a)) {
            self.corners.uv.iter_mut().flatten().for_each(|p| p.x = f64::from(1.0 - p.x as f32));
            (self.told.whole_mirrored, self.told.mirrored) = (true, turned);
            return Some(());
        }
        for (chart, areas) in charts.iter().zip(&areas) {
            let mirrored: Vec<usize> = if is_folded(areas) {
                let own: Vec<u32> = chart.iter().map(|&t| t as u32).collect();
                let backs: Vec<usize> = chart.iter().copied().filter(|&t| self.sign(t) < 0.0).collect();
                let before = self.corners.chart.clone();
                backs.iter().for_each(|&t| self.corners.chart[t] = self.corners.next);
                let pieces = surface.connected(&self.corners, &own).1.into_iter().max().map_or(0, |p| p + 1);
                if pieces as usize > MOST_PIECES {
                    // Noise rather than folded: found to be faulty triangles next.
                    self.corners.chart = before;
                    continue;
                }
                self.corners.next += 1;
                self.told.folded += 1;
                backs
            } else if is_mirrored(areas) {
                self.told.mirrored += 1;
                chart.clone()
            } else {
                continue;
            };
            let xs = || mirrored.iter().flat_map(|&t| self.corners.uv[t]).map(|p| p.x);
            let sum = xs().fold(f64::INFINITY, f64::min) + xs().fold(f64::NEG_INFINITY, f64::max);
            for &t in &mirrored {
                self.corners.uv[t].iter_mut().for_each(|p| p.x = sum - p.x);
                self.free[t] = true;
            }
        }
        Some(())
    }

    /// Triangles without area and those on others of their chart are opened or laid out afresh.
    fn lay_afresh(&mut self, surface: &Surface, options: &MendOptions) -> Option<()> {
        let (mut layout, live) = surface.layout(&self.corners);
        let mut faults = at_fault(&layout);
        if faults.is_empty() {
            return Some(());
        }
        let charts = layout.charts.iter().max().map_or(0, |c| *c as usize + 1);
        let mut sums = vec![[0.0; 3]; charts];
        for i in 0..live.len() {
            let sums = &mut sums[layout.charts[i] as usize];
            sums[0] += 0.5 * layout.doubled_area(i).abs();
            sums[1] += layout.rest_area(i);
        }
        // A chart that is drawn without area would have been drawn as large as the others.
        let (drawn, space) = sums.iter().fold((0.0, 0.0), |all, own| (all.0 + own[0], all.1 + own[1]));
        let scale = |drawn: f64, space: f64| (drawn / space.max(f64::MIN_POSITIVE)).sqrt();
        let whole = scale(drawn, space);
        let scales: Vec<f64> = sums.iter().map(|own| scale(own[0], own[1]).max(whole)).collect();
        let opened = points::open_slivers(&mut layout, &faults, &scales, options.pack.texture_size);
        if !opened.is_empty() {
            self.told.slivers += opened.len();
            live.iter().enumerate().for_each(|(i, &t)| self.corners.uv[t as usize] = layout.corners(i));
            faults = at_fault(&layout);
        }
        faults
            .iter()
            .for_each(|&i| sums[layout.charts[i as usize] as usize][2] += layout.rest_area(i as usize));
        let mut is_fresh = vec![false; live.len()];
        faults.iter().for_each(|&i| is_fresh[i as usize] = true);
        for (i, fresh) in is_fresh.iter_mut().enumerate() {
            let [_, space, faulty] = sums[layout.charts[i] as usize];
            *fresh |= faulty > MOST_FAULTS * space;
        }
        let fresh: Vec<u32> = (0..live.len()).filter(|&i| is_fresh[i]).map(|i| live[i]).collect();
        if fresh.is_empty() {
            return Some(());
        }
        let (mut drawn, mut space, mut all) = (0.0, 0.0, 0.0);
        for (i, is_fresh) in is_fresh.iter().enumerate() {
            all += layout.rest_area(i);
            if !is_fresh {
                drawn += 0.5 * layout.doubled_area(i);
                space += layout.rest_area(i);
            }
        }
        if space < (1.0 - MOST_MOVED) * all {
            return None;
        }
        let scale = (drawn / space).sqrt();
        flatten(surface, &mut self.corners, &fresh, options.max_chart_angle);
        for &t in &fresh {
            let t = t as usize;
            self.corners.uv[t].iter_mut().for_each(|p| *p *= scale);
            self.free[t] = true;
        }
        self.told.fresh += fresh.len();
        Some(())
    }

    /// Of charts that lie on each other the smaller ones make way, or their triangles that do.
    fn make_way(&mut self, surface: &Surface, options: &MendOptions, in_parts: bool) -> Option<()> {
        let (layout, live) = surface.layout(&self.corners);
        let charts = layout.charts.iter().max().map_or(0, |c| *c as usize + 1);
        let mut is_free = vec![false; charts];
        (0..live.len()).for_each(|i| is_free[layout.charts[i] as usize] |= self.free[live[i] as usize]);
        let mut pairs = conflicts::overlapping(&layout)?;
        if options.gutter_required {
            let gutter = options.pack.gutter_texels / options.pack.texture_size as f64;
            pairs.extend(conflicts::close(&layout, gutter)?);
        }
        let chart = |i: u32| layout.charts[i as usize] as usize;
        pairs.retain(|&[a, b]| chart(a) != chart(b) && !is_free[chart(a)] && !is_free[chart(b)]);
        let (mut area, mut total) = (vec![0.0; charts], 0.0);
        for i in 0..live.len() {
            area[layout.charts[i] as usize] += 0.5 * layout.doubled_area(i).abs();
            total += 0.5 * layout.doubled_area(i).abs();
        }
        let mut others: Vec<Vec<(u32, u32)>> = vec![Vec::new(); charts];
        for &[a, b] in &pairs {
            others[chart(a)].push((a, b));
            others[chart(b)].push((b, a));
        }
        let mut order: Vec<usize> = (0..charts).filter(|&c| !others[c].is_empty()).collect();
        order.sort_by(|&a, &b| area[b].total_cmp(&area[a]).then(a.cmp(&b)));
        let mut stays: Vec<bool> = is_free.iter().map(|free| !free).collect();
        order.iter().for_each(|&c| stays[c] = false);
        let mut cut = Vec::new();
        for c in order {
            let mut on_others: Vec<u32> =
                others[c].iter().filter(|(_, other)| stays[chart(*other)]).map(|(own, _)| *own).collect();
            on_others.sort_unstable();
            on_others.dedup();
            let own: f64 = on_others.iter().map(|&i| 0.5 * layout.doubled_area(i as usize).abs()).sum();
            if on_others.is_empty() {
                stays[c] = true;
            } else if in_parts && own < MOST_FAULTS * area[c] {
                stays[c] = true;
                cut.extend(on_others);
            } else {
                is_free[c] = true;
                self.told.moved += 1;
            }
        }
        (0..live.len()).for_each(|i| self.free[live[i] as usize] |= is_free[layout.charts[i] as usize]);
        if !cut.is_empty() {
            self.told.fresh += cut.len();
            for &i in &cut {
                self.corners.chart[live[i as usize] as usize] = self.corners.next;
                self.free[live[i as usize] as usize] = true;
            }
            self.corners.next += 1;
        }
        let moved: f64 = (0..live.len())
            .filter(|&i| self.free[live[i] as usize])
            .map(|i| 0.5 * layout.doubled_area(i).abs())
            .sum();
        (moved <= MOST_MOVED * total && total < 1.0).then_some(())
    }

    /// What is free gets its place.
    fn place(&mut self, surface: &Surface, options: &MendOptions) -> Option<()> {
        let (layout, live) = surface.layout(&self.corners);
        let mut is_free = vec![false; layout.charts.iter().max().map_or(0, |c| *c as usize + 1)];
        (0..live.len()).for_each(|i| is_free[layout.charts[i] as usize] |= self.free[live[i] as usize]);
        let placed = place(&layout, &is_free, options.pack)?;
        self.told.smaller += placed.smaller;
        for (i, &t) in live.iter().enumerate() {
            if is_free[layout.charts[i] as usize] {
                self.corners.uv[t as usize] = placed.layout.corners(i);
                // Charts that share no edge go their own ways from now on.
                self.corners.chart[t as usize] = self.corners.next + layout.charts[i];
            }
        }
        self.corners.next += is_free.len() as u32;
        self.free.fill(false);
        Some(())
    }

    /// The mesh, if the exact check finds nothing.
    fn finished(
        mut self,
        surface: &Surface,
        options: &MendOptions,
        rounds: usize,
    ) -> Option<(Mesh, Vec<String>)> {
        // Triangles without area in space stay where they have none in the texture.
        for t in 0..self.free.len() {
            if self.corners.chart[t] == NONE && self.sign(t) == 0.0 {
                self.corners.chart[t] = self.corners.next;
            }
        }
        self.corners.next += 1;
        surface.place_dead(&mut self.corners);
        let mesh = surface.mesh_with(&self.corners).0;
        let found = check(&Layout::new(&mesh), options.pack.texture_size);
        let is_wide = |least: f64| found.gutter.as_ref().is_none_or(|g| g.texels >= least);
        let is_good =
            found.is_bijective() && (!options.gutter_required || is_wide(options.pack.gutter_texels));
        is_good.then(|| (mesh, self.told.sentences(rounds)))
    }
}

impl Told {
    fn sentences(&self, rounds: usize) -> Vec<String> {
        let mut sentences = Vec::new();
        if self.tiles {
            sentences.push("Charts in other tiles of the texture were moved into its square.".to_string());
        }
        let mut say = |count: usize, one: &str, many: &str| match count {
            0 => {}
            1 => sentences.push(format!("1 {one}")),
            _ => sentences.push(format!("{count} {many}")),
        };
        say(
            self.outside,
            "chart that reached out of the square was moved into it.",
            "charts that reached out of the square were moved into it.",
        );
        say(self.mirrored, "mirrored chart was mirrored back.", "mirrored charts were mirrored back.");
        say(
            self.folded,
            "chart, folded onto itself, was cut along the fold.",
            "charts, folded onto themselves, were cut along the folds.",
        );
        say(
            self.slivers,
            "sliver was given an area by moving a point by less than a texel.",
            "slivers were given an area by moving points by less than a texel.",
        );
        say(
            self.fresh,
            "triangle that had no area in the texture or lay on others was laid into free space.",
            "triangles that had no area in the texture or lay on others were laid into free space.",
        );
        say(
            self.moved,
            "chart that lay on another or too close to it was moved aside.",
            "charts that lay on others or too close to them were moved aside.",
        );
        say(
            self.smaller,
            "of the moved parts had to be made smaller.",
            "of the moved parts had to be made smaller.",
        );
        if sentences.is_empty() && rounds == 0 {
            sentences.push("Texture coordinates outside the square were brought into it.".into());
        } else {
            sentences.push(
                if self.whole_mirrored {
                    "The layout, mirrored as a whole, was mirrored back."
                } else {
                    "All other texture coordinates are unchanged."
                }
                .into(),
            );
        }
        sentences
    }
}

#[cfg(test)]
mod tests;
