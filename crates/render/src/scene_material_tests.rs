//! Pictures of whole materials, on squares before one another.

use super::*;
use crate::camera::Projection;
use crate::interpretation::Interpretation;
use crate::lighting::{DirectionalLight, Lighting};
use crate::metallic_roughness::MetallicRoughness;
use parbake_image::maps::MapKind;
use parbake_model::glam::Vec4;
use parbake_model::{Clearcoat, Image, Material, Mesh, Sheen, Specular, TextureSlot, Transmission, Volume};

/// Squares of half a side across the z axis at these heights, each of a material of its own.
fn squares(heights: &[f32], materials: &[Material]) -> Scene {
    let mut mesh = Mesh::default();
    for (index, z) in heights.iter().enumerate() {
        let first = mesh.positions.len() as u32;
        for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
            mesh.positions.push(Vec3::new(x, y, *z));
            mesh.normals.push(Vec3::Z);
        }
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        mesh.triangle_materials.extend([index as u32; 2]);
    }
    Scene::new(mesh, materials, &[], Interpretation::default())
}

/// What shines in one colour, and shows nothing else.
fn glowing(color: [f32; 3], alpha: f32, alpha_mode: AlphaMode) -> Material {
    let black = [0.0, 0.0, 0.0, alpha];
    Material { base_color: black, emissive: color, alpha_mode, ..Material::default() }
}

fn seen_from(scene: &Scene, direction: Vec3) -> MaterialPicture {
    let camera = Camera::towards_origin(direction, 3.5, Projection::Orthographic(0.4));
    let dark = MetallicRoughness { lighting: Lighting::default() };
    scene.render_material(&dark, &camera, (16, 2), false, true)
}

/// Protects panes: layers are blended in the order of their depth from either side, whatever their order in the
/// file, each sample once, also along the edge that two triangles share.
#[test]
fn blended_layers_are_composited_in_order() {
    let (red, green, blue) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let materials = [
        glowing(green, 0.25, AlphaMode::Blend),
        glowing(blue, 1.0, AlphaMode::Opaque),
        glowing(red, 0.5, AlphaMode::Blend),
    ];
    let scene = squares(&[0.1, -0.3, 0.4], &materials);
    let front = seen_from(&scene, Vec3::Z);
    for pixel in &front.light.rgba {
        let want = Vec4::new(0.5, 0.5 * 0.25, 0.5 * 0.75, 1.0);
        assert!((Vec4::from(*pixel) - want).length() < 1e-5, "{pixel:?}");
    }
    // What the maps hold is weighted alike.
    assert!((front.values[0][MapKind::Emissive].y - 0.125).abs() < 1e-5);
    let back = seen_from(&scene, -Vec3::Z);
    assert!((Vec4::from(back.light.rgba[0]) - Vec4::new(0.0, 0.0, 1.0, 1.0)).length() < 1e-5);
    // With nothing behind them the background shows through.
    let panes = squares(&[0.1, 0.4], &[materials[0].clone(), materials[2].clone()]);
    let pixel = seen_from(&panes, Vec3::Z).light.rgba[100];
    assert!((Vec4::from(pixel) - Vec4::new(0.5, 0.125, 0.0, 0.625)).length() < 1e-5, "{pixel:?}");
}

/// Protects leaves: what is below the cutoff is not there, what is above is solid; a dozen sheets are no end.
#[test]
fn masks_cut() {
    let (red, green) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let mut materials = vec![glowing(green, 0.4, AlphaMode::Mask); 12];
    materials.push(glowing(red, 0.6, AlphaMode::Mask));
    let heights: Vec<f32> = (0..13).map(|i| 0.5 - 0.05 * i as f32).collect();
    let picture = seen_from(&squares(&heights, &materials), Vec3::Z);
    assert!(picture.light.rgba.iter().all(|p| *p == [1.0, 0.0, 0.0, 1.0]), "{:?}", picture.light.rgba[0]);
}

