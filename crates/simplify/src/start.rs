//! Surfaces to begin with: coarse, but with several times the wanted triangles (meshoptimizer, A. Kapoulkine).
//!
//! Contract: positions only; welded, without texture coordinates, so that no seam is in the way. The layout is made
//! anew for the result.

use crate::surface::{KEPT_SPAN, Surface};
use meshopt::SimplifyOptions as Flags;
use parbake_model::Mesh;
use parbake_model::glam::Vec3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Triangles that a part which was lost begins with, for each that it has to keep.
const LOST_ROOM: usize = 4;
/// Triangles keep an even shape, and the rims of thin walls, where the surface folds back, cost more to move: the planes around
/// them are nearly one, so that quadrics alone would let them go anywhere in it, and the wall's sides cross.
const SHAPED: Flags = Flags::RegularizeLight.union(Flags::PreserveFolds);

/// How a surface to begin with is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Edges of the model collapse, positions follow the quadrics (Garland and Heckbert 1997).
    Quadrics,
    /// The level before.
    Level,
}

/// A model's welded surface, and coarser ones of it: each has half of the triangles of the one before. They are made
/// when they are first asked for, and kept, since all levels of a model begin with the same ones: 12 bytes a triangle,
/// and for each surface 12 bytes a vertex of the first.
pub struct CoarseSurfaces {
    /// The part of each material, as in [`Surface::in_parts`].
    pub parts: Vec<u32>,
    materials: Vec<u32>,
    flags: Flags,
    halvings: Mutex<Vec<Arc<Coarse>>>,
}

/// A surface on its way: vertices that no triangle has stay in their places.
#[derive(Clone)]
struct Coarse {
    positions: Vec<[f32; 3]>,
    indices: Vec<u32>,
}

impl CoarseSurfaces {
    /// Of a mesh. `parts` has the part of each material, or nothing where there is one.
    pub fn new(mesh: &Mesh, parts: &[u32]) -> Self {
        let surface = Surface::in_parts(mesh, parts).to_mesh();
        Self { parts: parts.to_vec(), ..Self::of(&surface, Flags::Prune | SHAPED) }
    }

    /// Of a mesh of which no small part goes before the others.
    pub(crate) fn unpruned(mesh: &Mesh) -> Self {
        Self::of(&Surface::new(mesh).to_mesh(), SHAPED)
    }

    fn of(surface: &Mesh, flags: Flags) -> Self {
        let (positions, indices, materials) = by_material(surface);
        let halvings = Mutex::new(vec![Arc::new(Coarse { positions, indices })]);
        Self { parts: Vec::new(), materials, flags, halvings }
    }

    /// Edge collapses down to about `target` triangles, in halvings: one shot at a large reduction is worse.
    pub fn collapsed_to(&self, target: usize) -> Mesh {
        let mut halvings = self.halvings.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut now, mut place) = (halvings[0].clone(), Some(0));
        while now.count() > target {
            let half = now.count() / 2;
            let next = match place {
                // The same for every target.
                Some(last) if half >= target => {
                    if halvings.len() == last + 1 {
                        halvings.push(Arc::new(now.collapsed(half, self.flags)));
                    }
                    place = Some(last + 1);
                    halvings[last + 1].clone()
                }
                _ => {
                    place = None;
                    Arc::new(now.collapsed(half.max(target), self.flags))
                }
            };
            let is_stuck = next.count() >= now.count();
            now = next;
            if is_stuck {
                break;
            }
        }
        assembled(&now.positions, &now.indices, |triangle| self.materials[triangle[0] as usize])
    }
}

impl Coarse {
    fn count(&self) -> usize {
        self.indices.len() / 3
    }

    fn collapsed(&self, target: usize, flags: Flags) -> Self {
        let Self { mut positions, mut indices } = self.clone();
        let kept = meshopt::simplify_with_update(
            &mut indices,
            &mut positions,
            &mut [],
            &[],
            0,
            None,
            3 * target,
            f32::MAX,
            flags,
            None,
        );
        indices.truncate(kept);
        Self { positions, indices }
    }
}

