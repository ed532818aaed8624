//! A whole model made ready for rendering, forward only: the reference pictures of
//! a high-poly and the pictures of an evaluation go through here.
//!
//! Forward: for each sample `raster → interpolate → frame → parallax → texture → shade`,
//! as in the other files of this crate; samples of a pixel are averaged. Where a material has
//! a cutout, what that leaves out is looked through (`cutout.rs`). Whole materials, with what is cut out and
//! what is blended, are rendered by `scene_material.rs`.
//!
//! Contract: pictures are linear light, premultiplied, with coverage in the fourth
//! channel; gain and display curve come later (`display.rs`). Pixels are
//! independent, so the picture does not depend on the number of threads.

use crate::camera::Camera;
use crate::cutout::rasterise_cut;
use crate::frame::{Orientation, orientation, tangent_light};
use crate::interpolate::{barycentrics, interpolate};
use crate::interpretation::Interpretation;
use crate::material_layers::MaterialLayers;
use crate::on_screen::{AlphaClusters, OnScreen, Raster};
pub use crate::picture::Picture;
use crate::raster::{NOTHING, ScreenTriangle, ScreenTriangles, Visibility};
pub use crate::scene_pyramids::unpack;
use crate::scene_pyramids::{Map, Pyramids};
use crate::scene_textures::{SeenPoint, Surface, Textures};
use crate::shade::Brdf;
use parbake_image::display::encode_srgb;
use parbake_image::material_maps::sheen_as_color;
use parbake_image::pyramid::Pyramid;
use parbake_image::{MapKind, MapValues};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{AlphaMode, Image, Material, Mesh};
use rayon::prelude::*;
use std::cell::Cell;
use std::sync::Arc;

/// A point of the surface as a camera sees it.
pub(crate) struct Seen {
    /// The normal's is in the tangent frame.
    pub values: MapValues,
    normal: Vec3,
    tangent: Vec3,
    handedness: f32,
    pub to_viewer: Vec3,
    facing: f32,
    /// What extensions show there, if the interpretation asks for them.
    pub layers: Option<MaterialLayers>,
}

impl Seen {
    pub fn orientation(&self) -> Orientation {
        orientation(self.normal, self.tangent, self.handedness, self.to_viewer, self.facing)
    }

    fn light(&self, brdf: &impl Brdf) -> Vec3 {
        let Self { normal, tangent, handedness, to_viewer, facing, .. } = *self;
        brdf.light(&tangent_light(normal, tangent, handedness, to_viewer, facing), &self.values)
    }

    pub fn world_normal(&self) -> Vec3 {
        self.turned(self.values[MapKind::Normal].truncate())
    }

    /// A normal of the tangent frame as a unit vector of the common frame that looks to the side of the viewer.
    fn turned(&self, m: Vec3) -> Vec3 {
        let bitangent = self.normal.cross(self.tangent) * self.handedness;
        let world = self.tangent * m.x + bitangent * m.y + self.normal * m.z;
        (world * self.facing).normalize_or(self.to_viewer)
    }
}

/// A model with its textures unpacked into mip pyramids.
pub struct Scene {
    pub(crate) mesh: Mesh,
    pub(crate) surfaces: Vec<Surface>,
    /// Shared with scenes of the same materials.
    pub(crate) pyramids: Arc<Vec<Pyramid<3>>>,
    /// 0 where a face is degenerate.
    pub(crate) face_normals: Vec<Vec3>,
    /// How textures and vertex colours are read.
    interpretation: Interpretation,
    /// Where there are many triangles.
    pub(crate) clusters: Option<AlphaClusters>,
    /// Length of the model's unit, which thicknesses are given in, in that of the mesh.
    unit: f32,
}

impl Scene {
    /// Multiplies all emission, so that it fits into what maps can hold.
    pub fn scale_emission(&mut self, factor: f32) {
        self.surfaces.iter_mut().for_each(|surface| surface.factors[MapKind::Emissive] *= factor);
    }

    /// The brightest emission that a material's factor allows.
    pub fn strongest_emission(&self) -> f32 {
        let strongest = |s: &Surface| s.factors[MapKind::Emissive].truncate().max_element();
        self.surfaces.iter().map(strongest).fold(0.0, f32::max)
    }

