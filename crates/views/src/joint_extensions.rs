//! The extensions of several materials as those of one, whose textures say what each had.
//!
//! Contract: values as in `extension_values.rs`; a factor is the largest value, and the image says how much of it is where. What
//! glTF has no texture for has to agree ([`agree`]).

use crate::extension_maps::{ALIKE, painted, summed};
use crate::extension_values::Group;
use crate::layer_factors::set;
use parbake_image::FloatImage;
use parbake_model::glam::{Vec3, Vec4};
use parbake_model::{Image, Iridescence, MaterialExtensions, Volume};

/// Whether one material can have both: what no texture says is the same, or shows in one of them alone. `transmits` tells
/// whether light passes both.
pub fn agree(a: &MaterialExtensions, b: &MaterialExtensions, transmits: bool) -> bool {
    let inside = |e: &MaterialExtensions| {
        e.volume.filter(|v| v.thickness > 0.0).map(|v| (v.attenuation_distance, v.attenuation_color))
    };
    let film = |e: &MaterialExtensions| e.iridescence.filter(|i| i.factor > 0.0).map(|i| i.ior);
    let is_same_inside = inside(a).zip(inside(b)).is_none_or(|(a, b)| a == b);
    let is_same_film = film(a).zip(film(b)).is_none_or(|(a, b)| a == b);
    // Of an opaque surface the index becomes a colour of its reflection.
    let bends = |e: &MaterialExtensions| (e.ior.unwrap_or(1.5), e.dispersion.unwrap_or(0.0));
    is_same_inside && is_same_film && (!transmits || bends(a) == bends(b))
}

/// The extensions of one material in place of several that [`agree`], without a clearcoat's own normals, and the images that
/// they name, the first of which is to be the image `first`. `values` tells a group's value at each of width × height texels, none
/// where there is no surface; it is asked for groups alone that vary, with the index of refraction in the specular colour or not.
pub fn joint_extensions(
    materials: &[&MaterialExtensions],
    [width, height]: [usize; 2],
    first: usize,
    values: impl Fn(Group, bool) -> Vec<Option<Vec4>>,
) -> (MaterialExtensions, Vec<Image>) {
    let all = || materials.iter().copied();
    let ior = |e: &MaterialExtensions| e.ior.unwrap_or(1.5);
    let folds = all().any(|e| ior(e) != ior(materials[0]));
    let mut out = MaterialExtensions {
        ior: all().find_map(|e| e.ior).filter(|_| !folds),
        dispersion: all().find_map(|e| e.dispersion),
        volume: all().find_map(|e| e.volume).map(|v| Volume { thickness: 0.0, texture: None, ..v }),
        iridescence: all()
            .find_map(|e| e.iridescence.filter(|i| i.factor > 0.0))
            .map(|i| Iridescence { ior: i.ior, ..Iridescence::default() }),
        ..MaterialExtensions::default()
    };
    let mut images = Vec::new();
    for group in Group::ALL {
        let plain = |e: &MaterialExtensions| group.value(e, [None; 2], folds);
        let is_textured = all().any(|e| group.is_textured(e));
        let shows = |e: &MaterialExtensions| match group {
            Group::Specular => is_textured || plain(e) != Vec4::ONE,
            _ => group.strength(plain(e)) > 0.0,
        };
        if !all().any(shows) {
            continue;
        }
        let is_one = !is_textured && all().all(|e| plain(e) == plain(materials[0]));
        match (is_one, group) {
            (true, Group::Anisotropy) => out.anisotropy = materials[0].anisotropy,
            (true, _) => set(&mut out, group, group.parts().map(|part| part.said(plain(materials[0]))), 0),
            (false, _) => {
                let values = values(group, folds);
                let [said] = summed(group, &values, &|_| Some(0), 1)[..] else { continue };
                let varies = said.map(|s| group == Group::Anisotropy || s.spread > ALIKE * s.largest);
                let largest = [0, 1].map(|k| if varies[k] { said[k].largest } else { 0.0 });
                let mut said = said;
                for (own, varies) in said.iter_mut().zip(varies) {
                    if varies {
                        (own.value, own.is_textured) = (Vec3::splat(own.largest), true);
                    }
                }
                set(&mut out, group, said, first + images.len());
                if varies.contains(&true) {
                    images.push(painted(group, &filled(values, width, height), largest));
                }
            }
        }
    }
    (out, images)
}

