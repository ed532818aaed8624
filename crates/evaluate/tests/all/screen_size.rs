//! The size on screen at which two models look the same.

use crate::jar;
use parbake_evaluate::screen_size::ScreenComparison;
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

/// Protects where levels switch: what is too fine to be seen makes no difference from afar, the better two have to agree the
/// smaller the size is, and of what differs everywhere there is none.
#[test]
fn fine_differences_vanish_with_size() {
    let (fine, mean) = (patterned(true), patterned(false));
    let screens = ScreenComparison::new(&fine);
    let [fine, mean] = [&fine, &mean].map(|model| screens.place(model).unwrap());
    let psnr = |pixels: f64| screens.compare(&fine, &mean, pixels).unwrap().psnr;
    let (small, large) = (psnr(24.0), psnr(400.0));
    assert!(small > large + 1.0, "{small} {large}");
    let size = |same: f64| screens.largest_same(&mean, &[&fine], 100.0, same).unwrap();
    let (lenient, strict) = (size(large - 1.0), size(small - 0.1));
    assert!(lenient > strict && strict.is_some_and(|size| size < 100.0), "{lenient:?} {strict:?}");
    assert_eq!(size(119.0), None);
    let white = screens.place(&{
        let mut white = patterned(false);
        white.materials.iter_mut().for_each(|material| material.base_color = [1.0; 4]);
        white
    });
    assert_eq!(screens.largest_same(&white.unwrap(), &[&fine], 100.0, 40.0).unwrap(), None);
}
