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

    /// The same with so much more on each side.
    pub fn grown(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
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

    /// Protects boxes: around points, around boxes, what overlaps (not what touches),
    /// and distances beside and across.
    #[test]
    fn boxes_have_insides_and_distances() {
        let of = |low: [f64; 2], high: [f64; 2]| Bounds { low: low.into(), high: high.into() };
        let one = Bounds::of(&[dvec2(1.0, 5.0), dvec2(3.0, 2.0), dvec2(2.0, 4.0)]);
        assert_eq!((one.low, one.high), (dvec2(1.0, 2.0), dvec2(3.0, 5.0)));
        let both = one.with(of([2.0, -1.0], [7.0, 3.0]));
        assert_eq!((both.low, both.high), (dvec2(1.0, -1.0), dvec2(7.0, 5.0)));
        let cases = [
            (of([2.0, 3.0], [2.5, 3.5]), true, 0.0),
            (of([0.0, 0.0], [9.0, 9.0]), true, 0.0),
            (of([2.0, 3.0], [2.0, 3.0]), true, 0.0),
            (of([3.0, 3.0], [4.0, 4.0]), false, 0.0),
            (of([0.0, 3.0], [1.0, 4.0]), false, 0.0),
            (of([2.0, 5.0], [2.5, 6.0]), false, 0.0),
            (of([2.0, 0.0], [2.5, 2.0]), false, 0.0),
            (of([5.5, 3.0], [6.0, 4.0]), false, 6.25),
            (of([-2.0, 3.0], [-1.0, 4.0]), false, 4.0),
            (of([2.0, 8.0], [2.5, 9.0]), false, 9.0),
            (of([2.0, -1.0], [2.5, 0.5]), false, 2.25),
            (of([6.0, 9.0], [7.0, 10.0]), false, 25.0),
            (of([-4.0, -10.0], [-3.0, -1.0]), false, 25.0),
        ];
        for (other, overlaps, squared) in cases {
            assert_eq!((one.overlaps(&other), other.overlaps(&one)), (overlaps, overlaps), "{other:?}");
            assert_eq!(one.squared_distance(&other), squared, "{other:?}");
            assert_eq!(other.squared_distance(&one), squared, "{other:?}");
        }
    }

    /// The items of a tree's leaves, in the tree's order.
    fn leaves(tree: &BoxTree) -> Vec<Vec<u32>> {
        let holds_items = |n: &&Node| n.count > 0;
        let items = |n: &Node| {
            let first = n.next as usize;
            let mut items: Vec<u32> =
                tree.items[first..first + n.count as usize].iter().map(|i| i.index).collect();
            items.sort_unstable();
            items
        };
        tree.nodes.iter().filter(holds_items).map(items).collect()
    }

    /// Protects the shape of the tree, on which its speed rests: halves at the median of
    /// the centres along the side on which these reach farther, whatever the boxes'
    /// sizes and wherever they lie; indices decide among equal ones; leaves of four.
    #[test]
    fn items_are_halved_along_the_longer_side() {
        // Centres -8 to 7, boxes up to 1,800 high and of many widths, far off the axis.
        let item = |i: u32| {
            let centre = dvec2(f64::from(i) - 8.0, 1_000.0);
            let half = dvec2(f64::from(i * 7 % 16) * 3.0, f64::from(i * 5 % 16) * 60.0);
            Bounds { low: centre - half, high: centre + half }
        };
        let turned = |b: Bounds| Bounds { low: dvec2(b.low.y, b.low.x), high: dvec2(b.high.y, b.high.x) };
        let want: Vec<Vec<u32>> = (0..4).map(|k| (4 * k..4 * k + 4).collect()).collect();
        // Not in order to begin with, and known by their places.
        let order = |i: u32| i * 11 % 16;
        let named = |tree: &BoxTree| -> Vec<Vec<u32>> {
            let mut named = leaves(tree);
            for leaf in &mut named {
                leaf.iter_mut().for_each(|i| *i = order(*i));
                leaf.sort_unstable();
            }
            named
        };
        let row = BoxTree::new((0..16).map(|i| (item(order(i)), 0)));
        let column = BoxTree::new((0..16).map(|i| (turned(item(order(i))), 0)));
        assert_eq!((named(&row), named(&column)), (want.clone(), want));
        assert_eq!(row.nodes.len(), 7);
        // As wide as high: along x.
        let point = |i: u32| {
            let p = dvec2(f64::from(i % 3), f64::from(i / 3));
            (Bounds { low: p, high: p }, 0)
        };
        let square = BoxTree::new((0..9).map(point));
        assert_eq!(leaves(&square)[0], [0, 1, 3, 6]);
        assert_eq!(leaves(&BoxTree::new((0..5).map(point))), [vec![0, 3], vec![1, 2, 4]]);
    }

    /// Protects what nodes say of the items below them.
    #[test]
    fn nodes_know_boxes_and_groups_below_them() {
        let tree = BoxTree::new((0..16).map(|i| {
            let low = dvec2(2.0 * f64::from(i), 0.0);
            (Bounds { low, high: low + 1.0 }, u32::from(i >= 8) * 5)
        }));
        let nodes: Vec<_> = tree.nodes.iter().map(|n| (n.bounds.low.x, n.bounds.high.x, n.group)).collect();
        assert_eq!(
            nodes,
            [
                (0.0, 31.0, MIXED),
                (0.0, 15.0, 0),
                (0.0, 7.0, 0),
                (8.0, 15.0, 0),
                (16.0, 31.0, 5),
                (16.0, 23.0, 5),
                (24.0, 31.0, 5),
            ]
        );
    }

    /// Protects the end of a search: how many looks it takes, and the lower bound that
    /// it says where it was cut short. Items are said to be farther than their boxes, so
    /// that nodes nearer than these have to be looked at.
    #[test]
    fn a_search_cut_short_says_how_near_the_rest_may_be() {
        let tree = row(16);
        let place = Bounds { low: dvec2(18.0, 0.0), high: dvec2(19.0, 1.0) };
        let search = |max_looks| {
            let near = tree.nearest(&place, 9, max_looks, |i| if i < 8 { 29.0 } else { 30.0 }).unwrap();
            (near.squared, near.item / 4, near.exact)
        };
        // The root, the second half and its first leaf: 1 + 1 + 5, not to be cut short as
        // nothing would be known. Then the leaf beside (25 off), 5 looks more; the first
        // half (9 off), 1; its second leaf, 5, with what is nearest; its first one is too
        // far off.
        for max_looks in [0, 7, 11, 12] {
            assert_eq!(search(max_looks), (9.0, 2, false), "{max_looks}");
        }
        assert_eq!(search(17), (9.0, 2, false));
        assert_eq!(search(18), (29.0, 1, true));
        // The nearest node that is left need not be the last one, nor the first one.
        let near = tree.nearest(&place, 9, 11, |_| 7.0).unwrap();
        assert_eq!((near.squared, near.exact), (7.0, true));
        let near = tree.nearest(&place, 9, 11, |_| 26.0).unwrap();
        assert_eq!((near.squared, near.exact), (9.0, false));
    }

    /// Protects the order of a search: nodes of the own group cost nothing, nor do those
    /// that are no nearer than what was found; among equals the first one stays.
    #[test]
    fn a_search_skips_what_cannot_be_nearer() {
        let count = std::cell::Cell::new(0);
        let search = |tree: &BoxTree, low: f64, group: u32, max_looks: usize, squared: f64| {
            count.set(0);
            let place = Bounds { low: dvec2(low, 0.0), high: dvec2(low + 1.0, 1.0) };
            let near = tree.nearest(&place, group, max_looks, |_| {
                count.set(count.get() + 1);
                squared
            });
            near.map(|near| (near.item, near.exact))
        };
        // Two leaves, each of a group of its own: 1 look at the root, 5 at the second.
        let two = BoxTree::new((0..8).map(|i| {
            let low = dvec2(2.0 * f64::from(i), 0.0);
            (Bounds { low, high: low + 1.0 }, u32::from(i >= 4))
        }));
        assert!(search(&two, 0.0, 0, 0, 1e6).is_some_and(|(item, exact)| item >= 4 && exact));
        assert_eq!(count.get(), 4);
        // The other leaf is 1 off: no nearer than 1, nearer than 1.5.
        assert!(search(&two, 6.0, 2, 100, 1.0).is_some_and(|(item, exact)| item < 4 && exact));
        assert_eq!(count.get(), 4);
        assert!(search(&two, 6.0, 2, 100, 1.5).is_some_and(|(item, exact)| item < 4 && exact));
        assert_eq!(count.get(), 8);
        // As near as each other: the first half first. Nearer: the second half first.
        assert!(search(&two, 6.5, 2, 100, 1e6).is_some_and(|(item, _)| item < 4));
        let between = Bounds { low: dvec2(7.25, 0.0), high: dvec2(7.75, 1.0) };
        let near = two.nearest(&between, 2, 100, |_| 1e6).unwrap();
        assert!(near.item < 4);
        let near = two.nearest(&Bounds { low: dvec2(7.5, 0.0), ..between }, 2, 100, |_| 1e6).unwrap();
        assert!(near.item >= 4);
        // Within a leaf the first of equals stays, and a nearer one takes its place.
        let one = BoxTree::new((0..3).map(|i| (Bounds { low: DVec2::ZERO, high: DVec2::ONE }, i)));
        assert_eq!(search(&one, 0.0, 7, 100, 2.0), Some((0, true)));
        let near = one.nearest(&between, 7, 100, |i| 3.0 - f64::from(i)).unwrap();
        assert_eq!(near, Nearest { squared: 1.0, item: 2, exact: true });
    }

    /// Protects the end of a search that its visitor breaks.
    #[test]
    fn visitors_may_end_a_search() {
        let tree = row(100);
        let all = Bounds { low: DVec2::ZERO, high: dvec2(1_000.0, 1.0) };
        let mut seen = 0;
        tree.overlapping(&all, |_| {
            seen += 1;
            if seen == 7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(seen, 7);
    }

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
