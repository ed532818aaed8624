//! The size on screen at which two models look the same.

use crate::jar;
use parbake_evaluate::screen_size::{BLACK_AND_WHITE, ScreenComparison};
use parbake_model::Model;

/// The jar with a fine pattern of two greys, or their mean.
fn patterned(is_patterned: bool) -> Model {
    let mut jar = jar(1.0, 0.0, 1.0);
    let mut dark = jar.materials[0].clone();
    let greys = if is_patterned { [0.5, 0.3] } else { [0.4, 0.4] };
    jar.materials.iter_mut().for_each(|material| material.base_color = [greys[0], greys[0], greys[0], 1.0]);
    dark.base_color = [greys[1], greys[1], greys[1], 1.0];
    let index = jar.materials.len() as u32;
    jar.materials.push(dark);
    jar.mesh.triangle_materials.iter_mut().skip(1).step_by(2).for_each(|material| *material = index);
    jar
}

/// Protects where levels switch: what is too fine to be seen makes no difference from afar, so two models look the same up to a
/// size between one at which they do and one at which they do not; of what differs everywhere there is no such size.
#[test]
fn fine_differences_vanish_with_size() {
    let (fine, mean) = (patterned(true), patterned(false));
    let screens = ScreenComparison::new(&fine);
    let [fine, mean] = [&fine, &mean].map(|model| screens.place(model).unwrap());
    let psnr = |pixels: f64| screens.compare(&fine, &mean, pixels).unwrap().psnr;
    let (small, large) = (psnr(100.0), psnr(400.0));
    assert!(small > large + 1.0, "{small} {large}");
    let size = |same: f64| screens.largest_same(&mean, &[&fine], 300.0, same).unwrap();
    let between = size(0.5 * (small + large)).unwrap();
    assert!((100.0..400.0).contains(&between), "{between}");
    // Three steps of a fifth.
    assert!((size(large - 10.0).unwrap() - 518.4).abs() < 0.1);
    let mut white = patterned(false);
    white.materials.iter_mut().for_each(|material| material.base_color = [1.0; 4]);
    let white = screens.place(&white).unwrap();
    assert_eq!(screens.largest_same(&white, &[&fine], 100.0, 40.0).unwrap(), None);
}

/// Protects copies that share textures with one that is placed already: they are shown as if they were placed by themselves.
#[test]
fn models_of_the_same_materials_share_textures() {
    let (mut model, mut other) = (patterned(true), patterned(true));
    let colors = |model: &Model| model.mesh.positions.iter().map(|p| (0.5 + 0.3 * *p).extend(1.0)).collect();
    model.mesh.colors = colors(&model);
    other.mesh.positions.iter_mut().for_each(|position| position.y *= 0.7);
    other.mesh.colors = colors(&other);
    let screens = ScreenComparison::new(&model);
    let placed = screens.place(&model).unwrap();
    let pictures = screens.pictures(&screens.place(&other).unwrap(), 64.0).unwrap();
    let shared = screens.place_like(&other, &placed).unwrap();
    assert!(screens.compared(&pictures, &shared).errors.iter().flatten().all(|error| *error == 0.0));
    assert!(screens.psnr(&pictures, &placed) < 40.0);
}

/// Protects outlines: what has the colour of one background shows before others.
#[test]
fn black_and_white_show_every_outline() {
    let grey = |scale: f32| {
        let mut jar = jar(1.0, 0.0, 1.0);
        for material in &mut jar.materials {
            (material.unlit, material.base_color) = (true, [0.2159, 0.2159, 0.2159, 1.0]);
        }
        jar.mesh.positions.iter_mut().for_each(|position| *position *= scale);
        jar
    };
    let (model, smaller) = (grey(1.0), grey(0.9));
    let screens = ScreenComparison::new(&model);
    let [model, smaller] = [&model, &smaller].map(|model| screens.place(model).unwrap());
    let on_grey = screens.psnr(&screens.pictures(&model, 64.0).unwrap(), &smaller);
    let pictures = screens.pictures_on(&model, 64.0, BLACK_AND_WHITE).unwrap();
    let on_both = screens.psnr(&pictures, &smaller);
    assert!(on_grey > 60.0 && on_both < 30.0, "{on_grey} {on_both}");
    assert!(screens.psnr(&pictures, &model) > 60.0);
}
