//! The square while it fills: which cells are taken, and where a mask still fits.
//!
//! For each row and power of two 2^k a bit says whether any of the 2^k cells from there
//! on is taken (a sparse table). Whether a run of any length is free then takes two
//! look-ups for 64 places at a time, so that all columns of a row are tried at once.

use super::mask::{Mask, next_bit, set_range};

/// Square grid of cells.
pub(super) struct Board {
    size: usize,
    words: usize,
    /// `levels[k][row * words ..]`: bit x = any of x .. x + 2^k is taken.
    levels: Vec<Vec<u64>>,
    /// The longest free run of each row.
    longest_free: Vec<usize>,
}

/// How places are compared; lower is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Preference {
    /// The lowest top, then the leftmost.
    Bottom,
    /// The smallest square around the corner.
    Corner,
    /// The lowest centre, then the leftmost.
    Centre,
}

/// A place that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub x: usize,
    pub y: usize,
    /// The lower the better.
    pub cost: (usize, usize),
}

impl Board {
    pub fn new(size: usize) -> Self {
        // A spare word at the end, so that `first_free` reads the next word without a check.
        let words = size / 64 + 2;
        let levels = vec![vec![0; words * size]; size.max(1).ilog2() as usize + 1];
        Self { size, words, levels, longest_free: vec![size; size] }
    }

    /// The best place for a mask whose cost is below `limit`.
    pub fn find(&self, mask: &Mask, preference: Preference, limit: (usize, usize)) -> Option<Place> {
        if mask.width > self.size || mask.height > self.size {
            return None;
        }
        let mut best: Option<Place> = None;
        let mut bound = limit;
        let columns = self.size - mask.width + 1;
        let mut free = vec![0u64; columns.div_ceil(64)];
        let mut order: Vec<u32> = (0..mask.runs.len() as u32).collect();
        for y in 0..=self.size - mask.height {
            let lowest = cost(preference, 0, y, mask);
            if lowest >= bound {
                // Costs grow with y in the first place.
                break;
            }
            // Further to the right the cost is above the bound.
            let columns = match preference {
                Preference::Corner => columns.min((bound.0 - mask.width).saturating_add(1)),
                Preference::Bottom | Preference::Centre => columns,
            };
            if let Some(x) = self.first_free(mask, y, columns, &mut free, &mut order) {
                let found = cost(preference, x, y, mask);
                if found < bound {
                    bound = found;
                    best = Some(Place { x, y, cost: found });
                }
            }
        }
        best
    }

    /// Whether a mask fits with its column 0 of row 0 at `x` and `y`, all of it on the board.
    pub fn is_free(&self, mask: &Mask, x: i32, y: i32) -> bool {
        let fits = |at: i32, length: usize| at >= 0 && at as usize + length <= self.size;
        fits(x, mask.width)
            && fits(y, mask.height)
            && mask.runs.iter().all(|run| {
                let level = run.length.ilog2() as usize;
                let row = (y as usize + run.row) * self.words;
                let words = &self.levels[level][row..row + self.words];
                let is_taken = |at: usize| words[at / 64] >> (at % 64) & 1 == 1;
                let start = x as usize + run.start;
                !is_taken(start) && !is_taken(start + run.length - (1 << level))
            })
    }

    /// The leftmost of the first `columns` at which the mask fits in row `y`. Runs are tried in the `order` given; the one that
    /// leaves no column comes first from then on, since it meets the same obstacle in the next row.
    fn first_free(
        &self,
        mask: &Mask,
        y: usize,
        columns: usize,
        free: &mut [u64],
        order: &mut [u32],
    ) -> Option<usize> {
        // Most rows are ruled out by the longest runs alone.
        if mask.runs.iter().take(32).any(|run| self.longest_free[y + run.row] < run.length) {
            return None;
        }
        free.fill(0);
        set_range(free, 0, columns);
        let (mut first, mut last) = (0, (columns - 1) / 64);
        for place in 0..order.len() {
            let run = &mask.runs[order[place] as usize];
            let level = run.length.ilog2() as usize;
            let row = (y + run.row) * self.words;
            let taken = &self.levels[level][row..row + self.words];
            let (near, far) = (run.start, run.start + run.length - (1 << level));
            let free_words = &mut free[first..=last];
            let [near_words, far_words] =
                [near, far].map(|by| &taken[first + by / 64..first + by / 64 + free_words.len() + 1]);
            for (index, word) in free_words.iter_mut().enumerate() {
                let taken = |words: &[u64], by: usize| {
                    words[index] >> (by % 64) | words[index + 1] << 1 << (63 - by % 64)
                };
                *word &= !(taken(near_words, near) | taken(far_words, far));
            }
            while free[first] == 0 {
                if first == last {
                    order[..=place].rotate_right(1);
                    return None;
                }
                first += 1;
            }
            while free[last] == 0 {
                last -= 1;
            }
        }
        next_bit(free, 0, true)
    }

