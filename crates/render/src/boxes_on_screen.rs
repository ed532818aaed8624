//! Boxes on the screen of a camera, four at a time: which samples they may cover, and how near they are.
//!
//! A box's extent along an axis of the camera is |axis| · half extents about its centre; seen in perspective, its
//! sides go where depth brings them farthest out. All is in single precision, and boxes are taken a
//! little too large.
//!
//! Contract: a triangle in a box covers no sample but the box's, and is no nearer.

use crate::camera::{Camera, Projection};
use crate::raster::{NEAR, Visibility};
use parbake_model::glam::{Vec3, Vec4};

/// Boxes that are looked at together.
pub(crate) const FAN: usize = 4;

/// Boxes over more samples than this are not compared with what is seen already.
const MOST_COMPARED: usize = 64;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub min: Vec3,
    pub max: Vec3,
}

impl Bounds {
    /// One that holds nothing.
    pub const NONE: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    pub fn of_corners(corners: &[Vec3; 3]) -> Self {
        let [a, b, c] = *corners;
        Self { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    /// A box around all.
    pub fn around(all: impl Iterator<Item = Bounds>) -> Self {
        all.fold(Self::NONE, Self::and)
    }

    /// A box around both.
    pub fn and(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

/// Four boxes: each axis has its lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boxes {
    min: [Vec4; 3],
    max: [Vec4; 3],
}

impl Boxes {
    /// At most four; lanes without a box are never seen.
    pub fn new(few: &[Bounds]) -> Self {
        let lanes = |of: &dyn Fn(&Bounds) -> f32| {
            Vec4::from_array(std::array::from_fn(|lane| few.get(lane).map_or(f32::NAN, of)))
        };
        let axes =
            |of: &dyn Fn(&Bounds) -> Vec3| std::array::from_fn(|axis| lanes(&|bounds| of(bounds)[axis]));
        Self { min: axes(&|bounds| bounds.min), max: axes(&|bounds| bounds.max) }
    }
}

/// Four triangles: each axis of each corner has its lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangles {
    corners: [[Vec4; 3]; 3],
}

impl Triangles {
    /// At most four; lanes without a triangle hold what is not a number.
    pub fn new(few: impl Iterator<Item = [Vec3; 3]>) -> Self {
        let mut corners = [[Vec4::NAN; 3]; 3];
        for (lane, triangle) in few.take(FAN).enumerate() {
            for (corner, place) in corners.iter_mut().zip(triangle) {
                for axis in 0..3 {
                    corner[axis][lane] = place[axis];
                }
            }
        }
        Self { corners }
    }

    /// The corners of a lane.
    pub fn corners(&self, lane: usize) -> [Vec3; 3] {
        self.corners.map(|corner| Vec3::from_array(corner.map(|axis| axis[lane])))
    }
}

/// A box of a tree on the screen.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Node {
    /// Its level in the tree: 0 is that of leaves.
    pub level: u32,
    /// Its place in the level.
    pub index: u32,
    /// Samples that it may cover: first and last column, first and last row.
    samples: [u16; 4],
    /// Nothing in it is nearer.
    nearness: f32,
}

impl Node {
    /// Whether nearer things are seen at all of its samples.
    pub fn is_hidden(&self, seen: &Visibility, size: usize) -> bool {
        let [column0, column1, row0, row1] = self.samples.map(usize::from);
        if (column1 - column0 + 1) * (row1 - row0 + 1) > MOST_COMPARED {
            return false;
        }
        let nearest = self.nearness + 1e-5 * self.nearness.abs();
        (row0..=row1).all(|row| {
            seen.nearness[row * size + column0..=row * size + column1].iter().all(|&here| nearest < here)
        })
    }
}

/// A camera, made ready for boxes in single precision.
pub(crate) struct Window {
    eye: Vec3,
    /// Right, up and back.
    axes: [Vec3; 3],
    is_perspective: bool,
    half: f32,
    scale: f32,
    /// By how much boxes are taken too large, in pixels.
    margin: f32,
    /// The first sample's place.
    start: [f32; 2],
    last: f32,
}

impl Window {
    pub fn new(camera: &Camera, size: usize, offset: (f32, f32)) -> Self {
        let half = 0.5 * size as f32;
        let (is_perspective, half_width) = match camera.projection {
            Projection::Perspective(width) => (true, width),
            Projection::Orthographic(width) => (false, width),
        };
        Self {
            eye: camera.eye,
            axes: [camera.right, camera.up, camera.back],
            is_perspective,
            half,
            scale: half / half_width,
            margin: 1e-3 + 1e-6 * size as f32,
            start: [0.5 + offset.0, 0.5 + offset.1],
            last: size as f32 - 1.0,
        }
    }

