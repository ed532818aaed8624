//! Tests of `compress.rs`.

use super::*;
use parbake_model::Mesh;
use parbake_model::glam::{Vec2, Vec3, Vec4, vec2};

/// A box's six sides in a row of the texture from `top` on, a square each.
fn add_box(mesh: &mut Mesh, half: f32, top: f32) {
    for side in 0..6u32 {
        let (axis, sign) = (side as usize % 3, if side < 3 { 1.0f32 } else { -1.0 });
        let first = mesh.positions.len() as u32;
        for (x, y) in [(0.0f32, 0.0f32), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let mut p = [0.0; 3];
            p[axis] = sign * half;
            p[(axis + 1) % 3] = sign * (2.0 * x - 1.0) * half;
            p[(axis + 2) % 3] = (1.0 - 2.0 * y) * half;
            mesh.positions.push(Vec3::from(p));
            mesh.uvs.push(vec2((side as f32 + 0.1 + 0.8 * x) / 6.0, top + 0.02 + 0.13 * y));
        }
        mesh.triangles.extend([[first, first + 3, first + 1], [first + 1, first + 3, first + 2]]);
    }
    mesh.triangle_materials.resize(mesh.triangles.len(), 0);
}

/// A texture of noise on a mesh.
fn noisy(mesh: Mesh) -> Model {
    let size = 192usize;
    let noise = |i: usize| (i as u32).wrapping_mul(2_654_435_761).rotate_left(13).wrapping_mul(40_503) >> 24;
    let pixels = (0..size * size).map(|i| [noise(i) as u8, noise(i + 7) as u8, 128, 255]).collect();
    let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
    Model {
        name: "boxes".into(),
        mesh,
        materials: vec![Material { base_color_texture: Some(slot), ..Material::default() }],
        images: vec![Image { name: "noise".into(), width: size, height: size, pixels }],
        ..Model::default()
    }
}

/// Enough for boxes.
fn small() -> BakeOptions {
    BakeOptions { texture_size: 64, views: Some(24), view_size: Some(64), ..BakeOptions::default() }
}

/// Protects texels of what is seen: a box within another, which nobody sees, gives most of its
/// texels to the outer one, though its picture is as detailed.
#[test]
fn what_is_hidden_gets_few_texels() {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, 1.0, 0.1);
    add_box(&mut mesh, 0.9, 0.6);
    let model = noisy(mesh);
    let options = BakeOptions { preset: crate::options::Preset::Fast, ..small() };
    let baked = compress(&model, &options, &()).expect("boxes can be compressed");
    let mesh = &baked.model.mesh;
    let area = |of: fn(Vec3) -> bool| -> f32 {
        let doubled = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.uvs[i as usize]);
            (b - a).perp_dot(c - a).abs()
        };
        let is_of = |t: &&[u32; 3]| t.iter().all(|&i| of(mesh.positions[i as usize]));
        mesh.triangles.iter().filter(is_of).map(doubled).sum()
    };
    let inner = area(|p| p.abs().max_element() < 0.95);
    let outer = area(|p| p.abs().max_element() > 0.95);
    assert!(inner > 0.0 && inner < 0.5 * outer, "{inner} of {outer}");
    assert!(baked.report.uv.is_bijective());
}

/// Protects models that are coloured from a palette, all of a triangle at one point of it: there are no
/// coordinates to keep, so they get new ones, whether or not their material has more than colour.
#[test]
fn palettes_get_a_layout() {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, 1.0, 0.1);
    mesh.uvs.iter_mut().enumerate().for_each(|(i, uv)| *uv = Vec2::splat(0.1 + 0.1 * (i / 4) as f32));
    let mut model = noisy(mesh);
    let options = BakeOptions { uv_steps: Some(1), preset: crate::options::Preset::Fast, ..small() };
    for metallic in [0.0, 1.0] {
        model.materials[0].metallic = metallic;
        let baked = compress(&model, &options, &()).expect("a palette can be compressed");
        assert!(baked.report.uv.is_bijective(), "metallic {metallic}");
    }
}

