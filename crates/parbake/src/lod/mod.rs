//! A chain of levels of detail from one model, from fine to coarse.
//!
//! ```text
//! model ─ HighPoly (once) ─┬ triangles (low_poly.rs) ─ bake ─ level ─ figures, switch (evaluate/screen_size.rs) ─┐
//!                          └ … the next level may start from the triangles of this one ◁───────────┘
//! ```
//!
//! `ways.rs` makes a level in several ways and takes the best (`delivered.rs`: those that keep the model's layout).
//! `target.rs` makes a level of several bakes where a PSNR is asked for; `maker.rs` has the steps of both, `chain.rs` is
//! progress and time.
//!
//! Each level is made for a size on screen. From that follow how far its surface may be off, hence its triangles, and
//! how many texels it needs.
//!
//! Contract: levels have fewer and fewer triangles. They are finished and handed over in order; what the next one may keep of the
//! model is found meanwhile. A chain that is stopped keeps those that are finished. Deterministic.

mod candidate;
pub(crate) mod chain;
mod delivered;
pub mod document;
pub mod layout;
mod level;
mod maker;
pub mod options;
mod own_vertices;
mod picture_score;
mod scaled;
pub mod target;
mod ways;
mod written;

use crate::error::BakeError;
use crate::threads::join;
pub use candidate::{Candidate, Way};
use chain::Chain;
pub use level::{Level, LevelReport};
use maker::{Draft, Maker};
use options::LodOptions;
use own_vertices::{OwnVertices, own_vertices};
use parbake_evaluate::renderer::PlacedModel;
use parbake_levels::face_frames::with_face_tangents;
use parbake_levels::screen::{largest_texture, texels_of};
pub use parbake_levels::search;
use parbake_mesh::parts::{draw_calls, part_reports, with_kept_parts, with_parted_materials};
use parbake_model::Model;
use parbake_progress::{Message, Watcher};
use parbake_views::alpha_in_effect::with_alpha_in_effect;
use parbake_views::hidden::without_hidden;
use std::borrow::Cow;
use std::time::Instant;
use written::as_written;

/// Makes the levels of a model and hands them over one by one, before the next one is baked. Returns how many there are:
/// fewer than asked for where the watcher said stop, or where a level would have no fewer triangles than the one
/// before.
///
/// # Errors
/// An option out of range; a model without extent; parts that are not there, or too many for so few triangles; what
/// `on_level` returns.
pub fn make_levels<E: From<BakeError>>(
    model: &Model,
    options: &LodOptions,
    watcher: &dyn Watcher,
    mut on_level: impl FnMut(Level) -> Result<(), E>,
) -> Result<usize, E> {
    options.check()?;
    let start = Instant::now();
    let kept = with_kept_parts(model, &options.keep_parts).map_err(BakeError::from)?;
    let parted = with_parted_materials(&kept);
    let settled = with_settled_alpha(&parted, watcher);
    let model = &*without_hidden_parts(&settled, options, watcher)?;
    let maker = Maker::new(model, settled.mesh.triangles.len(), options)?;
    let sizes = (0..options.screen_size.len())
        .map(|level| (maker.wanted[level], maker.texture_size(model, options.screen_size[level])));
    let mut chain = Chain::new(watcher, start, options, &sizes.collect::<Vec<_>>());
    let (mut before, mut ahead): (Option<Before>, Option<OwnVertices>) = (None, None);
    let mut count = 0;
    for index in 0..options.screen_size.len() {
        let most = before.as_ref().map_or(maker.high.triangles, |before| before.low.mesh.triangles.len());
        let (triangles, until) = (maker.wanted[index].min(most), chain.level_until(index));
        chain.tell(index, 0);
        let own = match ahead.take().filter(|own| own.triangles == triangles) {
            None if options.target_psnr.is_none() => own_vertices(&maker, index, triangles, until, watcher)?,
            own => own,
        };
        // Of the next level as much as does not depend on this one: much of either keeps one core busy alone. A budget is shared out
        // to levels that are made one after the other.
        let is_ahead = options.target_psnr.is_none() && until.is_none() && rayon::current_num_threads() > 1;
        let next = (index + 1..options.screen_size.len()).next();
        let next = next.filter(|&next| is_ahead && !watcher.stopped() && maker.wanted[next] < triangles);
        let (made, own) = join(
            || made(&maker, &mut chain, index, triangles, before.as_ref(), own, until),
            || next.map(|next| own_vertices(&maker, next, maker.wanted[next], None, watcher)).transpose(),
        );
        let Some((level, low)) = made? else { break };
        before = Some(low);
        count += 1;
        on_level(level)?;
        if watcher.stopped() {
            break;
        }
        ahead = own?.flatten();
    }
    Ok(count)
}

