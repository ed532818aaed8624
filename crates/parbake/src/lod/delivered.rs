//! A level that starts from its model's own vertices, and keeps its layout and, where it can, its maps.
//!
//! Where a level keeps a good part of its model's triangles, a new layout has to repeat what an artist did: seams along
//! edges that are sharp or change colour, texels on the texels of the original. So two other ways compete:
//!
//! ```text
//! model ─ edges collapse, attributes follow (simplify_in_layout) ─┬ its maps, with fewer texels ─────────── Scaled
//!                                                                 └ layout repaired, maps fitted (a bake) ─ Delivered
//! ```
//!
//! Both compete with a new layout, and by pictures, in `ways.rs`.
//!
//! Contract: a level of scaled maps has at most half of the model's texels, and its layout as it was delivered, shared
//! texels and mirrored charts included. No level has more triangles than were asked for. A watcher that says stop is heeded
//! between pictures.

use super::chain::Chain;
use super::maps::{Reduction, level_maps, with_reductions};
use super::search::error_of;
use super::ways::Judge;
use super::{Draft, Maker, Way, largest_texture};
use crate::bake::Baked;
use crate::error::BakeError;
use crate::models::with_tangents;
use crate::options::{BakeOptions, ShapeMode};
use crate::report::{BakeReport, Work};
use crate::rigs::transferred;
use parbake_atlas::check_mesh;
use parbake_image::MapKind;
use parbake_image::material_maps::texture_slot;
use parbake_image::reduced::reduced;
use parbake_mesh::{Collapses, Seams, simplify_in_layout};
use parbake_model::{Material, Mesh, Model};
use std::time::Instant;

/// A level may have a model's own vertices where it keeps at least this share of its triangles.
const LEAST_SHARE: f64 = 1.0 / 64.0;
/// Ways to collapse edges.
const COLLAPSES: [Collapses; 8] = [
    Collapses { seams: Seams::Kept, normal_weight: 0.5, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.1, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.1, uv_weight: 0.5, moves: true },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.5, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::OfTextures, normal_weight: 0.5, uv_weight: 0.5, moves: true },
    Collapses { seams: Seams::Crossed, normal_weight: 0.1, uv_weight: 0.5, moves: true },
    Collapses { seams: Seams::Crossed, normal_weight: 0.5, uv_weight: 0.5, moves: false },
    Collapses { seams: Seams::Crossed, normal_weight: 0.5, uv_weight: 0.5, moves: true },
];
/// Texels of a map along a line for each pixel that the surface covers, at most.
const DENSITY: f64 = 4.0;

/// Decibels that fewer texels may cost, and those of which more show nothing, whatever is looked at.
const UNSEEN: f64 = 0.05;
const INVISIBLE: f64 = 60.0;

/// Whether a level of so many triangles may have the model's own vertices: the model has a layout, the level keeps a good
/// part of its triangles, and no option says where triangles have to go.
pub(crate) fn may_keep_vertices(maker: &Maker, triangles: usize) -> bool {
    let model = maker.model;
    let is_few = (triangles as f64) < LEAST_SHARE * model.mesh.triangles.len() as f64;
    let is_steered = model.parts.is_some() || !maker.high.importances.is_empty();
    !is_few && !is_steered && !model.mesh.uvs.is_empty()
}

/// A bake of the model onto its own vertices, fewer of them; the texture's size follows the level's where none is given.
pub(crate) fn baked_draft(
    maker: &Maker,
    chain: &mut Chain,
    level: usize,
    own: &Coarser,
    texture_size: Option<usize>,
) -> Result<Draft, BakeError> {
    let begin = Instant::now();
    let mut low = Model { images: Vec::new(), ..own.model.clone() };
    low.mesh.tangents.clear();
    let watcher = chain.bake(level, 0, None);
    let baked = maker.baked(&low, (level, texture_size), Some(ShapeMode::Keep), None, &watcher)?;
    let seconds = [0.0, begin.elapsed().as_secs_f64(), 0.0];
    Ok(Draft {
        low: surface_of(&low),
        layers: Vec::new(),
        baked,
        way: Way::Delivered,
        candidates: Vec::new(),
        seconds,
    })
}

