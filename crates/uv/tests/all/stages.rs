//! The UV stages as bakes call them, on a sheet of two charts whose coordinates are to stay, and on a small picture
//! whose details are all in one place: the texels go there.

use parbake_atlas::check;
use parbake_image::FloatImage;
use parbake_model::glam::{Vec2, Vec4};
use parbake_model::{Image, Material, Mesh, Model, TextureSlot};
use parbake_render::interpretation::Interpretation;
use parbake_render::scene::Scene;
use parbake_uv::contact::{Border, ContactOptions};
use parbake_uv::mode::{Method, UvMode};
use parbake_uv::paper::Guide;
use parbake_uv::picture::coarse_to_fine::optimised;
use parbake_uv::picture::plane::Plane;
use parbake_uv::picture::signal_scales::{Picture, signal_scales};
use parbake_uv::picture::texture::{errors, written_texture};
use parbake_uv::picture::{Moves, PictureOptions, as_f64};
use parbake_uv::surface::{RepairedLowPoly, Source, UvStageOptions, UvStageResult, optimise_uvs};
use parbake_views::frame::{common_frame, placed};

/// Two flat squares of four by four cells side by side, each a chart that fills half of the texture; all details
/// are on the first one.
fn sheet() -> Model {
    let mut mesh = Mesh::default();
    let cells = 4u32;
    for side in 0..2 {
        let first = mesh.positions.len() as u32;
        for i in 0..(cells + 1) * (cells + 1) {
            let at = Vec2::new((i % (cells + 1)) as f32, (i / (cells + 1)) as f32) / cells as f32;
            mesh.positions.push((at + Vec2::new(1.2 * side as f32, 0.0)).extend(0.0));
            let uv = Vec2::new(0.02 + 0.46 * at.x + 0.5 * side as f32, 0.02 + 0.96 * at.y);
            mesh.uvs.push(uv);
        }
        for i in 0..cells * cells {
            let a = first + i / cells * (cells + 1) + i % cells;
            let (b, c, d) = (a + 1, a + cells + 2, a + cells + 1);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
            mesh.triangle_materials.extend([0, 0]);
        }
    }
    mesh.normals = vec![parbake_model::glam::Vec3::Z; mesh.positions.len()];
    let side = 256;
    let pixel = |i: usize| {
        let (x, y) = (i % side, i / side);
        let fine = ((x / 8 + y / 8) % 2 * 150) as u8;
        if x < side / 2 { [50 + fine, 120, 200 - fine, 255] } else { [90, 120, 100, 255] }
    };
    let pixels = (0..side * side).map(pixel).collect();
    let slot = TextureSlot { image: 0, ..TextureSlot::default() };
    Model {
        name: "sheet".into(),
        mesh,
        materials: vec![Material { base_color_texture: Some(slot), ..Material::default() }],
        images: vec![Image { name: "details".into(), width: side, height: side, pixels }],
        ..Model::default()
    }
}

fn options(mode: UvMode) -> UvStageOptions {
    UvStageOptions {
        mode,
        method: Method::Fit,
        guide: Guide::ContentAware,
        texture_size: 64,
        gutter: 1.0,
        gutter_required: false,
        parallax_size: None,
        smallest_mip: None,
        steps: 12,
        refines_scarce_only: false,
        more_triangles: 0,
    }
}

fn delivered(model: &Model) -> RepairedLowPoly {
    RepairedLowPoly { name: model.name.clone(), mesh: model.mesh.clone(), repaired: Vec::new() }
}

fn stage(model: &Model, mode: UvMode) -> UvStageResult {
    let frame = common_frame(model).expect("it has an extent");
    let interpretation = Interpretation { decode_srgb: false, ..Interpretation::default() };
    let scene = Scene::new(placed(model, &frame), &model.materials, &model.images, interpretation);
    let source = Source {
        scene: &scene,
        surface: None,
        importances: &[],
        max_distance: 0.0,
        brightened: 0.0,
        normals: false,
        pixel: 0.01,
    };
    optimise_uvs(delivered(model), &frame, &source, &options(mode), &())
}

/// Protects coordinates that are to be kept, or are sound and need no repair: they stay to the bit.
#[test]
fn kept_coordinates_stay() {
    let model = sheet();
    for mode in [UvMode::Keep, UvMode::Repair] {
        let kept = stage(&model, mode);
        assert_eq!(kept.model.mesh.uvs, model.mesh.uvs);
        assert!(kept.moves.is_none() && kept.report.relative_error == [1.0; 2]);
    }
}

/// Protects what counts more: its chart gets as many times the area, the layout stays sound, and without weights
/// nothing is packed.
#[test]
fn charts_get_the_area_that_they_count() {
    let model = sheet();
    let half = model.mesh.triangles.len() / 2;
    let area = |mesh: &Mesh, from: usize| -> f32 {
        let of = |t: usize| {
            let [a, b, c] = mesh.corner_uvs(t);
            0.5 * (b - a).perp_dot(c - a).abs()
        };
        (from..from + half).map(of).sum()
    };
    let mut low = delivered(&model);
    low.weigh_charts(&[], &options(UvMode::Optimize)).expect("nothing to do");
    assert_eq!(low.mesh.uvs, model.mesh.uvs);
    let weights: Vec<f32> = (0..2 * half).map(|t| if t < half { 4.0 } else { 0.5 }).collect();
    low.weigh_charts(&weights, &options(UvMode::Optimize)).expect("both fit");
    let [first, second] = [0, half].map(|from| area(&low.mesh, from) / area(&model.mesh, from));
    assert!((first / second - 8.0).abs() < 0.1, "{first} {second}");
    let found = check(&parbake_atlas::Layout::new(&low.mesh), 64);
    assert_eq!((found.overlaps.pairs, found.orientations.outside.count), (0, 0));
}

/// Protects pictures: grids from coarse to fine show the corner with all details better than a plain plane does,
/// at full size and minified, and no cell turns over.
#[test]
fn a_pictures_details_get_the_texels() {
    let side = 96;
    let pixel = |i: usize| {
        let (x, y) = (i % side, i / side);
        let value = if x < 32 && y < 32 { 60 + 140 * ((x / 2 + y / 2) % 2) } else { (x + y) / 2 };
        [value as u8, value as u8, 90, 255]
    };
    let image = Image {
        name: "corner".into(),
        width: side,
        height: side,
        pixels: (0..side * side).map(pixel).collect(),
    };
    let picture = Picture::new(&image);
    let plane = Plane { cells: 8 };
    let options = PictureOptions { texture_size: 32, grid: 8, steps: 12, guide: Guide::ContentAware };
    let contact = ContactOptions { texture_size: 32, border: Border::Slide, ..Default::default() };
    let all = signal_scales(&picture, plane, usize::MAX);
    let grey = || FloatImage::solid(32, Vec4::splat(0.5));
    let kept = plane.layout(as_f64(&plane.points()));
    let before = errors(&kept, &all, &written_texture(&kept, &all[..1], grey()));
    let mut moves = Moves::new(plane);
    let (layout, ..) = optimised(&picture, &options, &contact, &mut moves, &()).expect("nobody stops it");
    let after = errors(&layout, &all, &written_texture(&layout, &all[..1], grey()));
    assert!(check(&layout, 32).is_bijective() && moves.steps > 0);
    assert!(
        after[0] < 0.7 * before[0] && after.iter().sum::<f64>() < before.iter().sum::<f64>(),
        "{before:?} {after:?}"
    );
}