/// A start in which each part has `least` triangles, or all that it has in `mesh`, and most of its span: parts of which
/// edge collapses left less are begun again, each by itself.
pub fn with_lost_parts(start: Mesh, mesh: &Mesh, parts: &[u32], least: usize) -> Mesh {
    if least == 0 {
        return start;
    }
    let (found, spans) = (counts_of_parts(&start, parts), spans_of_parts(&start, parts));
    let own_spans = spans_of_parts(mesh, parts);
    let is_lost = |(part, count): &(u32, usize)| {
        let [span, own] = [&spans, &own_spans].map(|spans| spans.get(part).copied().unwrap_or(0.0));
        found.get(part).copied().unwrap_or(0) < least.min(*count) || span < KEPT_SPAN * own
    };
    let lost: Vec<(u32, usize)> = counts_of_parts(mesh, parts).into_iter().filter(is_lost).collect();
    if lost.is_empty() {
        return start;
    }
    let part_of = |material: u32| parts.get(material as usize).copied().unwrap_or(0);
    let mut out = only(&start, |material| lost.iter().all(|(part, _)| *part != part_of(material)));
    for &(part, _) in &lost {
        let own = CoarseSurfaces::unpruned(&only(mesh, |material| part_of(material) == part));
        append(&mut out, own.collapsed_to(LOST_ROOM * least));
    }
    out
}

/// Triangles of each part.
pub fn counts_of_parts(mesh: &Mesh, parts: &[u32]) -> BTreeMap<u32, usize> {
    let mut counts = BTreeMap::new();
    for &material in &mesh.triangle_materials {
        *counts.entry(parts.get(material as usize).copied().unwrap_or(0)).or_default() += 1;
    }
    counts
}

/// Length from corner to corner of the box of each part.
fn spans_of_parts(mesh: &Mesh, parts: &[u32]) -> BTreeMap<u32, f32> {
    let mut boxes: BTreeMap<u32, (Vec3, Vec3)> = BTreeMap::new();
    for (triangle, &material) in mesh.triangle_materials.iter().enumerate() {
        let part = parts.get(material as usize).copied().unwrap_or(0);
        for point in mesh.corners(triangle) {
            let (low, high) = boxes.entry(part).or_insert((point, point));
            (*low, *high) = (low.min(point), high.max(point));
        }
    }
    boxes.into_iter().map(|(part, (low, high))| (part, low.distance(high))).collect()
}

/// Adds the triangles of another surface; positions, triangles and materials alone.
pub(crate) fn append(out: &mut Mesh, own: Mesh) {
    let first = out.positions.len() as u32;
    out.positions.extend(own.positions);
    out.triangles.extend(own.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    out.triangle_materials.extend(own.triangle_materials);
}

/// The triangles of some materials.
pub(crate) fn only(mesh: &Mesh, is_wanted: impl Fn(u32) -> bool) -> Mesh {
    let triangles = mesh.triangles.iter().zip(&mesh.triangle_materials);
    let (triangles, triangle_materials) = triangles.filter(|(_, material)| is_wanted(**material)).unzip();
    Mesh { positions: mesh.positions.clone(), triangles, triangle_materials, ..Mesh::default() }
}

/// How many triangles edge collapses need to stay within a distance, in the mesh's unit.
pub fn triangles_within(mesh: &Mesh, distance: f32) -> usize {
    let surface = Surface::new(mesh).to_mesh();
    let positions: Vec<[f32; 3]> = surface.positions.iter().map(|p| p.to_array()).collect();
    let indices: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
    let flags = Flags::Prune | Flags::ErrorAbsolute;
    meshopt::simplify_decoder(&indices, &positions, 0, distance, flags, None).len() / 3
}

/// Vertices with their materials: one at the border of two materials is its first one's, so that the surface stays
/// whole there.
fn by_material(mesh: &Mesh) -> (Vec<[f32; 3]>, Vec<u32>, Vec<u32>) {
    let mut materials = vec![u32::MAX; mesh.positions.len()];
    for (triangle, &material) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
        for &vertex in triangle {
            let own = &mut materials[vertex as usize];
            *own = (*own).min(material);
        }
    }
    let positions = mesh.positions.iter().map(|p| p.to_array()).collect();
    (positions, mesh.triangles.iter().flatten().copied().collect(), materials)
}

