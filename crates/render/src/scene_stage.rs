//! One view of whole materials while it is drawn: what each sample sees, and its light (formulas in `scene_material.rs`).
//!
//! ```text
//! visible(band): the solid surface of each sample, what is in front of it ─┬─ band(…): shaded and composited
//!                                                                          └─ over(…): glass over what is solid and shaded already
//! ```
//!
//! Contract: bands of rows are independent, so nothing depends on the number of threads. Memory grows with the layers of one
//! band, and where there is glass of the whole picture.

use crate::behind::Behind;
use crate::camera::Camera;
use crate::frame::Orientation;
use crate::interpolate::{barycentrics, interpolate};
use crate::material_layers::LayeredLight;
use crate::metallic_roughness::LEAST_ROUGHNESS;
use crate::on_screen::OnScreen;
use crate::raster::{NOTHING, ScreenTriangle, Visibility};
use crate::scene::{Scene, Seen};
use crate::shade::Brdf;
use crate::turning_normals::added_roughness;
use parbake_image::MapValues;
use parbake_image::maps::MapKind;
use parbake_model::AlphaMode;
use parbake_model::glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::ops::Range;

/// Rows of pixels in a band.
pub(crate) const BAND: usize = 8;

/// What a triangle is that takes more than a look at its depth.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// Solid where it is not cut out.
    Cut,
    Blended,
    Glass,
    BackOfGlass,
}

/// A triangle that takes more than a look at its depth.
pub(crate) struct Special {
    pub triangle: u32,
    pub on_screen: ScreenTriangle,
    pub kind: Kind,
}

/// What a sample sees of a special triangle.
pub(crate) struct Layer {
    pub sample: u32,
    /// Index among the special triangles.
    pub special: u32,
    pub nearness: f64,
}

/// The solid surface at a sample.
#[derive(Clone, Copy)]
pub(crate) enum Solid {
    Nothing,
    Plain(u32),
    Special(u32),
}

/// What stands still during one view.
pub(crate) struct Stage<'a, B> {
    pub scene: &'a Scene,
    pub brdf: &'a B,
    pub camera: &'a Camera,
    pub screen: OnScreen<'a>,
    pub special: Vec<Special>,
    /// Those that each band of rows may show, by their index in `special`, ascending.
    pub by_band: Vec<Vec<u32>>,
    /// Of all that is not special.
    pub opaque: Visibility,
    /// Samples along a side of the picture, and of a pixel.
    pub fine: usize,
    pub supersample: usize,
    pub widens_highlights: bool,
}

/// What is seen in the rows of a band.
pub(crate) struct InBand {
    /// The solid surface of each sample.
    pub solid: Vec<Solid>,
    /// What is in front of them: blended surfaces and glass, sample by sample and from front to back.
    pub layers: Vec<Layer>,
}

/// A picture, or some rows of it.
#[derive(Default)]
pub(crate) struct Drawn {
    pub light: Vec<[f32; 4]>,
    /// None unless asked for.
    pub values: Vec<MapValues>,
    /// The light of what is solid at each sample that has layers, of each band by itself, where it is asked for.
    pub solid: Vec<Vec<Vec3>>,
}

/// What is drawn of what is seen.
#[derive(Clone, Copy)]
pub(crate) struct Drawing<'a> {
    /// With what is in front of solid surfaces, and what glass shows.
    pub layers: bool,
    pub behind: Option<&'a Behind>,
    pub with_values: bool,
    /// With the light of solid surfaces behind layers.
    pub keeps_solid: bool,
}

