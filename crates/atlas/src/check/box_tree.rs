//! A tree of boxes that finds what lies at a place and what lies nearest to it.
//!
//! Items are halved at the median of their centres along the longer side, so the
//! depth is the logarithm of their number whatever their places and sizes: no input
//! makes the tree itself large or slow. Each node knows whether all its items belong
//! to one group, so that a search for another group's items skips it.

use glam::DVec2;
use std::ops::ControlFlow;

/// Items in a leaf at most.
const LEAF: usize = 4;
/// More than the depth of a tree over 2³² items.
const STACK: usize = 64;
/// The group of a node whose items belong to several.
const MIXED: u32 = u32::MAX;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The smallest coordinates.
    pub low: DVec2,
    /// The largest coordinates.
    pub high: DVec2,
}

impl Bounds {
    /// The box around points, of which there is at least one.
    pub fn of(points: &[DVec2]) -> Self {
        let none = Self { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };
        points.iter().fold(none, |b, &p| Self { low: b.low.min(p), high: b.high.max(p) })
    }

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.low.cmplt(other.high).all() && other.low.cmplt(self.high).all()
    }

    fn squared_distance(&self, other: &Self) -> f64 {
        (other.low - self.high).max(self.low - other.high).max(DVec2::ZERO).length_squared()
    }
}

/// The tree; items are known by their place in what it was built from.
pub struct BoxTree {
    nodes: Vec<Node>,
    items: Vec<Item>,
}

/// The result of a search for the nearest item.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Its squared distance, or a lower bound of it.
    pub squared: f64,
    /// The nearest item, or the nearest one seen.
    pub item: u32,
    /// Whether the search came to its end.
    pub exact: bool,
}

#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    index: u32,
    group: u32,
}

/// A node's first child comes right after it.
struct Node {
    bounds: Bounds,
    /// The second child of an inner node, the first item of a leaf.
    next: u32,
    /// Items of a leaf, 0 for an inner node.
    count: u32,
    group: u32,
}

impl BoxTree {
    /// A tree over boxes with finite coordinates, each with its group (below
    /// `u32::MAX`). There may be none.
    pub fn new(items: impl Iterator<Item = (Bounds, u32)>) -> Self {
        let items = items.zip(0..).map(|((bounds, group), index)| Item { bounds, index, group }).collect();
        let mut tree = Self { nodes: Vec::new(), items };
        if !tree.items.is_empty() {
            tree.build(0, tree.items.len());
        }
        tree
    }

