//! What the training views say of the low-poly's material: for each of their pixels, where it falls on
//! the low-poly's texture, and which values the high-poly's maps have in its place.
//!
//! Forward, a view at a time: both models are rasterised, layer by layer (`alpha_layers.rs`); the
//! high-poly's maps are read as wide as the pixel is (`Scene::material`), and its normal is turned into
//! the low-poly's tangent frame, `m = F⁻¹ N` with F as in `parbake_render::frame`. Nothing is shaded, so
//! what is fitted to these samples is right under any light.
//!
//! In layers without gaps a pixel is left out where its low-poly is one side of a thin wall and its high-poly the other
//! one, and, without a parallax map, where its high-poly is a part far in front that the low-poly lacks (`sides.rs`).
//!
//! Contract: samples are sorted as in `samples.rs`; nothing depends on the number of threads.

use crate::alpha_layers::AlphaLayer;
use crate::high_poly::{HighPoly, ViewSet};
use crate::material_sample::MaterialSample;
use crate::pool::View;
use crate::samples::{SampleSet, collect};
use crate::sides::is_of_another_side;
use parbake_image::{MapKind, MapValues};
use parbake_model::AlphaMode;
use parbake_model::Mesh;
use parbake_model::glam::{DVec3, Mat3, Vec2, Vec3};
use parbake_progress::Watcher;
use parbake_render::camera::Camera;
use parbake_render::cutout::rasterise_cut;
use parbake_render::directions::VertexFrame;
use parbake_render::interpolate::{barycentrics, interpolate};
use parbake_render::on_screen::{OnScreen, Raster};
use parbake_render::raster::{NOTHING, ScreenTriangle, ScreenTriangles, Visibility};
use rayon::prelude::*;

/// Where the maps are fetched for a texture coordinate, the unit direction to the viewer and the interpolated
/// vertex frame, both in the common frame; none where the surface is cut out.
pub type Shift<'a> = &'a (dyn Fn(Vec2, Vec3, &VertexFrame) -> Option<Vec2> + Sync);

/// What the views of a set are sampled for.
pub struct MaterialSampler<'a> {
    /// The high-poly.
    pub high: &'a HighPoly,
    /// The low-poly in the common frame, with normals, tangents and texture coordinates.
    pub low: &'a Mesh,
    /// Which of their triangles belong together.
    pub layers: &'a [AlphaLayer],
    /// How coordinates shift, where there is a parallax map.
    pub shift: Option<Shift<'a>>,
}

/// How far behind the low-poly a layer with gaps may lie in the high-poly for it to be the same leaf or
/// pane, in the common frame.
const BEHIND: f64 = 0.03;