/// What the level after one needs of it.
struct Before {
    /// Its triangles as they were chosen.
    low: Model,
    placed: PlacedModel,
}

/// A level of at most so many triangles with its figures; `own` is what it may keep of the model. None where the watcher said stop before
/// there was one.
fn made(
    maker: &Maker,
    chain: &mut Chain,
    index: usize,
    triangles: usize,
    before: Option<&Before>,
    own: Option<OwnVertices>,
    until: Option<Instant>,
) -> Result<Option<(Level, Before)>, BakeError> {
    let options = maker.options;
    let finer = before.map(|before| &before.low);
    let drafted = match options.target_psnr {
        Some(target) => target::find(maker, chain, index, finer, target)?
            .map(|found| (found.draft, found.write, Some(found.report))),
        None => ways::draft(maker, chain, index, finer, triangles, own, until)?
            .map(|draft| (draft, options.write, None)),
    };
    let Some((draft, write, target)) = drafted else { return Ok(None) };
    let begin = Instant::now();
    let written = as_written(&draft.baked.model, &write, options.normal_y)?.model;
    let placed = maker.screens.place(&with_face_tangents(&written))?;
    let figures = maker.figures(index, &placed, before.map(|before| &before.placed))?;
    let Draft { low, layers, baked, way, candidates, seconds: [chosen, fitted, compared] } = draft;
    let mip = baked.report.options.smallest_mip.unwrap_or(0.0);
    let gutter = baked.report.uv.gutter.as_ref().map(|gutter| (gutter.texels, mip));
    let report = LevelReport {
        level: index,
        screen_size: options.screen_size[index],
        triangles: baked.model.mesh.triangles.len(),
        texture_size: largest_texture(&baked.model),
        texels: texels_of(&baked.model),
        gutter: gutter.map(|(texels, _)| texels),
        smallest_gutter: gutter.map(|(texels, mip)| texels / mip.exp2()),
        draw_calls: draw_calls(&baked.model),
        parts: part_reports(&baked.model),
        way,
        candidates,
        low_poly: layers,
        at_screen_size: figures.at_screen_size,
        switch_pixels: figures.switch_pixels,
        switch_coverage: figures.switch_pixels.map(|pixels| (pixels / options.viewport_height).min(1.0)),
        against_before: figures.against_before,
        target,
        stopped_early: baked.report.stopped_early,
        seconds: [chosen, fitted, compared + begin.elapsed().as_secs_f64()],
    };
    Ok(Some((Level { baked, write, report }, Before { low, placed })))
}

/// The model without parts that no view from outside shows. One that moves may show them, and parts that were named stay.
fn without_hidden_parts<'a>(
    model: &'a Model,
    options: &LodOptions,
    watcher: &dyn Watcher,
) -> Result<Cow<'a, Model>, BakeError> {
    if options.keep_hidden || model.rig.is_some() || model.parts.is_some() {
        return Ok(Cow::Borrowed(model));
    }
    let Some(found) = without_hidden(model, options.screen_size[0])? else { return Ok(Cow::Borrowed(model)) };
    let ([parts, all_parts], [triangles, all]) = (found.parts, found.triangles);
    watcher.message(Message::Warning(format!(
        "{}: {parts} of {all_parts} parts ({triangles} of {all} triangles) are left out of the levels, since no view from \
         outside shows them; --keep-hidden keeps them",
        model.name
    )));
    Ok(Cow::Owned(found.model))
}