    /// Unpacks every texture that a material uses.
    ///
    /// The mesh must have normals, and tangents if a material has a normal map.
    pub fn new(mesh: Mesh, materials: &[Material], images: &[Image], interpretation: Interpretation) -> Self {
        let mut pyramids = Pyramids::new(images, interpretation);
        let surfaces = materials.iter().map(|m| Surface::new(m, &mut pyramids)).collect();
        Self::of(mesh, surfaces, Arc::new(pyramids.all), interpretation)
    }

    /// The same materials on another mesh, which is as for [`Scene::new`]: no texture is unpacked again.
    pub fn with_mesh(&self, mesh: Mesh) -> Self {
        Self::of(mesh, self.surfaces.clone(), Arc::clone(&self.pyramids), self.interpretation)
            .with_unit(self.unit)
    }

    fn of(
        mut mesh: Mesh,
        surfaces: Vec<Surface>,
        pyramids: Arc<Vec<Pyramid<3>>>,
        interpretation: Interpretation,
    ) -> Self {
        if interpretation.parallax {
            mesh.apply_parallax_offsets();
        }
        let face_normals = (0..mesh.triangles.len()).into_par_iter().map(|t| mesh.area_normal(t)).collect();
        let mut scene =
            Self { mesh, surfaces, pyramids, face_normals, interpretation, clusters: None, unit: 1.0 };
        // Not when views first look at them: these wait for each other, and would leave cores idle.
        scene.clusters = scene.clustered();
        scene
    }

    /// The same where a length of 1 of the model, which thicknesses of glass are given in, is `unit` in the mesh.
    pub fn with_unit(self, unit: f32) -> Self {
        Self { unit, ..self }
    }

    fn clustered(&self) -> Option<AlphaClusters> {
        let kind = |triangle| (self.alpha(triangle).0, self.transmits(triangle));
        AlphaClusters::of_many(&self.mesh, kind)
    }

    /// The mesh being rendered.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Whether a material has more of this map than its neutral value.
    pub fn has(&self, kind: MapKind) -> bool {
        self.surfaces.iter().any(|surface| {
            let (map, factor) = (&surface.plain[kind as usize], surface.factors[kind]);
            factor != kind.spec().neutral || (map.is_some() && factor != Vec4::ZERO)
        })
    }

    /// Whether all triangles have the same base colour: no texture, one factor, and vertex colours, if any, that do not differ.
    pub fn has_one_base_color(&self) -> bool {
        let mut used = vec![false; self.surfaces.len()];
        self.mesh.triangle_materials.iter().for_each(|&material| used[material as usize] = true);
        let of = |surface: &Surface| {
            let is_plain = surface.plain[MapKind::BaseColor as usize].is_none() && surface.sheen.is_none();
            is_plain.then_some(surface.factors[MapKind::BaseColor])
        };
        let mut colors = self.surfaces.iter().zip(used).filter(|(_, used)| *used).map(|(own, _)| of(own));
        let first = colors.next().flatten();
        let is_first = |color: &Vec4| Some(color) == self.mesh.colors.first();
        first.is_some() && colors.all(|color| color == first) && self.mesh.colors.iter().all(is_first)
    }