/// Protects what textures that repeat show: charts in other tiles are read where they are at home, so
/// that delivered coordinates are compared by what they can show.
#[test]
fn charts_in_other_tiles_are_read_at_home() {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, 1.0, 0.1);
    let preset = crate::options::Preset::Fast;
    let options = BakeOptions { uv_steps: Some(2), preset, ..small() };
    let at_home = compress(&noisy(mesh.clone()), &options, &()).expect("a box can be compressed");
    mesh.uvs[..4].iter_mut().for_each(|uv| *uv += vec2(2.0, -1.0));
    let mut away = noisy(mesh);
    away.materials[0].base_color_texture.iter_mut().for_each(|slot| slot.wrap = [Wrap::Repeat; 2]);
    let away = compress(&away, &options, &()).expect("a box can be compressed");
    let delivered =
        |baked: &Baked| (baked.report.losses[0].moved.clone(), baked.report.losses[0].mean_square);
    assert_eq!(delivered(&at_home).0, "delivered");
    assert_eq!(delivered(&away).0, "delivered");
    assert!((delivered(&away).1 / delivered(&at_home).1 - 1.0).abs() < 0.05);
    assert!(away.report.warnings.iter().any(|w| w.contains("other tiles")));
}

/// Protects coordinates that are to be kept: where their texture repeats, what is written repeats too.
#[test]
fn kept_tiles_show_what_they_showed() {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, 1.0, 0.1);
    mesh.uvs[..4].iter_mut().for_each(|uv| *uv += vec2(2.0, -1.0));
    let uvs = mesh.uvs.clone();
    let preset = crate::options::Preset::Fast;
    let options = BakeOptions { uv: UvMode::Keep, preset, ..small() };
    let baked = compress(&noisy(mesh), &options, &()).expect("a box can be compressed");
    assert_eq!(baked.model.mesh.uvs, uvs);
    let slot = baked.model.materials[0].base_color_texture.expect("it has a texture");
    assert_eq!(slot.wrap, [Wrap::Repeat; 2]);
}

/// Protects frame rates: what is single-sided stays so, and what shows its back does.
#[test]
fn sides_are_kept() {
    for double_sided in [false, true] {
        let mut mesh = Mesh::default();
        add_box(&mut mesh, 1.0, 0.1);
        let mut model = noisy(mesh);
        model.materials[0].double_sided = double_sided;
        let options = BakeOptions { uv: UvMode::Repair, preset: crate::options::Preset::Fast, ..small() };
        let baked = compress(&model, &options, &()).expect("a box can be compressed");
        assert_eq!(baked.model.materials[0].double_sided, double_sided);
    }
}

/// Protects models that have colours and no coordinates yet: they are unwrapped, and what lies between
/// two vertices is the light halfway, not the stored value halfway.
#[test]
fn vertex_colours_become_a_texture() {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, 1.0, 0.1);
    mesh.uvs.clear();
    mesh.colors = mesh.positions.iter().map(|p| Vec4::splat(if p.x > 0.0 { 1.0 } else { 0.0 })).collect();
    let model = Model { materials: vec![Material::default()], mesh, ..Model::default() };
    let keep = BakeOptions { uv: UvMode::Keep, ..small() };
    assert!(matches!(
        compress(&model, &keep, &()),
        Err(BakeError::Prepare(PrepareError::NoTextureCoordinates { .. }))
    ));
    let options = BakeOptions { uv: UvMode::Unwrap, ..keep };
    let Baked { model, report, .. } = compress(&model, &options, &()).expect("a box can be unwrapped");
    assert_eq!(report.losses[0].moved, "repaired");
    // Halfway along edges from black to white; half of the light is stored as 188 of 255.
    let mesh = &model.mesh;
    let [red, ..] = mesh
        .triangles
        .iter()
        .find_map(|&[a, b, _]| {
            let [p, q] = [a, b].map(|v| mesh.positions[v as usize]);
            let uv = 0.5 * (mesh.uvs[a as usize] + mesh.uvs[b as usize]);
            let at = (uv * 64.0).as_uvec2();
            (p.x * q.x < 0.0).then(|| model.images[0].pixels[(at.y * 64 + at.x) as usize])
        })
        .expect("an edge from black to white");
    assert!((180..=196).contains(&red), "{red}");
}

/// Protects close-ups of large textures: samples are no wider than texels, nor than views see.
#[test]
fn samples_are_as_fine_as_texels() {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, 0.5, 0.1);
    assert_eq!(sample_width(&mesh, 512), Source::SAMPLE);
    assert!((sample_width(&mesh, 2048) - 6f64.sqrt() / 2048.0).abs() < 1e-9);
    assert_eq!(sample_width(&mesh, 4096), sample_width(&mesh, 2048));
}

