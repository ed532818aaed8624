//! Connected pieces of a surface as disks, cut where they are none.

use crate::AtlasError;
use crate::unwrap::corners::Surface;
use glam::DVec3;
use std::collections::VecDeque;

/// A piece of the surface that is a disk.
pub(super) struct Disk {
    /// Its triangles.
    pub triangles: Vec<u32>,
    /// Their corners as points of the disk.
    pub points: Vec<[u32; 3]>,
    /// The points in space.
    pub positions: Vec<DVec3>,
    /// The points around it, counter-clockwise.
    pub boundary: Vec<u32>,
    /// Mean length of the triangles' edges.
    pub mean_edge: f64,
}

/// An edge with a triangle on either side, each with the number of its side.
#[derive(Clone, Copy)]
struct Inner {
    ends: [u32; 2],
    sides: [(u32, u8); 2],
}

/// All pieces of the triangles that have an area, in the order of their first ones.
pub(super) fn disks(surface: &Surface, cut: bool) -> Result<Vec<Disk>, AtlasError> {
    let count = surface.mesh.triangles.len();
    let corners: Vec<[u32; 3]> = (0..count).map(|t| surface.positions(t)).collect();
    let inner = inner_edges(surface, &corners);
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (e, edge) in inner.iter().enumerate() {
        edge.sides.iter().for_each(|side| around[side.0 as usize].push(e as u32));
    }
    let mut seen = vec![false; count];
    let mut disks = Vec::new();
    for first in (0..count).filter(|&t| surface.is_live(t)) {
        if seen[first] {
            continue;
        }
        // The spanning tree of neighbourhoods, breadth first.
        let mut triangles = vec![first as u32];
        let mut tree = Vec::new();
        let mut queue = VecDeque::from([first as u32]);
        seen[first] = true;
        while let Some(t) = queue.pop_front() {
            for &e in &around[t as usize] {
                let other = inner[e as usize].sides.iter().map(|s| s.0).find(|&s| s != t);
                if let Some(other) = other.filter(|&o| !std::mem::replace(&mut seen[o as usize], true)) {
                    tree.push(e);
                    triangles.push(other);
                    queue.push_back(other);
                }
            }
        }
        triangles.sort_unstable();
        let mut all: Vec<u32> = triangles.iter().flat_map(|&t| around[t as usize].iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        // First as it is: most pieces are disks.
        let whole = joined(surface, &corners, &inner, &triangles, &all);
        disks.push(match whole {
            Some(disk) => disk,
            None if !cut => {
                return Err(AtlasError::NotADisk {
                    triangle: first,
                    problem: "is no disk: it is closed, has holes or handles, or touches itself in a point",
                    remedy: "allow cuts, or unwrap the model instead",
                });
            }
            None => {
                let joins = joins_of_cut(&corners, &inner, &triangles, &all, &tree);
                joined(surface, &corners, &inner, &triangles, &joins).ok_or(AtlasError::NotADisk {
                    triangle: first,
                    problem: "could not be cut into a disk",
                    remedy: "unwrap the model instead",
                })?
            }
        });
    }
    Ok(disks)
}

/// Edges that exactly two live triangles share, running opposite ways.
fn inner_edges(surface: &Surface, corners: &[[u32; 3]]) -> Vec<Inner> {
    let mut edges: Vec<([u32; 2], bool, u32, u8)> = Vec::new();
    for t in (0..corners.len()).filter(|&t| surface.is_live(t)) {
        for k in 0..3 {
            let (a, b) = (corners[t][k], corners[t][(k + 1) % 3]);
            edges.push(([a.min(b), a.max(b)], a < b, t as u32, k as u8));
        }
    }
    edges.sort_unstable();
    edges
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|run| run.len() == 2 && run[0].1 != run[1].1)
        .map(|run| Inner { ends: run[0].0, sides: [(run[0].2, run[0].3), (run[1].2, run[1].3)] })
        .collect()
}

