//! Scenes with cutouts: what is left out, and what is seen in its place.

use super::*;
use crate::camera::Projection;
use crate::cutout::CutoutCoefficients;
use crate::shade::Unlit;
use crate::spherical_harmonics::{MOST_FUNCTIONS, evaluate};
use parbake_model::{Basis, ParallaxMap, TextureSlot, UvTransform, Wrap};

/// Two squares, in the planes z = 0 (material 0) and z = −0.5 (material 1).
fn squares() -> Mesh {
    let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let place = |z: f32| uvs.map(|uv| Vec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, z));
    Mesh {
        positions: [place(0.0), place(-0.5)].concat(),
        normals: vec![Vec3::Z; 8],
        uvs: [uvs, uvs].concat(),
        triangles: vec![[0, 3, 1], [1, 3, 2], [4, 7, 5], [5, 7, 6]],
        triangle_materials: vec![0, 0, 1, 1],
        ..Mesh::default()
    }
}

/// A material of one colour with a map that shifts by half a texture.
fn material(colour: [u8; 3], images: &mut Vec<Image>) -> Material {
    images.push(Image::solid("", 1, 1, [colour[0], colour[1], colour[2], 255]));
    images.push(Image::solid("", 1, 1, [0; 4]));
    let map = ParallaxMap {
        images: vec![images.len() - 1],
        scale: vec![0.0; 2],
        offset: vec![0.5 / 0.282_095, 0.0],
        ..ParallaxMap::default()
    };
    let slot = TextureSlot { image: images.len() - 2, ..TextureSlot::default() };
    Material { base_color_texture: Some(slot), parallax: Some(map), ..Material::default() }
}

/// Order 1, 2 × 1 texels: the left one is there where it is seen from z > 0 and left out
/// otherwise, the right one the other way round.
fn two_sided() -> CutoutCoefficients {
    let mut values = [0.0; MOST_FUNCTIONS];
    evaluate(1, Vec3::Z, &mut values);
    let z = 1.0 / values[2];
    let coefficients = vec![0.0, 0.0, z, 0.0, 0.0, 0.0, -z, 0.0];
    CutoutCoefficients {
        basis: Basis::Harmonics(1),
        width: 2,
        height: 1,
        coefficients,
        wrap: [Wrap::Clamp; 2],
    }
}

const RED: [u8; 3] = [255, 0, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const SIDE: usize = 32;

fn render(materials: &[Material], images: &[Image], from: Vec3, parallax: bool) -> Picture {
    let interpretation = Interpretation { parallax, ..Interpretation::default() };
    let scene = Scene::new(squares(), materials, images, interpretation);
    let camera = Camera::towards_origin(from, 3.5, Projection::Orthographic(1.0));
    scene.render(&Unlit, &camera, SIDE, 2)
}

/// The pixels of the middle row at a quarter and three quarters of its length.
fn left_and_right(picture: &Picture) -> [[f32; 4]; 2] {
    [SIDE / 4, 3 * SIDE / 4].map(|column| picture.rgba[SIDE / 2 * SIDE + column])
}

const SEEN_RED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];
const SEEN_BLUE: [f32; 4] = [0.0, 0.0, 1.0, 1.0];

/// Protects the meaning of a cutout in a file: what it leaves out is looked through, to what
/// lies behind or to nothing, from both sides of a face; materials without one stay whole;
/// and who leaves parallax out sees all of it.
#[test]
fn what_is_behind_a_cutout_is_seen() {
    let mut images = Vec::new();
    let mut materials = [material(RED, &mut images), material(BLUE, &mut images)];
    let whole = render(&materials, &images, Vec3::Z, true);
    let cutout = two_sided().pack(&mut images);
    materials[0].parallax.as_mut().unwrap().cutout = Some(cutout.clone());
    let front = render(&materials, &images, Vec3::Z, true);
    assert_eq!(left_and_right(&front), [SEEN_RED, SEEN_BLUE]);
    assert_eq!(render(&materials, &images, Vec3::Z, false), whole);
    // From behind, the blue square hides what the red one shows.
    let behind = render(&materials, &images, Vec3::NEG_Z, true);
    assert_eq!(left_and_right(&behind), [SEEN_BLUE, SEEN_BLUE]);
    materials[1].parallax.as_mut().unwrap().cutout = Some(cutout);
    let front = render(&materials, &images, Vec3::Z, true);
    assert_eq!(left_and_right(&front), [SEEN_RED, [0.0; 4]]);
    // The left of the picture is the right of the texture, and there from this side.
    let behind = render(&materials, &images, Vec3::NEG_Z, true);
    assert_eq!(left_and_right(&behind), [SEEN_BLUE, [0.0; 4]]);
    let covered: f32 = behind.rgba.iter().map(|p| p[3]).sum();
    assert_eq!(covered, (SIDE * SIDE / 2) as f32);
}

/// Protects the coordinate: the base colour's after its transform, before the shift (by half
/// a texture here, which does not move the border at all).
#[test]
fn opacity_is_fetched_where_the_shift_is() {
    let mut images = Vec::new();
    let mut materials = [material(RED, &mut images), material(RED, &mut images)];
    let cutout = two_sided().pack(&mut images);
    for material in &mut materials {
        material.parallax.as_mut().unwrap().cutout = Some(cutout.clone());
        let slot = material.base_color_texture.as_mut().unwrap();
        slot.transform = UvTransform { offset: Vec2::X, scale: Vec2::new(-1.0, 1.0), ..Default::default() };
    }
    let front = render(&materials, &images, Vec3::Z, true);
    assert_eq!(left_and_right(&front), [[0.0; 4], SEEN_RED]);
    let covered: f32 = front.rgba.iter().map(|p| p[3]).sum();
    assert_eq!(covered, (SIDE * SIDE / 2) as f32);
    for material in &mut materials {
        material.base_color_texture = None;
    }
    let untextured = render(&materials, &images, Vec3::Z, true);
    assert!(untextured.rgba.iter().all(|p| p[3] == 1.0), "no coordinate, no cutout");
}

/// Protects models from a cutout that cannot be shown: the whole map is left out.
#[test]
fn a_broken_cutout_takes_its_map_along() {
    let mut images = Vec::new();
    let mut materials = [material(RED, &mut images), material(BLUE, &mut images)];
    let mut cutout = two_sided().pack(&mut images);
    cutout.scale.clear();
    materials[0].parallax.as_mut().unwrap().cutout = Some(cutout);
    let plain = render(&materials, &images, Vec3::Z, false);
    assert_eq!(render(&materials, &images, Vec3::Z, true), plain);
}

/// Protects both looks of a file: vertices have their offsets where maps are shown, and only there.
#[test]
fn offsets_belong_to_the_maps() {
    let mut images = Vec::new();
    let materials = [material(RED, &mut images), material(BLUE, &mut images)];
    let mut mesh = squares();
    mesh.parallax_offsets = vec![Vec3::new(0.0, 0.0, -0.25); 4];
    mesh.parallax_offsets.resize(8, Vec3::ZERO);
    let depth = |parallax| {
        let interpretation = Interpretation { parallax, ..Interpretation::default() };
        Scene::new(mesh.clone(), &materials, &images, interpretation).mesh().positions[0].z
    };
    assert_eq!([depth(false), depth(true)], [0.0, -0.25]);
}