fn assembled(positions: &[[f32; 3]], indices: &[u32], material: impl Fn(&[u32; 3]) -> u32) -> Mesh {
    let triangles: Vec<[u32; 3]> = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let triangle_materials = triangles.iter().map(material).collect();
    let positions = positions.iter().map(|&p| Vec3::from(p)).collect();
    Mesh { positions, triangles, triangle_materials, ..Mesh::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three strips of triangles along x, each of a material; the last one is much smaller.
    fn strips() -> Mesh {
        let mut mesh = Mesh::default();
        for (material, length) in [8.0f32, 8.0, 0.01].into_iter().enumerate() {
            let first = mesh.positions.len() as u32;
            for k in 0..=16u32 {
                let (x, z) = (length * k as f32 / 16.0, 4.0 * material as f32);
                mesh.positions.extend([Vec3::new(x, 0.0, z), Vec3::new(x, 0.1 * length, z)]);
            }
            for k in 0..16 {
                let a = first + 2 * k;
                mesh.triangles.extend([[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]);
            }
            mesh.triangle_materials.resize(mesh.triangles.len(), material as u32);
        }
        mesh
    }

    /// Protects parts that edge collapses would take away or shorten: they begin again, others stay as they are.
    #[test]
    fn lost_parts_begin_again() {
        let (mesh, parts) = (strips(), [0, 1, 2]);
        let mut start = only(&mesh, |material| material == 0);
        // Of the second a crumb is left.
        start.triangles.extend(&mesh.triangles[32..36]);
        start.triangle_materials.extend([1; 4]);
        let whole = with_lost_parts(start.clone(), &mesh, &parts, 4);
        let (counts, spans) = (counts_of_parts(&whole, &parts), spans_of_parts(&whole, &parts));
        assert_eq!((counts[&0], &whole.triangles[..32]), (32, &mesh.triangles[..32]));
        for part in [1, 2] {
            assert!((4..=16).contains(&counts[&part]), "{counts:?}");
            assert!(spans[&part] > KEPT_SPAN * spans_of_parts(&mesh, &parts)[&part]);
        }
        assert_eq!(with_lost_parts(start.clone(), &mesh, &parts, 0), start);
    }

    /// Protects levels that begin with what others left: a coarser surface is the same whatever was asked for before.
    #[test]
    fn surfaces_do_not_depend_on_those_before() {
        let mut mesh = Mesh::default();
        for (row, column) in (0..=40u32).flat_map(|row| (0..=40u32).map(move |column| (row, column))) {
            let (x, y) = (row as f32 / 20.0, column as f32 / 20.0);
            mesh.positions.push(Vec3::new(x, y, 0.3 * (5.0 * x).sin() * (4.0 * y).cos()));
        }
        for (row, column) in (0..40).flat_map(|row| (0..40).map(move |column| (row, column))) {
            let first = row * 41 + column;
            mesh.triangles.extend([[first, first + 41, first + 42], [first, first + 42, first + 1]]);
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        let all = CoarseSurfaces::new(&mesh, &[]);
        for target in [3200, 90, 1000, 400, 91, 5000, 1] {
            let own = CoarseSurfaces::new(&mesh, &[]).collapsed_to(target);
            assert_eq!(all.collapsed_to(target), own, "{target}");
            assert!(own.triangles.len() <= target.max(2), "{}", own.triangles.len());
        }
    }

    /// Protects the rims of thin walls: their two sides are nearly one plane, in which a rim could go anywhere.
    #[test]
    fn a_thin_disc_keeps_its_outline() {
        const SECTORS: u32 = 96;
        const RINGS: u32 = 12;
        let mut mesh = Mesh::default();
        for side in [0.002, -0.002] {
            for ring in 0..=RINGS {
                for sector in 0..SECTORS {
                    let radius = ring as f32 / RINGS as f32;
                    let angle = std::f32::consts::TAU * sector as f32 / SECTORS as f32;
                    let z = if ring == RINGS { 0.0 } else { side };
                    mesh.positions.push(Vec3::new(radius * angle.cos(), radius * angle.sin(), z));
                }
            }
        }
        let lower = mesh.positions.len() as u32 / 2;
        for (ring, sector) in (0..RINGS).flat_map(|ring| (0..SECTORS).map(move |sector| (ring, sector))) {
            let at = |ring: u32, sector: u32| ring * SECTORS + sector % SECTORS;
            let [a, b, c, d] =
                [at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1), at(ring, sector + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
            mesh.triangles.extend([[a, c, b], [a, d, c]].map(|triangle| triangle.map(|v| v + lower)));
        }
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        let area = |mesh: &Mesh| -> f32 {
            let upwards =
                (0..mesh.triangles.len()).map(|triangle| 0.5 * mesh.area_normal(triangle).z.max(0.0));
            upwards.sum()
        };
        let coarse = CoarseSurfaces::new(&mesh, &[]).collapsed_to(60);
        let kept = area(&coarse) / area(&mesh);
        assert!((0.97..=1.0).contains(&kept), "{kept}");
    }
}
