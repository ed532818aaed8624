//! A low-poly's texture coordinates before the bake: kept, repaired, made anew, or moved to
//! where they show most ([`UvMode`]).
//!
//! ```text
//! as delivered ─ repair ─┬ the default method (moved.rs) ─┬ Mesh
//!        signal ─────────┴ the paper's (paper.rs) ────────┘
//! ```
//!
//! Contract: whatever comes out of any mode but `keep` is bijective, with the
//! gutter asked for between charts. Coordinates that the default method moved are only taken
//! if they show the surface better than the ones they began with; those of the paper's method
//! are the best of its rounds at two sizes, the start included.

mod finer;
mod layout_score;
mod moved;
mod paper;
mod plain_parts;
mod refined;
mod steps;
mod surface_samples;
mod surface_texture;

pub use plain_parts::{drawn_part, has_textures, with_plain_parts_apart};
pub use surface_samples::Source;
pub use surface_texture::{SurfaceSamples, SurfaceTexture};

use crate::contact::{Border, ContactOptions};
use crate::convergence::Convergence;
use crate::least_squares_texture::{
    ParameterizedSignal, Solve, least_squares_texture_from_means, least_squares_texture_in_box,
};
use crate::mode::{Method, UvMode};
use crate::moves::UvMoves;
use crate::optimise::Problem;
use crate::paper::Guide;
use crate::signal::Signal;
use crate::triangle_batches::TriangleBatches;
use crate::trilinear_error::trilinear_errors;
use parbake_atlas::{
    AtlasError, ChartScale, Layout, PackOptions, RepairOptions, TutteOptions, UnwrapOptions, check, pack,
    repair, tutte, unwrap,
};
use parbake_image::FloatImage;
use parbake_mesh::{Bisected, Piece, ensure_normals, material_uvs};
use parbake_model::glam::{DVec2, Vec2, Vec4};
use parbake_model::{Material, Mesh, Model, Placement};
use parbake_progress::Watcher;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use surface_samples::{FULL_AND_HALF, signal_scales};

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct UvStageOptions {
    /// What becomes of the coordinates.
    pub mode: UvMode,
    /// How they are moved.
    pub method: Method,
    /// What moves them in the paper's method.
    pub guide: Guide,
    /// Texels along a side.
    pub texture_size: usize,
    /// Least distance between charts in texels.
    pub gutter: f64,
    /// Whether it must be that gutter, as where the user asked for it: otherwise a sound layout with
    /// a smaller one is not packed again for it.
    pub gutter_required: bool,
    /// Texels along a side of the parallax map that is to come, if one is.
    pub parallax_size: Option<usize>,
    /// Smallest mip level at which charts should not touch: 1 is the half of the texture's side. Levels of detail say
    /// so.
    pub smallest_mip: Option<f64>,
    /// Steps of the refinement, or rounds of the paper's method at most.
    pub steps: usize,
    /// Whether a low-poly's coordinates are refined only where the texture has few texels a triangle (`moved.rs`).
    pub refines_scarce_only: bool,
    /// Triangles that a model's own surface may have more.
    pub more_triangles: usize,
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UvStageReport {
    /// What was repaired, a sentence each.
    pub repaired: Vec<String>,
    /// Share of the square that was covered before and after.
    pub utilisation: [f64; 2],
    /// Least distance between charts in texels that was asked for or chosen; sound layouts that were
    /// delivered may have less where nobody asked.
    #[serde(default)]
    pub gutter: f64,
    /// Steps of the refinement, or rounds of the paper's method.
    pub steps: usize,
    /// Estimated squared error of the surface's colours relative to that with the
    /// coordinates before, full size and half; 1 where nothing moved.
    pub relative_error: Vec<f64>,
    /// True where charts were packed anew before they moved.
    pub packed: bool,
    /// How the paper's method went, where it was asked for.
    #[serde(default)]
    pub convergence: Option<Convergence>,
}

/// A low-poly with new coordinates.
#[derive(Clone)]
pub struct UvStageResult {
    /// Its mesh alone: what its materials said of coordinates is applied.
    pub model: Model,
    /// How its coordinates moved.
    pub moves: Option<UvMoves>,
    /// Where its triangles lie on those before; empty where they are the same.
    pub pieces: Vec<Piece>,
    /// What was done.
    pub report: UvStageReport,
}

/// Samples of a low-poly's surface at most while coordinates move…
const MOST_SAMPLES: usize = 400_000;
/// …and of a model's own: with fewer, small textures of plainly coloured parts follow the samples (mask,
/// 128²: 1 dB more than with 131,000).
const OWN_SAMPLES: usize = 800_000;

/// Prepares the texture coordinates of a repaired low-poly that `frame` places.
pub fn optimise_uvs(
    low: RepairedLowPoly,
    frame: &Placement,
    source: &Source,
    options: &UvStageOptions,
    watcher: &dyn Watcher,
) -> UvStageResult {
    let RepairedLowPoly { name, mut mesh, repaired } = low;
    let start = Layout::new(&mesh);
    let before = check(&start, options.texture_size).utilisation;
    let mut report = UvStageReport {
        repaired,
        utilisation: [before; 2],
        gutter: options.gutter,
        relative_error: vec![1.0; 2],
        ..Default::default()
    };
    let (mut moves, mut pieces) = (None, Vec::new());
    if options.mode == UvMode::Optimize && options.steps > 0 {
        let mut placed = mesh.clone();
        frame.apply(&mut placed);
        let found = match options.method {
            Method::Fit => moved::moved(&placed, source, options, &mut report, watcher),
            Method::Paper => paper::moved(&placed, source, options, &mut report, watcher),
        };
        if let Some(Moved { layout, frames, bisected }) = found {
            report.utilisation[1] = check(&layout, options.texture_size).utilisation;
            if let Some(bisected) = bisected {
                mesh = bisected.of(&mesh);
                pieces = bisected.pieces;
            }
            mesh.uvs = layout.uvs();
            moves = Some(UvMoves { frames, triangles: layout.triangles, charts: layout.charts });
        }
    }
    mesh.triangle_materials.fill(0);
    let model = Model { name, mesh, materials: vec![Material::default()], ..Model::default() };
    UvStageResult { model, moves, pieces, report }
}

/// A low-poly whose coordinates are sound, or as they were where they are to be kept.
#[derive(Clone)]
pub struct RepairedLowPoly {
    /// The model's name.
    pub name: String,
    /// Its mesh with unit normals; what its materials said of coordinates is applied.
    pub mesh: Mesh,
    /// What was done, a sentence each.
    pub repaired: Vec<String>,
}

impl RepairedLowPoly {
    /// Packs charts anew, each with as many times the area as its triangles count on average; nothing where all count
    /// alike.
    ///
    /// # Errors
    /// Where charts do not fit into the texture with the gutter asked for.
    pub fn weigh_charts(&mut self, importances: &[f32], options: &UvStageOptions) -> Result<(), AtlasError> {
        if importances.is_empty() {
            return Ok(());
        }
        let layout = Layout::new(&self.mesh);
        let charts = layout.charts.iter().max().map_or(0, |&last| last as usize + 1);
        let mut sums = vec![[0.0, 0.0]; charts];
        for (t, (&chart, &weight)) in layout.charts.iter().zip(importances).enumerate() {
            let area = layout.rest_area(t);
            let [weighed, all] = &mut sums[chart as usize];
            *weighed += area * f64::from(weight);
            *all += area;
        }
        let scale = |[weighed, all]: &[f64; 2]| if *all > 0.0 { (weighed / all).sqrt() } else { 1.0 };
        let chart_scale = ChartScale::Given(sums.iter().map(scale).collect());
        self.mesh.uvs = pack(&layout, &PackOptions { chart_scale, ..packing(options) })?.uvs();
        Ok(())
    }
}

/// Makes a low-poly's coordinates sound, as the mode asks.
///
/// # Errors
/// Where charts do not fit into the texture with the gutter asked for.
pub fn repair_uvs(low: &Model, options: &UvStageOptions) -> Result<RepairedLowPoly, AtlasError> {
    let mut mesh = low.mesh.clone();
    mesh.uvs = material_uvs(&low.mesh, &low.materials);
    mesh.tangents.clear();
    // They belong to maps of an earlier bake.
    mesh.parallax_offsets.clear();
    let normals_replaced = ensure_normals(&mut mesh);
    let pack = packing(options);
    let sound = || check(&Layout::new(&mesh), options.texture_size).is_bijective();
    let (mesh, mut repaired) = match options.mode {
        UvMode::Keep => (mesh, Vec::new()),
        UvMode::Repair | UvMode::Optimize if !options.gutter_required && !mesh.uvs.is_empty() && sound() => {
            (mesh, Vec::new())
        }
        UvMode::Unwrap => (unwrap(&mesh, &UnwrapOptions { pack, ..Default::default() })?.mesh, Vec::new()),
        UvMode::Tutte => (
            tutte(&mesh, &TutteOptions { in_the_middle: true, pack, ..Default::default() })?.mesh,
            Vec::new(),
        ),
        UvMode::Repair | UvMode::Optimize => {
            let gutter_required = options.gutter_required;
            repair(&mesh, &RepairOptions { pack, gutter_required, ..Default::default() })?
        }
    };
    if normals_replaced > 0 && !low.mesh.normals.is_empty() {
        repaired.push(format!("{normals_replaced} unusable normals were replaced."));
    }
    Ok(RepairedLowPoly { name: low.name.clone(), mesh, repaired })
}

/// Gutter that a parallax map wants, in its texels: as far as what is fetched at a chart's border
/// blends in, from either side.
const PARALLAX_GUTTER: f64 = 2.0;
/// Gutter at the smallest mip level, in its texels: as far as what is fetched at a chart's border blends in, from either
/// side.
const MIP_GUTTER: f64 = 2.0;
/// Share of the square that wide gutters may take, with charts that are squares of one size.
const MOST_ROOM: f64 = 0.25;

impl UvStageOptions {
    /// The same with the gutter of a parallax map, where charts are few enough, and of the smallest mip level, as far as
    /// charts are; None where neither is wider, or where the layout or the gutter is the user's.
    fn with_room(&self, mesh: &Mesh) -> Option<Self> {
        let made_here = matches!(self.mode, UvMode::Optimize | UvMode::Unwrap);
        if !made_here || self.gutter_required || self.method != Method::Fit {
            return None;
        }
        let charts = Layout::new(mesh).charts.iter().max().map_or(0, |last| last + 1);
        let (size, most) = (self.texture_size as f64, MOST_ROOM / (2.0 * f64::from(charts).sqrt()));
        let of_parallax =
            self.parallax_size.map(|size| PARALLAX_GUTTER / size as f64).filter(|wide| *wide <= most);
        let of_mip = self.smallest_mip.map(|mip| (MIP_GUTTER * mip.exp2() / size).min(most));
        let gutter = size * of_parallax.into_iter().chain(of_mip).fold(0.0, f64::max);
        (gutter > self.gutter).then_some(Self { gutter, gutter_required: true, ..*self })
    }
}

/// What [`repair_uvs`] gives, and the same with a wider gutter.
pub struct RepairedLowPolys {
    /// What it gives.
    pub plain: RepairedLowPoly,
    /// With a wider gutter; none where there is no need or no room for it.
    pub roomy: Option<RepairedLowPoly>,
}

/// [`repair_uvs`], with room for a parallax map where charts are few: near another chart's a fetch blends in that
/// one's coefficients, which costs 0.1 to 0.4 dB; and for the smallest mip level. The gutter becomes that of `options`.
///
/// # Errors
/// As of [`repair_uvs`].
pub fn repair_uvs_with_room(
    low: &Model,
    options: &mut UvStageOptions,
) -> Result<RepairedLowPolys, AtlasError> {
    let plain = repair_uvs(low, options)?;
    // What does not fit so goes without it.
    let roomy = options.with_room(&plain.mesh).and_then(|wide| {
        let roomy = repair_uvs(low, &wide).ok()?;
        *options = wide;
        Some(roomy)
    });
    Ok(RepairedLowPolys { plain, roomy })
}

fn packing(options: &UvStageOptions) -> PackOptions {
    PackOptions {
        texture_size: options.texture_size,
        gutter_texels: options.gutter,
        ..PackOptions::default()
    }
}

/// A layout whose points moved, and its way there.
struct Moved {
    layout: Layout,
    frames: Vec<Vec<Vec2>>,
    /// The layout's triangles where the mesh's are too few.
    bisected: Option<Bisected>,
}

/// What the surface shows at its sizes; None where nothing of it is seen.
fn signal(mesh: &Mesh, start: &Layout, source: &Source, size: usize) -> Option<Vec<Signal>> {
    let most = match source.surface {
        Some(_) => MOST_SAMPLES.min((8 * size * size).max(1 << 16)),
        None => OWN_SAMPLES,
    };
    let signal_scales = signal_scales(mesh, &start.rest, source, &FULL_AND_HALF, most);
    (!signal_scales[0].samples.is_empty()).then_some(signal_scales)
}

/// How near charts may come, with a barrier of this width in texels.
fn contact(asked: &UvStageOptions, activation_texels: f64) -> ContactOptions {
    ContactOptions {
        texture_size: asked.texture_size as u32,
        gutter_texels: asked.gutter,
        activation_texels,
        border: Border::Margin { margin_texels: (0.5 * asked.gutter).max(0.5) },
        ..ContactOptions::default()
    }
}

/// Steps of the solver that tell layouts apart: by all sizes at once…
const ALL_SIZES_STEPS: usize = 40;
/// …or by the full one, where the errors of fifteen layouts were within 6 % of those after forty steps, in the same order.
const FULL_SIZE_STEPS: usize = 12;

/// What 8-bit texels leave of each scale, with a texture that is about the one that will be
/// solved for: for all sizes at once where `all_sizes` says so, else for the full one.
fn errors(problem: &Problem, layout: &Layout, all_sizes: bool) -> Vec<f64> {
    let solved = if all_sizes { problem.signal_scales } else { &problem.signal_scales[..1] };
    let (runs, size) = (&runs(layout, solved), problem.texture_size);
    let surface = mapped(layout, solved, runs);
    let rough = |steps| Solve { steps, ..Solve::ROUGH };
    let mut texture = match all_sizes {
        // A start nearer to the end would choose other layouts, no better ones.
        true => {
            let start = FloatImage::solid(size, Vec4::splat(0.5));
            least_squares_texture_in_box(&surface, start, &rough(ALL_SIZES_STEPS))
        }
        false => least_squares_texture_from_means(&surface, size, &rough(FULL_SIZE_STEPS)),
    };
    texture.texels.par_iter_mut().for_each(|t| *t = (*t * 255.0).round() / 255.0);
    trilinear_errors(&mapped(layout, problem.signal_scales, runs), &texture)
}

fn runs(layout: &Layout, signal_scales: &[Signal]) -> TriangleBatches {
    TriangleBatches::new(&layout.points, &layout.triangles, &signal_scales[0])
}

fn mapped<'a>(
    layout: &'a Layout,
    signal_scales: &'a [Signal],
    runs: &'a TriangleBatches,
) -> ParameterizedSignal<'a> {
    ParameterizedSignal { points: &layout.points, triangles: &layout.triangles, signal_scales, runs }
}

