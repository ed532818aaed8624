//! Meshes whose triangles repeat, as grids do, cut into runs of triangles that share their
//! indices: each run has vertices of its own, numbered as its triangles come to them, so that
//! runs of the same connectivity have the same indices, in two bytes, which are written once.
//!
//! A grid of 400 × 400 cells takes 120 kB of indices this way in place of 3.8 MB. Vertices
//! that two runs touch are written twice.

use super::binary::SHORT;
use parbake_model::Mesh;

/// Runs that a mesh may have: each is a call to the graphics card.
const MOST: usize = 16;

/// A mesh is cut only where its vertices and indices then take at most this share of the bytes.
const WORTH: f64 = 0.75;

/// Triangles in a row of one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    /// For each of the run's vertices the mesh's.
    pub vertices: Vec<u32>,
    /// The run's triangles, on its vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// The mesh in runs of as many triangles each, where they repeat and that makes it smaller by a
/// quarter; a vertex takes `stride` bytes. None elsewhere, and for meshes of several materials.
pub fn runs(mesh: &Mesh, stride: usize) -> Option<Vec<Run>> {
    if mesh.triangle_materials.windows(2).any(|m| m[0] != m[1]) {
        return None;
    }
    let count = mesh.positions.len();
    let whole = count * stride + mesh.triangles.len() * if count <= SHORT { 6 } else { 12 };
    let cuts = (2..=MOST).filter(|pieces| mesh.triangles.len().is_multiple_of(*pieces));
    let repeating =
        cuts.map(|pieces| cut(mesh, pieces)).filter(|runs| runs[0].triangles == runs[1].triangles);
    let best = repeating.min_by_key(|runs| bytes(runs, stride))?;
    (bytes(&best, stride) as f64 <= WORTH * whole as f64).then_some(best)
}

fn cut(mesh: &Mesh, pieces: usize) -> Vec<Run> {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; mesh.positions.len()];
    let run = |triangles: &[[u32; 3]]| {
        let mut vertices = Vec::new();
        let mut number = |vertex: u32| {
            let number = &mut numbers[vertex as usize];
            if *number == NONE {
                *number = vertices.len() as u32;
                vertices.push(vertex);
            }
            *number
        };
        let triangles = triangles.iter().map(|t| t.map(&mut number)).collect();
        for &vertex in &vertices {
            numbers[vertex as usize] = NONE;
        }
        Run { vertices, triangles }
    };
    mesh.triangles.chunks(mesh.triangles.len() / pieces).map(run).collect()
}

/// Bytes of vertices and of indices that no run before has.
fn bytes(runs: &[Run], stride: usize) -> usize {
    let indices = |i: usize| match &runs[i] {
        run if runs[..i].iter().any(|before| before.triangles == run.triangles) => 0,
        run if run.vertices.len() <= SHORT => 6 * run.triangles.len(),
        run => 12 * run.triangles.len(),
    };
    (0..runs.len()).map(|i| runs[i].vertices.len() * stride + indices(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec3;

    /// A grid of so many cells, row by row.
    fn grid(columns: u32, rows: u32) -> Mesh {
        let at = |i, j| j * (columns + 1) + i;
        let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        let triangles: Vec<[u32; 3]> = cells
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        Mesh {
            positions: vec![Vec3::ZERO; (at(columns, rows) + 1) as usize],
            triangle_materials: vec![0; triangles.len()],
            triangles,
            ..Mesh::default()
        }
    }

    /// Protects the smaller file: rows of a grid have the same indices, and name the grid's vertices.
    #[test]
    fn rows_of_a_grid_share_their_indices() {
        let mesh = grid(40, 30);
        let runs = runs(&mesh, 16).expect("a grid repeats");
        assert!(runs.len() > 1 && runs.len() <= MOST && 30 % runs.len() == 0);
        assert!(runs.iter().all(|run| run.triangles == runs[0].triangles));
        let named =
            runs.iter().flat_map(|run| run.triangles.iter().map(|t| t.map(|v| run.vertices[v as usize])));
        assert!(named.eq(mesh.triangles.iter().copied()));
    }

    /// Protects ordinary models: what does not repeat, is small or has several materials stays whole.
    #[test]
    fn ordinary_meshes_stay_whole() {
        let mut fan = grid(40, 30);
        fan.triangles = (0..1000).map(|i| [0, i * 7 % 1200 + 1, i * 11 % 1200 + 1]).collect();
        fan.triangle_materials = vec![0; 1000];
        assert_eq!(runs(&fan, 32), None);
        assert_eq!(runs(&grid(1, 1), 20), None);
        let mut two = grid(40, 30);
        two.triangle_materials[7] = 1;
        assert_eq!(runs(&two, 16), None);
    }
}