    /// Adds those of four boxes that cover a sample, the nearest last. They are the boxes
    /// 4 · `index` … 4 · `index` + 3 of a level.
    #[inline]
    pub fn push(&self, boxes: &Boxes, level: u32, index: u32, stack: &mut Vec<Node>) {
        let centre: [Vec4; 3] =
            std::array::from_fn(|k| (boxes.min[k] + boxes.max[k]) * 0.5 - Vec4::splat(self.eye[k]));
        let extent: [Vec4; 3] = std::array::from_fn(|k| (boxes.max[k] - boxes.min[k]) * 0.5);
        // For the rounding of these sums, which that of triangles is far below.
        let [a, b, c] = [0, 1, 2].map(|k| centre[k].abs() + extent[k]);
        let room = (a + b + c) * 1e-6;
        let along = |axis: Vec3, of: &[Vec4; 3]| of[0] * axis.x + of[1] * axis.y + of[2] * axis.z;
        let [x, y, back] = self.axes.map(|axis| {
            let (middle, half) = (along(axis, &centre), along(axis.abs(), &extent) + room);
            [middle - half, middle + half]
        });
        let [near, far] = [-back[1], -back[0]];
        let behind = Vec4::splat(NEAR as f32);
        let is_in_front = near.cmpge(behind * 2.0);
        let (nearness, [closest, farthest]) = match self.is_perspective {
            true => (Vec4::ONE / near, [Vec4::splat(self.scale) / near, Vec4::splat(self.scale) / far]),
            false => (-near, [Vec4::splat(self.scale); 2]),
        };
        let widest = |[low, high]: [Vec4; 2]| {
            let low = low * Vec4::select(low.cmplt(Vec4::ZERO), closest, farthest);
            let high = high * Vec4::select(high.cmpgt(Vec4::ZERO), closest, farthest);
            [low, high]
        };
        let ([x0, x1], [up0, up1]) = (widest(x), widest(y));
        let half = Vec4::splat(self.half);
        let columns = self.samples(half + x0, half + x1, self.start[0]);
        let rows = self.samples(half - up1, half - up0, self.start[1]);
        let covers = columns[0].cmple(columns[1]) & rows[0].cmple(rows[1]);
        let is_seen = far.cmpge(behind * 0.5) & (!is_in_front | covers);
        let mut lanes = is_seen.bitmask();
        if lanes == 0 {
            return;
        }
        let start = stack.len();
        let (columns, rows) = (columns.map(|c| c.to_array()), rows.map(|r| r.to_array()));
        let (nearness, in_front) = (nearness.to_array(), is_in_front.bitmask());
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let mut node = Node { level, index: index * FAN as u32 + lane as u32, ..Node::default() };
            if in_front >> lane & 1 == 1 {
                node.samples =
                    [columns[0][lane], columns[1][lane], rows[0][lane], rows[1][lane]].map(|x| x as u16);
                node.nearness = nearness[lane];
            } else {
                let last = self.last as u16;
                (node.samples, node.nearness) = ([0, last, 0, last], f32::INFINITY);
            }
            // The nearest comes last, and is looked at first.
            let mut place = stack.len();
            stack.push(node);
            while place > start && stack[place - 1].nearness > node.nearness {
                stack.swap(place - 1, place);
                place -= 1;
            }
        }
    }

