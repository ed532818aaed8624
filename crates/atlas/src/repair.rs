//! Repair: a sound layout from a delivered one, changing as little as possible.
//!
//! ```text
//! nothing wrong                      left as it is
//! only in other tiles                each chart moved by whole tiles
//! faults of a few triangles or charts mended where they are (repair/mend.rs)
//! only outside the square            all brought in together, unless it would be nearly empty
//! else, where too much is wrong or no place is left:
//! mirrored charts                    mirrored back
//! charts folded along few lines      cut there
//! triangles or charts beyond that    these alone laid out afresh
//! then                               those too long for the square cut across, all packed again, sizes kept
//! ```

mod faults;
mod mend;

use crate::sharing;
use crate::tiles::in_one_tile;
use crate::unwrap::corners::{Corners, Surface};
use crate::unwrap::long::{LEAST_COVER, cut_across};
use crate::unwrap::sound::{at_fault, settled};
use crate::{AtlasError, ChartScale, Layout, PackOptions, UnwrapOptions, UvCheck, check, unwrap};
use faults::{Found, cut_along_folds, fresh_triangles};
use mend::{MendOptions, mended};
use parbake_model::Mesh;

/// What [`repair()`] aims at.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairOptions {
    /// Texture size, gutter and packing. Charts keep their relative sizes; `chart_scale`
    /// is not looked at.
    pub pack: PackOptions,
    /// Whether charts that are sound but closer than the gutter must move apart. What is mended or packed
    /// has the gutter in any case.
    pub gutter_required: bool,
    /// For what is laid out afresh, as in [`UnwrapOptions`].
    pub max_chart_angle: f32,
}

impl Default for RepairOptions {
    fn default() -> Self {
        let UnwrapOptions { pack, max_chart_angle } = UnwrapOptions::default();
        Self { pack, gutter_required: true, max_chart_angle }
    }
}

/// Makes a mesh's layout sound, with the gutter asked for between its charts, and says in
/// one sentence each what was done; no sentences and an equal mesh where nothing was.
///
/// Triangles keep their order. Vertices are split where seams run anew; all attributes
/// are carried along but tangents, which belonged to the layout before.
///
/// # Errors
///
/// As [`unwrap()`].
pub fn repair(mesh: &Mesh, options: &RepairOptions) -> Result<(Mesh, Vec<String>), AtlasError> {
    let size = options.pack.texture_size;
    let surface = Surface::new(mesh);
    let unwrapped = |sentence: &str| {
        let options = UnwrapOptions { pack: options.pack.clone(), max_chart_angle: options.max_chart_angle };
        unwrap(mesh, &options).map(|u| (u.mesh, vec![sentence.to_string()]))
    };
    if mesh.uvs.is_empty() && !mesh.triangles.is_empty() {
        return unwrapped("The model has no texture coordinates; it was unwrapped.");
    }
    let delivered = check(&surface.delivered, size);
    if is_good(&delivered, options) {
        return Ok((mesh.clone(), Vec::new()));
    }
    if delivered.orientations.outside.count > 0
        && let Some(uvs) = in_one_tile(mesh, 0.0)
    {
        let home = Mesh { uvs, tangents: Vec::new(), ..mesh.clone() };
        if is_good(&check(&Layout::new(&home), size), options) {
            return Ok((
                home,
                vec!["Charts in other tiles of the texture were moved into its square.".into()],
            ));
        }
    }
    let live = (0..mesh.triangles.len()).filter(|&t| surface.is_live(t));
    let mut corners = corners_of(&surface);
    if live.clone().all(|t| surface.delivered.doubled_area(t) == 0.0) {
        return unwrapped("The texture coordinates cover no area; the model was unwrapped afresh.");
    }
    let mut sentences: Vec<String> = sharing::in_layout(&surface.delivered).sentence().into_iter().collect();
    let mend = MendOptions {
        pack: &options.pack,
        gutter_required: options.gutter_required,
        max_chart_angle: options.max_chart_angle,
    };
    if let Some((mesh, done)) = mended(&surface, &mend) {
        sentences.extend(done);
        return Ok((mesh, sentences));
    }
    if delivered.orientations.outside.count > 0 {
        if let Some(mesh) = brought_in(&surface, &corners, options) {
            sentences.push("Texture coordinates outside the square were brought into it.".into());
            return Ok((mesh, sentences));
        }
        sentences.push("Texture coordinates outside the square were brought into it.".into());
    }
    let mut found = cut_along_folds(&surface, &mut corners);
    let fresh = fresh_triangles(&surface, &mut corners, &mut found, options.max_chart_angle);
    tell(&mut sentences, &found, fresh);
    let pack = PackOptions { chart_scale: ChartScale::Keep, ..options.pack.clone() };
    match cut_across(&surface, &mut corners, &pack.chart_scale) {
        0 => {}
        1 => sentences.push("1 chart, too long for the square, was cut across.".into()),
        count => sentences.push(format!("{count} charts, too long for the square, were cut across.")),
    }
    let packed = settled(&surface, corners, &pack)?;
    let is_close = |least: f64| delivered.gutter.as_ref().is_some_and(|g| g.texels < least);
    let close = options.gutter_required && is_close(options.pack.gutter_texels);
    sentences.push(match (delivered.overlaps.pairs > 0, close) {
        (true, _) => {
            "Triangles lay on each other; all charts were packed again at their relative sizes, since the faults could not be repaired in place.".into()
        }
        (false, true) => format!(
            "Charts lay closer to each other than {} texels; all were packed again at their relative sizes.",
            options.pack.gutter_texels
        ),
        _ => "All charts were packed again at their relative sizes.".into(),
    });
    Ok((surface.mesh_with(&packed).0, sentences))
}

