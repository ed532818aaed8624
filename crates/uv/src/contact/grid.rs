//! A uniform grid over boxes, to find those near a place (spatial hashing with a
//! dense table: texture coordinates lie in a square, so cells need no hash).
//!
//! Contract: boxes are finite. A box lies in each cell that it touches; the cell size
//! adapts so that the table stays linear in the number of boxes. Answers come in an
//! order that depends on the boxes alone.

use glam::DVec2;

/// An axis-parallel box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub min: DVec2,
    pub max: DVec2,
}

impl Bounds {
    /// The box of two points, grown by `margin` to all sides.
    pub fn of(a: DVec2, b: DVec2, margin: f64) -> Self {
        Self { min: a.min(b) - margin, max: a.max(b) + margin }
    }

    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}

/// Boxes sorted into cells.
pub(super) struct Grid {
    boxes: Vec<Bounds>,
    origin: DVec2,
    cells_per_unit: f64,
    columns: usize,
    rows: usize,
    /// Where each cell's boxes begin in `items`.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Grid {
    /// Most entries and cells for each box, on average.
    const SHARE: f64 = 8.0;

    /// Sorts the boxes; at most 2²⁸ of them.
    pub fn new(boxes: Vec<Bounds>) -> Self {
        let all = boxes.iter().copied().reduce(Bounds::union);
        let all = all.unwrap_or(Bounds { min: DVec2::ZERO, max: DVec2::ZERO });
        let extent = all.max - all.min;
        let room = Self::SHARE * boxes.len() as f64 + 64.0;
        let mean =
            boxes.iter().map(|b| (b.max - b.min).max_element()).sum::<f64>() / boxes.len().max(1) as f64;
        let mut cell = mean.max(extent.max_element() * 1e-6);
        if cell <= 0.0 {
            cell = 1.0;
        }
        // Few large boxes among many small ones would fill the table: widen the cells.
        loop {
            let cells = ((extent / cell).floor() + 1.0).element_product();
            let entries: f64 =
                boxes.iter().map(|b| (((b.max - b.min) / cell).floor() + 2.0).element_product()).sum();
            if (cells <= room && entries <= room) || cell >= 2.0 * extent.max_element() {
                break;
            }
            cell *= 1.5;
        }
        let mut grid = Self {
            origin: all.min,
            cells_per_unit: 1.0 / cell,
            columns: (extent.x / cell) as usize + 1,
            rows: (extent.y / cell) as usize + 1,
            starts: Vec::new(),
            items: Vec::new(),
            boxes,
        };
        grid.fill();
        grid
    }

    /// Counting sort of the boxes by cell.
    fn fill(&mut self) {
        let mut starts = vec![0u32; self.columns * self.rows + 1];
        for b in &self.boxes {
            self.for_each_cell(b, |cell| starts[cell + 1] += 1);
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut items = vec![0u32; starts[starts.len() - 1] as usize];
        let mut next = starts.clone();
        for (i, b) in self.boxes.iter().enumerate() {
            self.for_each_cell(b, |cell| {
                items[next[cell] as usize] = i as u32;
                next[cell] += 1;
            });
        }
        (self.starts, self.items) = (starts, items);
    }

    /// The cell of a place, or the one nearest to it.
    #[inline]
    fn cell(&self, place: DVec2) -> (usize, usize) {
        // The cast saturates at zero.
        let at = (place - self.origin) * self.cells_per_unit;
        ((at.x as usize).min(self.columns - 1), (at.y as usize).min(self.rows - 1))
    }

    #[inline]
    fn for_each_cell(&self, bounds: &Bounds, mut visit: impl FnMut(usize)) {
        let ((left, top), (right, bottom)) = (self.cell(bounds.min), self.cell(bounds.max));
        for row in top..=bottom {
            for column in left..=right {
                visit(row * self.columns + column);
            }
        }
    }

    /// Calls `visit` once for each box that meets `query`.
    #[inline]
    pub fn for_each(&self, query: &Bounds, mut visit: impl FnMut(usize)) {
        self.for_each_cell(query, |cell| {
            for &item in &self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                let bounds = &self.boxes[item as usize];
                // Both lie in several cells: only the first one of their overlap tells.
                if bounds.meets(query) {
                    let (column, row) = self.cell(bounds.min.max(query.min));
                    if row * self.columns + column == cell {
                        visit(item as usize);
                    }
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = DVec2> {
        (-1.0f64..2.0, -1.0f64..2.0).prop_map(|(x, y)| dvec2(x, y))
    }

    proptest! {
        /// Protects completeness: the grid finds what comparing with every box finds,
        /// once each.
        #[test]
        fn finds_what_brute_force_finds(
            corners in proptest::collection::vec((place(), place(), 0.001f64..1.0), 0..40),
            query in (place(), place()),
        ) {
            let boxes: Vec<Bounds> =
                corners.iter().map(|&(a, b, scale)| Bounds::of(a, a + scale * (b - a), 0.0)).collect();
            let query = Bounds::of(query.0, query.1, 0.0);
            let mut found = Vec::new();
            Grid::new(boxes.clone()).for_each(&query, |i| found.push(i));
            found.sort_unstable();
            let expected: Vec<usize> = (0..boxes.len()).filter(|&i| boxes[i].meets(&query)).collect();
            prop_assert_eq!(found, expected);
        }
    }

    /// Protects inputs without extent: no box at all, and many in one place.
    #[test]
    fn boxes_without_extent() {
        let at = Bounds::of(dvec2(0.5, 0.5), dvec2(0.5, 0.5), 0.0);
        let mut count = 0;
        Grid::new(Vec::new()).for_each(&at, |_| count += 1);
        assert_eq!(count, 0);
        Grid::new(vec![at; 100]).for_each(&at, |_| count += 1);
        assert_eq!(count, 100);
    }
}
