//! The pictures to be matched: the high-poly from every training view, rendered
//! once and kept compactly, so that no later step depends on its size.
//!
//! Each pixel is the mean of a few samples spread over a box narrower than the
//! pixel: with the views' shifted grids the pool then shows the sharpness of much
//! larger pictures. Where samples fill the pixel, those of one triangle are shaded once, at their centroid.
//! Kept as four half floats a pixel: linear, premultiplied.

use crate::pool::View;
use half::f16;
use half::slice::HalfFloatSliceExt;
use parbake_progress::{Stage, Watcher};
use parbake_render::on_screen::Raster;
use parbake_render::raster::{NOTHING, Visibility};
use parbake_render::scene::Scene;
use parbake_render::shade::Brdf;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How reference pictures are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Pixels along a side of a view.
    pub size: usize,
    /// Width of a pixel's box filter in pixels, 0 … 1.
    pub filter: f32,
    /// Samples along a side of that box, ≥ 1.
    pub samples: usize,
}

/// One rendered training view.
#[derive(Clone, Debug)]
pub struct Reference {
    /// From where.
    pub view: View,
    /// size² pixels of premultiplied linear light and coverage.
    pub pixels: Vec<[f16; 4]>,
}

impl Reference {
    /// The pixels as single floats: many at once, where a CPU converts one as slowly as eight.
    pub fn linear(&self) -> Vec<[f32; 4]> {
        let mut pixels = vec![[0.0; 4]; self.pixels.len()];
        self.pixels.as_flattened().convert_to_f32_slice(pixels.as_flattened_mut());
        pixels
    }

    /// The same picture with half as many pixels along a side: each is the mean of four. For views
    /// without jitter and of even sizes; odd ones lose their last row and column, and with them a part
    /// of the field.
    pub fn halved(&self) -> Self {
        let (size, pixels) = (self.pixels.len().isqrt(), self.linear());
        let half = size / 2;
        let mean = |pixel: usize| -> [f16; 4] {
            let corner = 2 * (pixel / half) * size + 2 * (pixel % half);
            let four = [corner, corner + 1, corner + size, corner + size + 1].map(|i| pixels[i]);
            std::array::from_fn(|k| f16::from_f32(0.25 * four.iter().map(|p| p[k]).sum::<f32>()))
        };
        Self { view: self.view, pixels: (0..half * half).map(mean).collect() }
    }
}

/// Renders the pool. Stops early, with fewer views, when asked to, but never
/// before `at_least` views are done.
pub fn render_references(
    high: &Scene,
    brdf: &impl Brdf,
    pool: &[View],
    sampling: &Sampling,
    at_least: usize,
    watcher: &dyn Watcher,
) -> Vec<Reference> {
    let done = AtomicUsize::new(0);
    // Small groups in order, so that an early stop keeps a well-spread prefix.
    let group = rayon::current_num_threads().max(1) * 2;
    let mut out = Vec::with_capacity(pool.len());
    for (index, views) in pool.chunks(group).enumerate() {
        if index * group >= at_least && watcher.stopped() {
            break;
        }
        out.par_extend(views.par_iter().map(|view| {
            let picture = render(high, brdf, view, sampling);
            watcher.progress(Stage::Reference, done.fetch_add(1, Ordering::Relaxed) + 1, pool.len());
            picture
        }));
    }
    out
}

fn render(high: &Scene, brdf: &impl Brdf, view: &View, sampling: &Sampling) -> Reference {
    let Sampling { size, filter, samples } = *sampling;
    let screen = high.on_screen(&view.camera, size);
    let mut sum = vec![[0.0f32; 4]; size * size];
    let share = 1.0 / (samples * samples) as f32;
    let offset = |sample: usize| {
        let shift =
            [sample % samples, sample / samples].map(|i| filter * ((i as f32 + 0.5) / samples as f32 - 0.5));
        (view.jitter[0] + shift[0], view.jitter[1] + shift[1])
    };
    let count = samples * samples;
    let fills_pixels = samples > 1 && filter == 1.0;
    let finely = fills_pixels.then(|| screen.see_finely(size, samples, view.jitter)).flatten();
    let triangles = match finely {
        Some(seen) => by_pixel(&seen, samples),
        None => {
            let (mut seen, mut triangles) = (Visibility::default(), vec![NOTHING; size * size * count]);
            for sample in 0..count {
                screen.rasterise(size, offset(sample), None, &mut seen);
                let of_sample = triangles[sample..].iter_mut().step_by(count);
                of_sample.zip(&seen.triangle).for_each(|(to, &triangle)| *to = triangle);
            }
            triangles
        }
    };
    // Pixel by pixel: what the samples of one read of a texture lies close together, what their neighbours' do
    // is often in other pages of memory.
    let mut order = Vec::with_capacity(count);
    for (pixel, triangles) in triangles.chunks_exact(count).enumerate() {
        order.clear();
        order.extend((0..count).filter(|&sample| triangles[sample] != NOTHING));
        if fills_pixels {
            // As multisampling with centroid sampling: each triangle is shaded once, at the centroid of its samples.
            order.sort_by_key(|&sample| triangles[sample]);
        }
        for own in order.chunk_by(|&a, &b| fills_pixels && triangles[a] == triangles[b]) {
            let (count, weight) = (own.len() as f32, own.len() as f32 * share);
            let shifts = own.iter().map(|&sample| offset(sample));
            let (x, y) = shifts.fold((0.0, 0.0), |sum, shift| (sum.0 + shift.0, sum.1 + shift.1));
            let at = [(pixel % size, x / count), (pixel / size, y / count)]
                .map(|(pixel, shift)| pixel as f64 + 0.5 + f64::from(shift));
            let footprint = (filter * weight.sqrt()).max(1.0 / 16.0);
            let triangle = triangles[own[0]] as usize;
            let light = high.shade(brdf, &view.camera, &screen, triangle, (at[0], at[1]), footprint);
            (0..3).for_each(|k| sum[pixel][k] += light[k] * weight);
            sum[pixel][3] += weight;
        }
    }
    let mut pixels = vec![[f16::ZERO; 4]; sum.len()];
    pixels.as_flattened_mut().convert_from_f32_slice(sum.as_flattened());
    Reference { view: *view, pixels }
}