/// Protects shells: a single-sided surface is not seen from behind, as in viewers; a double-sided one is, and its
/// normal looks to the viewer.
#[test]
fn single_sided_surfaces_have_no_back() {
    let white = [1.0; 3];
    let single = Material { double_sided: false, ..glowing(white, 1.0, AlphaMode::Opaque) };
    let double = glowing(white, 1.0, AlphaMode::Opaque);
    let covered = |material: &Material, side: Vec3| {
        let picture = seen_from(&squares(&[0.0], std::slice::from_ref(material)), side);
        (picture.light.rgba[0][3], picture.values[0][MapKind::Normal].z)
    };
    assert_eq!(covered(&single, Vec3::Z), (1.0, 1.0));
    assert_eq!(covered(&single, -Vec3::Z), (0.0, 0.0));
    assert_eq!(covered(&double, -Vec3::Z), (1.0, -1.0));
}

/// Protects unlit materials: their base colour is shown as it is.
#[test]
fn unlit_surfaces_show_their_colour() {
    let material = Material { base_color: [0.2, 0.4, 0.6, 1.0], unlit: true, ..Material::default() };
    let picture = seen_from(&squares(&[0.0], &[material]), Vec3::Z);
    assert!((Vec4::from(picture.light.rgba[5]) - Vec4::new(0.2, 0.4, 0.6, 1.0)).length() < 1e-6);
}

/// Protects pictures of large models: a scene that looks for its triangles in a tree of boxes shows the same as if it
/// drew them all, with backs that are not seen, what is cut out, and what is blended.
#[test]
fn large_scenes_look_the_same() {
    let single = |color| Material { double_sided: false, ..glowing(color, 1.0, AlphaMode::Opaque) };
    let materials = [
        single([1.0, 0.0, 0.0]),
        glowing([0.0, 1.0, 0.0], 1.0, AlphaMode::Opaque),
        glowing([0.0, 0.0, 1.0], 0.6, AlphaMode::Mask),
        glowing([1.0, 1.0, 0.0], 0.3, AlphaMode::Blend),
    ];
    let scene = || {
        let mut mesh = Mesh::default();
        let side = 240u32;
        for (row, column) in (0..=side).flat_map(|row| (0..=side).map(move |column| (row, column))) {
            let [x, y] = [row, column].map(|i| 2.0 * i as f32 / side as f32 - 1.0);
            mesh.positions.push(Vec3::new(x, y, 0.4 * (9.0 * x).sin() * (8.0 * y).cos()));
            mesh.normals.push(Vec3::Z);
        }
        for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
            let first = row * (side + 1) + column;
            mesh.triangles
                .extend([[first, first + side + 1, first + side + 2], [first, first + side + 2, first + 1]]);
            mesh.triangle_materials.extend([(row / 40 + column / 60) % 4; 2]);
        }
        Scene::new(mesh, &materials, &[], Interpretation::default())
    };
    let (large, mut all) = (scene(), scene());
    assert!(large.clusters.is_some() && all.clusters.take().is_some());
    for direction in [Vec3::Z, Vec3::new(1.0, 0.4, 0.5), Vec3::new(-0.7, 0.9, -0.6)] {
        let [large, all] = [&large, &all].map(|scene| seen_from(scene, direction));
        assert!(all.light.rgba.iter().any(|p| p[2] > 0.1) && all.light.rgba.iter().any(|p| p[0] > 0.1));
        assert_eq!(large, all, "{direction}");
    }
}