/// The model with the alpha modes that have an effect; levels that keep its materials have them, too.
fn with_settled_alpha<'a>(model: &'a Model, watcher: &dyn Watcher) -> Cow<'a, Model> {
    let (materials, told) = with_alpha_in_effect(model);
    let Some(told) = told else { return Cow::Borrowed(model) };
    watcher.message(Message::Warning(format!("{}: {told}", model.name)));
    Cow::Owned(Model { materials: materials.into_owned(), ..model.clone() })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::threads::with_threads;
    use parbake_model::glam::Vec3;
    use parbake_model::{Material, Mesh};
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, Ordering};

    struct Warnings(Mutex<Vec<String>>);

    impl Watcher for Warnings {
        fn message(&self, message: Message) {
            if let Message::Warning(text) = message {
                self.0.lock().unwrap().push(text);
            }
        }
    }

    /// An octahedron in another one.
    fn nested() -> Model {
        let mut mesh = Mesh::default();
        for half in [1.0f32, 0.3] {
            let first = mesh.positions.len() as u32;
            let axes = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
            mesh.positions.extend(axes.map(|axis| half * axis));
            let ring = (0..4u32).map(|k| [first + k, first + (k + 1) % 4]);
            mesh.triangles.extend(ring.flat_map(|[a, b]| [[a, b, first + 4], [b, a, first + 5]]));
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        Model { name: "nested".into(), mesh, materials: vec![Material::default()], ..Model::default() }
    }

    /// A ball of 512 triangles, and options for two levels of it that are so close that none is baked.
    fn ball() -> (Model, LodOptions) {
        let mut mesh = nested().mesh;
        mesh.triangles.truncate(8);
        mesh.triangle_materials.truncate(8);
        for _ in 0..3 {
            mesh = parbake_mesh::subdivide(&mesh);
        }
        mesh.positions.iter_mut().for_each(|p| *p = p.normalize());
        let options = LodOptions {
            screen_size: vec![32.0, 16.0],
            triangles: vec![500, 450],
            max_texture_size: 32,
            ..LodOptions::default()
        };
        (Model { mesh, ..nested() }, options)
    }

    /// Protects levels that are begun while others are baked: they are the same as those of one thread, which begins none early.
    #[test]
    fn levels_that_are_begun_early_are_the_same() {
        let (model, options) = ball();
        let made = |threads: usize| {
            let mut made = Vec::new();
            let count = with_threads(threads, || {
                make_levels::<BakeError>(&model, &options, &(), |level| {
                    made.push((level.baked.model, level.report.at_screen_size));
                    Ok(())
                })
            });
            assert_eq!(count.unwrap().unwrap(), 2);
            made
        };
        assert!(made(1) == made(3));
    }

    struct StopsAfterLevel(AtomicBool);

    impl Watcher for StopsAfterLevel {
        fn stopped(&self) -> bool {
            self.0.load(Ordering::Relaxed)
        }
    }

    /// Protects Ctrl-C: no level follows the one that is finished, though the next one was begun.
    #[test]
    fn a_level_that_was_begun_early_does_not_follow_a_stop() {
        let (model, options) = ball();
        let watcher = StopsAfterLevel(AtomicBool::new(false));
        let made = make_levels::<BakeError>(&model, &options, &watcher, |_| {
            watcher.0.store(true, Ordering::Relaxed);
            Ok(())
        });
        assert_eq!(made.unwrap(), 1);
    }

    /// Protects triangles and texels from going to what nobody sees, and users who want hidden parts all the same.
    #[test]
    fn levels_go_without_hidden_parts() {
        let made = |keep_hidden: bool| {
            let options = LodOptions {
                screen_size: vec![16.0],
                ratio: vec![1.0],
                max_texture_size: 32,
                time_budget: Some(1.0),
                keep_hidden,
                ..LodOptions::default()
            };
            let (told, mut least) = (Warnings(Mutex::default()), f32::INFINITY);
            make_levels::<BakeError>(&nested(), &options, &told, |level| {
                let lengths = level.baked.model.mesh.positions.iter().map(|p| p.length());
                least = lengths.fold(least, f32::min);
                Ok(())
            })
            .unwrap();
            let told = told.0.into_inner().unwrap();
            (least, told.iter().any(|text| text.contains("1 of 2 parts (8 of 16 triangles)")))
        };
        let (least, is_told) = made(false);
        assert!(least > 0.5 && is_told, "{least}");
        let (least, is_told) = made(true);
        assert!(least < 0.5 && !is_told, "{least}");
    }
}
