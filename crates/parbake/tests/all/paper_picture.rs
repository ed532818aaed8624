//! The paper's UV method on pictures.

use parbake::{ImageOptions, Method, bake_image};
use parbake_model::Image;
use parbake_model::glam::Vec2;

/// A picture with all its detail in one corner.
fn picture() -> Image {
    let side = 192;
    let pixels = (0..side * side)
        .map(|i| {
            let (x, y) = (i % side, i / side);
            let value = if x < 64 && y < 64 { 60 + 140 * ((x / 2 + y / 2) % 2) } else { (2 * x + y) / 4 };
            [value as u8, value as u8, 90, 255]
        })
        .collect();
    Image { name: "corner".into(), width: side, height: side, pixels }
}

/// Protects the paper's method on pictures: it moves coordinates soundly, by what its guide
/// says, and is not undone.
#[test]
fn coordinates_move_and_stay_sound() {
    let run = |no_content_aware| {
        let options = ImageOptions {
            texture_size: 64,
            grid: Some(8),
            method: Method::Paper,
            no_content_aware,
            steps: Some(60),
            ..ImageOptions::default()
        };
        bake_image(&picture(), &options, &()).expect("options are in range")
    };
    let (with, without) = (run(false), run(true));
    for baked in [&with, &without] {
        assert!(baked.report.uv.is_bijective());
        assert!(!baked.report.left_as_is);
        // Off the border, which its barrier repels.
        let uvs = &baked.model.mesh.uvs;
        let gap = |p: &Vec2| p.min_element().min(1.0 - p.max_element());
        assert!(uvs.iter().all(|p| gap(p) > 0.0), "{:?}", uvs.iter().map(gap).reduce(f32::min));
        assert_eq!(baked.report.steps, 60);
        assert!(
            baked.report.written[0] > baked.report.kept[0],
            "{:?} {:?}",
            baked.report.kept,
            baked.report.written
        );
    }
    assert_ne!(with.model.mesh.uvs, without.model.mesh.uvs);
}