/// Protects soundness where it is asked for, and texels where it is not: boxes that share their texels
/// have more of them each, which is kept, and said, unless each shall have its own.
#[test]
fn what_is_shared_is_kept_where_it_shows_more() {
    let mut mesh = Mesh::default();
    for i in 0..24 {
        let first = mesh.positions.len();
        add_box(&mut mesh, 1.0, 0.1);
        mesh.positions[first..].iter_mut().for_each(|p| p.x += 3.0 * i as f32);
    }
    let options = BakeOptions { texture_size: 128, uv_steps: Some(1), ..small() };
    let uvs = mesh.uvs.clone();
    let shared = compress(&noisy(mesh.clone()), &options, &()).expect("boxes can be compressed");
    assert_eq!(shared.model.mesh.uvs, uvs);
    let told = shared.report.warnings.join(" ");
    assert!(told.contains("kept as they are") && told.contains("lie on copies"), "{told}");
    let options = BakeOptions { gutter: Some(1.0), ..options };
    let own = compress(&noisy(mesh), &options, &()).expect("boxes can be compressed");
    let [before, after] = [0, 1].map(|i| own.report.losses[i].mean_square);
    assert!(after > before, "{after} of {before}");
    assert!(own.report.uv.is_bijective());
}

/// Protects drawings that are kept from materials without textures whose coordinates lie on them: those get texels of their own,
/// with colours alone and with whole materials, but not where coordinates are to stay.
#[test]
fn plain_materials_leave_a_kept_drawing() {
    let mut mesh = Mesh::default();
    for i in 0..13 {
        let first = mesh.positions.len();
        add_box(&mut mesh, 1.0, 0.1);
        mesh.positions[first..].iter_mut().for_each(|p| p.x += 3.0 * i as f32);
    }
    mesh.triangle_materials[12 * 12..].fill(1);
    let drawn = mesh.uvs.len() - 24;
    for roughness in [1.0, 0.6] {
        let mut model = noisy(mesh.clone());
        model.materials[0].roughness = roughness;
        let red = Material { base_color: [1.0, 0.0, 0.0, 1.0], roughness, ..Material::default() };
        model.materials.push(red);
        let preset = crate::options::Preset::Fast;
        let options = BakeOptions { texture_size: 128, uv_steps: Some(1), preset, ..small() };
        let baked = compress(&model, &options, &()).expect("boxes can be compressed");
        let told = baked.report.warnings.join(" ");
        assert!(told.contains("materials without textures") && told.contains("lie on copies"), "{told}");
        let uvs = &baked.model.mesh.uvs;
        assert_eq!(uvs[..drawn], mesh.uvs[..drawn]);
        let image = &baked.model.images[0];
        for uv in &uvs[drawn..] {
            let [x, y] = (*uv * 128.0).floor().to_array().map(|at| at as usize);
            let [r, g, b, _] = image.pixels[y * image.width + x];
            assert!(r > 250 && g < 5 && b < 5, "{roughness}: {r} {g} {b} at {uv}");
        }
        let options = BakeOptions { uv: UvMode::Keep, ..options };
        let baked = compress(&model, &options, &()).expect("boxes can be compressed");
        assert_eq!(baked.model.mesh.uvs, mesh.uvs);
    }
}

/// Protects textures that repeat: a chart longer than the texture is kept where cutting it up shows less.
#[test]
fn what_repeats_is_kept_where_it_shows_more() {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, 1.0, 0.1);
    mesh.uvs
        .iter_mut()
        .enumerate()
        .for_each(|(i, uv)| *uv = vec2(f32::from(u8::from(i % 4 % 3 != 0)), (i % 4 / 2) as f32) * 4.0);
    let mut model = noisy(mesh.clone());
    model.materials[0].base_color_texture.iter_mut().for_each(|slot| slot.wrap = [Wrap::Repeat; 2]);
    let preset = crate::options::Preset::Fast;
    let options = BakeOptions { uv_steps: Some(2), preset, ..small() };
    let baked = compress(&model, &options, &()).expect("a box can be compressed");
    assert_eq!(baked.model.mesh.uvs, mesh.uvs);
    assert!(
        baked.report.warnings.iter().any(|w| w.contains("repeat the texture")),
        "{:?}",
        baked.report.warnings
    );
}
