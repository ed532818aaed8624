//! A whole model made ready for rendering, forward only: the reference pictures of
//! a high-poly and the pictures of an evaluation go through here.
//!
//! Forward: for each sample `raster → interpolate → frame → texture → shade`, as in
//! the other files of this room; samples of a pixel are averaged.
//!
//! Contract: pictures are linear light, premultiplied, with coverage in the fourth
//! channel; gain and display curve come later (`display.rs`). Pixels are
//! independent, so the picture does not depend on the number of threads.

use crate::camera::Camera;
use crate::display::{decode_srgb, encode_srgb};
use crate::frame::tangent_light;
use crate::interpolate::{barycentrics, interpolate};
use crate::raster::{NOTHING, ScreenTriangles, Visibility, rasterise};
use crate::shade::Shading;
use crate::texture::{Level, Pyramid};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Image, Material, Mesh, TextureSlot};
use rayon::prelude::*;

/// What a file's numbers mean when they are rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpretation {
    /// Decode base colour from sRGB to linear light before shading, as glTF says.
    /// Off: shade the stored numbers as they are (the paper's pictures).
    pub decode_srgb: bool,
    /// Fetch through mip levels; off: bilinear on the finest level.
    pub trilinear: bool,
}

impl Default for Interpretation {
    fn default() -> Self {
        Self { decode_srgb: true, trilinear: true }
    }
}

/// A square picture in linear light: premultiplied RGB and coverage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Pixels along a side.
    pub size: usize,
    /// size² pixels, row 0 on top.
    pub rgba: Vec<[f32; 4]>,
}

/// One use of a texture, with what moves its coordinates.
struct Map {
    slot: TextureSlot,
    /// Index into the scene's pyramids.
    pyramid: usize,
    moved: bool,
}

struct Surface {
    factor: Vec3,
    color: Option<Map>,
    normal: Option<Map>,
    normal_scale: f32,
}

/// A model with its textures unpacked into mip pyramids.
pub struct Scene {
    mesh: Mesh,
    surfaces: Vec<Surface>,
    pyramids: Vec<Pyramid<3>>,
    /// 0 where a face is degenerate.
    face_normals: Vec<Vec3>,
}

/// An image's RGB as numbers, each channel through `decode`.
fn unpack(image: &Image, decode: impl Fn(f32) -> f32) -> Level<3> {
    let table: Vec<f32> = (0..=255u32).map(|i| decode(i as f32 / 255.0)).collect();
    let texels = image.pixels.par_iter().map(|p| [0, 1, 2].map(|k| table[p[k] as usize])).collect();
    Level { width: image.width, height: image.height, texels }
}

/// Base colour texels as shading sees them.
pub fn unpack_color(image: &Image, decode: bool) -> Level<3> {
    unpack(image, |x| if decode { decode_srgb(x) } else { x })
}

/// Tangent-space normals, not normalised.
pub fn unpack_normal(image: &Image) -> Level<3> {
    unpack(image, |x| 2.0 * x - 1.0)
}

impl Scene {
    /// Unpacks every texture that a material uses.
    ///
    /// The mesh must have normals, and tangents if a material has a normal map.
    pub fn new(
        mut mesh: Mesh,
        materials: &[Material],
        images: &[Image],
        interpretation: Interpretation,
    ) -> Self {
        let mut pyramids: Vec<Pyramid<3>> = Vec::new();
        let mut built: Vec<(usize, bool, [parbake_model::Wrap; 2], usize)> = Vec::new();
        let mut map = |slot: &Option<TextureSlot>, is_color: bool| {
            let slot = (*slot)?;
            let image = images.get(slot.image)?;
            let key = (slot.image, is_color, slot.wrap);
            let pyramid = match built.iter().find(|b| (b.0, b.1, b.2) == key) {
                Some(b) => b.3,
                None => {
                    let base = if is_color {
                        unpack_color(image, interpretation.decode_srgb)
                    } else {
                        unpack_normal(image)
                    };
                    let mut p = if interpretation.trilinear {
                        Pyramid::from_base(base)
                    } else {
                        Pyramid::single(base)
                    };
                    p.wrap = slot.wrap;
                    pyramids.push(p);
                    built.push((key.0, key.1, key.2, pyramids.len() - 1));
                    pyramids.len() - 1
                }
            };
            Some(Map { slot, pyramid, moved: slot.transform != Default::default() })
        };
        let surfaces = materials
            .iter()
            .map(|m| {
                let linear = Vec4::from(m.base_color).truncate();
                Surface {
                    factor: if interpretation.decode_srgb {
                        linear
                    } else {
                        Vec3::from(linear.to_array().map(encode_srgb))
                    },
                    color: map(&m.base_color_texture, true),
                    normal: map(&m.normal_texture, false),
                    normal_scale: m.normal_scale,
                }
            })
            .collect();
        if !interpretation.decode_srgb {
            for c in &mut mesh.colors {
                *c = Vec4::from(c.to_array().map(encode_srgb));
            }
        }
        let face_normals = (0..mesh.triangles.len()).map(|t| mesh.area_normal(t)).collect();
        Self { mesh, surfaces, pyramids, face_normals }
    }

