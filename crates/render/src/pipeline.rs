//! One whole differentiable view: from a textured surface to a loss and back.
//!
//! Forward: raster → silhouettes → the samples' way (`patch.rs`) → antialias → background and display
//! → loss. Adjoint: the same backwards, from the [`Tape`] that the forward pass left.
//! Texels' gradients are left on the mip levels where the fetches were;
//! `Pyramid::base_adjoint` carries them to level 0, once for many views.
//!
//! Contract: one sample at each pixel's centre. Work is divided by rows and runs of
//! pixels and put together in their order: the results do not depend on the number of
//! threads. Vertices that share a position each receive their own part of its gradient.

use crate::antialias::{BlendTape, Blends, find_blends};
use crate::background::Composer;
use crate::camera::Camera;
use crate::gradient_pixels::{GradientPixels, ShadedPixels};
use crate::loss::{Comparison, LossValue, Reference, compare};
use crate::parallax::ParallaxCoefficients;
use crate::patch::{CornerGradients, Patch, ShiftUse};
use crate::raster::{NOTHING, ScreenTriangles, Visibility, rasterise};
use crate::scatter::{Fetch, Scatter};
use crate::shade::Brdf;
use crate::surface::{Surface, Textures};
use parbake_image::pyramid::Pyramid;
use parbake_model::glam::{Vec2, Vec3};
use rayon::prelude::*;

/// From where the surface is seen, and what the picture is compared with.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The viewer.
    pub camera: &'a Camera,
    /// The picture to be met; its size is the view's.
    pub reference: &'a Reference,
    /// Background and display, the same that made the reference.
    pub composer: &'a Composer,
    /// The loss.
    pub comparison: Comparison,
    /// Blend silhouettes: without it coverage has no gradient.
    pub antialias: bool,
    /// Pixels whose gradients the adjoint carries on to texels and vertices; those of blended edges' vertices are whole.
    /// Only pixels that these need are shaded.
    pub gradient_pixels: GradientPixels,
}

/// What a forward pass leaves for the adjoint, and for the curious.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    /// Premultiplied linear light and coverage, size² pixels; 0 where they were not shaded.
    pub rgba: Vec<[f32; 4]>,
    /// What each pixel sees.
    pub seen: Visibility,
    /// Mean losses, estimated from the pixels that the adjoint reads.
    pub loss: LossValue,
    screen: ScreenTriangles,
    blends: Blends,
    blend_tape: BlendTape,
    /// dL/drgba.
    gradient: Vec<[f32; 4]>,
}

/// Gradients of a loss, summed over views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gradients {
    /// Of the colour texels, on all levels.
    pub color: Pyramid<3>,
    /// Of the normal texels, on all levels.
    pub normal: Option<Pyramid<3>>,
    /// Of the parallax map's coefficients and depth.
    pub parallax: Option<ParallaxCoefficients>,
    /// V positions' (empty if not asked for, as all that follow).
    pub positions: Vec<Vec3>,
    /// V normals'.
    pub normals: Vec<Vec3>,
    /// V tangents' (their handedness has none).
    pub tangents: Vec<Vec3>,
    /// V texture coordinates'.
    pub uvs: Vec<Vec2>,
}

impl Gradients {
    /// Zeros. `vertices` asks for the gradients of what the vertices carry, which cost
    /// more than the texels'.
    pub fn zeros(surface: &Surface, textures: &Textures, vertices: bool) -> Self {
        let count = if vertices { surface.positions.len() } else { 0 };
        Self {
            color: textures.color.zeros_like(),
            normal: textures.normal.map(Pyramid::zeros_like),
            parallax: textures.parallax.map(ParallaxCoefficients::zeros_like),
            positions: vec![Vec3::ZERO; count],
            normals: vec![Vec3::ZERO; count],
            tangents: vec![Vec3::ZERO; count],
            uvs: vec![Vec2::ZERO; count],
        }
    }
}

fn add_pyramids(sum: &mut Pyramid<3>, more: &Pyramid<3>) {
    for (sum, more) in sum.levels.iter_mut().zip(&more.levels) {
        for (sum, more) in sum.texels.iter_mut().zip(&more.texels) {
            for (sum, more) in sum.iter_mut().zip(more) {
                *sum += more;
            }
        }
    }
}

fn add_all<T: Copy + std::ops::AddAssign>(sum: &mut [T], more: &[T]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += *more;
    }
}

impl Gradients {
    /// Adds those of another view of the same surface.
    pub fn add(&mut self, more: &Self) {
        add_pyramids(&mut self.color, &more.color);
        if let (Some(sum), Some(more)) = (&mut self.normal, &more.normal) {
            add_pyramids(sum, more);
        }
        if let (Some(sum), Some(more)) = (&mut self.parallax, &more.parallax) {
            add_all(&mut sum.coefficients, &more.coefficients);
            if let (Some(sum), Some(more)) = (&mut sum.depth, &more.depth) {
                for (sum, more) in sum.texels.iter_mut().zip(&more.texels) {
                    sum[0] += more[0];
                }
            }
        }
        add_all(&mut self.positions, &more.positions);
        add_all(&mut self.normals, &more.normals);
        add_all(&mut self.tangents, &more.tangents);
        add_all(&mut self.uvs, &more.uvs);
    }
}

/// The runs of pixels of a row that see one triangle: (triangle, columns).
fn runs(row: &[u32]) -> impl Iterator<Item = (usize, std::ops::Range<usize>)> + '_ {
    let mut column = 0;
    row.chunk_by(|a, b| a == b).filter_map(move |run| {
        let columns = column..column + run.len();
        column = columns.end;
        (run[0] != NOTHING).then_some((run[0] as usize, columns))
    })
}

