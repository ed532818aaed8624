//! Tests of common maps: squares of several materials side by side.
#![allow(clippy::unwrap_used)]

use super::*;
use parbake_image::pyramid::Pyramid;
use parbake_model::glam::{Vec3, vec2};
use parbake_model::{Clearcoat, Mesh, Transmission, UvTransform};

/// Squares side by side, each of its own material: a texture that repeats, another one moved by its transform with a
/// normal map of half of its size, and a shiny red without textures.
fn squares() -> Model {
    let mut mesh = Mesh::default();
    for square in 0..3u32 {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            mesh.positions.push(Vec3::new(1.1 * square as f32 + x, y, 0.0));
            mesh.normals.push(Vec3::Z);
            mesh.uvs.push(if square == 0 { vec2(2.0 * x + 0.3, y) } else { vec2(x, y) });
        }
        let v = 4 * square;
        mesh.triangles.extend([[v, v + 1, v + 2], [v, v + 2, v + 3]]);
        mesh.triangle_materials.extend([square; 2]);
    }
    let image = |side: usize, texel: fn(usize, usize) -> [u8; 4]| Image {
        name: "image".into(),
        width: side,
        height: side,
        pixels: (0..side * side).map(|i| texel(i % side, i / side)).collect(),
    };
    let images = vec![
        image(64, |x, y| [(4 * x) as u8, (4 * y) as u8, 90, 255]),
        image(64, |x, y| [200, (3 * x) as u8, (2 * y) as u8, 255]),
        image(32, |x, _| [(100 + x) as u8, 128, 250, 255]),
    ];
    let slot = |image| TextureSlot { image, ..TextureSlot::default() };
    let transform = UvTransform { offset: vec2(0.1, 0.2), scale: vec2(0.5, 0.5), ..UvTransform::default() };
    let moved = |image| TextureSlot { transform, ..slot(image) };
    let materials = vec![
        Material {
            name: "a".into(),
            base_color: [0.5, 1.0, 1.0, 1.0],
            base_color_texture: Some(slot(0)),
            ..Material::default()
        },
        Material {
            name: "b".into(),
            base_color_texture: Some(moved(1)),
            normal_texture: Some(moved(2)),
            roughness: 0.4,
            ..Material::default()
        },
        Material {
            name: "c".into(),
            base_color: [0.8, 0.1, 0.1, 1.0],
            roughness: 0.2,
            metallic: 1.0,
            ..Material::default()
        },
    ];
    Model { name: "squares".into(), mesh, materials, images, ..Model::default() }
}

/// What a kind of map says at a point of a triangle.
fn read(model: &Model, kind: MapKind, triangle: usize, weights: [f32; 3]) -> Vec4 {
    let material = &model.materials[model.mesh.triangle_materials[triangle] as usize];
    let corners = model.mesh.corner_uvs(triangle);
    let uv = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    let texel = texture_slot(material, kind).map(|slot| {
        let FloatImage { width, height, texels } = from_image(kind, &model.images[slot.image], true);
        let texels = texels.into_iter().map(|t| t.to_array()).collect();
        let pyramid = Pyramid { wrap: slot.wrap, ..Pyramid::single(FloatImage { width, height, texels }) };
        Vec4::from(pyramid.fetch(slot.transform.apply(uv), 0.0))
    });
    let one = if kind == MapKind::Normal { Vec4::Z } else { Vec4::ONE };
    factors(material)[kind] * texel.unwrap_or(one)
}

/// Protects looks: every point has the colour, the normal, the roughness and the metal that it had, whatever was moved.
#[test]
fn every_point_looks_as_before() {
    let model = squares();
    let out = with_common_maps(&model, 100.0, 1024, usize::MAX).unwrap();
    assert_eq!(out.materials.len(), 1);
    assert_eq!(out.materials[0].name, "squares");
    for triangle in 0..6 {
        for weights in [[0.2, 0.3, 0.5], [0.1, 0.8, 0.1], [0.6, 0.2, 0.2]] {
            for kind in [MapKind::BaseColor, MapKind::Normal, MapKind::MetallicRoughness] {
                let [before, now] = [&model, &out].map(|model| {
                    let value = read(model, kind, triangle, weights).truncate();
                    if kind == MapKind::Normal { value.normalize() } else { value }
                });
                assert!((before - now).abs().max_element() < 0.02, "{kind:?} of {triangle}: {before} {now}");
            }
        }
    }
}