/// Protects figures that agree with viewers: a glossy surface whose normals turn is rougher to them, so its highlight is
/// darker; a flat one is as it is.
#[test]
fn viewers_see_turning_normals_as_rougher() {
    let glossy = Material { roughness: 0.3, metallic: 1.0, ..Material::default() };
    let mut scene = squares(&[0.0], &[glossy]);
    let camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Orthographic(0.4));
    let lamp = DirectionalLight { direction: Vec3::new(3.0, 2.0, 1.0).normalize(), color: Vec3::ONE };
    let lit = MetallicRoughness { lighting: Lighting { directional: vec![lamp], ..Lighting::default() } };
    let brightest = |scene: &Scene, widens_highlights: bool| {
        let picture = scene.render_material(&lit, &camera, (16, 2), widens_highlights, false);
        picture.light.rgba.iter().map(|pixel| pixel[1]).fold(0.0, f32::max)
    };
    assert_eq!(brightest(&scene, true), brightest(&scene, false));
    // The lamp is mirrored somewhere on it.
    for (normal, x) in scene.mesh.normals.iter_mut().zip([-0.5f32, 0.5, 0.5, -0.5]) {
        *normal = Vec3::new(0.63 + 2.4 * x, 0.42, 1.0).normalize();
    }
    assert!(brightest(&scene, true) < 0.8 * brightest(&scene, false));
}

/// The same squares with images, read as viewers do that show extensions.
fn with_extensions(heights: &[f32], materials: &[Material], images: &[Image]) -> Scene {
    let plain = squares(heights, materials);
    let mut mesh = plain.mesh.clone();
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x + 0.5, 0.5 - p.y)).collect();
    Scene::new(mesh, materials, images, Interpretation { extensions: true, ..Interpretation::default() })
}

fn slot(image: usize) -> Option<TextureSlot> {
    Some(TextureSlot { image, ..TextureSlot::default() })
}

/// Protects glass in comparisons: what is behind a pane shows, tinted, less where a texture says so; coverage is what
/// does not pass. Without extensions the pane is what stands in for it.
#[test]
fn what_is_behind_glass_shows() {
    let transmission = Transmission { factor: 1.0, texture: slot(0) };
    let mut glass = Material { base_color: [1.0, 0.5, 1.0, 1.0], roughness: 1.0, ..Material::default() };
    glass.metallic = 0.0;
    glass.extensions.transmission = Some(transmission);
    // Light passes the left half.
    let mut image = Image::solid("passes", 16, 1, [255; 4]);
    image.pixels[8..].fill([0, 0, 0, 255]);
    let materials = [glass.clone(), glowing([1.0; 3], 1.0, AlphaMode::Opaque)];
    let seen = seen_from(&with_extensions(&[0.4, -0.3], &materials, &[image.clone()]), Vec3::Z).light;
    let (left, right) = (seen.rgba[8 * 16 + 3], seen.rgba[8 * 16 + 12]);
    assert!(left[0] > 0.9 && (left[1] / left[0] - 0.5).abs() < 0.01 && left[3] > 0.999, "{left:?}");
    assert_eq!(right, [0.0, 0.0, 0.0, 1.0]);
    let alone = seen_from(&with_extensions(&[0.4], &[glass], &[image]), Vec3::Z).light;
    assert!((alone.rgba[8 * 16 + 3][3] - (1.0 - left[0] * 2.5 / 3.0)).abs() < 0.01);
    assert_eq!(alone.rgba[8 * 16 + 12][3], 1.0);
}

