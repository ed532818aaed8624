//! Skin and morph targets of one surface on another: each vertex takes those of the closest point.
//!
//! The closest point is one of a triangle that faces as the vertex does, unless that is much farther away, so that legs
//! side by side and fingers keep their own joints. Parts that move against each other ([`mod@crate::rig_parts`]) never mix:
//! a triangle of a known part takes from that part alone; where parts are not known, those connected parts of the
//! surface that nearly all lie on one take from that one.
//!
//! Contract: vertices at one position of one part get the same influences and displacements, so that no seam tears.
//! Weights sum to 1. Both meshes are in the same space. The result does not depend on threads.

use crate::projection::{HighSurface, SurfacePoint};
use crate::rig_parts::rig_parts;
use crate::union_find::UnionFind;
use crate::weld::weld_by_position;
use parbake_model::glam::Vec3;
use parbake_model::{Bounds, Influences, Mesh, Morph, Placement, Rig};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// How much farther away a point may be that faces as the vertex does, as a share of half of the longest side.
const REACH: f32 = 0.1;
/// Share of a connected part's area that decides whose it is.
const NEARLY_ALL: f64 = 0.9;
/// Displacements below this share of half of the longest side are none.
const LEAST_MOVE: f32 = 1e-6;
/// Changes of unit normals below this are none.
const LEAST_TURN: f32 = 1e-3;
/// No part in particular.
const ANY: u32 = u32::MAX;

/// A point of the source's surface.
struct Found {
    corners: [u32; 3],
    weights: [f32; 3],
}

/// The rig of `target`, from that of `source`. `parts` has the part of each of the target's triangles by the numbers of
/// [`rig_parts`], if they are known. A source without extent gives its first vertex's.
pub fn transfer_rig(source: &Mesh, rig: &Rig, target: &Mesh, parts: Option<&[u32]>) -> Rig {
    let surfaces = Surfaces::new(source, rig);
    let mut placed = Mesh { positions: target.positions.clone(), ..Mesh::default() };
    surfaces.placement.apply(&mut placed);
    placed.triangles.clone_from(&target.triangles);
    let parts = parts.map_or_else(|| surfaces.nearest_parts(&placed), <[u32]>::to_vec);

    // Vertices at one place of one part are one.
    let welded = weld_by_position(&placed.positions);
    let mut part_of = vec![ANY; placed.positions.len()];
    for (triangle, &part) in placed.triangles.iter().zip(&parts) {
        triangle.iter().for_each(|&vertex| part_of[vertex as usize] = part_of[vertex as usize].min(part));
    }
    let mut points: BTreeMap<(u32, u32), Vec3> = BTreeMap::new();
    let key = |vertex: u32| (welded[vertex as usize], part_of[vertex as usize]);
    for index in 0..placed.triangles.len() {
        for vertex in placed.triangles[index] {
            *points.entry(key(vertex)).or_default() += placed.area_normal(index);
        }
    }
    (0..placed.positions.len() as u32).for_each(|vertex| {
        points.entry(key(vertex)).or_default();
    });
    let asked: Vec<((u32, u32), Vec3)> = points.into_iter().collect();
    let find = |&((vertex, part), side): &((u32, u32), Vec3)| {
        surfaces.find(placed.positions[vertex as usize], side, part)
    };
    let found: Vec<Found> = asked.par_iter().map(find).collect();
    let place = |vertex: u32| asked.binary_search_by_key(&key(vertex), |(key, _)| *key).unwrap_or(0);
    let places: Vec<usize> = (0..placed.positions.len() as u32).map(place).collect();

    let influences = match rig.influences.is_empty() {
        true => Vec::new(),
        false => {
            let blended: Vec<Influences> = found.iter().map(|found| found.influences(rig)).collect();
            places.iter().map(|&place| blended[place]).collect()
        }
    };
    let unit = 1.0 / surfaces.placement.scale;
    let morphs = (rig.morphs.par_iter()).map(|morph| {
        let moved: Vec<(Vec3, Vec3)> = found.iter().map(|found| found.displacement(morph)).collect();
        let mut out = Morph::default();
        for (vertex, &place) in (0..).zip(&places) {
            let (position, normal) = moved[place];
            if position.length() > LEAST_MOVE * unit || normal.length() > LEAST_TURN {
                out.push(vertex, position, normal);
            }
        }
        out
    });
    Rig { skeleton: rig.skeleton.clone(), influences, morphs: morphs.collect() }
}

/// The source's surface, and each of its parts alone.
struct Surfaces<'s> {
    source: &'s Mesh,
    placement: Placement,
    parts: Vec<u32>,
    whole: HighSurface,
    /// For each part its surface and its triangles; empty where there is only one.
    alone: Vec<(HighSurface, Vec<u32>)>,
}