/// Protects small files: textures of more texels than anybody sees are halved, and no size is exceeded.
#[test]
fn unseen_texels_are_left_out() {
    let model = squares();
    let texels = |model: &Model| model.images.iter().map(|i| i.width * i.height).max().unwrap();
    let fine = with_common_maps(&model, 100.0, 1024, usize::MAX).unwrap();
    assert!(texels(&with_common_maps(&model, 4.0, 1024, usize::MAX).unwrap()) <= texels(&fine) / 4);
    assert!(texels(&with_common_maps(&model, 100.0, 64, usize::MAX).unwrap()) <= 64 * 64);
    assert!(texels(&with_common_maps(&model, 100.0, 1024, 32 * 32).unwrap()) <= 32 * 32);
}

/// Protects coats that textures paint: they lie where the other maps do, and where a material has none, nothing is coated. A
/// coat's own normals stay with it.
#[test]
fn textures_of_extensions_go_along() {
    let mut model = squares();
    let texture = model.materials[1].base_color_texture;
    let normal_texture = model.materials[1].normal_texture;
    let coat = Clearcoat { factor: 0.6, texture, normal_texture, normal_scale: 0.5, ..Clearcoat::default() };
    model.materials[1].extensions.clearcoat = Some(coat);
    model.materials[2].extensions.clearcoat = Some(Clearcoat { factor: 0.6, ..Clearcoat::default() });
    let out = with_common_maps(&model, 100.0, 1024, usize::MAX).unwrap();
    assert_eq!(out.materials.len(), 1);
    let own = out.materials[0].extensions.clearcoat.unwrap();
    let at = |triangle: usize, image: usize| {
        let image = &out.images[image];
        let uv: Vec2 = out.mesh.corner_uvs(triangle).into_iter().sum::<Vec2>() / 3.0;
        image.pixels
            [(uv.y * image.height as f32) as usize * image.width + (uv.x * image.width as f32) as usize]
    };
    // Its red is the colour's, as a number.
    let strength =
        |triangle: usize| own.factor * f32::from(at(triangle, own.texture.unwrap().image)[0]) / 255.0;
    assert!((strength(2) - 0.6 * 200.0 / 255.0).abs() < 0.01, "{}", strength(2));
    assert!(strength(0) == 0.0 && (strength(4) - 0.6).abs() < 0.01, "{} {}", strength(0), strength(4));
    let normals = own.normal_texture.unwrap().image;
    let below = out.materials[0].normal_texture.unwrap().image;
    let slope = |image: usize| 128.0 - f32::from(at(2, image)[0]);
    assert!(slope(below) > 10.0 && (slope(normals) - 0.5 * slope(below)).abs() < 1.5, "{}", slope(normals));
    assert_eq!(at(4, normals), [128, 128, 255, 255]);
}

/// Protects outlines: materials with cutoffs of their own become one, and what was cut out is.
#[test]
fn outlines_stay_where_they_were() {
    let mut model = squares();
    let ramp = |i: usize| [90, 90, 90, (i % 64 * 4) as u8];
    model.images[0].pixels = (0..4096).map(ramp).collect();
    for (index, cutoff) in [(0, 0.7), (1, 0.3), (2, 0.5)] {
        let base_color_texture = model.materials[0].base_color_texture;
        let own = Material {
            alpha_mode: AlphaMode::Mask,
            alpha_cutoff: cutoff,
            base_color_texture,
            ..Material::default()
        };
        model.materials[index] = own;
    }
    let out = with_common_maps(&model, 100.0, 1024, usize::MAX).unwrap();
    assert_eq!((out.materials.len(), out.materials[0].alpha_cutoff), (1, 0.3));
    for triangle in 0..6 {
        for weights in [[0.2, 0.3, 0.5], [0.1, 0.8, 0.1], [0.6, 0.2, 0.2], [0.3, 0.4, 0.3]] {
            let above = |model: &Model| {
                let material = &model.materials[model.mesh.triangle_materials[triangle] as usize];
                read(model, MapKind::BaseColor, triangle, weights).w / material.alpha_cutoff
            };
            let [before, now] = [above(&model), above(&out)];
            assert!((before - now).abs() < 0.03, "{triangle}: {before} {now}");
        }
    }
}

