//! Figures of a model: what its files hold, its surface, its texture layouts; and how far it is from another one.
//!
//! Contract: the order only. Topology is `parbake-mesh`'s, layouts are `parbake-atlas`'s, distances `parbake-mesh`'s.

use crate::error::BakeError;
use parbake_atlas::model_check::DEFAULT_SIZE;
use parbake_atlas::{LayoutCheck, check_model};
use parbake_files::{Loaded, StoredPicture};
use parbake_mesh::distance::{DistanceOptions, SurfaceDistance, surface_distance};
use parbake_mesh::topology::{Topology, topology};
use parbake_model::Model;
use serde::{Deserialize, Serialize};

/// How a model is measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct StatsOptions {
    /// Points on each surface from which distances are measured, 1000 to 100000000
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 200_000))]
    pub samples: usize,

    /// Number of threads, 0 to 256; 0 is one a core
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0))]
    pub threads: usize,
}

impl Default for StatsOptions {
    fn default() -> Self {
        Self { samples: DistanceOptions::default().samples, threads: 0 }
    }
}

impl StatsOptions {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the option and what it may be.
    pub fn check(&self) -> Result<(), BakeError> {
        if (1000..=100_000_000).contains(&self.samples) {
            return Ok(());
        }
        let (option, value, range) = ("samples", self.samples.to_string(), "1000 to 100000000".into());
        Err(BakeError::Option { option, value, range })
    }
}

/// Figures of one model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelStats {
    /// What its files hold.
    pub file: FileStats,
    /// Sides of the bounding box, in the file's unit.
    pub size: [f32; 3],
    /// Its surface, welded by position.
    pub topology: Topology,
    /// Its texture layouts: one for each base colour picture, or one where there is none.
    pub layouts: Vec<LayoutStats>,
    /// Triangles that read no base colour picture in a model where others do; no layout has them.
    pub triangles_without_picture: usize,
}

/// What a model's files hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileStats {
    /// Vertices as a graphics card gets them, split where any attribute differs.
    pub vertices: usize,
    /// Triangles with an area.
    pub triangles: usize,
    /// Triangles without area, which were left out when it was read.
    pub degenerate_triangles: usize,
    /// Materials in use.
    pub materials: usize,
    /// Draw calls of a viewer that merges nothing: primitives as nodes place them, in an OBJ materials in use.
    pub draw_calls: usize,
    /// Pictures in use.
    pub textures: Vec<TextureStats>,
    /// Bytes of all pictures on a graphics card, as uncompressed RGBA with mip levels. KTX2 stays compressed there
    /// and takes a quarter.
    pub texture_gpu_bytes: u64,
    /// Bytes of the model's file and of all that it names.
    pub bytes: u64,
}

/// A picture and what it costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextureStats {
    /// As it is stored.
    #[serde(flatten)]
    pub stored: StoredPicture,
    /// Bytes on a graphics card, as uncompressed RGBA with mip levels.
    pub gpu_bytes: u64,
}

/// A texture layout.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutStats {
    /// The picture's texels in a row; 512 without a picture.
    pub width: usize,
    /// The picture's rows; 512 without a picture.
    pub height: usize,
    /// Texels along a unit of length; none where nothing has an area.
    pub texel_density: Option<TexelDensity>,
    /// Charts, overlaps, flips, utilisation and stretch.
    #[serde(flatten)]
    pub layout: LayoutCheck,
}

/// Texels along a unit of length on the surface: the root of a triangle's texels by its area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TexelDensity {
    /// Of the whole surface.
    pub mean: f64,
    /// 1 % of the surface has this or less.
    pub q1: f64,
    /// Half of the surface has this or less.
    pub q50: f64,
    /// 99 % of the surface have this or less.
    pub q99: f64,
}

