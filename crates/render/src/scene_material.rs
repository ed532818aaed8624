//! Whole materials in a picture: shaded by a BRDF that knows where the viewer is, single-sided where they say so,
//! cut out, and blended in order.
//!
//! Forward, for each sample: the nearest solid surface is found, opaque or above its cutoff (glTF 2.0, 3.9.4);
//! of all blended surfaces in front of it, from front to back, with transmittance `T`:
//!
//! ```text
//! light += T α c,  T ← T (1 − α + α p);  at last light += T c of the solid one,  coverage = 1 − T after it
//! ```
//!
//! (Porter and Duff, Compositing Digital Images, 1984), in linear light; p is what passes a surface that transmits light
//! (`material_layers.rs`), and of a tint coverage has the mean. What the maps hold is composited by the same
//! transmittance, its mean over the channels. Samples of a pixel are averaged.
//!
//! Contract: pictures are as in `scene.rs`. Bands of rows are independent, so nothing depends on the number of
//! threads; memory grows with the layers of one band.

use crate::camera::Camera;
use crate::frame::Orientation;
use crate::interpolate::{barycentrics, interpolate};
use crate::material_layers::LayeredLight;
use crate::metallic_roughness::LEAST_ROUGHNESS;
use crate::on_screen::OnScreen;
use crate::raster::{NOTHING, ScreenTriangle, Visibility};
use crate::scene::{Picture, Scene, Seen};
use crate::scene_pyramids::Map;
use crate::scene_textures::{SeenPoint, Surface};
use crate::shade::Brdf;
use crate::turning_normals::added_roughness;
use parbake_image::MapValues;
use parbake_image::maps::MapKind;
use parbake_model::AlphaMode;
use parbake_model::glam::{Vec2, Vec3};
use rayon::prelude::*;

/// A view of whole materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialPicture {
    /// What is seen.
    pub light: Picture,
    /// What the maps hold there, premultiplied by coverage, row 0 on top; none unless asked for. Normals are unit
    /// vectors of the common frame that look to the viewer's side.
    pub values: Vec<MapValues>,
}

/// Rows of pixels in a band.
const BAND: usize = 8;

/// A triangle that takes more than a look at its depth.
struct Special {
    triangle: u32,
    on_screen: ScreenTriangle,
    is_blended: bool,
}

/// What a sample sees of a special triangle.
struct Layer {
    sample: usize,
    nearness: f64,
    /// Index among the special triangles.
    special: usize,
}

/// The solid surface at a sample.
#[derive(Clone, Copy)]
enum Solid {
    Nothing,
    Plain(u32),
    Special(usize),
}

/// What stands still during one view.
struct Stage<'a, B> {
    scene: &'a Scene,
    brdf: &'a B,
    camera: &'a Camera,
    screen: OnScreen<'a>,
    special: Vec<Special>,
    /// Those that each band of rows may show, by their index in `special`, ascending.
    by_band: Vec<Vec<u32>>,
    /// Of all that is not special.
    opaque: Visibility,
    /// Samples along a side of the picture, and of a pixel.
    fine: usize,
    supersample: usize,
    widens_highlights: bool,
}