/// Protects cloth whose weave repeats while its shade does not: each map is read by its own transform.
#[test]
fn maps_may_repeat_at_their_own_scale() {
    let mut model = squares();
    let base = model.materials[1].base_color_texture.unwrap();
    let transform = UvTransform { offset: vec2(0.05, 0.1), scale: vec2(1.5, 2.0), ..UvTransform::default() };
    model.materials[1].normal_texture = None;
    model.materials[1].metallic_roughness_texture = Some(TextureSlot { image: 0, transform, ..base });
    let out = with_common_maps(&model, 1000.0, 1024, usize::MAX).unwrap();
    for weights in [[0.2, 0.3, 0.5], [0.1, 0.8, 0.1], [0.3, 0.35, 0.35]] {
        for kind in [MapKind::BaseColor, MapKind::MetallicRoughness] {
            let [before, now] = [&model, &out].map(|model| read(model, kind, 2, weights).truncate());
            assert!((before - now).abs().max_element() < 0.04, "{kind:?}: {before} {now}");
        }
    }
}

/// Protects layers, coats and glass: what maps do not say keeps materials apart, and where too many would stay, or a
/// texture cannot be moved, there are no common maps.
#[test]
fn what_maps_do_not_say_stays() {
    let mut model = squares();
    model.materials[1].alpha_mode = AlphaMode::Blend;
    let out = with_common_maps(&model, 100.0, 1024, usize::MAX).unwrap();
    assert_eq!(
        out.materials.iter().map(|m| m.alpha_mode).collect::<Vec<_>>(),
        [AlphaMode::Opaque, AlphaMode::Blend]
    );
    assert_eq!(out.mesh.triangle_materials, [0, 0, 1, 1, 0, 0]);
    let mut glass = squares();
    glass.materials[2].metallic = 0.0;
    let transmission = Some(Transmission { factor: 0.7, texture: None });
    glass.materials[2].extensions = MaterialExtensions { transmission, ..MaterialExtensions::default() };
    let out = with_common_maps(&glass, 100.0, 1024, usize::MAX).unwrap();
    assert_eq!(out.materials[1].extensions, glass.materials[2].extensions);
    let refused = |change: fn(&mut Model)| {
        let mut model = squares();
        change(&mut model);
        with_common_maps(&model, 100.0, 1024, usize::MAX).is_none()
    };
    assert!(refused(|model| model.materials[0].unlit = true));
    assert!(refused(|model| {
        model.mesh.uvs1 = model.mesh.uvs.clone();
        let slot = model.materials[1].normal_texture.unwrap();
        model.materials[1].normal_texture = Some(TextureSlot { uv_set: 1, ..slot });
    }));
    assert!(refused(|model| model.mesh.triangles[2][0] = 0));
    assert!(!refused(|_| {}));
}

/// Protects relief of models without tangents: viewers make frames of coordinates, which are scaled alike along u and v then. Two
/// textures side by side would fit into an oblong one.
#[test]
fn relief_keeps_its_aspect() {
    let mut model = squares();
    model.materials.iter_mut().for_each(|material| material.base_color_texture = None);
    model.materials[0].normal_texture = Some(TextureSlot { image: 1, ..TextureSlot::default() });
    model.materials[1].normal_texture = Some(TextureSlot { image: 0, ..TextureSlot::default() });
    model.mesh.uvs[..4].copy_from_slice(&[vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 1.0)]);
    let size = |model: &Model| {
        let image = with_common_maps(model, 1e3, 1024, usize::MAX).unwrap().images.remove(0);
        [image.width, image.height]
    };
    let [width, height] = size(&model);
    assert_eq!(width, height);
    model.mesh.tangents = vec![Vec4::X + Vec4::W; 12];
    let [width, height] = size(&model);
    assert_eq!(width, 2 * height);
}