impl MaterialSampler<'_> {
    /// The samples of all views on a texture of `texture_size`² texels, and how many views there were
    /// time for.
    pub fn samples(
        &self,
        set: &ViewSet,
        texture_size: usize,
        watcher: &dyn Watcher,
    ) -> (SampleSet<MaterialSample>, usize) {
        let views = set.views(&self.high.conventions.rig);
        let seen = std::sync::atomic::AtomicUsize::new(0);
        let samples = collect(views.par_iter().enumerate(), texture_size, watcher, |(index, view), out| {
            if index > 0 && watcher.stopped() {
                return;
            }
            seen.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            self.layers.iter().for_each(|layer| self.sample(layer, view, set, texture_size, out));
        });
        (samples, seen.into_inner())
    }

    fn sample(
        &self,
        layer: &AlphaLayer,
        view: &View,
        set: &ViewSet,
        texture_size: usize,
        out: &mut Vec<MaterialSample>,
    ) {
        let (size, filter) = (set.sampling.size, set.sampling.filter);
        let (scene, camera) = (&self.high.scene, &view.camera);
        let jitter = (view.jitter[0], view.jitter[1]);
        let at = |pixel: usize| {
            let along = |i: usize, shift: f32| i as f64 + 0.5 + f64::from(shift);
            (along(pixel % size, jitter.0), along(pixel / size, jitter.1))
        };
        let footprint = filter.max(1.0 / 16.0);
        let is_whole = self.high.is_whole_material;
        let is_own = |mode, transmits: bool| mode == layer.mode && (is_whole && transmits) == layer.transmits;
        let high = match scene.layer_on_screen(is_own, camera, size) {
            Some(screen) => Part { screen, own: None },
            None => Part::of(scene.mesh(), &layer.high, camera, size),
        };
        let mut shown = Visibility::default();
        match layer.mode {
            AlphaMode::Mask => rasterise_cut(&high.screen, size, jitter, &mut shown, |triangle, at| {
                let own = high.triangle(triangle);
                let on_screen = high.screen.triangle(triangle);
                scene.opacity_at(camera, &on_screen, own, at, footprint) >= scene.alpha(own).1
            }),
            _ => high.screen.rasterise(size, jitter, None, &mut shown),
        }
        let low = Part::of(self.low, &layer.low, camera, size);
        let mut seen = Visibility::default();
        match self.shift {
            None => low.screen.rasterise(size, jitter, None, &mut seen),
            Some(shift) => rasterise_cut(&low.screen, size, jitter, &mut seen, |triangle, at| {
                let point = Point::of(self.low, low.triangle(triangle), &low.screen.triangle(triangle), at);
                shift(point.uv, camera.view_direction(point.position), &point.frame()).is_some()
            }),
        }
        let has_gaps = layer.mode != AlphaMode::Opaque;
        for pixel in (0..size * size).filter(|&pixel| seen.triangle[pixel] != NOTHING) {
            let (under, over) = (seen.triangle[pixel] as usize, shown.triangle[pixel]);
            if over == NOTHING && !has_gaps {
                continue;
            }
            let at = at(pixel);
            let below = low.screen.triangle(under);
            let point = Point::of(self.low, low.triangle(under), &below, at);
            let direction = camera.view_direction(point.position);
            let Some(uv) =
                self.shift.map_or(Some(point.uv), |shift| shift(point.uv, direction, &point.frame()))
            else {
                continue;
            };
            // Where the layer is not there, or only far behind, it has a gap.
            let depth = |of: &ScreenTriangle| 1.0 / of.nearness.dot(DVec3::new(at.0, at.1, 1.0)).max(1e-9);
            let own = depth(&below);
            let above = (over != NOTHING).then(|| high.screen.triangle(over as usize));
            let theirs = above.as_ref().map_or(f64::INFINITY, depth);
            if has_gaps && theirs > own + BEHIND {
                out.push(MaterialSample::new(uv, texture_size, &GAP, [0.0, 1.0]));
                continue;
            }
            if has_gaps && theirs < own - BEHIND {
                continue;
            }
            // A parallax map fetches what lies behind.
            let behind = self.shift.is_none().then_some((theirs - own) as f32);
            let (seen, place) = (high.triangle(over as usize), [point.position, point.face_normal]);
            if !has_gaps && is_of_another_side(self.high, place, seen, behind) {
                continue;
            }
            let Some(above) = above else { continue };
            let mut values = scene.material(camera, &above, high.triangle(over as usize), at, footprint);
            if layer.mode == AlphaMode::Mask {
                values[MapKind::BaseColor].w = 1.0;
            }
            values[MapKind::Normal] =
                point.in_frame(values[MapKind::Normal].truncate(), direction).extend(0.0);
            out.push(MaterialSample::new(uv, texture_size, &values, [1.0, if has_gaps { 1.0 } else { 0.0 }]));
        }
    }
}

/// Nothing is there.
const GAP: MapValues = MapValues::ZERO;

/// Some triangles of a mesh on a screen.
struct Part<'a> {
    screen: OnScreen<'a>,
    /// Their indices in the mesh; none where all are there.
    own: Option<&'a [u32]>,
}

impl<'a> Part<'a> {
    fn of(mesh: &Mesh, triangles: &'a [u32], camera: &Camera, size: usize) -> Self {
        if triangles.len() == mesh.triangles.len() {
            let screen = ScreenTriangles::new(&mesh.positions, &mesh.triangles, camera, size);
            return Self { screen: OnScreen::All(screen), own: None };
        }
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| mesh.triangles[t as usize]).collect();
        let screen = ScreenTriangles::new(&mesh.positions, &corners, camera, size);
        Self { screen: OnScreen::All(screen), own: Some(triangles) }
    }

    fn triangle(&self, on_screen: usize) -> usize {
        self.own.map_or(on_screen, |own| own[on_screen] as usize)
    }
}

