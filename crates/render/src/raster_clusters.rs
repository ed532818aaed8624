//! Rasterisation of meshes whose triangles are far smaller than pixels: what a view costs follows its
//! pixels, and not the mesh.
//!
//! Triangles are sorted along Morton's curve (Morton 1966); runs of them are leaves of a tree of boxes.
//! A view walks the tree from near to far. Subtrees whose box on the screen has no sample in it are left
//! out, which is nearly all of a fine mesh, and so are those behind what is seen already at all of their
//! samples (hierarchical visibility, Greene, Kass and Miller 1993). Only triangles of the leaves that
//! remain are set up.
//!
//! Contract: what is seen is what `raster.rs` sees of all triangles, with the same arithmetic: boxes are
//! taken a little too large, and on equal depth the first triangle wins whatever the order. Where the two
//! differ a needle's depth was rounding. Coordinates are of moderate size, as in the common frame.

use crate::camera::{Camera, Projection};
use crate::raster::{NEAR, ScreenTriangle, Visibility, draw, triangle_on_screen};
use parbake_model::glam::Vec3;
use rayon::prelude::*;

/// Triangles in a leaf.
const LEAF: usize = 4;

/// Children of a node.
const FAN: usize = 4;

/// Boxes over more samples than this are not compared with what is seen already.
const MOST_COMPARED: usize = 64;

/// Steps of Morton's curve along an axis.
const STEPS: f32 = ((1u32 << 21) - 1) as f32;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: Vec3,
    max: Vec3,
}

impl Bounds {
    fn of(all: impl Iterator<Item = Bounds>) -> Self {
        let none = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
        all.fold(none, |a, b| Self { min: a.min.min(b.min), max: a.max.max(b.max) })
    }

    fn of_corners(corners: &[Vec3; 3]) -> Self {
        let [a, b, c] = *corners;
        Self { min: a.min(b).min(c), max: a.max(b).max(c) }
    }
}

/// Some triangles of a mesh, in a tree of boxes: 48 bytes a triangle.
#[derive(Clone, Debug)]
pub struct Clusters {
    /// The triangles' indices in the mesh, along the curve.
    sources: Vec<u32>,
    /// Their corners.
    corners: Vec<[Vec3; 3]>,
    /// Boxes of each level, those of leaves first; the last has one.
    levels: Vec<Vec<Bounds>>,
}

impl Clusters {
    /// A tree over these of a mesh's triangles. The same whatever the number of threads.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], which: &[u32]) -> Self {
        let corners_of = |t: u32| triangles[t as usize].map(|v| positions[v as usize]);
        let all = (which.par_iter().map(|&t| Bounds::of_corners(&corners_of(t))))
            .reduce(|| Bounds::of(std::iter::empty()), |a, b| Bounds::of([a, b].into_iter()));
        let scale = STEPS / (all.max - all.min).max_element().max(f32::MIN_POSITIVE);
        let mut order: Vec<(u64, u32)> = (which.par_iter())
            .map(|&t| {
                let own = Bounds::of_corners(&corners_of(t));
                (morton(((own.min + own.max) * 0.5 - all.min) * scale), t)
            })
            .collect();
        order.par_sort_unstable();
        let sources: Vec<u32> = order.into_par_iter().map(|(_, t)| t).collect();
        let corners: Vec<[Vec3; 3]> = sources.par_iter().map(|&t| corners_of(t)).collect();
        let leaf = |leaf: &[[Vec3; 3]]| Bounds::of(leaf.iter().map(Bounds::of_corners));
        let mut levels: Vec<Vec<Bounds>> = vec![corners.par_chunks(LEAF).map(leaf).collect()];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            levels.push(last.par_chunks(FAN).map(|few| Bounds::of(few.iter().copied())).collect());
        }
        Self { sources, corners, levels }
    }

    /// Adds what is seen of these triangles at each sample to `seen`, which must be of `size`² samples.
    /// With `front`, only of what lies behind it.
    pub(crate) fn rasterise(
        &self,
        camera: &Camera,
        size: usize,
        offset: (f32, f32),
        front: Option<&Visibility>,
        seen: &mut Visibility,
    ) {
        let window = Window::new(camera, size, offset);
        let mut stack: Vec<Node> = Vec::with_capacity(4 * FAN * self.levels.len());
        let root = self.levels.len() - 1;
        stack.extend(self.levels[root].first().and_then(|bounds| window.node(root as u32, 0, bounds)));
        while let Some(node) = stack.pop() {
            if node.is_hidden(seen, size) {
                continue;
            }
            if node.level == 0 {
                let first = node.index as usize * LEAF;
                for slot in first..(first + LEAF).min(self.corners.len()) {
                    let triangle = triangle_on_screen(&self.corners[slot], camera, size, Some(offset));
                    if let Some(triangle) = triangle {
                        draw_any(&triangle, self.sources[slot], size, offset, front, seen);
                    }
                }
                continue;
            }
            let level = node.level - 1;
            let first = node.index * FAN as u32;
            let start = stack.len();
            let children = (first..).zip(self.levels[level as usize][first as usize..].iter().take(FAN));
            stack.extend(children.filter_map(|(index, bounds)| window.node(level, index, bounds)));
            // The nearest comes last, and is looked at first.
            stack[start..].sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
        }
    }
}