/// Protects glass in comparisons: a thick pane bends what is behind it, in lengths of the model, and hides other panes; the back of
/// a double-sided pane shows through its front.
#[test]
fn thick_glass_bends_what_is_behind() {
    let mut glass = Material { roughness: 0.0, metallic: 0.0, double_sided: false, ..Material::default() };
    glass.extensions.transmission = Some(Transmission { factor: 1.0, ..Transmission::default() });
    glass.extensions.volume = Some(Volume { thickness: 0.25, ..Volume::default() });
    let camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Orthographic(0.4));
    let dark = MetallicRoughness { lighting: Lighting::default() };
    let seen = |scene: &Scene| scene.render_material(&dark, &camera, (32, 1), false, false).light;
    // A pane whose normals lean to the right, before a square that covers the right half of the picture.
    let scene = |glass: &Material, unit: f32, lean: f32| {
        let square = glowing([1.0; 3], 1.0, AlphaMode::Opaque);
        let mut scene = with_extensions(&[0.3, -0.3], &[glass.clone(), square], &[]).with_unit(unit);
        scene.mesh.positions[4..].iter_mut().for_each(|p| p.x += 0.5);
        scene.mesh.normals[..4].fill(Vec3::new(lean, 0.0, 1.0).normalize());
        scene
    };
    let edge = |scene: &Scene| {
        let picture = seen(scene);
        picture.rgba[16 * 32..17 * 32].iter().filter(|pixel| pixel[3] > 0.5).count()
    };
    let straight = edge(&scene(&glass, 1.0, 0.0));
    assert!((15..=17).contains(&straight), "{straight}");
    // Snell: a ray that meets the pane at an angle whose sine is 0.6 goes on at asin(0.6 / 1.5) to the normal, 13.3° to the left of
    // where it came from: 0.0575 in 0.25, which are 2.3 pixels. So what is seen lies to the left, and the edge moves to the right.
    let (bent, twice) = (edge(&scene(&glass, 1.0, 0.75)), edge(&scene(&glass, 2.0, 0.75)));
    assert!((2..=3).contains(&(straight - bent)) && (4..=5).contains(&(straight - twice)), "{bent} {twice}");
    let mut pair = vec![glass.clone(); 2];
    pair[1].base_color = [1.0, 0.0, 0.0, 1.0];
    let square = glowing([1.0; 3], 1.0, AlphaMode::Opaque);
    let panes = |materials: &[Material]| {
        let all = [materials, std::slice::from_ref(&square)].concat();
        let mut scene = with_extensions(&[0.3, 0.0, -0.3], &all, &[]);
        scene.mesh.triangles[2..4].iter_mut().for_each(|corners| corners.swap(1, 2));
        scene.face_normals[2..4].iter_mut().for_each(|normal| *normal = -*normal);
        scene.mesh.normals[4..8].fill(-Vec3::Z);
        seen(&scene).rgba[16 * 32 + 16]
    };
    // The red pane shows its back, which a single-sided one has not, before a white square.
    let (without, with) = (panes(&pair), {
        pair[1].double_sided = true;
        panes(&pair)
    });
    assert!(without[1] > 0.9 && with[0] > 0.8 && with[1] < 0.01, "{without:?} {with:?}");
    // With the maps' values all is drawn at once, else on top of what is solid.
    let slanted = Camera::towards_origin(Vec3::new(0.3, 0.2, 1.0), 3.5, Projection::Orthographic(0.8));
    let mut all = [&pair[..], &[square.clone(), glowing([0.0, 1.0, 0.0], 0.4, AlphaMode::Blend)]].concat();
    all[0].extensions.transmission = Some(Transmission { factor: 0.7, ..Transmission::default() });
    let mixed = with_extensions(&[0.3, 0.0, -0.3, 0.45], &all, &[]);
    let [once, over] =
        [true, false].map(|values| mixed.render_material(&dark, &slanted, (32, 2), false, values));
    for (once, over) in once.light.rgba.iter().zip(&over.light.rgba) {
        assert!((Vec4::from(*once) - Vec4::from(*over)).length() < 1e-5, "{once:?} {over:?}");
    }
    pair[1].double_sided = false;
    let front = with_extensions(&[0.3, 0.0, -0.3], &[pair[0].clone(), pair[1].clone(), square.clone()], &[]);
    let hidden = seen(&front).rgba[16 * 32 + 16];
    assert!(hidden[1] > 0.9, "{hidden:?}");
}

