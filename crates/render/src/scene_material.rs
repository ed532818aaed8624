//! Whole materials in a picture: shaded by a BRDF that knows where the viewer is, single-sided where they say so,
//! cut out, and blended in order.
//!
//! Forward, for each sample: the nearest solid surface is found, opaque or above its cutoff (glTF 2.0, 3.9.4);
//! of all blended surfaces in front of it, from front to back, with transmittance `T`:
//!
//! ```text
//! light += T α (c + p b),  coverage += T α (1 − p (1 − b_α)),  T ← T (1 − α);  at last the solid one with α = 1
//! ```
//!
//! (Porter and Duff, Compositing Digital Images, 1984), in linear light; p is what passes glass (`material_layers.rs`), else 0,
//! and b with coverage b_α what comes from behind it, from a picture of all that is solid (`behind.rs`). As in viewers,
//! glass hides what is blended behind it and other glass, but for the backs of double-sided glass, which are drawn into that picture. Of
//! a tint coverage has the mean. What the maps hold is composited by how much each surface covers. Samples of a pixel
//! are averaged.
//!
//! `scene_stage.rs` draws them, band by band.
//!
//! Contract: pictures are as in `scene.rs`, and do not depend on the number of threads.

use crate::behind::Behind;
use crate::camera::Camera;
use crate::frame::Orientation;
use crate::interpolate::{barycentrics, interpolate};
use crate::on_screen::OnScreen;
use crate::raster::{ScreenTriangle, Visibility};
use crate::scene::{Picture, Scene};
use crate::scene_pyramids::Map;
use crate::scene_stage::{BAND, Drawing, Drawn, InBand, Kind, Special, Stage};
use crate::scene_textures::{SeenPoint, Surface};
use crate::shade::Brdf;
use parbake_image::MapValues;
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
        let is_plain = |triangle: u32| {
            let triangle = triangle as usize;
            !self.surface(triangle).is_special() && !self.shows_its_back(camera, triangle)
        };
        let mut opaque = Visibility::default();
        screen.rasterise_some(fine, is_plain, &mut opaque);
        let special = self.special(camera, &screen);
        let mut by_band = vec![Vec::new(); size.div_ceil(BAND)];
        for (index, special) in special.iter().enumerate() {
            let rows = special.on_screen.rows(fine);
            if !rows.is_empty() {
                let [first, last] = [rows.start, rows.end - 1].map(|row| row / (BAND * supersample));
                by_band[first..=last].iter_mut().for_each(|band| band.push(index as u32));
            }
        }
        let shows = |kind: Kind| special.iter().any(|own| own.kind == kind);
        let (has_backs, has_glass) = (shows(Kind::BackOfGlass), shows(Kind::Glass));
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
        let picture = |light, values| MaterialPicture { light: Picture { size, rgba: light }, values };
        if !has_backs && !has_glass {
            let all = Drawing { layers: true, behind: None, with_values, keeps_solid: false };
            let Drawn { light, values, .. } = stage.drawn(|band| stage.band(band, &stage.visible(band), all));
            return picture(light, values);
        }
        let seen: Vec<InBand> =
            (0..stage.by_band.len()).into_par_iter().map(|band| stage.visible(band)).collect();
        let alone = Drawing { layers: false, behind: None, with_values: false, keeps_solid: true };
        let solid = stage.drawn(|band| stage.band(band, &seen[band], alone));
        let mut behind = Behind::new(Picture { size, rgba: solid.light.clone() });
        if has_backs {
            let light = stage.over(&solid, &seen, &behind, |kind| kind == Kind::BackOfGlass);
            behind = Behind::new(Picture { size, rgba: light });
        }
        if !with_values {
            return picture(stage.over(&solid, &seen, &behind, |_| true), Vec::new());
        }
        let all = Drawing { layers: true, behind: Some(&behind), with_values, keeps_solid: false };
        let Drawn { light, values, .. } = stage.drawn(|band| stage.band(band, &seen[band], all));
        picture(light, values)
    }

    /// All triangles that are cut out or blended, but for those that show only their back.
    fn special(&self, camera: &Camera, screen: &OnScreen) -> Vec<Special> {
        if !self.surfaces.iter().any(Surface::is_special) {
            return Vec::new();
        }
        let special = |triangle: usize| {
            let surface = self.surface(triangle);
            let is_seen = surface.is_special() && !self.shows_its_back(camera, triangle);
            is_seen.then(|| {
                let kind = match (surface.is_glass(), surface.is_blended()) {
                    (true, _) if self.is_turned_away(camera, triangle) => Kind::BackOfGlass,
                    (true, _) => Kind::Glass,
                    (false, true) => Kind::Blended,
                    (false, false) => Kind::Cut,
                };
                Special { triangle: triangle as u32, on_screen: screen.triangle(triangle), kind }
            })
        };
        (0..self.mesh.triangles.len()).into_par_iter().filter_map(special).collect()
    }

    pub(crate) fn surface(&self, triangle: usize) -> &Surface {
        &self.surfaces[self.mesh.triangle_materials[triangle] as usize]
    }

    /// Whether a triangle is single-sided and seen from behind.
    pub(crate) fn shows_its_back(&self, camera: &Camera, triangle: usize) -> bool {
        !self.surface(triangle).is_double_sided && self.is_turned_away(camera, triangle)
    }

    /// Whether a triangle is seen from behind.
    fn is_turned_away(&self, camera: &Camera, triangle: usize) -> bool {
        let corner = self.mesh.positions[self.mesh.triangles[triangle][0] as usize];
        camera.view_direction(corner).dot(self.face_normals[triangle]) < 0.0
    }

    /// Whether a point of a triangle is there at all: not left out by its cutout, nor below the cutoff of its mask.
    pub(crate) fn is_there(
        &self,
        camera: &Camera,
        triangle: usize,
        on_screen: &ScreenTriangle,
        at: (f64, f64),
    ) -> bool {
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

#[cfg(test)]
#[path = "scene_material_tests.rs"]
mod tests;