/// Renders and compares.
pub fn forward(surface: &Surface, textures: &Textures, brdf: &impl Brdf, view: &View) -> Tape {
    let size = view.reference.size;
    let screen = ScreenTriangles::new(surface.positions, surface.triangles, view.camera, size);
    let mut seen = Visibility::default();
    rasterise(&screen, size, (0.0, 0.0), &mut seen);
    let mut blends = Blends::default();
    if view.antialias {
        let (positions, triangles) = (surface.positions, surface.triangles);
        blends = find_blends(&screen, &seen, surface.edges, positions, triangles, view.camera);
    }
    let shaded = ShadedPixels::new(view.gradient_pixels, &blends, size);
    let mut rgba = vec![[0.0; 4]; size * size];
    let rows = rgba.par_chunks_mut(size.max(1)).zip(seen.triangle.par_chunks(size.max(1)));
    rows.enumerate().for_each(|(row, (pixels, seen))| {
        for (t, columns) in runs(seen) {
            let mut columns = columns.filter(|&column| shaded.contains(column, row)).peekable();
            if columns.peek().is_none() {
                continue;
            }
            let patch = Patch::new(surface, t, &screen.triangles[t], view.camera, textures);
            for column in columns {
                let at = (column as f64 + 0.5, row as f64 + 0.5);
                pixels[column] = patch.forward(brdf, at.0, at.1).extend(1.0).to_array();
            }
        }
    });
    let blend_tape = blends.forward(&mut rgba);
    let (loss, gradient) = compare(&rgba, view.composer, view.reference, &view.comparison, &shaded);
    Tape { rgba, seen, loss, screen, blends, blend_tape, gradient }
}

/// Rows that are worked on together.
const BAND: usize = 8;

/// What a band of rows hands on.
#[derive(Default)]
struct Band {
    fetches: [Vec<Fetch>; 2],
    texels: [Vec<[f32; 3]>; 2],
    shifts: Vec<ShiftUse>,
    corners: Vec<(u32, CornerGradients)>,
}

/// Adjoint of [`forward`]: adds the gradients of `tape.loss.total(…)` to `into`; where a quarter of the pixels is read, an
/// estimate of the gradients that all have.
///
/// All arguments must be those of the forward pass.
pub fn adjoint(
    surface: &Surface,
    textures: &Textures,
    brdf: &impl Brdf,
    view: &View,
    tape: &Tape,
    into: &mut Gradients,
) {
    let size = tape.seen.size;
    let count = 1 + usize::from(textures.normal.is_some());
    let vertices = into.positions.len() == surface.positions.len();
    let mut gradient = tape.gradient.clone();
    let to_edges = tape.blends.adjoint(&tape.blend_tape, &mut gradient);
    let rows = tape.seen.triangle.par_chunks((BAND * size).max(1));
    let bands: Vec<Band> = (rows.zip(gradient.par_chunks((BAND * size).max(1))))
        .enumerate()
        .map(|(index, (seen, gradient))| {
            let mut band = Band::default();
            for (row, (seen, gradient)) in seen.chunks(size).zip(gradient.chunks(size)).enumerate() {
                let row = index * BAND + row;
                let Some(weight) = view.gradient_pixels.weight_in_row(row) else { continue };
                let y = row as f64 + 0.5;
                for (t, columns) in runs(seen) {
                    let mut columns =
                        columns.filter(|&column| view.gradient_pixels.reads_column(column)).peekable();
                    if columns.peek().is_none() {
                        continue;
                    }
                    let triangle = &tape.screen.triangles[t];
                    let patch = Patch::new(surface, t, triangle, view.camera, textures);
                    let mut corners = CornerGradients::default();
                    for column in columns {
                        let [r, g, b, _] = gradient[column];
                        let (at, to_light) = ((column as f64 + 0.5, y), weight * Vec3::new(r, g, b));
                        let sink = vertices.then_some(&mut corners);
                        let texels = patch.adjoint(brdf, at, to_light, sink);
                        band.shifts.extend(texels.shift);
                        for k in 0..count {
                            band.texels[k].push(texels.gradients[k]);
                        }
                        for k in 0..if textures.shared { 1 } else { count } {
                            band.fetches[k].push(texels.fetches[k]);
                        }
                    }
                    if vertices {
                        patch.finish(&mut corners, size);
                        band.corners.push((t as u32, corners));
                    }
                }
            }
            band
        })
        .collect();

    let fetches = |k: usize| bands.iter().map(move |band| band.fetches[k].as_slice());
    let texels = |k: usize| bands.iter().map(|band| band.texels[k].as_slice()).collect::<Vec<_>>();
    let of_color = Scatter::new(textures.color, fetches(0));
    of_color.add(&texels(0), &mut into.color);
    if let (Some(map), Some(into)) = (textures.normal, &mut into.normal) {
        if textures.shared {
            of_color.add(&texels(1), into);
        } else {
            Scatter::new(map, fetches(1)).add(&texels(1), into);
        }
    }
    if let (Some(map), Some(into)) = (textures.parallax, &mut into.parallax) {
        bands.iter().flat_map(|band| &band.shifts).for_each(|shift| shift.scatter(map, into));
    }
    if !vertices {
        return;
    }
    for (t, corners) in bands.iter().flat_map(|band| &band.corners) {
        for (k, v) in surface.triangles[*t as usize].into_iter().enumerate() {
            into.positions[v as usize] += corners.positions[k];
            into.normals[v as usize] += corners.normals[k];
            into.tangents[v as usize] += corners.tangents[k];
            into.uvs[v as usize] += corners.uvs[k];
        }
    }
    for (ends, gradients) in to_edges {
        for (v, gradient) in ends.into_iter().zip(gradients) {
            into.positions[v as usize] += view.camera.project_adjoint(gradient, size);
        }
    }
}