/// What a coarser level may start from.
fn surface_of(low: &Model) -> Model {
    let Mesh { positions, triangles, triangle_materials, .. } = &low.mesh;
    let mesh = Mesh {
        positions: positions.clone(),
        triangles: triangles.clone(),
        triangle_materials: triangle_materials.clone(),
        ..Mesh::default()
    };
    Model { mesh, materials: low.materials.clone(), ..Model::default() }
}

/// A level without a bake. `side` is how many texels along a line its surface needs, `seconds` are those of [`Draft`].
pub(crate) fn scaled_draft(maker: &Maker, level: usize, model: Model, side: f64, seconds: [f64; 3]) -> Draft {
    let size = largest_texture(&model).max(1);
    let smallest_mip = Some(maker.smallest_mip(level, size as f64 / side));
    let options = BakeOptions { smallest_mip, ..maker.options.bake(size) };
    let report = BakeReport {
        work: Work::Level,
        shape: None,
        growth: None,
        parallax_maps: None,
        fallback: None,
        uv_stage: None,
        options,
        high_triangles: maker.high.triangles,
        low_triangles: model.mesh.triangles.len(),
        views: 0,
        samples: 0,
        covered_texels: 0,
        unseen_texels: 0,
        overlapping_texels: 0,
        missed_texels: 0,
        uv: check_mesh(&model.mesh, size),
        comparison: None,
        losses: Vec::new(),
        stages: Vec::new(),
        stopped_early: false,
        warnings: Vec::new(),
        written: None,
        peak_memory: crate::memory::peak_memory(),
    };
    let low = surface_of(&model);
    let baked = Baked { ray_cast: model.clone(), model, report, uv_moves: None };
    Draft { low, layers: Vec::new(), baked, way: Way::Scaled, candidates: Vec::new(), seconds }
}

/// A model's own vertices, fewer of them, with its own materials.
pub(crate) struct Coarser {
    pub model: Model,
    /// PSNR in dB with maps that are finer than the level's.
    pub psnr: f64,
}