/// Measures a model that was read.
///
/// Runs on rayon's current thread pool; the result does not depend on the number of threads.
pub fn model_stats(loaded: &Loaded) -> ModelStats {
    let model = &loaded.model;
    let textures: Vec<TextureStats> = loaded
        .contents
        .pictures
        .iter()
        .map(|stored| TextureStats { gpu_bytes: stored.rgba_bytes(), stored: stored.clone() })
        .collect();
    let check = check_model(model, None, 0.0);
    let size = parbake_model::Bounds::of(&model.mesh).map_or([0.0; 3], |bounds| bounds.size().to_array());
    ModelStats {
        file: FileStats {
            vertices: model.mesh.positions.len(),
            triangles: model.mesh.triangles.len(),
            degenerate_triangles: loaded.contents.degenerate_triangles,
            materials: model.materials.len(),
            draw_calls: loaded.contents.draw_calls,
            texture_gpu_bytes: textures.iter().map(|texture| texture.gpu_bytes).sum(),
            textures,
            bytes: loaded.bytes,
        },
        size,
        topology: topology(&model.mesh),
        triangles_without_picture: check.triangles_without_picture,
        layouts: check.layouts.into_iter().map(|layout| layout_stats(model, layout)).collect(),
    }
}

/// Distances between two models' surfaces, in the first one's frame and unit; none where either has no area.
///
/// Runs on rayon's current thread pool; the result does not depend on the number of threads.
pub fn model_distance(first: &Model, second: &Model, options: &StatsOptions) -> Option<SurfaceDistance> {
    surface_distance(&first.mesh, &second.mesh, DistanceOptions { samples: options.samples })
}

fn layout_stats(model: &Model, layout: LayoutCheck) -> LayoutStats {
    let image = layout.picture_index.and_then(|index| model.images.get(index));
    let (width, height) = image.map_or((DEFAULT_SIZE, DEFAULT_SIZE), |image| (image.width, image.height));
    // The check counts texels of a square.
    let wider = ((width * height) as f64).sqrt() / layout.uv.texture_size as f64;
    let texel_density = layout.uv.distortion.as_ref().map(|distortion| {
        let mean = distortion.texels_per_unit * wider;
        let at = |area_scale: f64| mean * area_scale.sqrt();
        let scale = &distortion.area_scale;
        TexelDensity { mean, q1: at(scale.q1), q50: at(scale.q50), q99: at(scale.q99) }
    });
    LayoutStats { width, height, texel_density, layout }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec3, vec2};
    use parbake_model::{Image, Material, Mesh, TextureSlot};

    /// Protects texel density on a picture that is not square: a square of side 2 on the left half of 64 × 16
    /// texels has 512 texels on an area of 4, everywhere the same.
    #[test]
    fn density_is_of_the_pictures_own_texels() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let slot = TextureSlot::default();
        let model = Model {
            mesh: Mesh {
                positions: corners.iter().map(|&(x, y)| Vec3::new(2.0 * x, 2.0 * y, 0.0)).collect(),
                uvs: corners.iter().map(|&(x, y)| vec2(0.5 * x, 1.0 - y)).collect(),
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                triangle_materials: vec![0; 2],
                ..Mesh::default()
            },
            materials: vec![Material { base_color_texture: Some(slot), ..Material::default() }],
            images: vec![Image::solid("a", 64, 16, [0; 4])],
            ..Model::default()
        };
        let stats = model_stats(&Loaded { model, ..Loaded::default() });
        let layout = &stats.layouts[0];
        let density = layout.texel_density.unwrap();
        for value in [density.mean, density.q1, density.q50, density.q99] {
            assert!((value - 128f64.sqrt()).abs() < 1e-6, "{density:?}");
        }
        assert_eq!((layout.width, layout.height, layout.layout.uv.charts), (64, 16, 1));
        assert!((layout.layout.uv.utilisation - 0.5).abs() < 1e-9);
        assert_eq!((stats.size, stats.topology.boundary_loops), ([2.0, 2.0, 0.0], 1));
    }
}
