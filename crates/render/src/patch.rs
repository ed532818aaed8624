//! One triangle's samples: interpolation, frame, texture and shading in one go.
//!
//! Forward: `β → (uv, footprint, point, n, t) → shift → (light, gram), colour, map normal →
//! light`, by the stages of the other files. Adjoint: the same stages backwards, each
//! sample computed anew: its texels are in the cache, a record of it would not be.
//! What is linear in the corners' gradients is summed over a run of samples and leaves
//! the patch once.
//!
//! Contract: normals and tangents are interpolated and not re-normalised; handedness is
//! that of the first corner; on a face seen from behind the normal is flipped.

use crate::camera::{Camera, Projection};
use crate::directions::ViewDirection;
use crate::frame::{TangentLight, tangent_light, tangent_light_adjoint};
use crate::interpolate::{Barycentrics, barycentrics, footprint_adjoint, interpolate, planes_adjoint};
use crate::parallax::ParallaxCoefficients;
use crate::raster::ScreenTriangle;
use crate::scatter::Fetch;
use crate::shade::{Brdf, BrdfGradient};
use crate::surface::{Surface, Textures};
use glam::DVec3;
use parbake_image::slopes::Reach;
use parbake_image::{MapKind, MapValues};
use parbake_model::glam::{Vec2, Vec3};

/// What all samples on one triangle share.
pub struct Patch<'a> {
    triangle: &'a ScreenTriangle,
    camera: &'a Camera,
    positions: [Vec3; 3],
    normals: [Vec3; 3],
    tangents: [Vec3; 3],
    uvs: [Vec2; 3],
    handedness: f32,
    facing: f32,
    textures: &'a Textures<'a>,
}

/// Gradients of what three corners carry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CornerGradients {
    /// Of the positions, in world space.
    pub positions: [Vec3; 3],
    /// Of the normals.
    pub normals: [Vec3; 3],
    /// Of the tangents.
    pub tangents: [Vec3; 3],
    /// Of the texture coordinates.
    pub uvs: [Vec2; 3],
    /// Of the screen's planes, from which [`Patch::finish`] makes positions'.
    planes: [DVec3; 3],
}

/// A sample's way as far as the shading.
struct Sample {
    at: Barycentrics,
    /// Before the shift.
    uv: Vec2,
    /// Where textures are fetched.
    fetched: Vec2,
    view_direction: ViewDirection,
    per_x: Vec2,
    per_y: Vec2,
    to_light: Vec3,
    /// Distance to the viewer.
    distance: f32,
    normal: Vec3,
    tangent: Vec3,
    light: TangentLight,
    lods: [f32; 2],
    reaches: [Reach; 2],
}

/// One use of a parallax map, and the gradient of the shift that it gave.
#[derive(Clone, Copy, Debug)]
pub struct ShiftUse {
    uv: Vec2,
    view_direction: ViewDirection,
    to_shift: Vec2,
}

impl ShiftUse {
    /// Adds to the gradient of the map that it was a use of.
    pub fn scatter(&self, map: &ParallaxCoefficients, into: &mut ParallaxCoefficients) {
        map.adjoint_of_maps(self.uv, &self.view_direction, self.to_shift, into);
    }
}

/// Where one sample fetched, and the gradients of what it got: colour, then normal.
#[derive(Clone, Copy, Debug)]
pub struct SampleTexels {
    /// In the two textures; equal where they have one shape, the second unused where
    /// there is no normal texture.
    pub fetches: [Fetch; 2],
    /// Of the fetched colour and the fetched normal.
    pub gradients: [[f32; 3]; 2],
    /// Of the shift, where there is a parallax map.
    pub shift: Option<ShiftUse>,
}

fn color_of(gradient: &BrdfGradient) -> Vec3 {
    gradient.maps[MapKind::BaseColor].truncate()
}

fn normal_of(gradient: &BrdfGradient) -> Vec3 {
    gradient.maps[MapKind::Normal].truncate()
}