/// The model with at most `triangles` triangles and its own layout, by those of [`COLLAPSES`] whose pictures show most; none
/// where seams leave too many triangles. `side` is how many texels along a line its surface needs.
pub(crate) fn coarser(
    maker: &Maker,
    judge: &Judge,
    triangles: usize,
    side: f64,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<Coarser>, BakeError> {
    let model = maker.model;
    let finest = maker.power_of_two(DENSITY * side);
    let look = with_maps_at_most(model, finest);
    let mut best: Option<Coarser> = None;
    // With all triangles there is nothing to choose.
    let ways = if model.mesh.triangles.len() > triangles { COLLAPSES.len() } else { 1 };
    for collapses in COLLAPSES.into_iter().take(ways) {
        if is_over() {
            break;
        }
        let mesh = simplify_in_layout(&model.mesh, triangles, collapses);
        if mesh.triangles.is_empty() || mesh.triangles.len() > triangles {
            continue;
        }
        let rig = transferred(model, &mesh, &[]);
        let coarse = Model { mesh, rig, ..look.clone() };
        let psnr = judge.psnr(&coarse)?;
        if best.as_ref().is_none_or(|best| psnr > best.psnr) {
            best = Some(Coarser { model: coarse, psnr });
        }
    }
    Ok(best)
}

/// A model's name, materials and maps without its surface; no map has more than `side` texels along a side.
fn with_maps_at_most(model: &Model, side: usize) -> Model {
    let mut images = model.images.clone();
    for (index, kind) in kinds_of_images(&model.materials) {
        if let Some(image) = images.get_mut(index) {
            let times = (0..).take_while(|&times| image.width.max(image.height) >> times > side).count();
            *image = reduced(kind, image, true, times);
        }
    }
    Model { name: model.name.clone(), materials: model.materials.clone(), images, ..Model::default() }
}

/// What images hold, each once.
fn kinds_of_images(materials: &[Material]) -> Vec<(usize, MapKind)> {
    let mut kinds: Vec<(usize, MapKind)> = Vec::new();
    for (material, kind) in materials.iter().flat_map(|m| MapKind::ALL.map(|kind| (m, kind))) {
        let image = texture_slot(material, kind).map(|slot| slot.image);
        let is_new = |image: &usize| kinds.iter().all(|(known, _)| known != image);
        kinds.extend(image.filter(is_new).map(|image| (image, kind)));
    }
    kinds
}

/// The model with the maps of its only material scaled, and its PSNR: to the fewest texels that show nothing less, at most
/// half of the original's. None where it has several materials, or maps that cannot be scaled, or time was too short for
/// enough of them.
pub(crate) fn scaled(
    maker: &Maker,
    judge: &Judge,
    coarser: &Coarser,
    is_over: &dyn Fn() -> bool,
) -> Result<Option<(Model, f64)>, BakeError> {
    let Some(model) = of_one_material(&coarser.model) else { return Ok(None) };
    let maps = level_maps(&model);
    let shown = |choice: &[usize]| -> Result<(Model, f64), BakeError> {
        let reductions: Vec<Reduction> = maps.iter().zip(choice).map(|(map, &k)| map.reductions[k]).collect();
        let reduced = with_reductions(&model, &maps, &reductions);
        let psnr = judge.psnr(&reduced)?;
        Ok((reduced, psnr))
    };
    // What each map costs by itself; of all together about the sum.
    let whole = error_of(coarser.psnr);
    let mut costs: Vec<Vec<f64>> = Vec::new();
    for place in 0..maps.len() {
        let mut own = vec![0.0];
        for reduction in 1..maps[place].reductions.len() {
            if is_over() {
                break;
            }
            let mut choice = vec![0; maps.len()];
            choice[place] = reduction;
            own.push((error_of(shown(&choice)?.1) - whole).max(0.0));
        }
        costs.push(own);
    }
    let texels_of = |place: usize, reduction: usize| match maps[place].reductions[reduction] {
        Reduction::Factor => 0,
        Reduction::Halved(times) => {
            let image = &model.images[maps[place].image];
            (image.width >> times).max(1) * (image.height >> times).max(1)
        }
    };
    let most = maps.iter().map(|map| texels(&maker.model.images[map.image])).sum::<usize>() / 2;
    let allowed = error_of((coarser.psnr - UNSEEN).min(INVISIBLE));
    let mut best: Option<((bool, f64, usize), Vec<usize>)> = None;
    for choice in choices(&costs.iter().map(Vec::len).collect::<Vec<_>>()) {
        let texels: usize = choice.iter().enumerate().map(|(place, &k)| texels_of(place, k)).sum();
        let error = whole + choice.iter().enumerate().map(|(place, &k)| costs[place][k]).sum::<f64>();
        let is_seen = error > allowed;
        // Where something is lost anyway, the least; else the fewest texels.
        let rank = if is_seen { (true, error, texels) } else { (false, texels as f64, texels) };
        if texels <= most && best.as_ref().is_none_or(|(least, _)| rank < *least) {
            best = Some((rank, choice));
        }
    }
    let Some((_, choice)) = best else { return Ok(None) };
    shown(&choice).map(Some)
}

/// A model whose triangles have one material, with that alone; none where they have several, or it has maps that cannot
/// be scaled.
fn of_one_material(model: &Model) -> Option<Model> {
    let own = *model.mesh.triangle_materials.first()?;
    let mut material = model.materials.get(own as usize)?.clone();
    let is_extended = material.extensions.textures_mut().into_iter().any(|(slot, _)| slot.is_some());
    if is_extended
        || material.parallax.is_some()
        || model.mesh.triangle_materials.iter().any(|&other| other != own)
    {
        return None;
    }
    let mut model = Model { materials: vec![material], ..model.clone() };
    model.mesh.triangle_materials.fill(0);
    Some(with_tangents(model))
}

/// All choices of one of so many for each place.
fn choices(counts: &[usize]) -> Vec<Vec<usize>> {
    counts.iter().fold(vec![Vec::new()], |all, &count| {
        let longer = |choice: &Vec<usize>| -> Vec<Vec<usize>> {
            (0..count).map(|k| choice.iter().copied().chain([k]).collect()).collect()
        };
        all.iter().flat_map(longer).collect()
    })
}

fn texels(image: &parbake_model::Image) -> usize {
    image.width * image.height
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::options::LodOptions;
    use super::super::ways::WORTHWHILE;
    use super::super::{Level, make_levels};
    use super::*;
    use parbake_model::Image;
    use parbake_model::glam::{Vec2, Vec3, vec2};
    use parbake_model::{TextureSlot, Wrap};

    /// A wavy sheet with a checkerboard of 32² fields on a texture of 64² texels: no other layout with fewer texels shows
    /// them as they are.
    fn checkered() -> Model {
        let (cells, mut mesh) = (24u32, Mesh::default());
        for (row, column) in (0..=cells).flat_map(|row| (0..=cells).map(move |column| (row, column))) {
            let (x, y) = (column as f32 / cells as f32, row as f32 / cells as f32);
            mesh.positions.push(Vec3::new(2.0 * x, 2.0 * y, 0.1 * (5.0 * x).sin() * (4.0 * y).cos()));
            mesh.uvs.push(vec2(x, y));
        }
        for (row, column) in (0..cells).flat_map(|row| (0..cells).map(move |column| (row, column))) {
            let a = row * (cells + 1) + column;
            mesh.triangles.extend([[a, a + 1, a + cells + 2], [a, a + cells + 2, a + cells + 1]]);
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        let field = |i: u32| {
            if (i % 64 / 2 + i / 64 / 2).is_multiple_of(2) { [200, 30, 20, 255] } else { [20, 60, 190, 255] }
        };
        let images = vec![Image {
            name: "fields".into(),
            width: 64,
            height: 64,
            pixels: (0..4096).map(field).collect(),
        }];
        let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
        let materials =
            vec![Material { base_color_texture: Some(slot), double_sided: true, ..Material::default() }];
        Model { name: "fields".into(), mesh, materials, images, ..Model::default() }
    }

    fn levels(model: &Model, triangles: usize) -> Vec<Level> {
        let options =
            LodOptions { screen_size: vec![64.0], triangles: vec![triangles], ..LodOptions::default() };
        let mut levels = Vec::new();
        make_levels::<BakeError>(model, &options, &(), |level| {
            levels.push(level);
            Ok(())
        })
        .unwrap();
        levels
    }

    /// Protects what an artist laid out: the way that shows most is taken and named, all figures are told, and a level
    /// never has more triangles than were asked for.
    #[test]
    fn the_best_way_is_taken() {
        let [level] = &levels(&checkered(), 400)[..] else { panic!("one level") };
        let Level { report, baked, .. } = level;
        assert!(report.triangles <= 400 && report.triangles == baked.model.mesh.triangles.len());
        let best = report.candidates.iter().map(|c| c.psnr).fold(0.0, f64::max);
        let taken = report
            .candidates
            .iter()
            .find(|c| c.way == report.way && c.texture_size == report.texture_size)
            .unwrap();
        assert!(taken.psnr >= best - WORTHWHILE, "{:?}", report.candidates);
        // Few triangles of a wavy sheet, and halved fields are grey: both ways were weighed.
        assert!(report.candidates.len() >= 2, "{:?}", report.candidates);
    }

    /// Protects small files and sharp maps: of maps that are larger than needed so many texels stay as are seen, at most
    /// half, and where that shows nearly all no bake is begun.
    #[test]
    fn large_maps_are_scaled() {
        let mut model = checkered();
        // The same fields with 32² texels each.
        let enlarged = |i: usize| model.images[0].pixels[i / 1024 / 16 * 64 + i % 1024 / 16];
        let pixels = (0..1024 * 1024).map(enlarged).collect();
        model.images[0] = Image { name: "fields".into(), width: 1024, height: 1024, pixels };
        let [level] = &levels(&model, 1100)[..] else { panic!("one level") };
        let Level { report, baked, .. } = level;
        assert_eq!(report.way, Way::Scaled, "{:?}", report.candidates);
        assert_eq!(report.candidates.len(), 1);
        assert!(report.texels <= 512 * 512 && report.texels >= 64 * 64, "{}", report.texels);
        let mesh = &baked.model.mesh;
        let is_own = |(uv, p): (&Vec2, &Vec3)| (*uv - 0.5 * p.truncate()).length() < 0.01;
        assert!(mesh.uvs.iter().zip(&mesh.positions).all(is_own));
        assert!(report.at_screen_size.psnr > 40.0, "{}", report.at_screen_size.psnr);
    }

    /// Protects models of several materials: their maps cannot be scaled in one material.
    #[test]
    fn several_materials_are_not_scaled() {
        let mut model = checkered();
        assert!(of_one_material(&model).is_some());
        model.materials.push(Material::default());
        assert_eq!(of_one_material(&model).map(|model| model.materials.len()), Some(1));
        model.mesh.triangle_materials[3] = 1;
        assert!(of_one_material(&model).is_none());
        assert_eq!(choices(&[2, 1, 2]), [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 0, 1]]);
    }
}
