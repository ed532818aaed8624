//! A level with its model's own maps, with fewer texels: no bake.
//!
//! Materials share one set of maps (`levels/merged.rs`), of which each loses as many texels as pictures allow
//! (`levels/fewer_texels.rs`).
//!
//! Contract: at most half of the model's texels. Charts are as they were delivered, shared texels and mirrored charts
//! included. A watcher that says stop is heeded between pictures.

use super::candidate::Way;
use super::delivered::{Coarser, surface_of};
use super::maker::{Draft, Maker};
use super::picture_score::PictureScore;
use crate::bake::Baked;
use crate::error::BakeError;
use crate::options::BakeOptions;
use crate::report::BakeReport;
use crate::work::Work;
use parbake_atlas::check_mesh;
use parbake_levels::fewer_texels::with_fewer_texels;
use parbake_levels::merged::with_common_maps;
use parbake_levels::screen::largest_texture;
use parbake_model::Model;

/// Texels that a model without textures may get for the colours of its materials.
const PALETTE: usize = 64 * 64;

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

/// The model with scaled maps: with the fewest texels that show nothing less, at most half of the original's.
/// `side` is how many texels along a line its surface needs. None where materials have no common maps, or time was too short for
/// enough of them.
pub(crate) fn scaled(
    maker: &Maker,
    score: &PictureScore,
    coarser: &Coarser,
    side: f64,
    is_over: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Model>, BakeError> {
    let most = match texels_read(maker.model) {
        0 => PALETTE,
        texels => texels / 2,
    };
    let Some(model) = with_common_maps(&coarser.model, side, maker.options.max_texture_size, most) else {
        return Ok(None);
    };
    with_fewer_texels(&model, most, is_over, |reduced| score.psnr_of_some(reduced))
}

/// Texels of all images that triangles show.
fn texels_read(model: &Model) -> usize {
    let mut images: Vec<usize> = (model.mesh.triangle_materials.iter())
        .filter_map(|&own| model.materials.get(own as usize))
        .flat_map(|material| material.all_texture_slots().map(|slot| slot.image))
        .collect();
    images.sort_unstable();
    images.dedup();
    images.iter().filter_map(|&image| model.images.get(image)).map(|image| image.width * image.height).sum()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::options::LodOptions;
    use super::super::ways::WORTHWHILE;
    use super::super::{Level, make_levels};
    use super::*;
    use parbake_model::glam::{Vec2, Vec3, vec2};
    use parbake_model::{Image, Material, Mesh, TextureSlot, Wrap};

    /// A wavy sheet with a checkerboard of 16² fields on a texture of 32² texels: no other layout with fewer texels shows
    /// them as they are.
    fn checkered() -> Model {
        let (cells, mut mesh) = (8u32, Mesh::default());
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
            if (i % 32 / 2 + i / 32 / 2).is_multiple_of(2) { [200, 30, 20, 255] } else { [20, 60, 190, 255] }
        };
        let images = vec![Image {
            name: "fields".into(),
            width: 32,
            height: 32,
            pixels: (0..1024).map(field).collect(),
        }];
        let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
        let materials =
            vec![Material { base_color_texture: Some(slot), double_sided: true, ..Material::default() }];
        Model { name: "fields".into(), mesh, materials, images, ..Model::default() }
    }

    fn levels(model: &Model, triangles: usize) -> Vec<Level> {
        let options =
            LodOptions { screen_size: vec![32.0], triangles: vec![triangles], ..LodOptions::default() };
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
        let [level] = &levels(&checkered(), 45)[..] else { panic!("one level") };
        let Level { report, baked, .. } = level;
        assert!(report.triangles <= 45 && report.triangles == baked.model.mesh.triangles.len());
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
        // The same fields with 64² texels each.
        let enlarged = |i: usize| model.images[0].pixels[i / 1024 / 32 * 32 + i % 1024 / 32];
        let pixels = (0..1024 * 1024).map(enlarged).collect();
        model.images[0] = Image { name: "fields".into(), width: 1024, height: 1024, pixels };
        let [level] = &levels(&model, 120)[..] else { panic!("one level") };
        let Level { report, baked, .. } = level;
        assert_eq!(report.way, Way::Scaled, "{:?}", report.candidates);
        assert_eq!(report.candidates.len(), 1);
        assert!(report.triangles <= 120);
        assert!(report.texels <= 512 * 512 && report.texels >= 32 * 32, "{}", report.texels);
        let mesh = &baked.model.mesh;
        let is_own = |(uv, p): (&Vec2, &Vec3)| (*uv - 0.5 * p.truncate()).length() < 0.01;
        assert!(mesh.uvs.iter().zip(&mesh.positions).all(is_own));
        assert!(report.at_screen_size.psnr > 40.0, "{}", report.at_screen_size.psnr);
    }
}
