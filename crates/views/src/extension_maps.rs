//! The high-poly's material extensions for the low-poly's layers: factors where one value holds all over a
//! layer, else images on the low-poly's own texture coordinates.
//!
//! Nothing is fitted. Each texel asks the high-poly's part of its layer along its normal, as in
//! `projection.rs`, so textures of extensions, and parts that differ in their factors, come out alike.
//! A factor is the largest value, and the image says how much of it is where.
//!
//! Contract: layers are those of [`alpha_layers`]; images are as large as the texture; what could not be
//! kept is said in words.

use crate::alpha_layers::{AlphaLayer, LayerKind, alpha_layers};
use crate::coat_normals::coat_normals;
use crate::extension_values::{Group, tangent_frame};
use crate::gutter;
use crate::high_poly::HighPoly;
use crate::layer_factors::{Part, Said, Shares, set};
use crate::low_poly::LowPoly;
use crate::projection::{corner_weights, texel_width};
use parbake_image::FloatImage;
use parbake_image::display::encode_srgb;
use parbake_mesh::{HighSurface, SurfacePoint};
use parbake_model::glam::{Vec2, Vec3, Vec4, vec4};
use parbake_model::{Image, MaterialExtensions, Mesh, TextureSlot};
use parbake_render::interpolate::interpolate;
use rayon::prelude::*;

/// What the layers of a low-poly have of the high-poly's extensions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExtensionMaps {
    /// The images that the layers' extensions name.
    pub images: Vec<Image>,
    /// Each layer's part.
    pub layers: Vec<LayerLook>,
    /// What is lost, in words; nothing where all is kept.
    pub lost: Vec<String>,
}

/// What one layer has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayerLook {
    /// Which layer.
    pub kind: LayerKind,
    /// Factors, and textures by their indices in [`ExtensionMaps::images`].
    pub extensions: MaterialExtensions,
    /// Whether the clearcoat has the normals of the surface below it, which are yet to be fitted. Else those that it
    /// has are among the extensions, if the mesh's do not do.
    pub coats_normals: bool,
}

/// Less than this share of the largest value makes no difference.
pub(crate) const ALIKE: f32 = 0.01;

