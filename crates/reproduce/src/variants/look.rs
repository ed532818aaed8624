//! A low-poly under any map that shifts its coordinates, rendered forward only.
//!
//! As `parbake_render::scene`, which knows only the maps that files hold: for each sample
//! `raster → interpolate → frame → shift → texture → shade`, filtered as at the unshifted
//! coordinate; samples of a pixel are averaged.
//!
//! Contract: the mesh has normals, tangents and texture coordinates; pictures are linear
//! light, premultiplied, with coverage, whatever the number of threads.

use parbake_image::pyramid::Pyramid;
use parbake_image::{MapKind, MapValues};
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Image, Mesh};
use parbake_render::camera::Camera;
use parbake_render::directions::ViewDirection;
use parbake_render::frame::tangent_light;
use parbake_render::interpolate::{barycentrics, interpolate};
use parbake_render::parallax_variants::shift_map::{ShiftMap, TangentView};
use parbake_render::raster::{NOTHING, ScreenTriangles, Visibility, rasterise};
use parbake_render::scene::{Picture, unpack};
use parbake_render::shade::Brdf;
use parbake_views::high_poly::HEADLIGHT_BRDF;
use rayon::prelude::*;

/// A low-poly, its textures and its map.
pub struct Look<'a, M> {
    mesh: &'a Mesh,
    face_normals: Vec<Vec3>,
    color: Pyramid<3>,
    normal: Pyramid<3>,
    map: M,
}

impl<'a, M: ShiftMap> Look<'a, M> {
    /// Textures as files hold them; `srgb` says that colours are decoded before shading.
    pub fn new(mesh: &'a Mesh, color: &Image, normal: &Image, srgb: bool, map: M) -> Self {
        Self {
            mesh,
            face_normals: (0..mesh.triangles.len()).map(|t| mesh.area_normal(t)).collect(),
            color: Pyramid::from_base(unpack(MapKind::BaseColor, color, srgb)),
            normal: Pyramid::from_base(unpack(MapKind::Normal, normal, srgb)),
            map,
        }
    }

    fn light(&self, camera: &Camera, screen: &ScreenTriangles, triangle: usize, at: (f64, f64)) -> Vec3 {
        let (mesh, b) = (self.mesh, barycentrics(&screen.triangles[triangle], at.0, at.1));
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let direction = camera.view_direction(interpolate(corners.map(|i| mesh.positions[i]), b.weights));
        let facing = if direction.dot(self.face_normals[triangle]) < 0.0 { -1.0 } else { 1.0 };
        let normal: Vec3 = interpolate(corners.map(|i| mesh.normals[i]), b.weights);
        let tangent = interpolate(corners.map(|i| mesh.tangents[i].truncate()), b.weights);
        let light = tangent_light(normal, tangent, mesh.tangents[corners[0]].w, direction, facing);
        let view_direction = ViewDirection { direction, cosine: normal.normalize_or_zero().dot(direction) };

        let along = |weights| -> Vec2 { interpolate(corners.map(|i| mesh.uvs[i]), weights) };
        let uv = along(b.weights);
        let uv = uv + self.map.shift(uv, &TangentView::under_headlight(view_direction, &light));
        let lod = self.color.lod(along(b.per_x), along(b.per_y));
        let (color, normal) = (self.color.fetch(uv, lod), self.normal.fetch(uv, lod));
        HEADLIGHT_BRDF.light(&light, &MapValues::of(Vec3::from(color), Vec3::from(normal)))
    }

    /// The whole view, each pixel the mean of `supersample`² samples.
    pub fn render(&self, camera: &Camera, size: usize, supersample: usize) -> Picture {
        let fine = size * supersample;
        let screen = ScreenTriangles::new(&self.mesh.positions, &self.mesh.triangles, camera, fine);
        let mut seen = Visibility::default();
        rasterise(&screen, fine, (0.0, 0.0), &mut seen);
        let mut rgba = vec![[0.0; 4]; size * size];
        let share = 1.0 / (supersample * supersample) as f32;
        rgba.par_chunks_mut(size).enumerate().for_each(|(row, pixels)| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                for sample in 0..supersample * supersample {
                    let x = column * supersample + sample % supersample;
                    let y = row * supersample + sample / supersample;
                    let triangle = seen.triangle[y * fine + x];
                    if triangle != NOTHING {
                        let at = (x as f64 + 0.5, y as f64 + 0.5);
                        let [r, g, b] = self.light(camera, &screen, triangle as usize, at).to_array();
                        for (sum, x) in pixel.iter_mut().zip([r, g, b, 1.0]) {
                            *sum += x * share;
                        }
                    }
                }
            }
        });
        Picture { size, rgba }
    }
}