/// Protects glass among other surfaces: a blended pane in front of it shows, one behind it does not, as in viewers; a mask of glass
/// is cut out; unlit glass is solid; a camera that stands in a thick pane gets numbers.
#[test]
fn glass_hides_what_is_blended_behind_it() {
    let mut glass = Material { roughness: 0.0, metallic: 0.0, ..Material::default() };
    glass.extensions.transmission = Some(Transmission { factor: 1.0, ..Transmission::default() });
    let pane = glowing([0.0, 1.0, 0.0], 0.5, AlphaMode::Blend);
    let square = glowing([1.0, 0.0, 0.0], 1.0, AlphaMode::Opaque);
    let middle = |heights: &[f32], materials: &[Material]| {
        seen_from(&with_extensions(heights, materials, &[]), Vec3::Z).light.rgba[8 * 16 + 8]
    };
    let [in_front, behind] =
        [0.4, 0.0].map(|height| middle(&[height, 0.2, -0.3], &[pane.clone(), glass.clone(), square.clone()]));
    assert!((in_front[1] - 0.5).abs() < 1e-5 && (0.4..0.5).contains(&in_front[0]), "{in_front:?}");
    assert!(behind[1] < 1e-5 && behind[0] > 0.9, "{behind:?}");
    let cut = Material { alpha_mode: AlphaMode::Mask, base_color: [0.0, 0.0, 1.0, 0.1], ..glass.clone() };
    assert_eq!(middle(&[0.2, -0.3], &[cut, square.clone()]), [1.0, 0.0, 0.0, 1.0]);
    let unlit = Material { unlit: true, base_color: [0.0, 0.0, 1.0, 1.0], ..glass.clone() };
    assert_eq!(middle(&[0.2, -0.3], &[unlit, square.clone()]), [0.0, 0.0, 1.0, 1.0]);
    let mut thick = glass;
    thick.extensions.ior = Some(0.0);
    thick.extensions.volume = Some(Volume { thickness: 50.0, ..Volume::default() });
    let mut scene = with_extensions(&[0.2, -0.3], &[thick, square], &[]);
    scene.mesh.normals[..4].fill(-Vec3::Z);
    let camera = Camera::towards_origin(Vec3::new(0.2, 0.1, 1.0), 3.5, Projection::Perspective(0.2));
    let dark = MetallicRoughness { lighting: Lighting::default() };
    for size in [1, 5] {
        let picture = scene.render_material(&dark, &camera, (size, 2), true, false).light;
        assert!(picture.rgba.iter().flatten().all(|value| value.is_finite()), "{picture:?}");
    }
}

/// Protects varnish and cloth in comparisons: factors and textures of both arrive at the shading.
#[test]
fn coats_and_sheens_are_read_from_their_textures() {
    let ambient = Lighting { ambient: Vec3::ONE, ..Lighting::default() };
    let camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Orthographic(0.4));
    let picture = |change: fn(&mut Material)| {
        let mut black = Material { base_color: [0.0, 0.0, 0.0, 1.0], metallic: 1.0, ..Material::default() };
        change(&mut black);
        // The right half is 0 in all channels.
        let mut image = Image::solid("half", 16, 1, [255; 4]);
        image.pixels[8..].fill([0; 4]);
        let scene = with_extensions(&[0.0], &[black], &[image]);
        let brdf = MetallicRoughness { lighting: ambient.clone() };
        let seen = scene.render_material(&brdf, &camera, (16, 1), false, false).light.rgba;
        [seen[8 * 16 + 3], seen[8 * 16 + 12]].map(|pixel| pixel[0])
    };
    let [plain, _] = picture(|_| {});
    let [coat, without] = picture(|m| {
        let coat = Clearcoat { factor: 1.0, texture: slot(0), ..Clearcoat::default() };
        m.extensions.clearcoat = Some(coat);
    });
    assert!(coat > plain + 0.03 && without == plain, "{plain} {coat} {without}");
    let [sheen, without] = picture(|m| {
        let sheen = Sheen { color: [1.0; 3], color_texture: slot(0), roughness: 1.0, ..Sheen::default() };
        m.extensions.sheen = Some(sheen);
    });
    assert!(sheen > plain + 0.1 && without == plain, "{plain} {sheen} {without}");
    // Dielectrics reflect as much as they are told to.
    let [full, none] = picture(|m| {
        m.metallic = 0.0;
        m.extensions.specular = Some(Specular { texture: slot(0), ..Specular::default() });
    });
    assert!(full > 0.01 && none == 0.0, "{full} {none}");
}
