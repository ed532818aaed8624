use super::*;
use crate::{RepairOptions, repair, sharing};
use parbake_model::glam::{Vec2, Vec3};

/// Planes of `n` × `n` squares side by side in space, the first point of each at `lows` in the texture
/// and `size` wide there, each a chart.
fn planes(n: u32, lows: &[Vec2], size: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for (i, low) in lows.iter().enumerate() {
        let first = mesh.positions.len() as u32;
        for y in 0..=n {
            for x in 0..=n {
                let p = Vec2::new(x as f32, y as f32) / n as f32;
                mesh.positions.push(Vec3::new(p.x + 2.0 * i as f32, -p.y, 0.0));
                mesh.uvs.push(*low + p * size);
            }
        }
        for y in 0..n {
            for x in 0..n {
                let v = first + y * (n + 1) + x;
                let below = v + n + 1;
                mesh.triangles.extend([[v, below, v + 1], [v + 1, below, below + 1]]);
            }
        }
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

/// The mesh repaired for a texture of 256² with a gutter of a texel; the triangles whose coordinates
/// changed; the sentences.
fn repaired(mesh: &Mesh) -> (Mesh, Vec<usize>, String) {
    let pack = PackOptions { texture_size: 256, gutter_texels: 1.0, ..PackOptions::default() };
    let options = RepairOptions { pack, gutter_required: false, ..RepairOptions::default() };
    let (after, sentences) = repair(mesh, &options).expect("it fits");
    assert!(check(&Layout::new(&after), 256).is_bijective());
    let changed = (0..mesh.triangles.len()).filter(|&t| mesh.corner_uvs(t) != after.corner_uvs(t)).collect();
    (after, changed, sentences.join(" "))
}

/// Protects all that is not faulty: two triangles without area among 800 are laid into free space, and the
/// others keep their coordinates to the bit.
#[test]
fn collapsed_triangles_alone_are_laid_afresh() {
    let mut mesh = planes(20, &[Vec2::splat(0.05)], 0.8);
    // A square of the plane with vertices of its own, all in one place of the texture.
    let two = [400usize, 401];
    for t in two {
        for k in 0..3 {
            let v = mesh.triangles[t][k] as usize;
            mesh.positions.push(mesh.positions[v]);
            mesh.uvs.push(Vec2::splat(0.4));
            mesh.triangles[t][k] = mesh.positions.len() as u32 - 1;
        }
    }
    let (after, changed, text) = repaired(&mesh);
    assert_eq!(changed, two, "{text}");
    assert!(text.contains("2 triangles that had no area in the texture"), "{text}");
    let layout = Layout::new(&after);
    let area = layout.doubled_area(400) / layout.doubled_area(0);
    assert!((area - 1.0).abs() < 0.05, "as large as its neighbours: {area}");
    assert_eq!(layout.charts[400], layout.charts[401]);
}

/// Protects layouts in which two charts touch by a hair: the smaller one moves aside, no further than it
/// must.
#[test]
fn charts_that_overlap_by_a_hair_are_nudged_apart() {
    let mut mesh = planes(6, &[Vec2::splat(0.1), Vec2::new(0.5, 0.1)], 0.4);
    let half = mesh.positions.len() / 2;
    mesh.uvs[half..].iter_mut().for_each(|p| p.y = 0.1 + (p.y - 0.1) * 0.5);
    mesh.uvs[half..].iter_mut().for_each(|p| p.x -= 1e-6);
    let overlaps = check(&Layout::new(&mesh), 256).overlaps;
    assert!(overlaps.pairs > 0 && overlaps.texels < 0.1, "{overlaps:?}");
    let (after, changed, text) = repaired(&mesh);
    assert!(changed.iter().all(|t| *t >= 72) && text.contains("1 chart that lay on another"), "{text}");
    let farthest = mesh.uvs.iter().zip(&after.uvs).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(farthest < 4.0 / 256.0, "{farthest}");
    assert!(check(&Layout::new(&after), 256).gutter.is_some_and(|g| g.texels >= 1.0));
}

/// Protects slivers: a triangle on one line gets an area by less than a texel, and no seam.
#[test]
fn slivers_are_opened_where_they_are() {
    let mut mesh = planes(4, &[Vec2::splat(0.1)], 0.6);
    // On the border, between the first two vertices and the middle of their edge, thin in space too.
    let [a, b] = [0usize, 1];
    let middle = 0.5 * (mesh.positions[a] + mesh.positions[b]) + Vec3::new(0.0, 1e-4, 0.0);
    mesh.positions.push(middle);
    mesh.uvs.push(0.5 * (mesh.uvs[a] + mesh.uvs[b]));
    mesh.triangles.push([0, 1, mesh.positions.len() as u32 - 1]);
    mesh.triangle_materials.push(0);
    let (after, changed, text) = repaired(&mesh);
    assert_eq!(changed, [32], "{text}");
    assert!(text.contains("1 sliver was given an area"), "{text}");
    assert_eq!(check(&Layout::new(&after), 256).charts, 1);
    assert!(mesh.uvs.iter().zip(&after.uvs).all(|(a, b)| a.distance(*b) < 0.5 / 256.0));
}

/// Protects what is said: stacked copies, mirrored halves and tiling are recognised; a single bad triangle
/// is not taken for any of them. Each part gets texels of its own.
#[test]
fn deliberate_sharing_is_said() {
    let low = Vec2::splat(0.05);
    let mut stacked = planes(3, &[low, low, Vec2::splat(0.5)], 0.3);
    assert_eq!(sharing(&stacked), sharing::Sharing { stacked: 2, ..Default::default() });
    let (_, changed, text) = repaired(&stacked);
    assert!(text.contains("2 parts lie on copies of the same orientation"), "{text}");
    assert_eq!(changed.len(), 18, "{text}");
    stacked.uvs[..16].iter_mut().for_each(|p| p.x = 0.4 - p.x);
    assert_eq!(sharing(&stacked).mirrored, 2);
    let folded = {
        let mut mesh = planes(4, &[low], 0.8);
        mesh.uvs.iter_mut().for_each(|p| p.x = 0.05 + (p.x - 0.45).abs());
        mesh
    };
    assert_eq!(sharing(&folded).mirrored, 2);
    let (_, changed, text) = repaired(&folded);
    assert!(text.contains("lie on their mirror images") && changed.len() == 16, "{text}");
    assert_eq!(sharing(&planes(4, &[low], 1.5)).repeating, 1);
    let mut bad = planes(4, &[low], 0.8);
    bad.uvs[0] = Vec2::splat(0.6);
    assert_eq!(sharing(&bad), sharing::Sharing::default());
}

/// Protects layouts that are mirrored as a whole: nothing is packed again.
#[test]
fn a_mirrored_layout_is_mirrored_back() {
    let mut mesh = planes(3, &[Vec2::splat(0.05), Vec2::splat(0.5)], 0.3);
    mesh.uvs.iter_mut().for_each(|p| p.x = 1.0 - p.x);
    let (after, _, text) = repaired(&mesh);
    assert!(text.contains("mirrored as a whole"), "{text}");
    assert!(mesh.uvs.iter().zip(&after.uvs).all(|(a, b)| (1.0 - a.x - b.x).abs() < 1e-6 && a.y == b.y));
}

/// Protects the end: where nothing is free, all is packed again.
#[test]
fn without_room_all_is_packed_again() {
    let half = [0.02, 0.5].map(|x| Vec2::new(x, 0.02));
    let mut mesh = planes(3, &[half[0], half[1], half[0], half[1]], 0.47);
    mesh.uvs.iter_mut().for_each(|p| p.y *= 2.0);
    let (_, changed, text) = repaired(&mesh);
    assert_eq!(changed.len(), mesh.triangles.len(), "{text}");
    assert!(text.contains("all charts were packed again"), "{text}");
}

/// Protects whole parts that are drawn as a line: they get texels as the rest has, and are not opened by a part
/// of a texel as a sliver is.
#[test]
fn a_part_without_area_gets_its_texels() {
    let mut mesh = planes(1, &[Vec2::splat(0.05), Vec2::splat(0.05)], 0.5);
    let half = mesh.positions.len() / 2;
    for (uv, x) in mesh.uvs[half..].iter_mut().zip([0.6, 0.9, 0.7, 0.8]) {
        *uv = Vec2::new(x, 0.9);
    }
    // A quarter as large as the other.
    let first = mesh.positions[half];
    mesh.positions[half..].iter_mut().for_each(|p| *p = first + (*p - first) * 0.5);
    let (after, _, text) = repaired(&mesh);
    let layout = Layout::new(&after);
    let area = |triangles: std::ops::Range<usize>| triangles.map(|t| layout.doubled_area(t)).sum::<f64>();
    let count = mesh.triangles.len();
    let share = area(count / 2..count) / area(0..count / 2);
    assert!((share - 0.25).abs() < 0.02, "{share} {text}");
}