    /// The mesh being rendered.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Sets up all triangles for one camera.
    pub fn on_screen(&self, camera: &Camera, size: usize) -> ScreenTriangles {
        ScreenTriangles::new(&self.mesh.positions, &self.mesh.triangles, camera, size)
    }

    /// Albedo and unit normal of a point on the surface, textures included.
    ///
    /// `width` is how wide an area to average over, in the mesh's unit.
    pub fn look(&self, triangle: usize, weights: [f32; 3], width: f32) -> (Vec3, Vec3) {
        let mesh = &self.mesh;
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let surface = &self.surfaces[mesh.triangle_materials[triangle] as usize];
        let fetch = |map: &Map| {
            let uvs = self.map_uvs(map, corners);
            let pyramid = &self.pyramids[map.pyramid];
            let area = self.face_normals[triangle].length().max(1e-20);
            let density = ((uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs() / area).sqrt();
            let along = Vec2::new(density * width, 0.0);
            Vec3::from(pyramid.fetch(interpolate(uvs, weights), pyramid.lod(along, along)))
        };
        let normal = interpolate(corners.map(|i| mesh.normals[i]), weights);
        let mapped = match &surface.normal {
            Some(map) if !mesh.tangents.is_empty() => {
                let tangent = interpolate(corners.map(|i| mesh.tangents[i].truncate()), weights);
                let m = fetch(map) * Vec3::new(surface.normal_scale, surface.normal_scale, 1.0);
                let bitangent = normal.cross(tangent) * mesh.tangents[corners[0]].w;
                tangent * m.x + bitangent * m.y + normal * m.z
            }
            _ => normal,
        };
        (self.albedo(surface, corners, weights, fetch), mapped.normalize_or(Vec3::Z))
    }

    /// A map's texture coordinates at three vertices.
    fn map_uvs(&self, map: &Map, corners: [usize; 3]) -> [Vec2; 3] {
        let set = if map.slot.uv_set == 1 { &self.mesh.uvs1 } else { &self.mesh.uvs };
        let uvs = corners.map(|i| set.get(i).copied().unwrap_or_default());
        if map.moved { uvs.map(|uv| map.slot.transform.apply(uv)) } else { uvs }
    }

    /// Factor × texture × vertex colour.
    fn albedo(
        &self,
        surface: &Surface,
        corners: [usize; 3],
        weights: [f32; 3],
        fetch: impl Fn(&Map) -> Vec3,
    ) -> Vec3 {
        let mut color = surface.factor;
        if let Some(map) = &surface.color {
            color *= fetch(map);
        }
        if !self.mesh.colors.is_empty() {
            color *= interpolate(corners.map(|i| self.mesh.colors[i]), weights).truncate();
        }
        color
    }

    /// Light that leaves the surface towards the camera at one sample.
    ///
    /// `footprint` scales the pixel over which textures are filtered: 1 for one
    /// sample a pixel of this screen.
    pub fn shade(
        &self,
        shading: &impl Shading,
        camera: &Camera,
        screen: &ScreenTriangles,
        triangle: usize,
        at: (f64, f64),
        footprint: f32,
    ) -> Vec3 {
        let b = barycentrics(&screen.triangles[triangle], at.0, at.1);
        let mesh = &self.mesh;
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let surface = &self.surfaces[mesh.triangle_materials[triangle] as usize];
        let fetch = |map: &Map| {
            let uvs = self.map_uvs(map, corners);
            let pyramid = &self.pyramids[map.pyramid];
            let along = |w: [f32; 3]| -> Vec2 { interpolate(uvs, w) };
            let lod = pyramid.lod(along(b.per_x) * footprint, along(b.per_y) * footprint);
            Vec3::from(pyramid.fetch(along(b.weights), lod))
        };
        let color = self.albedo(surface, corners, b.weights, fetch);
        let point = interpolate(corners.map(|i| mesh.positions[i]), b.weights);
        let to_light = camera.view_direction(point);
        let facing = if to_light.dot(self.face_normals[triangle]) < 0.0 { -1.0 } else { 1.0 };
        let normal = interpolate(corners.map(|i| mesh.normals[i]), b.weights);
        let (tangent, handedness, map_normal) = match &surface.normal {
            Some(map) if !mesh.tangents.is_empty() => {
                let t = interpolate(corners.map(|i| mesh.tangents[i].truncate()), b.weights);
                let scale = Vec3::new(surface.normal_scale, surface.normal_scale, 1.0);
                (t, mesh.tangents[corners[0]].w, fetch(map) * scale)
            }
            _ => (Vec3::ZERO, 1.0, Vec3::Z),
        };
        shading.forward(&tangent_light(normal, tangent, handedness, to_light, facing), color, map_normal)
    }

    /// The whole view, each pixel the mean of `supersample`² samples.
    pub fn render(
        &self,
        shading: &impl Shading,
        camera: &Camera,
        size: usize,
        supersample: usize,
    ) -> Picture {
        let fine = size * supersample;
        let screen = self.on_screen(camera, fine);
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
                    if triangle == NOTHING {
                        continue;
                    }
                    let at = (x as f64 + 0.5, y as f64 + 0.5);
                    let light = self.shade(shading, camera, &screen, triangle as usize, at, 1.0);
                    for k in 0..3 {
                        pixel[k] += light[k] * share;
                    }
                    pixel[3] += share;
                }
            }
        });
        Picture { size, rgba }
    }
}
