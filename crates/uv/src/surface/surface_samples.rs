//! What a surface's texture shall show, before any texture or view exists: points all over
//! the surface, each with the colour and the normal that the high-poly has there.
//!
//! Points are spread evenly, as cameras all around see the surface on average: a triangle
//! has as many as its area asks for, laid out by the R2 sequence (Roberts 2018).

use crate::distortion::{has_area, total_area};
use crate::signal::{Pixels, Sample, Signal};
use parbake_image::MapKind;
use parbake_image::display::encode_srgb;
use parbake_mesh::HighSurface;
use parbake_model::Mesh;
use parbake_model::glam::{DMat2, Vec3, Vec4};
use parbake_render::interpolate::interpolate;
use parbake_render::scene::Scene;
use rayon::prelude::*;

/// Where the signal comes from.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The high-poly.
    pub scene: &'a Scene,
    /// Its surface to project on; None where the low-poly is the high-poly itself, with the
    /// same triangles.
    pub surface: Option<&'a HighSurface>,
    /// How much each triangle counts, for instance how much of it is seen (`parbake_mesh::visibilities`); empty where
    /// all count alike.
    pub importances: &'a [f32],
    /// How far projection looks to either side, in the common frame.
    pub max_distance: f32,
    /// How far dark colours are brightened before they are compared, as strong light does: 0 for stored
    /// values, 1 for what sRGB's curve makes of them.
    pub brightened: f32,
    /// Whether normals count: where a normal map is to be made.
    pub normals: bool,
    /// Width of a sample of a view that sees the surface from straight above, in the common frame.
    pub pixel: f64,
}

impl Source<'_> {
    /// Width of a pixel of views that a low-poly is fitted to: it fills some 700 of them.
    pub const PIXEL: f64 = 2.8 / 1024.0;
    /// Width of a sample of views that a model's own texture is made for, if its texels are not finer: a
    /// model that fills 512² pixels of four samples each, where it is nearest.
    pub const SAMPLE: f64 = 0.0021;
}

/// A size at which a surface is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Width of a sample as a multiple of [`Source::pixel`].
    pub width: f64,
    /// How much it counts.
    pub share: f64,
}

/// The surface as it is seen from straight above, and from twice as far.
pub const FULL_AND_HALF: [Size; 2] = [Size { width: 1.0, share: 1.0 }, Size { width: 2.0, share: 1.0 }];

/// The surface as views all around see it. A fetch is as wide as the longer side of what a sample
/// covers, 1 / cos times as wide as from straight above; of what views see of a round body, the
/// share c² has a cosine below c. The widths are an octave apart or half of one.
pub const FORESHORTENED: [Size; 4] = [
    Size { width: 1.0, share: 0.29 },
    Size { width: std::f64::consts::SQRT_2, share: 0.35 },
    Size { width: 2.0, share: 0.23 },
    Size { width: 4.0, share: 0.13 },
];

/// How much a normal's change counts against a colour's: light from the camera turns a
/// change of the angle into about this share of the colour, over the visible half-sphere.
const NORMAL_WEIGHT: f32 = 0.5;

/// Shade where normals do not count: a number that bytes hold, so that rounding has nothing to lose.
const UNSHADED: f32 = 128.0 / 255.0;

/// What is never seen from outside counts as if this share of its views showed it: a camera may go
/// inside.
const HIDDEN: f32 = 0.05;

/// The surface at these sizes: a sample for each that views take, at most about `most` where the
/// width is 1 and in proportion at the others.
pub fn signal_scales(
    mesh: &Mesh,
    rest: &[DMat2],
    source: &Source,
    sizes: &[Size],
    most: usize,
) -> Vec<Signal> {
    let least = (total_area(rest) / most as f64).sqrt();
    let spacing = source.pixel.max(least);
    sizes.iter().map(|size| signal_scale(mesh, rest, source, size, spacing * size.width)).collect()
}

fn signal_scale(mesh: &Mesh, rest: &[DMat2], source: &Source, size: &Size, spacing: f64) -> Signal {
    let pixel = source.pixel * size.width;
    let total = total_area(rest);
    // What one triangle is too small for goes to the next: the sum is right.
    let mut carried = 0.0;
    let counts: Vec<usize> = rest
        .iter()
        .map(|r| {
            carried += 0.5 * r.determinant() / (spacing * spacing);
            let count = carried.floor();
            carried -= count;
            if has_area(r, total) { count as usize } else { 0 }
        })
        .collect();
    let counted = |t: usize| source.importances.get(t).map_or(1.0, |weight| weight.max(HIDDEN));
    let all: f64 = counts.iter().enumerate().map(|(t, n)| *n as f64 * f64::from(counted(t))).sum();
    let unit = (size.share / all.max(f64::MIN_POSITIVE)) as f32;
    let samples: Vec<(u32, Sample)> = (counts.par_iter().enumerate())
        .flat_map_iter(|(t, &count)| {
            (0..count).filter_map(move |i| {
                let barycentric = spread(t, i);
                let target = look(mesh, t, barycentric, source, pixel as f32)?;
                Some((t as u32, Sample { target, barycentric, weight: unit * counted(t) }))
            })
        })
        .collect();
    let mut signal = Signal::new(rest.len(), &samples);
    let pixel_on = |r: &DMat2| if has_area(r, total) { r.inverse() * pixel } else { DMat2::ZERO };
    signal.pixels = Pixels::Each(rest.iter().map(pixel_on).collect());
    signal
}