    /// All triangles on the screen of one camera.
    pub fn on_screen(&self, camera: &Camera, size: usize) -> OnScreen<'_> {
        let clusters = self.clusters.as_ref().and_then(|c| c.on_screen(&self.mesh, camera, size, |_| true));
        clusters.unwrap_or_else(|| {
            OnScreen::All(ScreenTriangles::new(&self.mesh.positions, &self.mesh.triangles, camera, size))
        })
    }

    /// The triangles on the screen whose alpha mode, and whether light passes them, are meant, by their
    /// indices in the mesh; none where they are not kept apart, since there are few.
    pub fn layer_on_screen(
        &self,
        is_meant: impl Fn(AlphaMode, bool) -> bool,
        camera: &Camera,
        size: usize,
    ) -> Option<OnScreen<'_>> {
        self.clusters
            .as_ref()?
            .on_screen(&self.mesh, camera, size, |(mode, transmits)| is_meant(mode, transmits))
    }

    /// The maps' values at a point of the surface, textures included; the normal is a unit vector of
    /// the common frame.
    ///
    /// `width` is how wide an area to average over, in the mesh's unit. No one looks from
    /// anywhere, so parallax maps and cutouts have no say.
    pub fn look(&self, triangle: usize, weights: [f32; 3], width: f32) -> MapValues {
        let mesh = &self.mesh;
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let surface = &self.surfaces[mesh.triangle_materials[triangle] as usize];
        let fetch = |map: &Map| {
            let uvs = map.uvs(mesh, corners);
            let pyramid = &self.pyramids[map.pyramid];
            let area = self.face_normals[triangle].length().max(1e-20);
            let density = ((uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs() / area).sqrt();
            let along = Vec2::new(density * width, 0.0);
            Vec3::from(pyramid.fetch(interpolate(uvs, weights), pyramid.lod(along, along)))
        };
        let normal = interpolate(corners.map(|i| mesh.normals[i]), weights);
        let mut values = self.values(surface, &surface.plain, corners, weights, &|_| true, &fetch);
        let mapped = match &surface.plain[MapKind::Normal as usize] {
            Some(map) if !mesh.tangents.is_empty() => {
                let tangent = interpolate(corners.map(|i| mesh.tangents[i].truncate()), weights);
                let m = fetch(map) * surface.factors[MapKind::Normal].truncate();
                let bitangent = normal.cross(tangent) * mesh.tangents[corners[0]].w;
                tangent * m.x + bitangent * m.y + normal * m.z
            }
            _ => normal,
        };
        values[MapKind::Normal] = mapped.normalize_or(Vec3::Z).extend(0.0);
        values
    }

    /// Factor × texture of each map that is read, and × vertex colour of the base colour; all but the normal,
    /// which is left neutral, as are maps that are not read.
    fn values(
        &self,
        surface: &Surface,
        textures: &Textures,
        corners: [usize; 3],
        weights: [f32; 3],
        reads: &impl Fn(MapKind) -> bool,
        fetch: &impl Fn(&Map) -> Vec3,
    ) -> MapValues {
        let mut values = MapValues::NEUTRAL;
        let is_wanted = |kind: MapKind| kind != MapKind::Normal && reads(kind);
        for (kind, map) in MapKind::ALL.into_iter().zip(textures).filter(|(kind, _)| is_wanted(*kind)) {
            values[kind] = surface.factors[kind];
            if let Some(map) = map {
                let texture = fetch(map).extend(1.0);
                values[kind] = match kind {
                    MapKind::Occlusion => Vec4::ONE + values[kind] * (texture - Vec4::ONE),
                    _ => values[kind] * texture,
                };
            }
        }
        values[MapKind::BaseColor].w = self.opacity(surface, corners, weights, fetch);
        if !self.mesh.colors.is_empty() {
            let own: Vec4 = interpolate(corners.map(|i| self.mesh.colors[i]), weights);
            // Light is what is blended between vertices, whatever is stored.
            let stored = |x: f32| if self.interpretation.decode_srgb { x } else { encode_srgb(x) };
            values[MapKind::BaseColor] *= Vec3::from(own.truncate().to_array().map(stored)).extend(1.0);
        }
        if let Some(sheen) = surface.sheen.as_ref().filter(|_| self.interpretation.decode_srgb) {
            let texture = sheen.texture.as_ref().map_or(Vec3::ONE, fetch);
            let (added, below) = sheen_as_color(sheen.color * texture, sheen.albedo);
            let color = values[MapKind::BaseColor];
            values[MapKind::BaseColor] = (color.truncate() * below + added).min(Vec3::ONE).extend(color.w);
        }
        values
    }

    /// Opacity before any cutoff; 1 where the material is opaque.
    pub(crate) fn opacity(
        &self,
        surface: &Surface,
        corners: [usize; 3],
        weights: [f32; 3],
        fetch: &impl Fn(&Map) -> Vec3,
    ) -> f32 {
        if surface.alpha_mode == AlphaMode::Opaque {
            return 1.0;
        }
        let texture = surface.opacity.as_ref().map_or(1.0, |map| fetch(map).x);
        let own = match self.mesh.colors.is_empty() {
            true => 1.0,
            false => interpolate::<Vec4>(corners.map(|i| self.mesh.colors[i]), weights).w,
        };
        surface.factors[MapKind::BaseColor].w * texture * own
    }

    /// Whether any material is cut out or blended.
    pub fn has_alpha(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.alpha_mode != AlphaMode::Opaque)
    }

    /// Whether light passes any material.
    pub fn has_transmission(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.transmits)
    }

    /// Whether light passes a triangle.
    pub fn transmits(&self, triangle: usize) -> bool {
        self.surfaces[self.mesh.triangle_materials[triangle] as usize].transmits
    }

    /// From now on nothing stands in for the gloss of cloth and for light that passes a surface.
    pub fn leave_out_extensions(&mut self) {
        let modes = |scene: &Self| scene.surfaces.iter().map(|own| own.alpha_mode).collect::<Vec<_>>();
        let before = modes(self);
        for surface in &mut self.surfaces {
            let (mode, opacity) = surface.own_alpha;
            surface.sheen = None;
            surface.alpha_mode = mode;
            surface.factors[MapKind::BaseColor].w = opacity;
        }
        // Triangles are kept apart by them.
        if modes(self) != before {
            self.clusters = self.clustered();
        }
    }

    /// Whether every material shows its base colour without lights.
    pub fn is_unlit(&self) -> bool {
        self.surfaces.iter().all(|surface| surface.is_unlit)
    }

    /// Whether a material is more than rough, opaque and not metallic: what only shading by the whole
    /// metallic-roughness model shows.
    pub fn needs_whole_material(&self) -> bool {
        let plain = Vec4::new(0.0, 1.0, 0.0, 0.0);
        self.has_alpha()
            || self.has(MapKind::Occlusion)
            || self
                .surfaces
                .iter()
                .any(|s| s.is_unlit || s.sheen.is_some() || s.factors[MapKind::MetallicRoughness] != plain)
    }

    /// How a triangle's alpha is to be understood, and below which it is cut out.
    pub fn alpha(&self, triangle: usize) -> (AlphaMode, f32) {
        let surface = &self.surfaces[self.mesh.triangle_materials[triangle] as usize];
        (surface.alpha_mode, surface.alpha_cutoff)
    }

    /// Light that leaves the surface towards the camera at one sample. With parallax,
    /// colours and normals are fetched at the shifted coordinate and filtered as at the
    /// unshifted one, whose tangent frame stays.
    ///
    /// `footprint` scales the pixel over which textures are filtered: 1 for one
    /// sample a pixel of this screen.
    pub fn shade(
        &self,
        brdf: &impl Brdf,
        camera: &Camera,
        screen: &OnScreen,
        triangle: usize,
        at: (f64, f64),
        footprint: f32,
    ) -> Vec3 {
        let reads = |kind| brdf.reads(kind);
        self.seen(camera, &screen.triangle(triangle), triangle, at, footprint, &reads).light(brdf)
    }

    /// The maps' values at one sample, as of [`Scene::shade`]; the normal is a unit vector of the
    /// common frame that looks to the side of the viewer. `on_screen` is the triangle's place on the
    /// screen.
    pub fn material(
        &self,
        camera: &Camera,
        on_screen: &ScreenTriangle,
        triangle: usize,
        at: (f64, f64),
        footprint: f32,
    ) -> MapValues {
        let seen = self.seen(camera, on_screen, triangle, at, footprint, &|_| true);
        let mut values = seen.values;
        values[MapKind::Normal] = seen.world_normal().extend(0.0);
        values
    }

    /// The opacity at one sample, as [`Scene::material`] has it beside the base colour.
    pub fn opacity_at(
        &self,
        camera: &Camera,
        on_screen: &ScreenTriangle,
        triangle: usize,
        at: (f64, f64),
        footprint: f32,
    ) -> f32 {
        let seen = self.seen(camera, on_screen, triangle, at, footprint, &|_| false);
        seen.values[MapKind::BaseColor].w
    }

    /// What is seen at one sample. Maps that are not read are neutral, since each costs a fetch.
    pub(crate) fn seen(
        &self,
        camera: &Camera,
        on_screen: &ScreenTriangle,
        triangle: usize,
        at: (f64, f64),
        footprint: f32,
        reads: &impl Fn(MapKind) -> bool,
    ) -> Seen {
        let b = barycentrics(on_screen, at.0, at.1);
        let mesh = &self.mesh;
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let surface = &self.surfaces[mesh.triangle_materials[triangle] as usize];
        let point = interpolate(corners.map(|i| mesh.positions[i]), b.weights);
        let to_viewer = camera.view_direction(point);
        let facing = if to_viewer.dot(self.face_normals[triangle]) < 0.0 { -1.0 } else { 1.0 };
        let normal = interpolate(corners.map(|i| mesh.normals[i]), b.weights);
        let (textures, shift) = match &surface.shifted {
            Some(shifted) => {
                (&shifted.textures, shifted.at(&SeenPoint { mesh, corners, at: &b, to_viewer, footprint }))
            }
            None => (&surface.plain, Vec2::ZERO),
        };
        // Maps of one material are mostly read at the same place and have the same size.
        let last = Cell::new(None);
        let fetch = |map: &Map| {
            let pyramid = &self.pyramids[map.pyramid];
            let asked = (map.coordinates, pyramid.size());
            let (uv, lod) = match last.get() {
                Some((known, place)) if known == asked => place,
                _ => {
                    let uvs = map.uvs(mesh, corners);
                    let along = |w: [f32; 3]| -> Vec2 { interpolate(uvs, w) };
                    let lod = pyramid.lod(along(b.per_x) * footprint, along(b.per_y) * footprint);
                    let place = (along(b.weights) + shift, lod);
                    last.set(Some((asked, place)));
                    place
                }
            };
            Vec3::from(pyramid.fetch(uv, lod))
        };
        let mut values = self.values(surface, textures, corners, b.weights, reads, &fetch);
        let (mut tangent, mut handedness) = (Vec3::ZERO, 1.0);
        let is_read = reads(MapKind::Normal) && !mesh.tangents.is_empty();
        let normals = textures[MapKind::Normal as usize].as_ref().filter(|_| is_read);
        if normals.is_some() || surface.layers.is_some() && !mesh.tangents.is_empty() {
            tangent = interpolate(corners.map(|i| mesh.tangents[i].truncate()), b.weights);
            handedness = mesh.tangents[corners[0]].w;
        }
        if let Some(map) = normals {
            values[MapKind::Normal] = fetch(map).extend(0.0) * surface.factors[MapKind::Normal];
        }
        let mut seen = Seen { values, normal, tangent, handedness, to_viewer, facing, layers: None };
        seen.layers = surface
            .layers
            .as_ref()
            .map(|own| own.at(&fetch, &|m| seen.turned(m.unwrap_or(Vec3::Z)), self.unit));
        seen
    }

    /// What is seen at each sample, through all that is cut out.
    fn see(&self, camera: &Camera, screen: &OnScreen, size: usize) -> Visibility {
        let mut seen = Visibility::default();
        // Asking every sample takes time, so it is done only where the answer matters.
        if self.surfaces.iter().filter_map(|s| s.shifted.as_ref()).all(|s| s.cutout.is_none()) {
            screen.rasterise(size, (0.0, 0.0), None, &mut seen);
            return seen;
        }
        rasterise_cut(screen, size, (0.0, 0.0), &mut seen, |triangle, (x, y)| {
            let mesh = &self.mesh;
            let surface = &self.surfaces[mesh.triangle_materials[triangle] as usize];
            let Some(shifted) = &surface.shifted else { return true };
            let at = barycentrics(&screen.triangle(triangle), x, y);
            let corners = mesh.triangles[triangle].map(|i| i as usize);
            let to_viewer =
                camera.view_direction(interpolate(corners.map(|i| mesh.positions[i]), at.weights));
            shifted.is_opaque(&SeenPoint { mesh, corners, at: &at, to_viewer, footprint: 1.0 })
        });
        seen
    }

    /// The whole view, each pixel the mean of `supersample`² samples.
    pub fn render(&self, brdf: &impl Brdf, camera: &Camera, size: usize, supersample: usize) -> Picture {
        let fine = size * supersample;
        let screen = self.on_screen(camera, fine);
        let seen = self.see(camera, &screen, fine);
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
                    let light = self.shade(brdf, camera, &screen, triangle as usize, at, 1.0);
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

#[cfg(test)]
#[path = "scene_parallax_tests.rs"]
mod parallax_tests;

#[cfg(test)]
#[path = "scene_cutout_tests.rs"]
mod cutout_tests;

#[cfg(test)]
#[path = "scene_clusters_tests.rs"]
mod clusters_tests;
