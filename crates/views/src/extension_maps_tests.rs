use super::*;
use crate::alpha_layers::layer_kinds;
use crate::backs::sides;
use crate::high_poly::Conventions;
use crate::pool::Rig;
use parbake_image::display::{Curve, Display};
use parbake_model::glam::vec2;
use parbake_model::{Anisotropy, Clearcoat, Material, Model, Sheen, TextureSlot, Transmission, Volume};
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;

/// Two squares of side 2 across the z axis, one at each end; each has a material and a half of the texture.
fn squares(materials: Vec<Material>, images: Vec<Image>) -> Model {
    let mut mesh = Mesh::default();
    for index in 0..2u32 {
        let first = mesh.positions.len() as u32;
        for (x, y) in [(-1.0f32, -1.0f32), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            mesh.positions.push(Vec3::new(x, y, index as f32));
            mesh.normals.push(Vec3::Z);
            mesh.uvs.push(vec2(0.22 * (x + 1.0) + 0.5 * index as f32 + 0.03, 0.47 * (1.0 - y) + 0.03));
        }
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        mesh.triangle_materials.extend([index; 2]);
    }
    Model { name: "squares".into(), mesh, materials, images, ..Model::default() }
}

fn maps_of(model: &Model) -> ExtensionMaps {
    maps_on(model, model)
}

fn high_of(model: &Model) -> HighPoly {
    let conventions = Conventions {
        interpretation: Interpretation::default(),
        display: Display { gain: 1.0, curve: Curve::Srgb },
        whole_material: None,
        rig: Rig { radius: 3.5, projection: Projection::Perspective(0.4) },
        max_distance: 0.1,
    };
    HighPoly::new(model, conventions).expect("it has an extent")
}

fn maps_on(low: &Model, model: &Model) -> ExtensionMaps {
    let high = high_of(model);
    assert!(high.is_whole_material, "extensions ask for whole materials");
    let placed = LowPoly::new(low, &high.frame, 16).expect("it has coordinates");
    extension_maps(&placed, &layer_kinds(&placed.placed, low, &high), &high)
}

fn material(change: impl FnOnce(&mut MaterialExtensions)) -> Material {
    let mut material = Material { double_sided: false, ..Material::default() };
    change(&mut material.extensions);
    material
}

/// Protects parts that differ: cloth beside what has none has an image that says where it is, and what is
/// the same all over stays a factor.
#[test]
fn parts_that_differ_have_an_image() {
    let sheen = Sheen { color: [0.5, 0.25, 0.0], roughness: 0.5, ..Sheen::default() };
    let maps = maps_of(&squares(vec![material(|_| {}), material(|e| e.sheen = Some(sheen))], Vec::new()));
    let [layer] = &maps.layers[..] else { panic!("one layer") };
    let found = layer.extensions.sheen.expect("a sheen");
    assert_eq!((found.color, found.roughness), ([0.5; 3], 0.5));
    assert_eq!((found.color_texture, found.roughness_texture), (Some(TextureSlot::default()), None));
    assert!(maps.lost.is_empty() && maps.images.len() == 1, "{:?}", maps.lost);
    let [plain, cloth] = [3, 12].map(|x| maps.images[0].pixels[8 * 16 + x]);
    assert_eq!((plain[0], cloth[0], cloth[1], cloth[2]), (0, 255, 188, 0));
}

/// Protects small files: one value all over is a factor without an image, and what shows nothing is not
/// written.
#[test]
fn one_value_is_a_factor() {
    let coat = |e: &mut MaterialExtensions| {
        e.clearcoat = Some(Clearcoat { factor: 0.5, roughness: 0.25, ..Clearcoat::default() });
        e.sheen = Some(Sheen::default());
        e.ior = Some(1.8);
    };
    let maps = maps_of(&squares(vec![material(coat), material(coat)], Vec::new()));
    let [layer] = &maps.layers[..] else { panic!("one layer") };
    let expected = Clearcoat { factor: 0.5, roughness: 0.25, ..Clearcoat::default() };
    let expected =
        MaterialExtensions { clearcoat: Some(expected), ior: Some(1.8), ..MaterialExtensions::default() };
    assert_eq!((&layer.extensions, maps.images.len()), (&expected, 0));
    assert!(layer.coats_normals);
}

/// Whether the one layer of a model of single-sided materials is written double-sided.
fn is_double_sided(model: &Model, keeps: bool) -> bool {
    let [(_, double_sided)] = sides(&high_of(model), keeps)[..] else { panic!("one layer") };
    double_sided
}