/// A point of the low-poly.
struct Point {
    uv: Vec2,
    position: Vec3,
    normal: Vec3,
    tangent: Vec3,
    handedness: f32,
    face_normal: Vec3,
}

impl Point {
    fn of(mesh: &Mesh, triangle: usize, on_screen: &ScreenTriangle, at: (f64, f64)) -> Self {
        let weights = barycentrics(on_screen, at.0, at.1).weights;
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        Self {
            uv: interpolate(corners.map(|i| mesh.uvs[i]), weights),
            position: interpolate(corners.map(|i| mesh.positions[i]), weights),
            normal: interpolate(corners.map(|i| mesh.normals[i]), weights),
            tangent: interpolate(corners.map(|i| mesh.tangents[i].truncate()), weights),
            handedness: mesh.tangents[corners[0]].w,
            face_normal: mesh.area_normal(triangle),
        }
    }

    fn frame(&self) -> VertexFrame {
        VertexFrame { normal: self.normal, tangent: self.tangent, handedness: self.handedness }
    }

    /// A world normal in the tangent frame of the side that is seen, of unit length.
    fn in_frame(&self, world: Vec3, to_viewer: Vec3) -> Vec3 {
        let facing = if to_viewer.dot(self.face_normal) < 0.0 { -1.0 } else { 1.0 };
        let bitangent = self.normal.cross(self.tangent) * self.handedness;
        let frame = Mat3::from_cols(self.tangent, bitangent, self.normal) * facing;
        if frame.determinant().abs() < 1e-6 {
            return Vec3::Z;
        }
        (frame.inverse() * world).normalize_or(Vec3::Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alpha_layers::{alpha_layers, layer_kinds};
    use crate::high_poly::Conventions;
    use crate::low_poly::LowPoly;
    use crate::pool::Rig;
    use crate::reference::Sampling;
    use crate::samples::Fetched;
    use parbake_image::display::{Curve, Display};
    use parbake_model::glam::{Vec4, vec2};
    use parbake_model::{Material, Model};
    use parbake_render::camera::Projection;
    use parbake_render::interpretation::Interpretation;

    /// Two squares of side 2 across the z axis, at these heights; each has a material and a half of the
    /// texture.
    fn squares(heights: [f32; 2], materials: Vec<Material>) -> Model {
        let corners = [(-1.0f32, -1.0f32), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let mut mesh = Mesh::default();
        for (index, z) in heights.into_iter().enumerate() {
            let first = mesh.positions.len() as u32;
            for (x, y) in corners {
                mesh.positions.push(Vec3::new(x, y, z));
                mesh.normals.push(Vec3::Z);
                mesh.uvs.push(vec2(
                    0.25 * (x + 1.0) * 0.9 + 0.5 * index as f32 + 0.02,
                    0.5 * (1.0 - y) * 0.9 + 0.02,
                ));
            }
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            mesh.triangle_materials.extend([index as u32; 2]);
        }
        Model { name: "squares".into(), mesh, materials, ..Model::default() }
    }

    fn conventions() -> Conventions {
        Conventions {
            interpretation: Interpretation::default(),
            display: Display { gain: 1.0, curve: Curve::Srgb },
            whole_material: Some(true),
            rig: Rig { radius: 3.5, projection: Projection::Perspective(0.4) },
            max_distance: 0.1,
        }
    }

    fn sampled(high: &Model, low: &Model) -> Vec<MaterialSample> {
        let high = HighPoly::new(high, conventions()).expect("it has an extent");
        let prepared = LowPoly::new(low, &high.frame, 32).expect("it has coordinates");
        let layers = alpha_layers(&layer_kinds(&prepared.placed, low, &high), &high);
        let set = ViewSet {
            count: 12,
            seed: 1,
            jitter: true,
            sampling: Sampling { size: 32, filter: 0.5, samples: 1 },
        };
        let sampler = MaterialSampler { high: &high, low: &prepared.placed, layers: &layers, shift: None };
        sampler.samples(&set, 32, &()).0.iter().copied().collect()
    }

    /// Protects whole materials: samples carry factors of metal, roughness and colour, and a normal that
    /// looks out of the surface.
    #[test]
    fn samples_carry_the_material() {
        let metal = Material {
            base_color: [0.5, 0.25, 1.0, 1.0],
            metallic: 1.0,
            roughness: 0.25,
            ..Material::default()
        };
        let model = squares([0.0, 0.5], vec![metal.clone(), metal]);
        let samples = sampled(&model, &model);
        assert!(samples.len() > 500, "{}", samples.len());
        for sample in samples {
            let found = sample.target(MapKind::MetallicRoughness);
            assert!((found - Vec4::new(0.0, 0.25, 1.0, 0.0)).length() < 1e-3, "{found}");
            assert!((sample.target(MapKind::BaseColor).y - 0.5371).abs() < 1e-3);
            assert!(sample.target(MapKind::Normal).z > 0.99);
        }
    }

    /// Protects glass whose low-poly says nothing of it: it is a layer of its own where the high-poly lets
    /// light pass, and shows nothing of what is behind it.
    #[test]
    fn glass_is_recognised_by_the_high_poly() {
        let wall = Material::default();
        let passing = parbake_model::Transmission { factor: 1.0, texture: None };
        let mut glass = Material { base_color: [0.0, 1.0, 0.0, 1.0], ..Material::default() };
        glass.extensions.transmission = Some(passing);
        let high = squares([0.0, 0.5], vec![wall.clone(), glass]);
        let low = squares([0.0, 0.5], vec![wall.clone(), wall]);
        let is_glass = |s: &&MaterialSample| s.texel() % 32 >= 16;
        let samples = sampled(&high, &low);
        let (panes, walls): (Vec<&MaterialSample>, Vec<&MaterialSample>) = samples.iter().partition(is_glass);
        assert!(panes.len() > 200 && walls.len() > 200, "{} {}", panes.len(), walls.len());
        let is_green = |s: &&MaterialSample| s.target(MapKind::BaseColor).x < 0.1;
        assert!(panes.iter().all(is_green) && !walls.iter().any(is_green));
        assert!(samples.iter().all(|s| s.opacity_weight() == 0.0));
    }

    /// Protects what is behind glass: a pane before a wall is sampled as a layer of its own, and the wall
    /// is seen through it.
    #[test]
    fn panes_and_what_is_behind_them_are_layers() {
        let wall = Material { base_color: [1.0, 0.0, 0.0, 1.0], ..Material::default() };
        let glass = Material {
            base_color: [0.0, 0.0, 1.0, 0.25],
            alpha_mode: AlphaMode::Blend,
            ..Material::default()
        };
        let model = squares([0.0, 0.5], vec![wall, glass]);
        let samples = sampled(&model, &model);
        let is_glass = |s: &&MaterialSample| s.texel() % 32 >= 16;
        let (panes, walls): (Vec<&MaterialSample>, Vec<&MaterialSample>) = samples.iter().partition(is_glass);
        assert!(panes.len() > 200 && walls.len() > 200, "{} {}", panes.len(), walls.len());
        for pane in panes {
            let color = pane.target(MapKind::BaseColor);
            assert!((color - Vec4::new(0.0, 0.0, 1.0, 0.25)).length() < 1e-3, "{color}");
            assert_eq!(pane.opacity_weight(), 1.0);
        }
        for wall in walls {
            let color = wall.target(MapKind::BaseColor);
            assert!((color - Vec4::new(1.0, 0.0, 0.0, 1.0)).length() < 1e-3, "{color}");
            assert_eq!(wall.opacity_weight(), 0.0);
        }
    }

    /// Protects walls behind wires that a low-poly has no triangles for: no texel of the wall takes the wire's colour where
    /// the wire is farther away than a projection looks, while a thin layer right on the wall is what the wall shows.
    #[test]
    fn a_wall_does_not_take_what_is_far_in_front() {
        let materials = [[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]]
            .map(|base_color| Material { base_color, ..Material::default() })
            .to_vec();
        let mut wall = squares([0.0, 0.5], materials.clone());
        wall.mesh.triangles.truncate(2);
        wall.mesh.triangle_materials.truncate(2);
        for (height, is_taken) in [(0.5, false), (0.05, true)] {
            let mut high = squares([0.0, height], materials.clone());
            high.mesh.positions[4..].iter_mut().for_each(|p| p.x *= 0.2);
            let samples = sampled(&high, &wall);
            let blue = samples.iter().filter(|s| s.target(MapKind::BaseColor).z > 0.5).count();
            assert!(samples.len() > 300 && (blue > 20) == is_taken, "{height}: {blue} of {}", samples.len());
            assert!(is_taken || blue == 0, "{height}: {blue}");
        }
        // Where the strip is all there is, it is what the low-poly shows.
        let mut high = squares([0.0, 0.5], materials);
        high.mesh.triangles.drain(..2);
        high.mesh.triangle_materials.drain(..2);
        assert!(sampled(&high, &wall).iter().filter(|s| s.target(MapKind::BaseColor).z > 0.5).count() > 100);
    }

    /// An open tube around the y axis, of two shells of one segment in height: white outside, black inside,
    /// each with a half of the texture. Normals at the rims look along the wall, as smooth ones do.
    fn tube(segments: u32) -> Model {
        let mut mesh = Mesh::default();
        for (shell, radius) in [0.6f32, 0.59].into_iter().enumerate() {
            let first = mesh.positions.len() as u32;
            let outwards = if shell == 0 { 1.0 } else { -1.0 };
            for i in 0..=segments {
                let along = i as f32 / segments as f32;
                let (sin, cos) = (std::f32::consts::TAU * along).sin_cos();
                for y in [-1.0f32, 1.0] {
                    mesh.positions.push(Vec3::new(radius * cos, y, radius * sin));
                    mesh.normals.push((Vec3::new(cos, 0.0, sin) * outwards * 0.3 + Vec3::Y * y).normalize());
                    mesh.uvs.push(vec2(0.03 + 0.44 * along + 0.5 * shell as f32, 0.5 - 0.45 * y));
                }
            }
            for i in 0..segments {
                let v = first + 2 * i;
                let quad = [[v, v + 1, v + 2], [v + 2, v + 1, v + 3]];
                mesh.triangles.extend(if shell == 0 { quad } else { quad.map(|[a, b, c]| [a, c, b]) });
            }
        }
        let count = mesh.triangles.len() as u32;
        mesh.triangle_materials = (0..count).map(|t| u32::from(t >= count / 2)).collect();
        let plain = |value: f32| Material {
            base_color: [value, value, value, 1.0],
            double_sided: true,
            ..Material::default()
        };
        Model { name: "tube".into(), mesh, materials: vec![plain(1.0), plain(0.0)], ..Model::default() }
    }

    /// Protects thin walls: where a coarse wall is far thicker in its sag than the fine one is, no pixel asks
    /// one side for the other's colour, from any side, nor does the projection find it.
    #[test]
    fn no_side_of_a_thin_wall_takes_the_other_s_colour() {
        let (high, low) = (tube(96), tube(12));
        let samples = sampled(&high, &low);
        let is_outside = |texel: usize| texel % 32 < 16;
        for outside in [true, false] {
            let own: Vec<f32> = samples
                .iter()
                .filter(|s| is_outside(s.texel()) == outside)
                .map(|s| s.target(MapKind::BaseColor).x)
                .collect();
            let wrong = own.iter().filter(|x| (**x > 0.5) != outside).count();
            assert!(own.len() > 300 && wrong == 0, "{wrong} of {} with outside = {outside}", own.len());
        }
        let conventions = conventions();
        let high = HighPoly::new(&high, conventions).expect("it has an extent");
        let prepared = LowPoly::new(&low, &high.frame, 32).expect("it has coordinates");
        let projected = crate::projection::project(&prepared, &high);
        let base = projected.maps.get(MapKind::BaseColor).expect("a bake has one");
        for (texel, value) in base.texels.iter().enumerate().filter(|(i, _)| prepared.atlas.covered[*i]) {
            assert_eq!(value.x > 0.5, is_outside(texel), "texel {texel}: {value}");
        }
    }
}