impl<'a> Patch<'a> {
    /// Gathers one triangle's corners.
    pub fn new(
        surface: &Surface,
        index: usize,
        triangle: &'a ScreenTriangle,
        camera: &'a Camera,
        textures: &'a Textures<'a>,
    ) -> Self {
        let corners = surface.triangles[index].map(|i| i as usize);
        let positions = corners.map(|i| surface.positions[i]);
        let area_normal = (positions[1] - positions[0]).cross(positions[2] - positions[0]);
        let behind = camera.view_direction(positions[0]).dot(area_normal) < 0.0;
        let (tangents, handedness) = match surface.tangents {
            [] => ([Vec3::ZERO; 3], 1.0),
            all if textures.normal.is_some() => (corners.map(|i| all[i].truncate()), all[corners[0]].w),
            _ => ([Vec3::ZERO; 3], 1.0),
        };
        Self {
            triangle,
            camera,
            positions,
            normals: corners.map(|i| surface.normals.get(i).copied().unwrap_or_default()),
            tangents,
            uvs: corners.map(|i| surface.uvs.get(i).copied().unwrap_or_default()),
            handedness,
            facing: if behind { -1.0 } else { 1.0 },
            textures,
        }
    }

    #[inline]
    fn sample(&self, x: f64, y: f64) -> Sample {
        let at = barycentrics(self.triangle, x, y);
        let along = |w: [f32; 3]| -> Vec2 { interpolate(self.uvs, w) };
        let normal = interpolate(self.normals, at.weights);
        let tangent = interpolate(self.tangents, at.weights);
        let (to_light, distance) = match self.camera.projection {
            Projection::Perspective(_) => {
                let way = self.camera.eye - interpolate(self.positions, at.weights);
                let length = way.length().max(1e-20);
                (way / length, length)
            }
            Projection::Orthographic(_) => (self.camera.back, 1.0),
        };
        let (uv, per_x, per_y) = (along(at.weights), along(at.per_x), along(at.per_y));
        let Textures { color, normal: map, parallax, .. } = self.textures;
        let mut view_direction = ViewDirection { direction: to_light, cosine: 1.0 };
        let mut fetched = uv;
        if let Some(parallax) = parallax {
            view_direction.cosine = normal.normalize_or_zero().dot(to_light);
            fetched += parallax.shift(uv, &view_direction);
        }
        let mut lods = [color.lod(per_x, per_y); 2];
        let mut reaches = [color.reach(fetched, lods[0]); 2];
        if let (Some(map), false) = (map, self.textures.shared) {
            lods[1] = map.lod(per_x, per_y);
            reaches[1] = map.reach(fetched, lods[1]);
        }
        Sample {
            at,
            uv,
            fetched,
            view_direction,
            per_x,
            per_y,
            lods,
            reaches,
            to_light,
            distance,
            normal,
            tangent,
            light: tangent_light(normal, tangent, self.handedness, to_light, self.facing),
        }
    }

    /// Forward: the light that leaves the triangle where it is seen at (x, y).
    #[inline]
    pub fn forward(&self, brdf: &impl Brdf, x: f64, y: f64) -> Vec3 {
        let s = self.sample(x, y);
        brdf.light(&s.light, &self.fetch(&s))
    }

    #[inline]
    fn fetch(&self, s: &Sample) -> MapValues {
        let color = self.textures.color.fetch_at(&s.reaches[0]);
        let normal = self.textures.normal.map(|map| map.fetch_at(&s.reaches[1]));
        MapValues::of(Vec3::from(color), normal.map_or(Vec3::Z, Vec3::from))
    }