/// Protects open sheets from backs that they do not have, and closed surfaces from holes: views see backs of
/// two squares, and none of the sides of a box. That may be written as it was, too.
#[test]
fn open_sheets_show_their_backs() {
    let coat = |e: &mut MaterialExtensions| e.ior = Some(1.8);
    let open = squares(vec![material(coat), material(coat)], Vec::new());
    assert!(!is_double_sided(&open, false));
    let mut unlit = open.clone();
    unlit.materials.iter_mut().for_each(|m| m.unlit = true);
    assert!(!is_double_sided(&unlit, false));
    let mut closed = open;
    let mesh = &mut closed.mesh;
    // The lower square looks down, and four walls join both.
    mesh.triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    for [a, b] in [[0, 1], [1, 2], [2, 3], [3, 0]] {
        mesh.triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    assert!(is_double_sided(&closed, false) && !is_double_sided(&closed, true));
    closed.materials.iter_mut().for_each(|m| m.double_sided = true);
    assert!(is_double_sided(&closed, true));
}

/// Protects what is seen through glass: the glass is a layer of its own, which has the volume, and the rest
/// transmits nothing. Textures of the high-poly come out where they were.
#[test]
fn glass_is_a_layer_of_its_own() {
    let mut image = Image::solid("t", 16, 16, [255; 4]);
    (0..8 * 16).for_each(|texel| image.pixels[texel] = [0, 255, 255, 255]);
    let glass = material(|e| {
        e.transmission = Some(Transmission { factor: 0.75, texture: Some(TextureSlot::default()) });
        e.volume = Some(Volume { thickness: 0.5, attenuation_distance: 2.0, ..Volume::default() });
    });
    let maps = maps_of(&squares(vec![material(|_| {}), glass], vec![image]));
    assert_eq!(maps.layers.len(), 2);
    let [wall, glass] =
        [0, 1].map(|k| maps.layers.iter().find(|l| l.kind.transmits == (k == 1)).expect("two layers"));
    assert!(wall.extensions.is_empty());
    let volume = glass.extensions.volume.expect("a volume");
    assert_eq!((volume.thickness, volume.attenuation_distance, volume.texture), (0.5, 2.0, None));
    let transmission = glass.extensions.transmission.expect("it transmits");
    assert!((transmission.factor - 0.75).abs() < 0.01 && transmission.texture.is_some());
    let [above, below] = [3, 12].map(|y| maps.images[0].pixels[y * 16 + 12][0]);
    assert!(above < 10 && below > 245, "{above} {below}");
}

/// Protects brushed metal: the direction is that of the high-poly in space, whatever the low-poly's tangents.
#[test]
fn stretched_highlights_keep_their_direction() {
    let brushed = material(|e| {
        e.anisotropy = Some(Anisotropy {
            strength: 0.5,
            rotation: std::f32::consts::FRAC_PI_2,
            ..Anisotropy::default()
        });
    });
    let maps = maps_of(&squares(vec![brushed.clone(), brushed], Vec::new()));
    let found = maps.layers[0].extensions.anisotropy.expect("it is anisotropic");
    assert_eq!((found.strength, found.rotation), (0.5, 0.0));
    // Along the bitangent, all of it.
    let [x, y, strength, _] = maps.images[0].pixels[8 * 16 + 3];
    assert!(x.abs_diff(128) <= 1 && y == 255 && strength == 255, "{x} {y} {strength}");
}

/// Protects reflections of a coat above a normal map: where the low-poly's mesh has other normals than the high-poly's, or
/// the coat has a map of its own, an image turns them back; else there is none.
#[test]
fn a_coat_keeps_its_own_normals() {
    let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
    let coated = |normal_texture| {
        let mut own = material(|e| {
            e.clearcoat = Some(Clearcoat { factor: 1.0, normal_texture, ..Clearcoat::default() });
        });
        own.normal_texture = slot(0);
        let images = vec![
            Image::solid("rough", 2, 2, [80, 128, 240, 255]),
            Image::solid("coat", 2, 2, [204, 128, 230, 255]),
        ];
        squares(vec![own.clone(), own], images)
    };
    let normals_of = |maps: &ExtensionMaps| {
        assert!(maps.lost.is_empty(), "{:?}", maps.lost);
        let [layer] = &maps.layers[..] else { panic!("one layer") };
        let slot = layer.extensions.clearcoat.expect("a coat").normal_texture?;
        Some(maps.images[slot.image].pixels[8 * 16 + 3])
    };
    let smooth = coated(None);
    assert_eq!(normals_of(&maps_of(&smooth)), None);
    let mut tilted = smooth.clone();
    tilted.mesh.normals.fill(Vec3::new(0.6, 0.0, 0.8));
    let [x, y, z, _] = normals_of(&maps_on(&smooth, &tilted)).expect("they differ");
    assert!(x.abs_diff(204) <= 1 && y.abs_diff(128) <= 1 && z.abs_diff(230) <= 1, "{x} {y} {z}");
    let [x, y, z, _] = normals_of(&maps_of(&coated(slot(1)))).expect("a map of its own");
    assert!(x.abs_diff(204) <= 2 && y.abs_diff(128) <= 2 && z.abs_diff(230) <= 2, "{x} {y} {z}");
}
