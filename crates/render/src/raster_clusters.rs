//! Rasterisation of meshes whose triangles are far smaller than pixels: what a view costs follows its
//! pixels, and not the mesh.
//!
//! A tree of boxes halves the triangles across the widest axis again and again (a k-d order, Bentley 1975); four are
//! a leaf, and four nodes a larger one. Boxes that follow a curve through space instead overlap so much that twice as many
//! leaves lie under a sample.
//!
//! A view walks the tree from near to far. Subtrees whose box on the screen has no sample in it are left
//! out, which is nearly all of a fine mesh, and so are those behind what is seen already at all of their
//! samples (hierarchical visibility, Greene, Kass and Miller 1993). Only triangles of the leaves that
//! remain are set up.
//!
//! Contract: what is seen is what `raster.rs` sees of all triangles, with the same arithmetic: boxes are
//! taken a little too large, and on equal depth the first triangle wins whatever the order. Where the two
//! differ a needle's depth was rounding. Coordinates are of moderate size, as in the common frame.

use crate::boxes_on_screen::{Bounds, Boxes, FAN, Node, Triangles, Window};
use crate::camera::Camera;
use crate::raster::{ScreenTriangle, Visibility, draw, triangle_on_screen};
use parbake_model::glam::Vec3;
use rayon::prelude::*;

/// Some triangles of a mesh, in a tree of boxes: 48 bytes a triangle.
#[derive(Clone, Debug)]
pub struct Clusters {
    /// The triangles' indices in the mesh, leaf by leaf.
    sources: Vec<u32>,
    /// Their corners.
    leaves: Vec<Triangles>,
    /// Boxes of each level, four by four, those of leaves first; the last has one.
    levels: Vec<Vec<Boxes>>,
}

impl Clusters {
    /// A tree over these of a mesh's triangles. The same whatever the number of threads.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], which: &[u32]) -> Self {
        let corners_of = |t: u32| triangles[t as usize].map(|v| positions[v as usize]);
        let mut placed: Vec<(Vec3, u32)> = (which.par_iter())
            .map(|&t| {
                let own = Bounds::of_corners(&corners_of(t));
                (own.min + own.max, t)
            })
            .collect();
        arrange(&mut placed);
        let sources: Vec<u32> = placed.into_par_iter().map(|(_, t)| t).collect();
        let leaf = |leaf: &[u32]| Triangles::new(leaf.iter().map(|&t| corners_of(t)));
        let leaves: Vec<Triangles> = sources.par_chunks(FAN).map(leaf).collect();
        let level = |of: &[Bounds]| of.par_chunks(FAN).map(Boxes::new).collect();
        let around = |leaf: &[u32]| Bounds::around(leaf.iter().map(|&t| Bounds::of_corners(&corners_of(t))));
        let mut bounds: Vec<Bounds> = sources.par_chunks(FAN).map(around).collect();
        let mut levels: Vec<Vec<Boxes>> = vec![level(&bounds)];
        while bounds.len() > FAN {
            bounds = bounds.par_chunks(FAN).map(|few| Bounds::around(few.iter().copied())).collect();
            levels.push(level(&bounds));
        }
        Self { sources, leaves, levels }
    }

    /// Adds what is seen of those of these triangles that are meant at each sample to `seen`, which must be of
    /// `size`² samples. With `front`, only of what lies behind it.
    pub(crate) fn rasterise(
        &self,
        camera: &Camera,
        size: usize,
        offset: (f32, f32),
        front: Option<&Visibility>,
        is_meant: &impl Fn(u32) -> bool,
        seen: &mut Visibility,
    ) {
        let window = Window::new(camera, size, offset);
        let mut stack: Vec<Node> = Vec::with_capacity(4 * FAN * self.levels.len());
        // Leaves are level 0; a node of a level above holds four boxes of the one below.
        let look_into = |level: usize, index: usize, stack: &mut Vec<Node>| {
            if let Some(boxes) = self.levels[level - 1].get(index) {
                window.push(boxes, (level - 1) as u32, index as u32, stack);
            }
        };
        look_into(self.levels.len(), 0, &mut stack);
        while let Some(node) = stack.pop() {
            if node.is_hidden(seen, size) {
                continue;
            }
            if node.level > 0 {
                look_into(node.level as usize, node.index as usize, &mut stack);
                continue;
            }
            let (leaf, first) = (&self.leaves[node.index as usize], node.index as usize * FAN);
            let covering = window.may_cover(leaf);
            let own = self.sources[first..].iter().take(FAN).enumerate();
            for (lane, &source) in
                own.filter(|(lane, source)| covering >> lane & 1 == 1 && is_meant(**source))
            {
                let triangle = triangle_on_screen(&leaf.corners(lane), camera, size, Some(offset));
                if let Some(triangle) = triangle {
                    draw_any(&triangle, source, size, offset, front, seen);
                }
            }
        }
    }
}

/// Sorts centres so that each run of 4^k is the halves of halves of a larger one, each time across the widest axis.
fn arrange(placed: &mut [(Vec3, u32)]) {
    if placed.len() <= FAN {
        return;
    }
    let (min, max) =
        placed.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), (p, _)| (a.min(*p), b.max(*p)));
    let axis = (max - min).max_position();
    // The largest run below, or half of the runs.
    let mut run = FAN;
    while run * FAN < placed.len() {
        run *= FAN;
    }
    let middle = if placed.len() > 2 * run { 2 * run } else { run };
    let by = |a: &(Vec3, u32), b: &(Vec3, u32)| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1));
    placed.select_nth_unstable_by(middle, by);
    let (low, high) = placed.split_at_mut(middle);
    if low.len() > 4096 {
        rayon::join(|| arrange(low), || arrange(high));
    } else {
        arrange(low);
        arrange(high);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
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
                clusters.rasterise(&camera, size, offset, None, &|_| true, &mut seen);
                let mut behind = Visibility::empty(size);
                clusters.rasterise(&camera, size, offset, Some(&seen), &|_| true, &mut behind);
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
            clusters.rasterise(&camera, 16, (0.0, 0.0), None, &|_| true, &mut seen);
            assert_eq!(seen.triangle.contains(&0), count == 1);
        }
    }
}
