//! The boundary of a layout as contact sees it: vertices, edges, and which of them
//! belong together.
//!
//! Charts that share a point (a bow tie) have no room between them and count as one;
//! elsewhere each chart is a group by itself.

use glam::DVec2;
use parbake_atlas::Layout;

/// Boundary vertices and edges.
#[derive(Clone, Debug)]
pub(super) struct Boundary {
    /// Indices of the points on the boundary, ascending.
    pub vertices: Vec<u32>,
    /// The group of each of these vertices.
    pub vertex_groups: Vec<u32>,
    /// The two points of each edge; the chart lies to the left.
    pub edges: Vec<[u32; 2]>,
    /// The group of each edge.
    pub edge_groups: Vec<u32>,
}

impl Boundary {
    pub fn new(layout: &Layout) -> Self {
        let boundary = layout.boundary();
        let edges: Vec<[u32; 2]> = boundary.iter().map(|e| e.points).filter(|[a, b]| a != b).collect();
        let mut vertices: Vec<u32> = edges.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();

        let count = layout.charts.iter().max().map_or(0, |&last| last as usize + 1);
        let mut leaders: Vec<u32> = (0..count as u32).collect();
        let mut chart_of_point = vec![u32::MAX; layout.points.len()];
        for (corners, &chart) in layout.triangles.iter().zip(&layout.charts) {
            for &point in corners {
                let first = &mut chart_of_point[point as usize];
                if *first == u32::MAX {
                    *first = chart;
                } else {
                    let (a, b) = (leader(&mut leaders, *first), leader(&mut leaders, chart));
                    leaders[a.max(b) as usize] = a.min(b);
                }
            }
        }
        let mut group = |point: u32| leader(&mut leaders, chart_of_point[point as usize]);
        Self {
            vertex_groups: vertices.iter().map(|&v| group(v)).collect(),
            edge_groups: edges.iter().map(|e| group(e[0])).collect(),
            vertices,
            edges,
        }
    }

    /// Where an edge's ends are.
    #[inline]
    pub fn ends(&self, edge: usize, points: &[DVec2]) -> [DVec2; 2] {
        self.edges[edge].map(|i| points[i as usize])
    }
}

/// The smallest member of a chart's group (union-find with path halving).
fn leader(leaders: &mut [u32], mut chart: u32) -> u32 {
    while leaders[chart as usize] != chart {
        let next = leaders[leaders[chart as usize] as usize];
        leaders[chart as usize] = next;
        chart = next;
    }
    chart
}