    fn build(&mut self, first: usize, end: usize) {
        let items = &mut self.items[first..end];
        let mut bounds = items[0].bounds;
        let mut centres = Bounds { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };
        let mut group = items[0].group;
        for item in &*items {
            bounds = bounds.with(item.bounds);
            let centre = item.bounds.low + item.bounds.high;
            centres = centres.with(Bounds { low: centre, high: centre });
            group = if item.group == group { group } else { MIXED };
        }
        let node = self.nodes.len();
        if items.len() <= LEAF {
            self.nodes.push(Node { bounds, next: first as u32, count: items.len() as u32, group });
            return;
        }
        let extent = centres.high - centres.low;
        let axis = usize::from(extent.y > extent.x);
        let key = |item: &Item| item.bounds.low[axis] + item.bounds.high[axis];
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.index.cmp(&b.index)));
        self.nodes.push(Node { bounds, next: 0, count: 0, group });
        self.build(first, first + half);
        self.nodes[node].next = self.nodes.len() as u32;
        self.build(first + half, end);
    }

    /// Shows all items whose boxes have inner points in common with a box, which may be
    /// a point, until `visit` breaks. The order depends on the items alone.
    pub fn overlapping(&self, bounds: &Bounds, mut visit: impl FnMut(u32) -> ControlFlow<()>) {
        let mut stack = [0; STACK];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let index = stack[height];
            let node = &self.nodes[index as usize];
            if !node.bounds.overlaps(bounds) {
                continue;
            }
            if node.count == 0 {
                stack[height] = node.next;
                stack[height + 1] = index + 1;
                height += 2;
                continue;
            }
            for item in &self.items[node.next as usize..(node.next + node.count) as usize] {
                if item.bounds.overlaps(bounds) && visit(item.index).is_break() {
                    return;
                }
            }
        }
    }

    /// The smallest squared distance to an item of another group, and that item;
    /// `None` where there is none.
    ///
    /// `squared_distance` of an item must not be below that of its box. After
    /// `max_looks` looks at nodes and items the search ends without being exact.
    pub fn nearest(
        &self,
        bounds: &Bounds,
        group: u32,
        max_looks: usize,
        squared_distance: impl Fn(u32) -> f64,
    ) -> Option<Nearest> {
        let mut stack = [(0, 0.0); STACK];
        let mut height = usize::from(!self.nodes.is_empty());
        let mut best: Option<Nearest> = None;
        let mut looks = 0;
        while height > 0 {
            height -= 1;
            let (index, from) = stack[height];
            let node = &self.nodes[index as usize];
            if node.group == group || best.is_some_and(|best| best.squared <= from) {
                continue;
            }
            looks += 1 + node.count as usize;
            if looks > max_looks
                && let Some(best) = best
            {
                let left = stack[..=height].iter().map(|s| s.1).fold(best.squared, f64::min);
                return Some(Nearest { squared: left, exact: false, ..best });
            }
            if node.count == 0 {
                let child = |i: u32| (i, self.nodes[i as usize].bounds.squared_distance(bounds));
                let (one, two) = (child(index + 1), child(node.next));
                let (near, far) = if two.1 < one.1 { (two, one) } else { (one, two) };
                stack[height] = far;
                stack[height + 1] = near;
                height += 2;
                continue;
            }
            for item in &self.items[node.next as usize..(node.next + node.count) as usize] {
                if item.group != group {
                    let distance = squared_distance(item.index);
                    if best.is_none_or(|best| distance < best.squared) {
                        best = Some(Nearest { squared: distance, item: item.index, exact: true });
                    }
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// A row of unit boxes two apart, each its own group.
    fn row(count: u32) -> BoxTree {
        BoxTree::new((0..count).map(|i| {
            let low = dvec2(2.0 * f64::from(i), 0.0);
            (Bounds { low, high: low + 1.0 }, i)
        }))
    }

    fn found(tree: &BoxTree, low: DVec2, high: DVec2) -> Vec<u32> {
        let mut found = Vec::new();
        tree.overlapping(&Bounds { low, high }, |i| {
            found.push(i);
            ControlFlow::Continue(())
        });
        found.sort_unstable();
        found
    }

    /// Protects searches in trees of no, few and many items; what touches is left out.
    #[test]
    fn what_overlaps_a_box_is_found() {
        assert!(found(&row(0), DVec2::ZERO, DVec2::ONE).is_empty());
        assert_eq!(found(&row(1), DVec2::splat(0.9), DVec2::splat(3.0)), [0]);
        assert_eq!(found(&row(100), dvec2(11.0, 0.5), dvec2(16.0, 0.6)), [6, 7]);
        assert!(found(&row(100), dvec2(11.1, 0.5), dvec2(11.9, 0.6)).is_empty());
    }

    /// Protects the nearest item, the exclusion of the own group, and the promise
    /// that a search cut short never returns too large a distance.
    #[test]
    fn the_nearest_of_another_group_is_found() {
        let tree = row(100);
        let low = dvec2(20.0, 0.0);
        let place = Bounds { low, high: low + 1.0 };
        let distance = |i: u32| (2.0 * f64::from(i) - 20.0).abs().max(1.0) - 1.0;
        let squared = |i: u32| distance(i).powi(2);
        assert_eq!(
            tree.nearest(&place, 99, usize::MAX, squared),
            Some(Nearest { squared: 0.0, item: 10, exact: true })
        );
        let nearest = tree.nearest(&place, 10, usize::MAX, squared).unwrap();
        assert!(nearest.exact && nearest.squared == 1.0 && [9, 11].contains(&nearest.item));
        for max_looks in 0..100 {
            let nearest = tree.nearest(&place, 10, max_looks, squared).unwrap();
            assert!(if nearest.exact { nearest.squared == 1.0 } else { nearest.squared <= 1.0 });
        }
        assert_eq!(row(1).nearest(&place, 0, usize::MAX, squared), None);
        assert_eq!(row(0).nearest(&place, 0, usize::MAX, squared), None);
    }
}