    /// Which of four triangles may cover a sample: a bit a lane, of no meaning where there is no triangle.
    #[inline]
    pub fn may_cover(&self, triangles: &Triangles) -> u32 {
        let none = [Vec4::INFINITY, Vec4::NEG_INFINITY];
        let (mut x, mut y, mut is_near) = (none, none, Vec4::ZERO.cmpgt(Vec4::ZERO));
        let reach = |range: &mut [Vec4; 2], at: Vec4, room: Vec4| {
            *range = [range[0].min(at - room), range[1].max(at + room)];
        };
        for corner in &triangles.corners {
            let place: [Vec4; 3] = std::array::from_fn(|k| corner[k] - Vec4::splat(self.eye[k]));
            let room = (place[0].abs() + place[1].abs() + place[2].abs()) * 1e-6;
            let [right, up, back] = self.axes.map(|a| place[0] * a.x + place[1] * a.y + place[2] * a.z);
            is_near |= back.cmpgt(Vec4::splat(-2.0 * NEAR as f32));
            let scale = match self.is_perspective {
                true => Vec4::splat(self.scale) / -back,
                false => Vec4::splat(self.scale),
            };
            // What rounding of depth does is as large where a point is seen at 45 degrees.
            let room = room * scale * 2.0;
            reach(&mut x, right * scale, room + right.abs() * room);
            reach(&mut y, -up * scale, room + up.abs() * room);
        }
        let half = Vec4::splat(self.half);
        let columns = self.samples(x[0] + half, x[1] + half, self.start[0]);
        let rows = self.samples(y[0] + half, y[1] + half, self.start[1]);
        (is_near | columns[0].cmple(columns[1]) & rows[0].cmple(rows[1])).bitmask()
    }

    /// The first and last sample along an axis from `low` to `high`; where there is none, the first is behind the last.
    #[inline]
    fn samples(&self, low: Vec4, high: Vec4, start: f32) -> [Vec4; 2] {
        let (low, high) = (low - (start + self.margin), high - (start - self.margin));
        [low.max(Vec4::ZERO).ceil(), high.min(Vec4::splat(self.last)).floor()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::triangle_on_screen;

    /// Numbers from 0 to 1.
    fn random(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (*state >> 8) as f32 / (1 << 24) as f32
    }

    fn cameras() -> [Camera; 3] {
        let direction = Vec3::new(0.3, 0.5, 1.0);
        [
            Camera::towards_origin(direction, 3.5, Projection::Perspective(0.4)),
            Camera::towards_origin(direction, 3.0, Projection::Orthographic(1.2)),
            // From inside, where much is behind the camera.
            Camera::towards_origin(direction, 0.3, Projection::Perspective(0.7)),
        ]
    }

    /// Protects the contract of boxes and of triangles alike: whatever covers a sample is not left out, and no
    /// sample or depth of it is beyond what its box says.
    #[test]
    fn nothing_that_covers_a_sample_is_left_out() {
        let (mut state, size, offset) = (3, 64, (0.3, -0.2));
        let mut counts = [0; 2];
        for round in 0..3000 {
            let camera = &cameras()[round % 3];
            let width = 0.02 + 0.3 * random(&mut state);
            let near = Vec3::from_array(std::array::from_fn(|_| 2.0 * random(&mut state) - 1.0));
            let mut corner = || near + Vec3::from_array(std::array::from_fn(|_| width * random(&mut state)));
            let few: Vec<[Vec3; 3]> = (0..3).map(|_| std::array::from_fn(|_| corner())).collect();
            let window = Window::new(camera, size, offset);
            let covering = window.may_cover(&Triangles::new(few.iter().copied()));
            let bounds: Vec<Bounds> = few.iter().map(Bounds::of_corners).collect();
            let mut nodes = Vec::new();
            window.push(&Boxes::new(&bounds), 0, 5, &mut nodes);
            assert!(nodes.windows(2).all(|pair| pair[0].nearness <= pair[1].nearness));
            for (lane, triangle) in few.iter().enumerate() {
                let mut seen = Visibility::empty(size);
                if let Some(on_screen) = triangle_on_screen(triangle, camera, size, Some(offset)) {
                    crate::raster::draw::<true>(&on_screen, 7, size, offset, &mut seen, |_, _| true);
                }
                let node = nodes.iter().find(|node| node.index == 20 + lane as u32);
                counts[0] += usize::from(covering >> lane & 1 == 0);
                for (sample, _) in seen.triangle.iter().enumerate().filter(|(_, t)| **t == 7) {
                    counts[1] += 1;
                    assert!(covering >> lane & 1 == 1, "a triangle that covers {sample} is left out");
                    let node = node.expect("its box is not left out");
                    let [column0, column1, row0, row1] = node.samples.map(usize::from);
                    assert!((column0..=column1).contains(&(sample % size)));
                    assert!((row0..=row1).contains(&(sample / size)));
                    assert!(seen.nearness[sample] <= node.nearness + 1e-5 * node.nearness.abs());
                }
            }
        }
        assert!(counts[0] > 1000 && counts[1] > 10_000, "{counts:?}");
    }
}