impl Scene {
    /// The whole view with whole materials, each pixel the mean of `supersample`² samples; the maps' values too,
    /// if `with_values`. With `widens_highlights` roughness grows where vertex normals turn (`turning_normals.rs`).
    pub fn render_material(
        &self,
        brdf: &impl Brdf<Orientation>,
        camera: &Camera,
        (size, supersample): (usize, usize),
        widens_highlights: bool,
        with_values: bool,
    ) -> MaterialPicture {
        let fine = size * supersample;
        let screen = self.layer_on_screen(|mode, _| mode == AlphaMode::Opaque, camera, fine);
        let screen = screen.unwrap_or_else(|| self.on_screen(camera, fine));
        let special = self.special(camera, &screen);
        let is_plain = |triangle: u32| {
            let triangle = triangle as usize;
            !self.surface(triangle).is_special() && !self.shows_its_back(camera, triangle)
        };
        let mut opaque = Visibility::default();
        screen.rasterise_some(fine, is_plain, &mut opaque);
        let mut by_band = vec![Vec::new(); size.div_ceil(BAND)];
        for (index, special) in special.iter().enumerate() {
            let rows = special.on_screen.rows(fine);
            if !rows.is_empty() {
                let [first, last] = [rows.start, rows.end - 1].map(|row| row / (BAND * supersample));
                by_band[first..=last].iter_mut().for_each(|band| band.push(index as u32));
            }
        }
        let stage = Stage {
            scene: self,
            brdf,
            camera,
            screen,
            special,
            by_band,
            opaque,
            fine,
            supersample,
            widens_highlights,
        };
        let mut light = Picture { size, rgba: vec![[0.0; 4]; size * size] };
        let mut values = vec![MapValues::ZERO; if with_values { size * size } else { 0 }];
        let bands = light.rgba.par_chunks_mut(size * BAND);
        if with_values {
            let bands = bands.zip(values.par_chunks_mut(size * BAND)).enumerate();
            bands.for_each(|(band, (light, values))| stage.fill(band, light, values));
        } else {
            bands.enumerate().for_each(|(band, light)| stage.fill(band, light, &mut []));
        }
        MaterialPicture { light, values }
    }

    /// All triangles that are cut out or blended, but for those that show only their back.
    fn special(&self, camera: &Camera, screen: &OnScreen) -> Vec<Special> {
        if !self.surfaces.iter().any(Surface::is_special) {
            return Vec::new();
        }
        let special = |triangle: usize| {
            let surface = self.surface(triangle);
            (surface.is_special() && !self.shows_its_back(camera, triangle)).then(|| Special {
                triangle: triangle as u32,
                on_screen: screen.triangle(triangle),
                is_blended: surface.is_blended(),
            })
        };
        (0..self.mesh.triangles.len()).into_par_iter().filter_map(special).collect()
    }

    fn surface(&self, triangle: usize) -> &Surface {
        &self.surfaces[self.mesh.triangle_materials[triangle] as usize]
    }

    /// Whether a triangle is single-sided and seen from behind.
    fn shows_its_back(&self, camera: &Camera, triangle: usize) -> bool {
        let corner = || self.mesh.positions[self.mesh.triangles[triangle][0] as usize];
        let is_turned = || camera.view_direction(corner()).dot(self.face_normals[triangle]) < 0.0;
        !self.surface(triangle).is_double_sided && is_turned()
    }

    /// Whether a point of a triangle is there at all: not left out by its cutout, nor below the cutoff of its mask.
    fn is_there(&self, camera: &Camera, triangle: usize, on_screen: &ScreenTriangle, at: (f64, f64)) -> bool {
        let (surface, mesh) = (self.surface(triangle), &self.mesh);
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let b = barycentrics(on_screen, at.0, at.1);
        if let Some(shifted) = &surface.shifted {
            let point: Vec3 = interpolate(corners.map(|i| mesh.positions[i]), b.weights);
            let to_viewer = camera.view_direction(point);
            if !shifted.is_opaque(&SeenPoint { mesh, corners, at: &b, to_viewer, footprint: 1.0 }) {
                return false;
            }
        }
        if surface.alpha_mode != AlphaMode::Mask {
            return true;
        }
        let fetch = |map: &Map| {
            let uvs = map.uvs(mesh, corners);
            let along = |w: [f32; 3]| -> Vec2 { interpolate(uvs, w) };
            let pyramid = &self.pyramids[map.pyramid];
            Vec3::from(pyramid.fetch(along(b.weights), pyramid.lod(along(b.per_x), along(b.per_y))))
        };
        self.opacity(surface, corners, b.weights, &fetch) >= surface.alpha_cutoff
    }
}