    /// Adjoint of [`Patch::forward`]: adds to the corners' gradients, and returns the
    /// texels'. Without `corners` only the latter are computed.
    #[inline]
    pub fn adjoint(
        &self,
        brdf: &impl Brdf,
        (x, y): (f64, f64),
        gradient: Vec3,
        corners: Option<&mut CornerGradients>,
    ) -> SampleTexels {
        let s = self.sample(x, y);
        let texels = |color: Vec3, normal: Vec3, shift| SampleTexels {
            fetches: [Fetch { uv: s.fetched, lod: s.lods[0] }, Fetch { uv: s.fetched, lod: s.lods[1] }],
            gradients: [color.to_array(), normal.to_array()],
            shift,
        };
        let used = |to_shift| ShiftUse { uv: s.uv, view_direction: s.view_direction, to_shift };
        let Some(corners) = corners else {
            let shade = brdf.adjoint(&s.light, &self.fetch(&s), gradient);
            let to_shift = self.textures.parallax.map(|_| used(self.to_coordinate(&s, &shade)));
            return texels(color_of(&shade), normal_of(&shade), to_shift);
        };
        let color = self.textures.color.slopes_at(&s.reaches[0]);
        let mapped = self.textures.normal.map(|map| (map, map.slopes_at(&s.reaches[1])));
        let map_normal = mapped.as_ref().map_or(Vec3::Z, |(_, slopes)| Vec3::from(slopes.value));
        let values = MapValues::of(Vec3::from(color.value), map_normal);
        let shade = brdf.adjoint(&s.light, &values, gradient);

        let (mut to_uv, to_lod) = color.adjoint(&color_of(&shade).to_array());
        let (mut to_x, mut to_y) = self.textures.color.lod_adjoint(s.per_x, s.per_y, to_lod);
        if let Some((map, slopes)) = &mapped {
            let (uv, to_lod) = slopes.adjoint(&normal_of(&shade).to_array());
            let (x, y) = map.lod_adjoint(s.per_x, s.per_y, to_lod);
            (to_uv, to_x, to_y) = (to_uv + uv, to_x + x, to_y + y);
        }
        let (mut to_normal, to_tangent, mut to_direction) = tangent_light_adjoint(
            s.normal,
            s.tangent,
            self.handedness,
            s.to_light,
            self.facing,
            &shade.surface,
        );
        let to_shift = self.textures.parallax.map(|parallax| {
            let used = used(to_uv);
            let shift = parallax.view_direction_adjoint(s.uv, &s.view_direction, to_uv);
            to_uv += shift.uv;
            let unit = s.normal.normalize_or_zero();
            let across = s.to_light - unit * s.view_direction.cosine;
            to_normal += across * (shift.cosine / s.normal.length().max(1e-20));
            to_direction += shift.direction + unit * shift.cosine;
            used
        });
        let to_point = match self.camera.projection {
            // d = (eye − p) / |eye − p|: what is along d does not turn it.
            Projection::Perspective(_) => {
                (s.to_light * s.to_light.dot(to_direction) - to_direction) / s.distance
            }
            Projection::Orthographic(_) => Vec3::ZERO,
        };
        let mut to_weights = Barycentrics::default();
        for k in 0..3 {
            let weight = s.at.weights[k];
            corners.positions[k] += to_point * weight;
            corners.normals[k] += to_normal * weight;
            corners.tangents[k] += to_tangent * weight;
            corners.uvs[k] += to_uv * weight + to_x * s.at.per_x[k] + to_y * s.at.per_y[k];
            to_weights.weights[k] = to_uv.dot(self.uvs[k])
                + to_normal.dot(self.normals[k])
                + to_tangent.dot(self.tangents[k])
                + to_point.dot(self.positions[k]);
            to_weights.per_x[k] = to_x.dot(self.uvs[k]);
            to_weights.per_y[k] = to_y.dot(self.uvs[k]);
        }
        let planes = footprint_adjoint(self.triangle, x, y, &s.at, &to_weights);
        for (sum, plane) in corners.planes.iter_mut().zip(planes) {
            *sum += plane;
        }
        texels(color_of(&shade), normal_of(&shade), to_shift)
    }

    /// The gradient of the coordinate that is fetched at, levels of detail held.
    fn to_coordinate(&self, s: &Sample, shade: &BrdfGradient) -> Vec2 {
        let of_color = self.textures.color.slopes_at(&s.reaches[0]).adjoint(&color_of(shade).to_array()).0;
        let of_normal = self
            .textures
            .normal
            .map_or(Vec2::ZERO, |map| map.slopes_at(&s.reaches[1]).adjoint(&normal_of(shade).to_array()).0);
        of_color + of_normal
    }

    /// Ends a run of samples of an image `size` pixels wide: what moved on the screen
    /// moved in the world.
    pub fn finish(&self, corners: &mut CornerGradients, size: usize) {
        let on_screen = planes_adjoint(self.triangle, &std::mem::take(&mut corners.planes));
        for (position, gradient) in corners.positions.iter_mut().zip(on_screen) {
            *position += self.camera.project_adjoint(gradient, size);
        }
    }
}