/// The i-th point of a triangle.
fn spread(triangle: usize, i: usize) -> [f32; 2] {
    let at = |step: f64| ((i as f64 + 1.0) * step + triangle as f64 * 0.618_033_988_749).fract() as f32;
    let (b, c) = (at(0.754_877_666_246_7), at(0.569_840_290_998_1));
    if b + c <= 1.0 { [b, c] } else { [1.0 - b, 1.0 - c] }
}

/// Colour in three channels; in the fourth how the normal shades it, which stands for the
/// normal map.
fn look(mesh: &Mesh, t: usize, [b, c]: [f32; 2], source: &Source, width: f32) -> Option<Vec4> {
    // A layout's second and third corner are the mesh's third and second.
    let weights = [1.0 - b - c, c, b];
    let (color, normal) = match source.surface {
        None => {
            let found = source.scene.look(t, weights, width);
            (found[MapKind::BaseColor].truncate(), found[MapKind::Normal].truncate())
        }
        Some(surface) => {
            let corners = mesh.triangles[t].map(|i| i as usize);
            let point = interpolate(corners.map(|i| mesh.positions[i]), weights);
            let normal = interpolate(corners.map(|i| mesh.normals[i]), weights).normalize_or_zero();
            let hit = surface.project(point, normal, source.max_distance)?;
            let [b1, b2] = hit.barycentric;
            // Where the surfaces are apart, views see the detail in different places by about
            // that distance, and no texture can show more than their mean.
            let width = width.max(hit.distance.abs());
            let values = source.scene.look(hit.triangle as usize, [1.0 - b1 - b2, b1, b2], width);
            let (color, found) = (values[MapKind::BaseColor].truncate(), values[MapKind::Normal].truncate());
            (color, if found.dot(normal) < 0.0 { -found } else { found })
        }
    };
    let shown = |x: f32| {
        let x = x.clamp(0.0, 1.0);
        if source.brightened > 0.0 { x + source.brightened * (encode_srgb(x) - x) } else { x }
    };
    let color = Vec3::from(color.to_array().map(shown));
    let shade = if source.normals {
        0.5 + NORMAL_WEIGHT * color.element_sum() / 3.0 * normal.dot(Vec3::ONE) / 3f32.sqrt()
    } else {
        UNSHADED
    };
    Some(color.extend(shade))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_atlas::Layout;
    use parbake_model::glam::vec2;
    use parbake_model::{Image, Material, Model, TextureSlot};
    use parbake_render::interpretation::Interpretation;
    use parbake_views::frame::{common_frame, scene};

    /// Protects what a normal map shows: a bump in it counts as a change of shade where normals count, and
    /// on plain colour nothing does where they do not.
    #[test]
    fn normals_count_where_a_map_is_to_be_made() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let mesh = Mesh {
            positions: corners.iter().map(|&(x, y)| Vec3::new(x, -y, 0.0)).collect(),
            uvs: corners.iter().map(|&(x, y)| vec2(x, y)).collect(),
            triangles: vec![[0, 2, 1], [0, 3, 2]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        let tilted = |i: usize| if i % 64 < 32 { [128, 128, 255, 255] } else { [218, 128, 218, 255] };
        let pixels = (0..64 * 64).map(tilted).collect();
        let map = TextureSlot { image: 0, ..TextureSlot::default() };
        let model = Model {
            mesh,
            materials: vec![Material { normal_texture: Some(map), ..Material::default() }],
            images: vec![Image { name: "normals".into(), width: 64, height: 64, pixels }],
            ..Model::default()
        };
        let frame = common_frame(&model).expect("it has an extent");
        let scene = scene(&model, &frame, Interpretation { decode_srgb: false, ..Interpretation::default() });
        let shades = |normals: bool| -> Vec<f32> {
            let (brightened, pixel) = (0.0, 0.02);
            let source = Source {
                scene: &scene,
                surface: None,
                importances: &[],
                max_distance: 0.0,
                brightened,
                normals,
                pixel,
            };
            let rest = Layout::new(scene.mesh()).rest;
            let signal = signal_scales(scene.mesh(), &rest, &source, &FULL_AND_HALF, 10_000).remove(0);
            signal.samples.iter().map(|sample| sample.target.w).collect()
        };
        let spread = |shades: &[f32]| {
            let (low, high) = shades.iter().fold((1.0f32, 0.0f32), |(l, h), s| (l.min(*s), h.max(*s)));
            high - low
        };
        assert!(spread(&shades(true)) > 0.05);
        assert!(shades(false).iter().all(|shade| *shade == UNSHADED));
    }
}