impl<B: Brdf<Orientation>> Stage<'_, B> {
    /// Fills the pixels of a band.
    fn fill(&self, band: usize, light: &mut [[f32; 4]], values: &mut [MapValues]) {
        let size = self.fine / self.supersample;
        let first = band * BAND * self.supersample;
        let rows = first..first + light.len() / size * self.supersample;
        let (solid, layers) = self.visible(band, rows.clone());
        let share = 1.0 / (self.supersample * self.supersample) as f32;
        let mut next = 0;
        // Neighbouring samples mostly see the same triangle.
        let mut last = (NOTHING, ScreenTriangle::HIDDEN);
        for (sample, solid) in solid.into_iter().enumerate() {
            let from = next;
            next += layers[from..].iter().take_while(|layer| layer.sample == sample).count();
            let (column, row) = (sample % self.fine, sample / self.fine);
            let pixel = row / self.supersample * size + column / self.supersample;
            let at = (column as f64 + 0.5, (rows.start + row) as f64 + 0.5);
            let mut passed = Vec3::ONE;
            let mut add = |triangle: u32, on_screen: &ScreenTriangle, is_blended: bool, passed: &mut Vec3| {
                let (seen, lit) = self.shade(triangle as usize, on_screen, at);
                let alpha = match self.scene.surface(triangle as usize).alpha_mode {
                    AlphaMode::Blend => seen.values[MapKind::BaseColor].w.clamp(0.0, 1.0),
                    _ => 1.0,
                };
                let passes = if is_blended { lit.passes } else { Vec3::ZERO };
                let to = &mut light[pixel];
                (0..3).for_each(|k| to[k] += lit.light[k] * (passed[k] * alpha * share));
                let after = *passed * (1.0 - alpha * (1.0 - passes));
                let weight = (*passed - after).element_sum() / 3.0 * share;
                to[3] += weight;
                if let Some(to) = values.get_mut(pixel) {
                    for kind in MapKind::ALL {
                        to[kind] += match kind {
                            MapKind::Normal => seen.world_normal().extend(0.0),
                            _ => seen.values[kind],
                        } * weight;
                    }
                }
                *passed = after;
            };
            for layer in &layers[from..next] {
                let special = &self.special[layer.special];
                add(special.triangle, &special.on_screen, true, &mut passed);
            }
            match solid {
                Solid::Nothing => {}
                Solid::Plain(triangle) => {
                    if last.0 != triangle {
                        last = (triangle, self.screen.triangle(triangle as usize));
                    }
                    add(triangle, &last.1, false, &mut passed);
                }
                Solid::Special(special) => {
                    let special = &self.special[special];
                    add(special.triangle, &special.on_screen, false, &mut passed);
                }
            }
        }
    }

    /// The light of a triangle at a sample.
    fn shade(&self, triangle: usize, on_screen: &ScreenTriangle, at: (f64, f64)) -> (Seen, LayeredLight) {
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
        (seen, light)
    }

    /// What is seen in the rows of a band: the solid surface of each sample, and the blended ones in front of it, sample by
    /// sample and from front to back.
    fn visible(&self, band: usize, rows: std::ops::Range<usize>) -> (Vec<Solid>, Vec<Layer>) {
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
            return (seen.iter().map(solid).collect(), Vec::new());
        }
        let with_nearness = |(sample, triangle): (usize, &u32)| {
            let (x, y) = place(sample);
            let is_seen = *triangle != NOTHING;
            let nearness = is_seen.then(|| self.screen.triangle(*triangle as usize).nearness_at(x, y));
            (solid(triangle), nearness.unwrap_or(f64::NEG_INFINITY))
        };
        let mut solids: Vec<(Solid, f64)> = seen.iter().enumerate().map(with_nearness).collect();
        let each = |is_blended: bool, found: &mut dyn FnMut(usize, usize, f64)| {
            let all = self.by_band[band].iter().map(|&index| (index as usize, &self.special[index as usize]));
            for (index, special) in all.filter(|(_, s)| s.is_blended == is_blended) {
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
        each(false, &mut |index, sample, nearness| {
            if nearness > solids[sample].1 && is_there(index, sample) {
                solids[sample] = (Solid::Special(index), nearness);
            }
        });
        let mut layers = Vec::new();
        each(true, &mut |index, sample, nearness| {
            if nearness > solids[sample].1 && is_there(index, sample) {
                layers.push(Layer { sample, nearness, special: index });
            }
        });
        layers.sort_by(|a, b| {
            let order = a.sample.cmp(&b.sample).then(b.nearness.total_cmp(&a.nearness));
            order.then(a.special.cmp(&b.special))
        });
        (solids.into_iter().map(|(solid, _)| solid).collect(), layers)
    }
}

#[cfg(test)]
#[path = "scene_material_tests.rs"]
mod tests;