/// What samples on one fine grid see, pixel by pixel, each row by row; `samples` are along a side of a pixel.
fn by_pixel(seen: &Visibility, samples: usize) -> Vec<u32> {
    let size = seen.size / samples;
    let row = |pixel: usize, row: usize| {
        let first = (pixel / size * samples + row) * seen.size + pixel % size * samples;
        &seen.triangle[first..first + samples]
    };
    (0..size * size).flat_map(|pixel| (0..samples).flat_map(move |r| row(pixel, r))).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec3;
    use parbake_model::{Material, Mesh};
    use parbake_render::camera::{Camera, Projection};
    use parbake_render::interpretation::Interpretation;
    use parbake_render::shade::Lambert;

    /// Protects coarse views: each pixel is the mean of its own four, also where a side is odd.
    #[test]
    fn half_as_many_pixels_are_means_of_four() {
        let camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Perspective(0.4));
        let view = View { camera, jitter: [0.0; 2] };
        let pixels = (0..25u8).map(|i| [f16::from(i), f16::ZERO, f16::ZERO, f16::ONE]).collect();
        let halved = Reference { view, pixels }.halved();
        let red: Vec<f32> = halved.linear().iter().map(|p| p[0]).collect();
        assert_eq!(red, [3.0, 5.0, 13.0, 15.0]);
        assert!(halved.linear().iter().all(|p| p[3] == 1.0));
    }

    /// Protects what vertices follow: where samples fill pixels, each triangle is shaded once and counts by its share, which
    /// shows what shading each sample does.
    #[test]
    fn shading_a_triangle_once_a_pixel_shows_the_same() {
        let corners = [[-1.0, -1.0], [1.0, -0.9], [0.9, 1.0], [-0.8, 0.9]];
        let positions: Vec<Vec3> = corners.iter().map(|&[x, y]| Vec3::new(x, y, 0.3 * x)).collect();
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let normals = positions.iter().map(|p| Vec3::new(0.7 * p.x, 0.5 * p.y, 1.0).normalize()).collect();
        let mesh = Mesh { positions, normals, triangles, triangle_materials: vec![0, 1], ..Mesh::default() };
        let painted = |base_color| Material { base_color, ..Material::default() };
        let materials = [painted([0.9, 0.1, 0.2, 1.0]), painted([0.1, 0.7, 0.3, 1.0])];
        let scene = Scene::new(mesh, &materials, &[], Interpretation::default());
        let camera = Camera::towards_origin(Vec3::new(0.3, 0.2, 1.0), 3.5, Projection::Perspective(0.4));
        let view = View { camera, jitter: [0.0; 2] };
        let of = |filter| {
            let sampling = Sampling { size: 16, filter, samples: 3 };
            render(&scene, &Lambert, &view, &sampling).linear()
        };
        // A box that is a little narrower is sampled one by one.
        let (once, each) = (of(1.0), of(1.0 - 1e-6));
        let is_mixed = |p: &&[f32; 4]| p[0] > 0.12 && p[1] > 0.12 && p[3] == 1.0;
        assert!(once.iter().filter(is_mixed).count() > 5, "pixels along the diagonal");
        let difference =
            |(a, b): (&[f32; 4], &[f32; 4])| (0..4).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
        let most = once.iter().zip(&each).map(difference).fold(0.0, f32::max);
        assert!(most < 2e-3, "{most}");
    }
}