/// The extensions for a low-poly whose triangles are of these kinds.
pub fn extension_maps(low: &LowPoly, kinds: &[LayerKind], high: &HighPoly) -> ExtensionMaps {
    let layers = alpha_layers(kinds, high);
    let shares: Vec<Shares> = layers.iter().map(|layer| Shares::of(&layer.high, high)).collect();
    let mut out = ExtensionMaps::default();
    for (layer, shares) in layers.iter().zip(&shares) {
        let kind = LayerKind { mode: layer.mode, transmits: layer.transmits };
        let mut look = LayerLook {
            kind,
            coats_normals: shares.coats_normals(high),
            extensions: MaterialExtensions::default(),
        };
        if !high.scene.is_unlit() {
            shares.set_numbers(high, kind, &mut look.extensions, &mut out.lost);
        }
        out.layers.push(look);
    }
    // Of what is not lit no extension shows.
    if high.scene.is_unlit() {
        return out;
    }
    let asked = |group: Group, layer: usize| {
        (group != Group::Passing || layers[layer].transmits) && shares[layer].has(group, high)
    };
    let folds = |layer: usize| !layers[layer].transmits && shares[layer].iors_differ(high);
    let mut points: Option<Vec<Option<SurfacePoint>>> = None;
    for group in Group::ALL {
        // One value for the whole layer needs no texels.
        let plain = |layer: usize| shares[layer].one_value(group, high, folds(layer));
        let varying: Vec<bool> =
            (0..layers.len()).map(|layer| asked(group, layer) && plain(layer).is_none()).collect();
        for layer in (0..layers.len()).filter(|&layer| asked(group, layer)) {
            if let Some(value) = plain(layer) {
                set(&mut out.layers[layer].extensions, group, group.parts().map(|p| p.said(value)), 0);
            }
        }
        if !varying.contains(&true) {
            continue;
        }
        let points = points.get_or_insert_with(|| project(low, &layers, high));
        let of_triangle = places(&layers, low.placed.triangles.len());
        let values =
            Values { low, high, points, of_triangle: &of_triangle, varying: &varying, folds: &folds };
        let values = values.of(group);
        let of_texel = |texel: usize| {
            let triangle = low.map.triangle[texel] as usize;
            of_triangle.get(triangle).copied().filter(|&l| varying.get(l) == Some(&true))
        };
        let said = summed(group, &values, &of_texel, layers.len());
        let largest = group.parts().map(|part| {
            let is_mapped = |s: &Said| group == Group::Anisotropy || s.spread > ALIKE * s.largest;
            let textured = said.iter().map(|s| s[part.place]).filter(is_mapped);
            textured.map(|s| s.largest).fold(0.0, f32::max)
        });
        let is_mapped = group == Group::Anisotropy || largest.iter().any(|&l| l > 0.0);
        let image = out.images.len();
        // A layer that covers no texel keeps the extension's defaults.
        let is_seen = |layer: usize| said[layer].iter().any(|s| s.is_there);
        for layer in (0..layers.len()).filter(|&layer| varying[layer] && is_seen(layer)) {
            let said =
                said[layer].map(|s| match group == Group::Anisotropy || s.spread > ALIKE * s.largest {
                    true => Said { value: Vec3::splat(largest[s.place]), is_textured: true, ..s },
                    false => s,
                });
            set(&mut out.layers[layer].extensions, group, said, image);
        }
        if is_mapped {
            let known: Vec<bool> = values.iter().map(Option::is_some).collect();
            let texels = values.into_iter().map(|value| value.unwrap_or_default()).collect();
            let mut canvas = FloatImage::square(low.map.size, texels);
            gutter::fill(&mut canvas, &known);
            out.images.push(painted(group, &canvas, largest));
        }
    }
    let coated: Vec<bool> = (out.layers.iter())
        .map(|look| !look.coats_normals && look.extensions.clearcoat.is_some_and(|coat| coat.factor > 0.0))
        .collect();
    if coated.contains(&true) {
        let points = points.get_or_insert_with(|| project(low, &layers, high));
        let of_triangle = places(&layers, low.placed.triangles.len());
        let is_coated = |triangle: usize| of_triangle.get(triangle).is_some_and(|&layer| coated[layer]);
        if let Some(normals) = coat_normals(low, high, points, is_coated) {
            let slot = TextureSlot { image: out.images.len(), ..TextureSlot::default() };
            out.images.push(normals);
            for (look, _) in out.layers.iter_mut().zip(coated).filter(|(_, is_coated)| *is_coated) {
                look.extensions.clearcoat.iter_mut().for_each(|coat| coat.normal_texture = Some(slot));
            }
        }
    }
    out
}

/// The layer of each triangle of the low-poly.
fn places(layers: &[AlphaLayer], triangles: usize) -> Vec<usize> {
    let mut places = vec![usize::MAX; triangles];
    for (place, layer) in layers.iter().enumerate() {
        layer.low.iter().for_each(|&t| places[t as usize] = place);
    }
    places
}

/// The point of the high-poly's part of its layer that each texel shows.
fn project(low: &LowPoly, layers: &[AlphaLayer], high: &HighPoly) -> Vec<Option<SurfacePoint>> {
    let mesh = high.scene.mesh();
    let parts: Vec<Option<HighSurface>> = layers
        .iter()
        .map(|layer| {
            (layer.high.len() < mesh.triangles.len()).then(|| {
                let triangles = layer.high.iter().map(|&t| mesh.triangles[t as usize]).collect();
                HighSurface::new(&Mesh { positions: mesh.positions.clone(), triangles, ..Mesh::default() })
            })
        })
        .collect();
    let of_triangle = places(layers, low.placed.triangles.len());
    let texels = low.map.size * low.map.size;
    let point = |texel: usize| {
        let triangle = low.map.triangle[texel] as usize;
        let place = *of_triangle.get(triangle)?;
        let corners = low.placed.triangles[triangle].map(|i| i as usize);
        let weights = corner_weights(low.map.barycentric[texel]);
        let point: Vec3 = interpolate(corners.map(|i| low.placed.positions[i]), weights);
        let normal: Vec3 = interpolate(corners.map(|i| low.placed.normals[i]), weights);
        let reach = high.conventions.max_distance;
        let (surface, own) = match parts.get(place)? {
            Some(part) => (part, Some(&layers[place].high)),
            None => (&high.surface, None),
        };
        let side = low.placed.area_normal(triangle);
        let mut hit = surface.project_facing(point, normal.normalize_or_zero(), side, reach)?;
        if let Some(own) = own {
            hit.triangle = own[hit.triangle as usize];
        }
        Some(hit)
    };
    (0..texels).into_par_iter().map(point).collect()
}