/// The edges to join: all but a graph of cuts without loose ends, or a path of two.
fn joins_of_cut(
    corners: &[[u32; 3]],
    inner: &[Inner],
    triangles: &[u32],
    all: &[u32],
    tree: &[u32],
) -> Vec<u32> {
    let mut joined = vec![false; inner.len()];
    tree.iter().for_each(|&e| joined[e as usize] = true);
    let mut positions: Vec<u32> = triangles.iter().flat_map(|&t| corners[t as usize]).collect();
    positions.sort_unstable();
    positions.dedup();
    let local = |p: u32| positions.partition_point(|&q| q < p);
    // Ends of cuts, by position; an edge of the boundary is a cut that stays.
    let mut cuts: Vec<Vec<u32>> = vec![Vec::new(); positions.len()];
    for &e in all.iter().filter(|&&e| !joined[e as usize]) {
        inner[e as usize].ends.iter().for_each(|&p| cuts[local(p)].push(e));
    }
    let mut kept = vec![0usize; positions.len()];
    let mut sides: Vec<[u32; 2]> = Vec::new();
    for &t in triangles {
        let [a, b, c] = corners[t as usize];
        sides.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
    }
    let inside: Vec<[u32; 2]> = all.iter().map(|&e| inner[e as usize].ends).collect();
    // `all` is sorted by index, and so are the edges by their ends.
    for side in sides.iter().filter(|side| inside.binary_search(side).is_err()) {
        side.iter().for_each(|&p| kept[local(p)] += 1);
    }
    let mut degree: Vec<usize> = (0..positions.len()).map(|p| cuts[p].len() + kept[p]).collect();
    let mut left = all.iter().filter(|&&e| !joined[e as usize]).count();
    let closed = kept.iter().all(|&k| k == 0);
    let mut ends: VecDeque<usize> = (0..positions.len()).filter(|&p| degree[p] == 1).collect();
    while let Some(p) = ends.pop_front() {
        // A sphere's cuts would all go: two edges in a row are enough for a boundary.
        if degree[p] != 1 || (closed && left <= 2) {
            continue;
        }
        if let Some(&e) = cuts[p].iter().find(|&&e| !joined[e as usize]) {
            joined[e as usize] = true;
            left -= 1;
            for q in inner[e as usize].ends.map(local) {
                degree[q] -= 1;
                if degree[q] == 1 {
                    ends.push_back(q);
                }
            }
        }
    }
    all.iter().copied().filter(|&e| joined[e as usize]).collect()
}

/// The triangles joined along edges, if that makes a disk.
fn joined(
    surface: &Surface,
    corners: &[[u32; 3]],
    inner: &[Inner],
    triangles: &[u32],
    joins: &[u32],
) -> Option<Disk> {
    let local = |t: u32| triangles.partition_point(|&u| u < t);
    let mut leader: Vec<usize> = (0..3 * triangles.len()).collect();
    fn find(leader: &mut [usize], mut c: usize) -> usize {
        while leader[c] != c {
            leader[c] = leader[leader[c]];
            c = leader[c];
        }
        c
    }
    let mut is_joined = vec![false; 3 * triangles.len()];
    for &e in joins {
        let [(s, i), (t, k)] = inner[e as usize].sides.map(|(t, k)| (local(t), k as usize));
        is_joined[3 * s + i] = true;
        is_joined[3 * t + k] = true;
        // They run opposite ways: the one's start is the other's end.
        for (a, b) in [(3 * s + i, 3 * t + (k + 1) % 3), (3 * s + (i + 1) % 3, 3 * t + k)] {
            let (a, b) = (find(&mut leader, a), find(&mut leader, b));
            leader[a.max(b)] = a.min(b);
        }
    }
    let mut number = vec![u32::MAX; leader.len()];
    let mut positions = Vec::new();
    for c in 0..leader.len() {
        let first = find(&mut leader, c);
        if first == c {
            number[c] = positions.len() as u32;
            let p = corners[triangles[c / 3] as usize][c % 3];
            positions.push(surface.mesh.positions[p as usize].as_dvec3());
        } else {
            number[c] = number[first];
        }
    }
    let mut next = vec![u32::MAX; positions.len()];
    let mut length = 0;
    let mut start = None;
    let mut sum = 0.0;
    for c in 0..leader.len() {
        let (a, b) = (number[c], number[c / 3 * 3 + (c + 1) % 3]);
        sum += positions[a as usize].distance(positions[b as usize]);
        if !is_joined[c] {
            // A point that the boundary passes twice: no disk.
            if std::mem::replace(&mut next[a as usize], b) != u32::MAX {
                return None;
            }
            length += 1;
            start.get_or_insert(a);
        }
    }
    let mut boundary = vec![start?];
    while let Some(&last) = boundary.last() {
        let following = next[last as usize];
        if following == boundary[0] || following == u32::MAX || boundary.len() > length {
            break;
        }
        boundary.push(following);
    }
    // Euler: points − edges + triangles of a disk are 1.
    let euler = positions.len() + triangles.len() == joins.len() + length + 1;
    let points = (0..triangles.len()).map(|t| [0, 1, 2].map(|k| number[3 * t + k])).collect();
    (euler && boundary.len() == length && length >= 3).then(|| Disk {
        triangles: triangles.to_vec(),
        points,
        positions,
        boundary,
        mean_edge: sum / leader.len() as f64,
    })
}
