//! Scenes with parallax maps, held against scenes whose coordinates are moved by hand.

use super::*;
use crate::camera::Projection;
use crate::shade::Lambert;
use crate::spherical_harmonics::{MOST_FUNCTIONS, evaluate};
use parbake_model::{Basis, ParallaxMap, TextureSlot, UvTransform, Wrap};

/// A square in the plane z = 0, as large as its texture.
fn square() -> Mesh {
    let uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    Mesh {
        positions: uvs.iter().map(|uv| Vec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0)).collect(),
        normals: vec![Vec3::Z; 4],
        tangents: vec![Vec4::X + Vec4::W; 4],
        uvs,
        triangles: vec![[0, 3, 1], [1, 3, 2]],
        triangle_materials: vec![0; 2],
        ..Mesh::default()
    }
}

fn noise(name: &str, seed: usize) -> Image {
    let texel = |i: usize| [0, 1, 2, 3].map(|k| ((i * 73 + k * 19 + seed) % 251) as u8);
    Image { name: name.into(), width: 16, height: 16, pixels: (0..256).map(texel).collect() }
}

fn slot(image: usize) -> Option<TextureSlot> {
    Some(TextureSlot { image, wrap: [Wrap::Repeat; 2], ..TextureSlot::default() })
}

fn material() -> Material {
    Material { base_color_texture: slot(0), normal_texture: slot(1), ..Material::default() }
}

/// One coefficient map of one texel: order 1, images 2 to 4.
fn map() -> (ParallaxMap, Vec<Image>) {
    let solid = |rgb: [u8; 3]| Image::solid("", 1, 1, [rgb[0], rgb[1], rgb[2], 255]);
    let mut images = vec![noise("colour", 0), noise("normal", 40)];
    images.extend([solid([255, 0, 51]), solid([102, 204, 255]), solid([0, 51, 0])]);
    let (scale, offset) = (vec![0.4; 8], vec![-0.1; 8]);
    (
        ParallaxMap {
            basis: Basis::Harmonics(1),
            images: vec![2, 3, 4],
            scale,
            offset,
            ..Default::default()
        },
        images,
    )
}

/// What the map shifts by, from its numbers.
fn shift(direction: Vec3) -> Vec2 {
    let coefficients = [[0.3, -0.1], [-0.02, 0.06], [0.22, 0.3], [-0.1, -0.02]];
    let mut values = [0.0; MOST_FUNCTIONS];
    evaluate(1, direction, &mut values);
    let sum: Vec2 = coefficients.iter().zip(values).map(|(c, y)| Vec2::from_array(*c) * y).sum();
    sum / direction.z.abs().max(0.25)
}

fn moved(mut mesh: Mesh, by: Vec2) -> Mesh {
    mesh.uvs.iter_mut().for_each(|uv| *uv += by);
    mesh
}

fn render(mesh: &Mesh, material: &Material, images: &[Image], direction: Vec3, parallax: bool) -> Picture {
    let interpretation = Interpretation { parallax, ..Interpretation::default() };
    let scene = Scene::new(mesh.clone(), std::slice::from_ref(material), images, interpretation);
    let camera = Camera::towards_origin(direction, 3.5, Projection::Orthographic(1.2));
    scene.render(&Lambert, &camera, 96, 1)
}