/// Where the values of texels come from.
struct Values<'a, F> {
    low: &'a LowPoly,
    high: &'a HighPoly,
    points: &'a [Option<SurfacePoint>],
    of_triangle: &'a [usize],
    varying: &'a [bool],
    folds: &'a F,
}

impl<F: Fn(usize) -> bool + Sync> Values<'_, F> {
    /// A group's value at each texel of the layers in which it varies. Of anisotropy xy becomes the
    /// direction in the low-poly's own tangent space.
    fn of(&self, group: Group) -> Vec<Option<Vec4>> {
        let mesh = self.high.scene.mesh();
        let (low, size) = (&self.low.placed, self.low.map.size);
        let folds: Vec<bool> = (0..self.varying.len()).map(self.folds).collect();
        let value = |texel: usize| {
            let hit = self.points[texel]?;
            let triangle = self.low.map.triangle[texel] as usize;
            let layer = self.of_triangle[triangle];
            if !self.varying[layer] {
                return None;
            }
            let width = texel_width(low, triangle, size);
            let own = corner_weights(hit.barycentric);
            let source = &self.high.extensions;
            let value = source.at(group, mesh, hit.triangle as usize, own, width, folds[layer]);
            if group != Group::Anisotropy {
                return Some(value);
            }
            let frame = tangent_frame(low, triangle, corner_weights(self.low.map.barycentric[texel]));
            let found = value.truncate();
            let along = Vec2::new(found.dot(frame.x_axis), found.dot(frame.y_axis));
            let direction = along.normalize_or(Vec2::X);
            Some(vec4(direction.x, direction.y, 0.0, value.w))
        };
        (0..size * size).into_par_iter().map(value).collect()
    }
}

/// What the texels of each layer say together of either part of a group.
pub(crate) fn summed(
    group: Group,
    values: &[Option<Vec4>],
    of_texel: &impl Fn(usize) -> Option<usize>,
    layers: usize,
) -> Vec<[Said; 2]> {
    struct Sum {
        low: Vec3,
        high: Vec3,
        sum: Vec3,
        count: f32,
    }
    let none = || Sum { low: Vec3::INFINITY, high: Vec3::ZERO, sum: Vec3::ZERO, count: 0.0 };
    let mut sums: Vec<[Sum; 2]> = (0..layers).map(|_| [none(), none()]).collect();
    let parts = group.parts();
    for (texel, value) in values.iter().enumerate() {
        let (Some(value), Some(layer)) = (value, of_texel(texel)) else { continue };
        for (part, sum) in parts.iter().zip(&mut sums[layer]) {
            // What is not there has no roughness.
            if part.is_strength || group.strength(*value) > ALIKE {
                let own = part.of(*value);
                (sum.low, sum.high) = (sum.low.min(own), sum.high.max(own));
                sum.sum += own;
                sum.count += 1.0;
            }
        }
    }
    let said = |part: Part, sum: &Sum| match sum.count > 0.0 {
        false => Said { place: part.place, ..Said::default() },
        true => Said {
            place: part.place,
            value: sum.sum / sum.count,
            spread: (sum.high - sum.low).max_element(),
            largest: sum.high.max_element(),
            is_textured: false,
            is_there: true,
        },
    };
    sums.iter().map(|own| [0, 1].map(|k| said(parts[k], &own[k]))).collect()
}

/// The image of a group, in which `largest` is white.
pub(crate) fn painted(group: Group, texels: &FloatImage<Vec4>, largest: [f32; 2]) -> Image {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let share = |x: f32, place: usize| if largest[place] > 0.0 { x / largest[place] } else { 1.0 };
    let pixel = |v: &Vec4| match group {
        Group::Anisotropy => {
            let direction = v.truncate().truncate().normalize_or(Vec2::X) * 0.5 + 0.5;
            [byte(direction.x), byte(direction.y), byte(share(v.w, 0)), 255]
        }
        Group::Clearcoat | Group::Passing | Group::Iridescence => {
            [byte(share(v.x, 0)), byte(share(v.y, 1)), 0, 255]
        }
        Group::Sheen | Group::DiffuseTransmission | Group::Specular => {
            let color = |x: f32| byte(encode_srgb(share(x, 0).clamp(0.0, 1.0)));
            [color(v.x), color(v.y), color(v.z), byte(share(v.w, 1))]
        }
    };
    let pixels = texels.texels.par_iter().map(pixel).collect();
    Image { name: group.name().into(), width: texels.width, height: texels.height, pixels }
}

#[cfg(test)]
#[path = "extension_maps_tests.rs"]
mod tests;