/// Whether there is nothing to do.
fn is_good(check: &UvCheck, options: &RepairOptions) -> bool {
    let is_wide = |least: f64| check.gutter.as_ref().is_none_or(|g| g.texels >= least);
    check.is_bijective() && (!options.gutter_required || is_wide(options.pack.gutter_texels))
}

pub(crate) fn corners_of(surface: &Surface) -> Corners {
    let layout = &surface.delivered;
    let count = layout.triangles.len();
    let chart = (0..count)
        .map(|t| if surface.is_live(t) { layout.charts[t] } else { crate::unwrap::corners::NONE })
        .collect();
    let next = layout.charts.iter().max().map_or(0, |c| c + 1);
    Corners { uv: (0..count).map(|t| layout.corners(t)).collect(), chart, next }
}

/// The whole layout moved, and shrunk if need be, into the square, if nothing else is
/// wrong with it and shrinking leaves no more of the square empty than it should.
fn brought_in(surface: &Surface, corners: &Corners, options: &RepairOptions) -> Option<Mesh> {
    let pack = &options.pack;
    let all = || corners.uv.iter().flatten().copied();
    let low = all().reduce(|a, b| a.min(b))?;
    let high = all().reduce(|a, b| a.max(b))?;
    let border = (0.5 * pack.gutter_texels).max(0.5) / pack.texture_size as f64;
    let scale = ((1.0 - 2.0 * border) / (high - low).max_element()).min(1.0);
    let mut moved = corners.clone();
    moved.uv.iter_mut().flatten().for_each(|p| *p = (*p - low) * scale + border);
    let mesh = surface.mesh_with(&moved).0;
    let check = check(&Layout::new(&mesh), pack.texture_size);
    (is_good(&check, options) && (scale == 1.0 || check.utilisation >= LEAST_COVER)).then_some(mesh)
}

fn tell(sentences: &mut Vec<String>, found: &Found, fresh: usize) {
    let mut say = |count: usize, one: &str, many: &str| match count {
        0 => {}
        1 => sentences.push(format!("1 {one}")),
        _ => sentences.push(format!("{count} {many}")),
    };
    say(found.mirrored, "mirrored chart was mirrored back.", "mirrored charts were mirrored back.");
    say(
        found.cut,
        "chart, folded onto itself, was cut along the fold.",
        "charts, folded onto themselves, were cut along the folds.",
    );
    say(
        fresh,
        "triangle that had no area in the texture or lay on others of its chart was laid out afresh.",
        "triangles that had no area in the texture or lay on others of their charts were laid out afresh.",
    );
}

/// Triangles of a layout that are at fault, by [`at_fault`], with the share of their
/// charts' surface that they make up.
fn faulty_shares(layout: &Layout) -> (Vec<u32>, Vec<f64>) {
    let faults = at_fault(layout);
    let charts = layout.charts.iter().max().map_or(0, |&c| c as usize + 1);
    let (mut all, mut bad) = (vec![0.0; charts], vec![0.0; charts]);
    (0..layout.triangles.len()).for_each(|t| all[layout.charts[t] as usize] += layout.rest_area(t));
    faults.iter().for_each(|&t| bad[layout.charts[t as usize] as usize] += layout.rest_area(t as usize));
    (faults, bad.iter().zip(all).map(|(bad, all)| bad / all).collect())
}