/// Texels without a surface get the mean of the others.
fn filled(values: Vec<Option<Vec4>>, width: usize, height: usize) -> FloatImage<Vec4> {
    let known = values.iter().flatten().count().max(1);
    let mean = values.iter().flatten().sum::<Vec4>() / known as f32;
    let texels = values.into_iter().map(|value| value.unwrap_or(mean)).collect();
    FloatImage { width, height, texels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::vec4;
    use parbake_model::{Clearcoat, Sheen, Specular, Transmission};

    fn coat(factor: f32, roughness: f32) -> MaterialExtensions {
        let clearcoat = Some(Clearcoat { factor, roughness, ..Clearcoat::default() });
        MaterialExtensions { clearcoat, ..MaterialExtensions::default() }
    }

    /// Texels of materials in turn, and one without a surface.
    fn in_turn(materials: &[&MaterialExtensions], group: Group, folds: bool) -> Vec<Option<Vec4>> {
        let values = materials.iter().map(|e| Some(group.value(e, [None; 2], folds)));
        values.chain([None]).collect()
    }

    /// Protects paint beside rubber: only the paint is coated, and what is the same for all needs no image.
    #[test]
    fn an_image_says_who_is_coated() {
        let cloth = MaterialExtensions {
            sheen: Some(Sheen { color: [0.2, 0.4, 0.0], roughness: 0.5, ..Sheen::default() }),
            ..MaterialExtensions::default()
        };
        let all = [&coat(0.8, 0.3), &MaterialExtensions::default(), &cloth];
        assert!(agree(all[0], all[2], false));
        let (own, images) = joint_extensions(&all, [4, 1], 7, |group, folds| in_turn(&all, group, folds));
        let clearcoat = own.clearcoat.unwrap_or_default();
        assert_eq!((clearcoat.factor, clearcoat.roughness), (0.8, 0.3));
        assert_eq!((clearcoat.texture.map(|slot| slot.image), clearcoat.roughness_texture), (Some(7), None));
        let coated: Vec<u8> = images[0].pixels.iter().map(|p| p[0]).collect();
        assert_eq!(coated, [255, 0, 0, 85]);
        let sheen = own.sheen.unwrap_or_default();
        assert_eq!((sheen.color, sheen.color_texture.map(|slot| slot.image)), ([0.4; 3], Some(8)));
        let [r, g, b, _] = images[1].pixels[2];
        assert!(r.abs_diff(188) <= 1 && g == 255 && b == 0, "{r} {g} {b}");
        let (same, images) = joint_extensions(&[all[0], all[0]], [1, 1], 0, |_, _| panic!("nothing varies"));
        assert_eq!((&same, images.len()), (all[0], 0));
    }

    /// Protects glass from the inside of other glass, and opaque surfaces from losing what their index reflects.
    #[test]
    fn what_no_texture_says_has_to_agree() {
        let glass = |thickness, distance, ior| MaterialExtensions {
            transmission: Some(Transmission { factor: 1.0, texture: None }),
            volume: Some(Volume { thickness, attenuation_distance: distance, ..Volume::default() }),
            ior: Some(ior),
            ..MaterialExtensions::default()
        };
        assert!(agree(&glass(1.0, 2.0, 1.4), &glass(0.5, 2.0, 1.4), true));
        assert!(agree(&glass(1.0, 2.0, 1.4), &glass(0.0, 3.0, 1.4), true));
        assert!(!agree(&glass(1.0, 2.0, 1.4), &glass(0.5, 3.0, 1.4), true));
        assert!(!agree(&glass(1.0, 2.0, 1.4), &glass(0.5, 2.0, 1.3), true));
        let dense = MaterialExtensions { ior: Some(2.0), ..MaterialExtensions::default() };
        let dull = MaterialExtensions {
            specular: Some(Specular { factor: 0.5, ..Specular::default() }),
            ..MaterialExtensions::default()
        };
        assert!(agree(&dense, &dull, false));
        let all = [&dense, &dull];
        let (own, images) = joint_extensions(&all, [3, 1], 0, |group, folds| in_turn(&all, group, folds));
        let specular = own.specular.unwrap_or_default();
        let reflected = Group::Specular.value(&dense, [None; 2], true).x;
        assert_eq!((own.ior, specular.color, specular.factor), (None, [reflected; 3], 1.0));
        assert_eq!((images[0].pixels[0][3], images[0].pixels[1][3]), (255, 128));
        assert!(in_turn(&all, Group::Specular, true)[1] == Some(vec4(1.0, 1.0, 1.0, 0.5)));
    }
}