fn as_f32(points: &[DVec2]) -> Vec<Vec2> {
    points.iter().map(|p| p.as_vec2()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::vec2;

    fn with_parallax(gutter: Option<f64>) -> UvStageOptions {
        UvStageOptions {
            mode: UvMode::Optimize,
            method: Method::Fit,
            guide: Guide::ContentAware,
            texture_size: 256,
            gutter: gutter.unwrap_or(1.0),
            gutter_required: gutter.is_some(),
            parallax_size: Some(64),
            smallest_mip: None,
            steps: 30,
            refines_scarce_only: false,
            more_triangles: 0,
        }
    }

    /// Right triangles in rows of four, each a chart, seven and a half texels of 256 apart.
    fn sheet(charts: u32) -> Model {
        let corner = |i: u32| vec2((i % 3 % 2) as f32, (i % 3 / 2) as f32);
        let place = |i: u32| vec2((i / 3 % 4) as f32, (i / 12) as f32);
        let mesh = Mesh {
            positions: (0..3 * charts).map(|i| (place(i) * 2.0 + corner(i)).extend(0.0)).collect(),
            uvs: (0..3 * charts).map(|i| place(i) * 0.2 + corner(i) * 0.17 + 0.01).collect(),
            triangles: (0..charts).map(|c| [3 * c, 3 * c + 1, 3 * c + 2]).collect(),
            triangle_materials: vec![0; charts as usize],
            ..Mesh::default()
        };
        Model {
            name: "sheet".into(),
            mesh,
            materials: vec![Material::default()],
            images: Vec::new(),
            ..Model::default()
        }
    }

    /// Protects parallax maps from their neighbours: two of the map's texels lie between charts,
    /// unless a gutter was asked for.
    #[test]
    fn few_charts_get_room_for_a_parallax_map() {
        for (asked, wanted) in [(None, 8.0), (Some(3.0), 3.0)] {
            let mut options = with_parallax(asked);
            let RepairedLowPolys { plain, roomy } =
                repair_uvs_with_room(&sheet(4), &mut options).expect("four charts fit");
            assert_eq!((options.gutter, roomy.is_some()), (wanted, asked.is_none()));
            let mesh = roomy.unwrap_or(plain).mesh;
            let gutter = check(&Layout::new(&mesh), 256).gutter.expect("several charts").texels;
            assert!(gutter >= wanted, "{gutter} of {wanted}");
        }
    }

    /// Protects what bakes are compared with: coordinates that are repaired to move later are those that are only repaired.
    #[test]
    fn coordinates_are_repaired_alike_whether_they_move_or_not() {
        let mut low = sheet(4);
        let (first, others) = low.mesh.uvs.split_at_mut(3);
        others[..3].copy_from_slice(first);
        let mut options = with_parallax(None);
        let repair = UvStageOptions { mode: UvMode::Repair, parallax_size: None, ..options };
        let repaired = repair_uvs(&low, &repair).expect("four charts fit");
        let both = repair_uvs_with_room(&low, &mut options).expect("four charts fit");
        assert!(both.roomy.is_some() && !repaired.repaired.is_empty());
        assert_eq!((both.plain.mesh, both.plain.repaired), (repaired.mesh, repaired.repaired));
    }

    /// Protects texels: gutters of many charts would leave none.
    #[test]
    fn many_charts_stay_close() {
        let options = with_parallax(None);
        let with_room = |charts| options.with_room(&sheet(charts).mesh);
        assert!(with_room(16).is_some() && with_room(17).is_none());
    }

    /// Protects small mip levels: two of their texels lie between charts, or as many as a quarter of the square has room
    /// for.
    #[test]
    fn charts_do_not_touch_at_the_smallest_mip() {
        for (charts, mip, wanted) in [(4, 2.0, 8.0), (16, 1.5, 2.0 * 2f64.powf(1.5)), (16, 3.0, 8.0)] {
            let mut options =
                UvStageOptions { parallax_size: None, smallest_mip: Some(mip), ..with_parallax(None) };
            let roomy = repair_uvs_with_room(&sheet(charts), &mut options).expect("they fit").roomy;
            assert!((options.gutter - wanted).abs() < 1e-9, "{}", options.gutter);
            let mesh = roomy.expect("a wider gutter").mesh;
            let gutter = check(&Layout::new(&mesh), 256).gutter.expect("several charts").texels;
            assert!(gutter >= wanted, "{gutter} of {wanted}");
        }
    }
}