fn difference(a: &Picture, b: &Picture) -> f32 {
    let pairs = a.rgba.as_flattened().iter().zip(b.rgba.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

const DIRECTIONS: [Vec3; 4] =
    [Vec3::Z, Vec3::new(0.48, -0.6, 0.64), Vec3::new(0.6, 0.3, -0.74), Vec3::new(0.9, 0.3, 0.2)];

/// Protects the meaning of a map in a file: colours and normals come from where the formula
/// says, from both sides and at grazing angles, and from nowhere else where it is left out.
#[test]
fn a_map_shifts_coordinates() {
    let (map, images) = map();
    let plain = material();
    let shifting = Material { parallax: Some(map), ..material() };
    for direction in DIRECTIONS.map(Vec3::normalize) {
        let by_hand = render(&moved(square(), shift(direction)), &plain, &images, direction, true);
        let with = render(&square(), &shifting, &images, direction, true);
        assert!(with.rgba.iter().any(|p| p[3] > 0.0));
        assert!(difference(&with, &by_hand) < 1e-3, "{direction}");
        let without = render(&square(), &shifting, &images, direction, false);
        assert_eq!(without, render(&square(), &plain, &images, direction, true));
        let shown = difference(&with, &without);
        assert!(shown > 0.05, "{direction} {shown}");
    }
}

/// One map in the tangent frame of one texel, whose layers say what x shifts along u and y along v.
fn tangent_map(fade: f32) -> (ParallaxMap, Vec<Image>) {
    let image = Image { name: "".into(), width: 1, height: 2, pixels: vec![[255, 0, 0, 255], [0; 4]] };
    let (scale, offset) = (vec![0.3; 8], vec![0.0; 8]);
    let map = ParallaxMap {
        basis: Basis::TangentShift,
        images: vec![2],
        scale,
        offset,
        fade,
        ..Default::default()
    };
    (map, vec![noise("colour", 0), noise("normal", 40), image])
}

/// Protects maps in the tangent frame: both sides of a square show what the line of sight asks for, and a map fades by
/// the footprint that a pixel has face on, whatever the angle.
#[test]
fn a_map_in_the_tangent_frame_shifts_and_fades() {
    // A pixel of 96 on a picture 2.4 wide spans a 80th of the texture, face on.
    let footprint = 1.0 / 80.0;
    for direction in DIRECTIONS.map(Vec3::normalize) {
        let line = if direction.z < 0.0 { -direction } else { direction };
        // The second pair's number is along v, which grows downwards.
        let full = 0.3 * Vec2::new(line.x, line.y) / line.z.max(0.25);
        let half = if direction == Vec3::Z { footprint / 1.5 } else { f32::NAN };
        let fades = [(f32::INFINITY, 1.0), (1.01 * footprint, 1.0), (half, 0.5), (0.05 * footprint, 0.0)];
        for (fade, left) in fades.into_iter().filter(|(fade, _)| !fade.is_nan()) {
            let (map, images) = tangent_map(fade);
            let shifting = Material { parallax: Some(map), ..material() };
            let by_hand = render(&moved(square(), full * left), &material(), &images, direction, true);
            let with = render(&square(), &shifting, &images, direction, true);
            assert!(
                difference(&with, &by_hand) < 0.02,
                "{direction} {fade}: {}",
                difference(&with, &by_hand)
            );
        }
    }
}

/// Protects maps with textures of their own: those shift, and the material's stay for
/// whoever leaves the map out. Coordinates that are transformed are shifted afterwards.
#[test]
fn own_textures_take_the_place_of_the_materials() {
    let (mut map, mut images) = map();
    images.push(noise("own", 90));
    let transform = UvTransform { rotation: 0.5, scale: Vec2::new(0.5, 2.0), ..UvTransform::default() };
    let own = slot(5).map(|slot| TextureSlot { transform, ..slot });
    map.base_color_texture = own;
    let shifting = Material { parallax: Some(map), ..material() };
    let direction = DIRECTIONS[1].normalize();
    let by = shift(direction);
    let mut by_hand = Material { base_color_texture: own, ..material() };
    for slot in [&mut by_hand.base_color_texture, &mut by_hand.normal_texture].into_iter().flatten() {
        slot.transform.offset += by;
    }
    let with = render(&square(), &shifting, &images, direction, true);
    let expected = render(&square(), &by_hand, &images, direction, true);
    assert!(difference(&with, &expected) < 1e-3);
    let without = render(&square(), &shifting, &images, direction, false);
    assert_eq!(without, render(&square(), &material(), &images, direction, true));
}

/// Protects bakes from shifted models: what a point of the surface looks like from nowhere
/// in particular has no shift in it.
#[test]
fn looks_ignore_parallax() {
    let (map, images) = map();
    let shifting = Material { parallax: Some(map), ..material() };
    let scene = |m: Material| Scene::new(square(), &[m], &images, Interpretation::default());
    let weights = [0.2, 0.5, 0.3];
    assert_eq!(scene(shifting).look(0, weights, 0.01), scene(material()).look(0, weights, 0.01));
}