    /// Takes a mask's cells; `x` and `y` are where its column 0 of row 0 stands, which
    /// may be outside, as may some of its cells.
    pub fn take(&mut self, mask: &Mask, x: i32, y: i32) {
        let (mut low, mut high) = (self.size, 0);
        for run in &mask.runs {
            let row = y + run.row as i32;
            let start = (x + run.start as i32).max(0);
            let end = (x + (run.start + run.length) as i32).min(self.size as i32);
            if row >= 0 && (row as usize) < self.size && start < end {
                let row = row as usize;
                set_range(
                    &mut self.levels[0][row * self.words..][..self.words],
                    start as usize,
                    end as usize,
                );
                (low, high) = (low.min(row), high.max(row + 1));
            }
        }
        for row in low..high {
            self.refresh(row);
        }
    }

    /// Brings a row's sparse table and its longest free run up to date.
    fn refresh(&mut self, row: usize) {
        let range = row * self.words..(row + 1) * self.words;
        for level in 1..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(level);
            let (source, target) = (&below[level - 1][range.clone()], &mut above[0][range.clone()]);
            for (index, word) in target.iter_mut().enumerate() {
                *word = source[index] | shifted(source, index, 1 << (level - 1));
            }
        }
        let words = &self.levels[0][range];
        let (mut longest, mut column) = (0, 0);
        while let Some(start) = next_bit(words, column, false).filter(|&start| start < self.size) {
            let end = next_bit(words, start, true).unwrap_or(self.size).min(self.size);
            longest = longest.max(end - start);
            column = end;
        }
        self.longest_free[row] = longest;
    }
}

fn cost(preference: Preference, x: usize, y: usize, mask: &Mask) -> (usize, usize) {
    match preference {
        Preference::Bottom => (y + mask.height, x),
        Preference::Corner => ((y + mask.height).max(x + mask.width), y + x),
        Preference::Centre => (2 * y + mask.height, x),
    }
}

/// Word `index` of a row moved down by `by` bits.
#[inline]
fn shifted(row: &[u64], index: usize, by: usize) -> u64 {
    let (whole, part) = (index + by / 64, by % 64);
    let low = row.get(whole).copied().unwrap_or(0) >> part;
    if part == 0 { low } else { low | row.get(whole + 1).copied().unwrap_or(0) << (64 - part) }
}

#[cfg(test)]
mod tests {
    use super::super::mask::Shape;
    use super::*;
    use glam::dvec2;

    fn rectangle(width: f64, height: f64, reach: f64) -> Mask {
        let points = [dvec2(0.0, 0.0), dvec2(width, 0.0), dvec2(width, height), dvec2(0.0, height)];
        let outline = [[0, 1], [1, 2], [2, 3], [3, 0]];
        Mask::new(&Shape { points: &points, triangles: &[[0, 1, 2], [0, 2, 3]], outline: &outline }, reach)
    }

    /// Protects the search: the place is the best one by trying all cells.
    #[test]
    fn finds_the_best_place_that_is_free() {
        let size = 150;
        for preference in [Preference::Bottom, Preference::Corner, Preference::Centre] {
            let mut board = Board::new(size);
            let mut taken = vec![false; size * size];
            let mut state = 7u32;
            for _ in 0..60 {
                state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                let (w, h) = (1 + (state >> 8) as usize % 40, 1 + (state >> 20) as usize % 40);
                let mask = rectangle(w as f64, h as f64, 0.0);
                assert_eq!((mask.width, mask.height), (w, h));
                let fits = |x: usize, y: usize| (y..y + h).all(|r| (x..x + w).all(|c| !taken[r * size + c]));
                let places = (0..=size - h).flat_map(|y| (0..=size - w).map(move |x| (x, y)));
                let wanted =
                    places.filter(|&(x, y)| fits(x, y)).min_by_key(|&(x, y)| cost(preference, x, y, &mask));
                let find = |limit| board.find(&mask, preference, limit).map(|p| (p.x, p.y));
                assert_eq!(find((usize::MAX, 0)), wanted);
                if let Some((x, y)) = wanted {
                    let least = cost(preference, x, y, &mask);
                    assert_eq!((find(least), find((least.0, least.1 + 1))), (None, wanted));
                    board.take(&mask, x as i32, y as i32);
                    for r in y..y + h {
                        taken[r * size + x..r * size + x + w].fill(true);
                    }
                }
            }
        }
    }

    /// Protects cells beyond the square's border, which gutters reach.
    #[test]
    fn gutters_may_reach_beyond_the_square() {
        let mut board = Board::new(64);
        let grown = rectangle(64.0, 10.0, 3.0);
        board.take(&grown, grown.origin.x, grown.origin.y);
        let place = board.find(&rectangle(1.0, 1.0, 0.0), Preference::Bottom, (usize::MAX, 0));
        // A cell that the gutter only touches counts as within reach of it.
        assert_eq!(place.map(|p| (p.x, p.y)), Some((0, 13)));
    }
}