impl<'s> Surfaces<'s> {
    fn new(source: &'s Mesh, rig: &Rig) -> Self {
        let bounds = Bounds::of(source);
        let placement = bounds.as_ref().and_then(Placement::unit_box);
        let placement = placement.unwrap_or(Placement { centre: Vec3::ZERO, scale: 1.0 });
        let mut placed = Mesh { positions: source.positions.clone(), ..Mesh::default() };
        placement.apply(&mut placed);
        placed.triangles.clone_from(&source.triangles);
        let parts = rig_parts(source, rig);
        let count = parts.iter().max().map_or(0, |&last| last + 1);
        let mut triangles: Vec<Vec<u32>> = vec![Vec::new(); count as usize];
        (0..).zip(&parts).for_each(|(triangle, &part)| triangles[part as usize].push(triangle));
        let whole = HighSurface::new(&placed);
        let alone = match count {
            0..=1 => Vec::new(),
            _ => {
                let surface = |own: Vec<u32>| {
                    placed.triangles = own.iter().map(|&t| source.triangles[t as usize]).collect();
                    (HighSurface::new(&placed), own)
                };
                triangles.into_iter().map(surface).collect()
            }
        };
        Self { source, placement, parts, whole, alone }
    }

    /// The closest point of a part, or of all.
    fn find(&self, point: Vec3, side: Vec3, part: u32) -> Found {
        let own = self.alone.get(part as usize).and_then(|(surface, triangles)| {
            let found = surface.closest_on_side(point, side, REACH)?;
            Some((triangles[found.triangle as usize], found))
        });
        let found = own.or_else(|| {
            let found = self.whole.closest_on_side(point, side, REACH)?;
            Some((found.triangle, found))
        });
        let Some((triangle, SurfacePoint { barycentric: [u, v], .. })) = found else {
            return Found { corners: [0; 3], weights: [1.0, 0.0, 0.0] };
        };
        let corners = self.source.triangles[triangle as usize];
        Found { corners, weights: [(1.0 - u - v).max(0.0), u, v] }
    }

    /// For each triangle of another surface the part on which its connected part lies.
    fn nearest_parts(&self, target: &Mesh) -> Vec<u32> {
        if self.alone.is_empty() {
            return vec![0; target.triangles.len()];
        }
        let welded = weld_by_position(&target.positions);
        let mut connected = UnionFind::new(target.positions.len());
        for triangle in &target.triangles {
            let [a, b, c] = triangle.map(|vertex| welded[vertex as usize]);
            connected.union(a, b);
            connected.union(a, c);
        }
        let nearest = |index: usize| {
            let [a, b, c] = target.corners(index);
            let normal = target.area_normal(index);
            let found = self.whole.closest_on_side((a + b + c) / 3.0, normal, REACH)?;
            Some((self.parts[found.triangle as usize], f64::from(normal.length())))
        };
        let votes: Vec<_> = (0..target.triangles.len()).into_par_iter().map(nearest).collect();
        let roots: Vec<u32> =
            target.triangles.iter().map(|t| connected.find(welded[t[0] as usize])).collect();
        let mut areas: BTreeMap<u32, BTreeMap<u32, f64>> = BTreeMap::new();
        for (&root, (part, area)) in
            roots.iter().zip(&votes).filter_map(|(root, vote)| Some((root, (*vote)?)))
        {
            *areas.entry(root).or_default().entry(part).or_default() += area;
        }
        let decided = |root: &u32| {
            let areas = areas.get(root)?;
            let total: f64 = areas.values().sum();
            let (&part, &most) = areas.iter().max_by(|a, b| a.1.total_cmp(b.1))?;
            (most >= NEARLY_ALL * total).then_some(part)
        };
        roots.iter().map(|root| decided(root).unwrap_or(ANY)).collect()
    }
}

impl Found {
    fn influences(&self, rig: &Rig) -> Influences {
        let corners = self.corners.into_iter().zip(self.weights);
        let all: Vec<(u32, f32)> = corners
            .filter_map(|(vertex, share)| Some((rig.influences.get(vertex as usize)?, share)))
            .flat_map(|(influences, share)| {
                influences.used().map(move |(joint, weight)| (joint, weight * share))
            })
            .collect();
        let first = rig.influences.get(self.corners[0] as usize).copied();
        Influences::strongest(&all).or(first).unwrap_or_else(|| Influences::of(0))
    }

