//! Unwrapping and repair: sound for any mesh, attributes and order kept.

use parbake_atlas::predicates::{orientation, triangles_overlap};
use parbake_atlas::{Layout, PackOptions, RepairOptions, UnwrapOptions, check, repair, unwrap};
use parbake_model::Mesh;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use proptest::prelude::*;

/// A plane of `n` × `n` squares in space and texture.
fn plane(n: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for y in 0..=n {
        for x in 0..=n {
            let p = Vec2::new(x as f32, y as f32) / n as f32;
            mesh.positions.push(Vec3::new(p.x, -p.y, 0.0));
            mesh.uvs.push(p * 0.8 + 0.1);
        }
    }
    for y in 0..n as u32 {
        for x in 0..n as u32 {
            let v = y * (n as u32 + 1) + x;
            let below = v + n as u32 + 1;
            mesh.triangles.extend([[v, below, v + 1], [v + 1, below, below + 1]]);
        }
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

/// A strip of `n` squares in a row, in space and texture, each split as a plane's are.
fn strip(n: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for x in 0..=n {
        for y in [0.0, 1.0] {
            mesh.positions.push(Vec3::new(x as f32, -y, 0.0));
            mesh.uvs.push(Vec2::new(x as f32, y));
        }
    }
    for x in 0..n as u32 {
        let v = 2 * x;
        mesh.triangles.extend([[v, v + 1, v + 2], [v + 2, v + 1, v + 3]]);
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

fn pack_options() -> PackOptions {
    PackOptions { texture_size: 256, gutter_texels: 1.0, effort: 0, ..PackOptions::default() }
}

fn repair_options() -> RepairOptions {
    RepairOptions { pack: pack_options(), ..RepairOptions::default() }
}

/// Proves a layout sound by looking at all pairs of triangles; triangles without area in
/// space must have none in the texture.
fn assert_sound(mesh: &Mesh, gutter: f64) {
    let layout = Layout::new(mesh);
    for t in 0..layout.triangles.len() {
        let [a, b, c] = layout.corners(t);
        assert!([a, b, c].iter().all(|p| p.min_element() >= 0.0 && p.max_element() <= 1.0));
        let area = orientation(a, b, c);
        assert!(if layout.rest_area(t) > 0.0 { area > 0.0 } else { area == 0.0 }, "triangle {t}: {area}");
        for s in 0..t {
            assert!(!triangles_overlap([a, b, c], layout.corners(s)), "triangles {s} and {t}");
        }
    }
    // Triangles without area have no distance to keep.
    let mut seen = mesh.clone();
    seen.triangles.clear();
    seen.triangles
        .extend((0..mesh.triangles.len()).filter(|&t| layout.rest_area(t) > 0.0).map(|t| mesh.triangles[t]));
    let check = check(&Layout::new(&seen), 256);
    assert!(check.gutter.is_none_or(|g| g.texels >= gutter), "gutter");
}

/// Meshes over few positions: doubled, crossing, degenerate and non-manifold triangles.
fn soup() -> impl Strategy<Value = Mesh> {
    (4usize..12, 0.0f32..1.0).prop_flat_map(|(points, flatness)| {
        let position = prop::array::uniform3(-1.0f32..1.0);
        let uv = prop::array::uniform2((-2i32..8).prop_map(|i| i as f32 * 0.2));
        (
            prop::collection::vec((position, uv), points),
            prop::collection::vec(prop::array::uniform3(0..points as u32), 1..24),
        )
            .prop_map(move |(vertices, triangles)| Mesh {
                positions: vertices.iter().map(|(p, _)| Vec3::new(p[0], p[1], p[2] * flatness)).collect(),
                uvs: vertices.iter().map(|(_, uv)| Vec2::from(*uv)).collect(),
                triangle_materials: vec![0; triangles.len()],
                triangles,
                ..Mesh::default()
            })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Protects the promise that unwrapping is sound for any input.
    #[test]
    fn any_soup_is_unwrapped_soundly(mesh in soup()) {
        let options = UnwrapOptions { pack: pack_options(), ..UnwrapOptions::default() };
        let unwrapped = unwrap(&mesh, &options).unwrap();
        assert_sound(&unwrapped.mesh, 1.0);
        for (before, after) in mesh.triangles.iter().zip(&unwrapped.mesh.triangles) {
            prop_assert_eq!(*before, after.map(|v| unwrapped.source[v as usize]));
        }
    }

    /// Protects the promise that repair is sound for any input.
    #[test]
    fn any_soup_is_repaired_soundly(mesh in soup()) {
        let (repaired, sentences) = repair(&mesh, &repair_options()).unwrap();
        prop_assert_eq!(sentences.is_empty(), repaired == mesh);
        let before: Vec<_> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        let after: Vec<_> = (0..mesh.triangles.len()).map(|t| repaired.corners(t)).collect();
        prop_assert_eq!(before, after);
        if !sentences.is_empty() {
            assert_sound(&repaired, 1.0);
        }
    }

    /// Protects layouts of planes whose points have been thrown about.
    #[test]
    fn crumpled_planes_are_repaired_soundly(
        moves in prop::collection::vec(prop::array::uniform2(-0.4f32..0.4), 36), strength in 0.0f32..1.0
    ) {
        let mut mesh = plane(5);
        for (uv, by) in mesh.uvs.iter_mut().zip(&moves) {
            *uv += Vec2::from(*by) * strength;
        }
        assert_sound(&repair(&mesh, &repair_options()).unwrap().0, 1.0);
    }
}

/// Protects good layouts from being touched.
#[test]
fn a_sound_layout_is_left_alone() {
    let mesh = plane(3);
    assert_eq!(repair(&mesh, &repair_options()).unwrap(), (mesh, Vec::new()));
    assert_eq!(repair(&Mesh::default(), &repair_options()).unwrap().1.len(), 0);
}

/// Protects the sentences and that only what is wrong is changed.
#[test]
fn repairs_are_named() {
    let said = |change: fn(&mut Mesh)| {
        let mut mesh = plane(4);
        change(&mut mesh);
        let (repaired, sentences) = repair(&mesh, &repair_options()).unwrap();
        assert_sound(&repaired, 1.0);
        (repaired, sentences.join(" "))
    };
    let (home, text) = said(|m| m.uvs.iter_mut().for_each(|p| p.x += 3.0));
    assert_eq!(text, "Charts in other tiles of the texture were moved into its square.");
    assert!(home.uvs.iter().zip(&plane(4).uvs).all(|(a, b)| a.abs_diff_eq(*b, 1e-6)));
    let (moved, text) = said(|m| m.uvs.iter_mut().for_each(|p| p.x += 0.7));
    assert_eq!(text, "Texture coordinates outside the square were brought into it.");
    let layout = Layout::new(&moved);
    assert!((layout.doubled_area(0) - 0.04).abs() < 1e-5, "only moved");
    assert!(said(|m| m.uvs.iter_mut().for_each(|p| p.x = 1.0 - p.x)).1.contains("1 mirrored chart was"));
    assert!(said(|m| m.uvs.clear()).1.contains("no texture coordinates"));
    assert!(said(|m| m.uvs.fill(Vec2::ZERO)).1.contains("cover no area"));
    let (folded, text) = said(|m| m.uvs.iter_mut().for_each(|p| p.x = (p.x - 0.5).abs()));
    assert!(text.contains("1 chart, folded onto itself, was cut"), "{text}");
    assert_eq!(check(&Layout::new(&folded), 256).charts, 2);
}

/// Protects texels: one strip as long as the square would leave nine tenths of it empty, delivered or
/// made here. Two triangles as long as the strip cannot be cut, and what is compact is not.
#[test]
fn charts_too_long_for_the_square_are_cut_across() {
    let long = strip(20);
    let (repaired, sentences) = repair(&long, &repair_options()).unwrap();
    let made =
        unwrap(&long, &UnwrapOptions { pack: pack_options(), ..UnwrapOptions::default() }).unwrap().mesh;
    assert!(
        sentences.join(" ").contains("1 chart, too long for the square, was cut across."),
        "{sentences:?}"
    );
    for mesh in [repaired, made] {
        assert_sound(&mesh, 1.0);
        let check = check(&Layout::new(&mesh), 256);
        assert!(check.charts == 4 && check.utilisation > 0.6, "{} {}", check.charts, check.utilisation);
    }
    let mut whole = strip(1);
    whole.positions.iter_mut().for_each(|p| p.x *= 20.0);
    whole.uvs.iter_mut().for_each(|p| p.x *= 20.0);
    for (mesh, wanted) in [(whole, 1), (strip(2), 1)] {
        let (repaired, _) = repair(&mesh, &repair_options()).unwrap();
        assert_eq!(check(&Layout::new(&repaired), 256).charts, wanted);
    }
}

/// Protects attributes when vertices are split, and triangles' materials.
#[test]
fn attributes_are_carried_along() {
    // A cube, whose corners must be split.
    let mut mesh = Mesh {
        positions: (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect(),
        ..Mesh::default()
    };
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh.triangle_materials = (0..12).collect();
    mesh.colors = (0..8).map(|i| Vec4::splat(i as f32)).collect();
    mesh.normals = vec![Vec3::X; 8];
    mesh.tangents = vec![Vec4::X; 8];
    let unwrapped = unwrap(&mesh, &UnwrapOptions::default()).unwrap();
    let after = &unwrapped.mesh;
    assert_sound(after, 0.5);
    assert!(after.positions.len() > 8 && after.tangents.is_empty());
    assert_eq!(after.triangle_materials, mesh.triangle_materials);
    for (v, &source) in unwrapped.source.iter().enumerate() {
        assert_eq!(after.positions[v], mesh.positions[source as usize]);
        assert_eq!(after.colors[v], mesh.colors[source as usize]);
    }
    assert_eq!((after.normals.len(), after.uvs.len()), (after.positions.len(), after.positions.len()));
}

/// Protects triangles without area: they lie on an edge of a neighbour.
#[test]
fn triangles_without_area_stay_with_their_neighbours() {
    let mut mesh = plane(2);
    mesh.triangles.extend([[0, 0, 1], [0, 1, 2], [4, 4, 4]]);
    mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    let unwrapped =
        unwrap(&mesh, &UnwrapOptions { pack: pack_options(), ..UnwrapOptions::default() }).unwrap();
    assert_sound(&unwrapped.mesh, 1.0);
}