impl<B: Brdf<Orientation>> Stage<'_, B> {
    /// A picture, band by band.
    pub fn drawn(&self, band: impl Fn(usize) -> Drawn + Sync + Send) -> Drawn {
        let bands: Vec<Drawn> = (0..self.by_band.len()).into_par_iter().map(band).collect();
        let mut all = Drawn::default();
        for band in bands {
            all.light.extend(band.light);
            all.values.extend(band.values);
            all.solid.extend(band.solid);
        }
        all
    }

    /// The rows of samples of a band.
    fn rows(&self, band: usize) -> Range<usize> {
        let first = band * BAND * self.supersample;
        first..(first + BAND * self.supersample).min(self.fine)
    }

    /// The pixel of a band that a sample of it is in, and the sample's place in the picture.
    fn place(&self, rows: &Range<usize>, sample: usize) -> (usize, (f64, f64)) {
        let (column, row) = (sample % self.fine, sample / self.fine);
        let pixel = row / self.supersample * (self.fine / self.supersample) + column / self.supersample;
        (pixel, (column as f64 + 0.5, (rows.start + row) as f64 + 0.5))
    }

    /// The part of a pixel that one sample is.
    fn share(&self) -> f32 {
        1.0 / (self.supersample * self.supersample) as f32
    }

    /// The rows of a band.
    pub fn band(&self, band: usize, seen: &InBand, drawing: Drawing) -> Drawn {
        let (rows, share, size) = (self.rows(band), self.share(), self.fine / self.supersample);
        let pixels = rows.len() / self.supersample * size;
        let mut out = Drawn {
            light: vec![[0.0; 4]; pixels],
            values: vec![MapValues::ZERO; if drawing.with_values { pixels } else { 0 }],
            solid: Vec::new(),
        };
        let (mut solid_light, mut next) = (Vec::new(), 0);
        // Neighbouring samples mostly see the same triangle.
        let mut last = (NOTHING, ScreenTriangle::HIDDEN);
        for (sample, &solid) in seen.solid.iter().enumerate() {
            let from = next;
            next += seen.layers[from..].iter().take_while(|layer| layer.sample as usize == sample).count();
            let layers = if drawing.layers { &seen.layers[from..next] } else { &[] };
            if from == next && matches!(solid, Solid::Nothing) {
                continue;
            }
            let (pixel, at) = self.place(&rows, sample);
            let mut passed = 1.0;
            let mut add = |triangle: u32, on_screen: &ScreenTriangle, passed: &mut f32| {
                let (seen, lit) = self.shade(triangle as usize, on_screen, at, drawing.behind);
                let alpha = self.alpha(triangle, &seen);
                let to = &mut out.light[pixel];
                (0..3).for_each(|k| to[k] += lit.light[k] * (*passed * alpha * share));
                let weight = *passed * alpha * covered(&lit) * share;
                to[3] += weight;
                if let Some(to) = out.values.get_mut(pixel) {
                    for kind in MapKind::ALL {
                        to[kind] += match kind {
                            MapKind::Normal => seen.world_normal().extend(0.0),
                            _ => seen.values[kind],
                        } * weight;
                    }
                }
                *passed *= 1.0 - alpha;
                lit.light
            };
            for layer in layers {
                if passed > 0.0 {
                    let special = &self.special[layer.special as usize];
                    add(special.triangle, &special.on_screen, &mut passed);
                }
            }
            let light = match solid {
                Solid::Nothing => Vec3::ZERO,
                _ if passed == 0.0 => Vec3::ZERO,
                Solid::Plain(triangle) => {
                    if last.0 != triangle {
                        last = (triangle, self.screen.triangle(triangle as usize));
                    }
                    add(triangle, &last.1, &mut passed)
                }
                Solid::Special(special) => {
                    let special = &self.special[special as usize];
                    add(special.triangle, &special.on_screen, &mut passed)
                }
            };
            if drawing.keeps_solid && from < next {
                solid_light.push(light);
            }
        }
        out.solid.push(solid_light);
        out
    }

    /// The picture of what is solid with what is in front of it, of the kinds that are meant.
    pub fn over(
        &self,
        solid: &Drawn,
        seen: &[InBand],
        behind: &Behind,
        is_meant: impl Fn(Kind) -> bool + Sync,
    ) -> Vec<[f32; 4]> {
        let (share, size) = (self.share(), self.fine / self.supersample);
        let mut light = solid.light.clone();
        light.par_chunks_mut(BAND * size).enumerate().for_each(|(band, light)| {
            let (rows, seen) = (self.rows(band), &seen[band]);
            let samples = seen.layers.chunk_by(|a, b| a.sample == b.sample);
            for (layers, solid) in samples.zip(&solid.solid[band]) {
                let sample = layers[0].sample as usize;
                let (pixel, at) = self.place(&rows, sample);
                let (mut sum, mut passed) = (Vec4::ZERO, 1.0);
                let specials = layers.iter().map(|layer| &self.special[layer.special as usize]);
                for special in specials.filter(|special| is_meant(special.kind)) {
                    if passed > 0.0 {
                        let (seen, lit) =
                            self.shade(special.triangle as usize, &special.on_screen, at, Some(behind));
                        let alpha = self.alpha(special.triangle, &seen);
                        sum += lit.light.extend(covered(&lit)) * (passed * alpha);
                        passed *= 1.0 - alpha;
                    }
                }
                // What of the solid surface is hidden now.
                if !matches!(seen.solid[sample], Solid::Nothing) {
                    sum -= solid.extend(1.0) * (1.0 - passed);
                }
                // Bright light that is hidden leaves what rounding adds.
                (0..4).for_each(|k| light[pixel][k] = (light[pixel][k] + sum[k] * share).max(0.0));
            }
        });
        light
    }

    /// The opacity of a surface where it is there, 0 to 1.
    fn alpha(&self, triangle: u32, seen: &Seen) -> f32 {
        match self.scene.surface(triangle as usize).alpha_mode {
            AlphaMode::Blend => seen.values[MapKind::BaseColor].w.clamp(0.0, 1.0),
            _ => 1.0,
        }
    }

    /// The light of a triangle at a sample, with what comes from behind; what passes then is of the background.
    fn shade(
        &self,
        triangle: usize,
        on_screen: &ScreenTriangle,
        at: (f64, f64),
        behind: Option<&Behind>,
    ) -> (Seen, LayeredLight) {
        let reads = |kind| self.brdf.reads(kind);
        let mut seen = self.scene.seen(self.camera, on_screen, triangle, at, 1.0, &reads);
        let mut values = seen.values;
        if self.widens_highlights {
            let mesh = &self.scene.mesh;
            let normals = mesh.triangles[triangle].map(|vertex| mesh.normals[vertex as usize]);
            let added = added_roughness(self.camera, normals, &barycentrics(on_screen, at.0, at.1));
            let roughness = &mut values[MapKind::MetallicRoughness].y;
            let widened = |roughness: f32| (roughness.max(LEAST_ROUGHNESS) + added).min(1.0);
            *roughness = widened(*roughness);
            if let Some(coat) = seen.layers.as_mut().and_then(|layers| layers.coat.as_mut()) {
                coat.roughness = widened(coat.roughness);
            }
        }
        let solid = |light| LayeredLight { light, passes: Vec3::ZERO };
        let light = match (self.scene.surface(triangle).is_unlit, &seen.layers) {
            (true, _) => solid(seen.values[MapKind::BaseColor].truncate()),
            (false, None) => solid(self.brdf.light(&seen.orientation(), &values)),
            (false, Some(layers)) => self.brdf.light_in_layers(&seen.orientation(), &values, layers),
        };
        let (Some(behind), Some(layers)) = (behind, &seen.layers) else { return (seen, light) };
        if light.passes == Vec3::ZERO {
            return (seen, light);
        }
        let mesh = &self.scene.mesh;
        let corners = mesh.triangles[triangle].map(|vertex| mesh.positions[vertex as usize]);
        let point: Vec3 = interpolate(corners, barycentrics(on_screen, at.0, at.1).weights);
        let exit = layers.refraction.exit(point, seen.world_normal(), seen.to_viewer);
        let projected = self.camera.project(exit, 1).homogeneous;
        let place = (projected.truncate() / projected.z).as_vec2();
        let roughness = values[MapKind::MetallicRoughness].y.clamp(LEAST_ROUGHNESS, 1.0);
        let from_behind = behind.through(place, &layers.refraction, roughness);
        let light = LayeredLight {
            light: light.light + light.passes * from_behind.truncate(),
            passes: light.passes * (1.0 - from_behind.w),
        };
        (seen, light)
    }

    /// What is seen in the rows of a band.
    pub fn visible(&self, band: usize) -> InBand {
        let rows = self.rows(band);
        let begin = rows.start * self.fine;
        let seen = &self.opaque.triangle[begin..rows.end * self.fine];
        let place = |sample: usize| {
            let (column, row) = (sample % self.fine, rows.start + sample / self.fine);
            (column as f64 + 0.5, row as f64 + 0.5)
        };
        let solid = |&triangle: &u32| match triangle {
            NOTHING => Solid::Nothing,
            triangle => Solid::Plain(triangle),
        };
        if self.special.is_empty() {
            return InBand { solid: seen.iter().map(solid).collect(), layers: Vec::new() };
        }
        let with_nearness = |(sample, triangle): (usize, &u32)| {
            let (x, y) = place(sample);
            let is_seen = *triangle != NOTHING;
            let nearness = is_seen.then(|| self.screen.triangle(*triangle as usize).nearness_at(x, y));
            (solid(triangle), nearness.unwrap_or(f64::NEG_INFINITY))
        };
        let mut solids: Vec<(Solid, f64)> = seen.iter().enumerate().map(with_nearness).collect();
        let each = |is_meant: &dyn Fn(Kind) -> bool, found: &mut dyn FnMut(usize, usize, f64)| {
            let all = self.by_band[band].iter().map(|&index| (index as usize, &self.special[index as usize]));
            for (index, special) in all.filter(|(_, special)| is_meant(special.kind)) {
                let own = special.on_screen.rows(self.fine);
                for row in rows.start.max(own.start)..rows.end.min(own.end) {
                    for (column, nearness) in special.on_screen.on_row(row, self.fine) {
                        found(index, (row - rows.start) * self.fine + column, nearness);
                    }
                }
            }
        };
        let is_there = |index: usize, sample: usize| {
            let special = &self.special[index];
            self.scene.is_there(self.camera, special.triangle as usize, &special.on_screen, place(sample))
        };
        each(&|kind| kind == Kind::Cut, &mut |index, sample, nearness| {
            if nearness > solids[sample].1 && is_there(index, sample) {
                solids[sample] = (Solid::Special(index as u32), nearness);
            }
        });
        let mut layers = Vec::new();
        each(&|kind| kind != Kind::Cut, &mut |index, sample, nearness| {
            if nearness > solids[sample].1 && is_there(index, sample) {
                layers.push(Layer { sample: sample as u32, special: index as u32, nearness });
            }
        });
        layers.sort_by(|a, b| {
            let order = a.sample.cmp(&b.sample).then(b.nearness.total_cmp(&a.nearness));
            order.then(a.special.cmp(&b.special))
        });
        InBand { solid: solids.into_iter().map(|(solid, _)| solid).collect(), layers }
    }
}

/// How much of what is behind it a surface covers: all, or what does not pass on to the background, the mean over the channels.
fn covered(lit: &LayeredLight) -> f32 {
    1.0 - lit.passes.element_sum() / 3.0
}