    fn displacement(&self, morph: &Morph) -> (Vec3, Vec3) {
        let corners = self.corners.into_iter().zip(self.weights);
        corners.fold((Vec3::ZERO, Vec3::ZERO), |(position, normal), (vertex, share)| match morph.of(vertex) {
            Some((p, n)) => (position + share * p, normal + share * n),
            None => (position, normal),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::DAffine3;
    use parbake_model::{Joint, MorphTarget, Node, NodeTransform, Skeleton};
    use std::sync::Arc;

    /// A tube along y from 0 to 1 around (x, 0), 0.1 thick from its middle, with so many rings of so many corners.
    fn tube(mesh: &mut Mesh, x: f32, rings: u32, corners: u32) {
        let first = mesh.positions.len() as u32;
        let step = std::f32::consts::TAU / corners as f32;
        for ring in 0..rings {
            let y = ring as f32 / (rings - 1) as f32;
            for k in 0..corners {
                let (sin, cos) = ((k as f32 + 0.5) * step).sin_cos();
                let radius = 0.1 / (0.5 * step).cos();
                mesh.positions.push(Vec3::new(x + radius * cos, y, radius * sin));
            }
        }
        for ring in 0..rings - 1 {
            for k in 0..corners {
                let [a, b] = [k, (k + 1) % corners].map(|k| first + corners * ring + k);
                let [c, d] = [a + corners, b + corners];
                mesh.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
        mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    }

    fn skeleton(joints: usize) -> Arc<Skeleton> {
        let node = Node { name: String::new(), parent: None, rest: NodeTransform::IDENTITY };
        let joint = |node| Joint { node, inverse_bind: DAffine3::IDENTITY };
        Arc::new(Skeleton {
            nodes: vec![node; joints],
            joints: (0..joints).map(joint).collect(),
            targets: vec![MorphTarget::default()],
            animations: Vec::new(),
        })
    }

    /// Two tubes a hair apart, each of its own joint.
    fn two_tubes(corners: u32) -> (Mesh, Rig) {
        let mut mesh = Mesh::default();
        tube(&mut mesh, 0.0, 9, corners);
        let half = mesh.positions.len();
        tube(&mut mesh, 0.21, 9, corners);
        let influences = (0..mesh.positions.len()).map(|v| Influences::of((v >= half).into())).collect();
        (mesh, Rig { skeleton: skeleton(2), influences, morphs: vec![Morph::default()] })
    }

    /// Protects parts that move against each other: a coarse tube whose wall lies inside of its neighbour still follows
    /// its own joint alone.
    #[test]
    fn neighbours_do_not_bleed() {
        let (source, rig) = two_tubes(4);
        let mut coarse = Mesh::default();
        tube(&mut coarse, 0.02, 2, 4);
        let half = coarse.positions.len();
        tube(&mut coarse, 0.19, 2, 4);
        let parts: Vec<u32> =
            (0..coarse.triangles.len()).map(|t| (2 * t >= coarse.triangles.len()).into()).collect();
        for parts in [Some(&parts[..]), None] {
            let found = transfer_rig(&source, &rig, &coarse, parts);
            assert_eq!(found.fault(coarse.positions.len()), None);
            for (vertex, influences) in found.influences.iter().enumerate() {
                assert_eq!(*influences, Influences::of((vertex >= half).into()), "{vertex}");
            }
        }
    }

    /// Protects limbs of one skin side by side: walls that face each other take from the wall that faces as they do,
    /// though the other one is closer.
    #[test]
    fn walls_that_face_away_are_not_taken() {
        let (source, mut rig) = two_tubes(8);
        // One part: some triangle has both joints.
        let both = Influences::strongest(&[(0, 0.999), (1, 0.001)]).unwrap_or_default();
        rig.influences[0] = both;
        let mut coarse = Mesh::default();
        tube(&mut coarse, 0.02, 3, 8);
        let found = transfer_rig(&source, &rig, &coarse, None);
        for influences in &found.influences {
            assert!(influences.weights[0] > 0.99 && influences.joints[0] == 0, "{influences:?}");
        }
    }

    /// Protects seams: copies of a vertex move alike; and weights and displacements are mixed along the surface.
    #[test]
    fn copies_get_the_same() {
        let mut source = Mesh::default();
        tube(&mut source, 0.0, 3, 4);
        let weights = |v: usize| [(0, 1.0 - source.positions[v].y), (1, source.positions[v].y)];
        let influences = (0..12).map(|v| Influences::strongest(&weights(v)).unwrap_or_default()).collect();
        let mut morph = Morph::default();
        (8..12).for_each(|v| morph.push(v, Vec3::Z, Vec3::ZERO));
        let rig = Rig { skeleton: skeleton(2), influences, morphs: vec![morph] };
        let mut target = Mesh::default();
        tube(&mut target, 0.0, 5, 4);
        let copies: Vec<Vec3> = target.positions.clone();
        target.positions.extend(copies);
        let shifted: Vec<[u32; 3]> = target.triangles.iter().map(|t| t.map(|v| v + 20)).collect();
        target.triangles.extend(shifted.into_iter().take(9));
        let found = transfer_rig(&source, &rig, &target, None);
        assert_eq!(found.fault(40), None);
        for v in 0..20 {
            assert_eq!(found.influences[v], found.influences[v + 20]);
            assert_eq!(found.morphs[0].of(v as u32), found.morphs[0].of(v as u32 + 20));
            let y = target.positions[v].y;
            let upper: f32 = found.influences[v].used().filter(|(j, _)| *j == 1).map(|(_, w)| w).sum();
            assert!((upper - y).abs() < 1e-5, "{y} {upper}");
            let moved = found.morphs[0].of(v as u32).map_or(0.0, |(p, _)| p.z);
            assert!((moved - (2.0 * y - 1.0).max(0.0)).abs() < 1e-5, "{y} {moved}");
        }
    }
}