fn draw_any(
    triangle: &ScreenTriangle,
    index: u32,
    size: usize,
    offset: (f32, f32),
    front: Option<&Visibility>,
    seen: &mut Visibility,
) {
    match front {
        None => draw::<true>(triangle, index, size, offset, seen, |_, _| true),
        Some(front) => draw::<true>(triangle, index, size, offset, seen, |sample, nearness| {
            nearness < front.nearness[sample]
        }),
    }
}

/// Where a point lies on Morton's curve: the bits of its coordinates, each 0 … [`STEPS`], in turn.
fn morton(p: Vec3) -> u64 {
    let spread = |x: f32| {
        let mut x = x.clamp(0.0, STEPS) as u64;
        x = (x | x << 32) & 0x001f_0000_0000_ffff;
        x = (x | x << 16) & 0x001f_0000_ff00_00ff;
        x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2
}

/// A box of the tree on the screen.
struct Node {
    level: u32,
    index: u32,
    /// Samples that it may cover: first and last column, first and last row.
    samples: [u16; 4],
    /// Nothing in it is nearer.
    nearness: f32,
}

impl Node {
    /// Whether nearer things are seen at all of its samples.
    fn is_hidden(&self, seen: &Visibility, size: usize) -> bool {
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
struct Window {
    eye: Vec3,
    /// Right, up and back, and their absolute values.
    axes: [[Vec3; 2]; 3],
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
    fn new(camera: &Camera, size: usize, offset: (f32, f32)) -> Self {
        let half = 0.5 * size as f32;
        let (is_perspective, half_width) = match camera.projection {
            Projection::Perspective(width) => (true, width),
            Projection::Orthographic(width) => (false, width),
        };
        Self {
            eye: camera.eye,
            axes: [camera.right, camera.up, camera.back].map(|axis| [axis, axis.abs()]),
            is_perspective,
            half,
            scale: half / half_width,
            margin: 1e-3 + 1e-6 * size as f32,
            start: [0.5 + offset.0, 0.5 + offset.1],
            last: size as f32 - 1.0,
        }
    }

    /// A box on the screen; none where it covers no sample.
    #[inline]
    fn node(&self, level: u32, index: u32, bounds: &Bounds) -> Option<Node> {
        let centre = (bounds.min + bounds.max) * 0.5 - self.eye;
        let extent = (bounds.max - bounds.min) * 0.5;
        // For the rounding of these sums, which that of triangles is far below.
        let room = 1e-6 * (centre.abs() + extent).element_sum();
        let [x, y, back] = self.axes.map(|[axis, absolute]| {
            let (middle, half) = (centre.dot(axis), extent.dot(absolute) + room);
            [middle - half, middle + half]
        });
        let [near, far] = [-back[1], -back[0]];
        let behind = NEAR as f32;
        if far < 0.5 * behind {
            return None;
        }
        let last = self.last as u16;
        if near < 2.0 * behind {
            return Some(Node { level, index, samples: [0, last, 0, last], nearness: f32::INFINITY });
        }
        let (nearness, [closest, farthest]) = match self.is_perspective {
            true => (1.0 / near, [self.scale / near, self.scale / far]),
            false => (-near, [self.scale; 2]),
        };
        let widest = |[low, high]: [f32; 2]| {
            let low = low * if low < 0.0 { closest } else { farthest };
            let high = high * if high > 0.0 { closest } else { farthest };
            [low, high]
        };
        let ([x0, x1], [up0, up1]) = (widest(x), widest(y));
        let [column0, column1] = self.samples(self.half + x0, self.half + x1, self.start[0])?;
        let [row0, row1] = self.samples(self.half - up1, self.half - up0, self.start[1])?;
        Some(Node { level, index, samples: [column0, column1, row0, row1], nearness })
    }

    /// The first and last sample along an axis from `low` to `high`.
    #[inline]
    fn samples(&self, low: f32, high: f32, start: f32) -> Option<[u16; 2]> {
        let (low, high) = (low - start - self.margin, high - start + self.margin);
        if high < 0.0 || low > self.last {
            return None;
        }
        // Without `ceil`, which is a call on older processors.
        let low = low.max(0.0);
        let first = low as u16;
        let first = first + u16::from(f32::from(first) < low);
        let last = high.min(self.last) as u16;
        (first <= last).then_some([first, last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::{NOTHING, ScreenTriangles, rasterise, rasterise_behind};

    /// A bumpy ball of 2 × 60 × 120 triangles with a lid that is seen from its back, and needles through it.
    fn ball() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (rings, sides) = (60u32, 120u32);
        let mut positions = Vec::new();
        for ring in 0..=rings {
            for side in 0..sides {
                let (a, b) = (
                    std::f32::consts::PI * ring as f32 / rings as f32,
                    std::f32::consts::TAU * side as f32 / sides as f32,
                );
                let radius = 0.8 + 0.1 * (7.0 * a).sin() * (5.0 * b).cos();
                positions.push(Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()) * radius);
            }
        }
        let at = |ring: u32, side: u32| ring * sides + side % sides;
        let mut triangles = Vec::new();
        for ring in 0..rings {
            for side in 0..sides {
                let [a, b, c, d] =
                    [at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)];
                triangles.extend([[a, c, b], [a, d, c]]);
            }
        }
        let first = positions.len() as u32;
        positions.extend([Vec3::new(-1.0, 0.3, 0.9), Vec3::new(1.0, 0.3, 0.95), Vec3::new(0.0, 0.9, -0.9)]);
        positions.push(Vec3::new(1.0, 0.301, 0.95));
        triangles.extend([[first, first + 2, first + 1], [first, first + 1, first + 3]]);
        // The same once more: the first of both is seen.
        let twice: Vec<[u32; 3]> = triangles[..500].to_vec();
        triangles.extend(twice);
        (positions, triangles)
    }

    fn cameras() -> Vec<Camera> {
        let mut cameras: Vec<Camera> = crate::camera::fibonacci_sphere(12, 0.4)
            .into_iter()
            .map(|d| Camera::towards_origin(d, 3.5, Projection::Perspective(0.4)))
            .collect();
        cameras.push(Camera::towards_origin(Vec3::new(0.2, 0.5, 1.0), 3.0, Projection::Orthographic(1.2)));
        // From inside, where much is behind the camera.
        cameras.push(Camera::towards_origin(Vec3::new(0.2, 0.5, 1.0), 0.4, Projection::Perspective(0.7)));
        cameras
    }

    /// Protects the promise that a large model looks as it would if all of its triangles were drawn:
    /// the same triangle at every sample, and behind that the same again.
    #[test]
    fn clusters_see_what_all_triangles_show() {
        let (positions, triangles) = ball();
        let which: Vec<u32> = (0..triangles.len() as u32).collect();
        let clusters = Clusters::new(&positions, &triangles, &which);
        for camera in cameras() {
            for (size, offset) in [(48, (0.2, -0.4)), (7, (0.0, 0.0)), (200, (0.5, 0.5))] {
                let screen = ScreenTriangles::new(&positions, &triangles, &camera, size);
                let (mut all, mut next) = (Visibility::default(), Visibility::default());
                rasterise(&screen, size, offset, &mut all);
                rasterise_behind(&screen, size, offset, &all, &mut next);
                let mut seen = Visibility::empty(size);
                clusters.rasterise(&camera, size, offset, None, &mut seen);
                let mut behind = Visibility::empty(size);
                clusters.rasterise(&camera, size, offset, Some(&seen), &mut behind);
                assert!(all.triangle.iter().any(|&t| t != NOTHING));
                assert_eq!(all.triangle, seen.triangle, "{size}");
                assert_eq!(next.triangle, behind.triangle, "{size}");
            }
        }
    }

    /// Protects models of a few triangles, and layers of none.
    #[test]
    fn trees_of_none_and_of_one() {
        let positions = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        let camera = cameras()[12];
        for count in [0, 1] {
            let clusters = Clusters::new(&positions, &[[0, 1, 2]], &[0][..count]);
            let mut seen = Visibility::empty(16);
            clusters.rasterise(&camera, 16, (0.0, 0.0), None, &mut seen);
            assert_eq!(seen.triangle.contains(&0), count == 1);
        }
    }

    /// Protects the curve: neighbours stay neighbours only if bits are spread rightly.
    #[test]
    fn bits_take_turns() {
        assert_eq!(morton(Vec3::new(3.0, 0.0, 0.0)), 0b001_001);
        assert_eq!(morton(Vec3::new(0.0, 5.0, 0.0)), 0b010_000_010);
        assert_eq!(morton(Vec3::splat(STEPS)), (1 << 63) - 1);
    }
}
