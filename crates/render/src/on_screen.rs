//! A mesh on the screen of one camera: all of its triangles set up in advance, or, where they are many,
//! those that are asked for (`raster_clusters.rs`).
//!
//! Contract: both ways see the same.

use crate::camera::Camera;
use crate::raster::{
    ScreenTriangle, ScreenTriangles, Visibility, rasterise, rasterise_behind, triangle_on_screen,
};
use crate::raster_clusters::Clusters;
use parbake_model::Mesh;

/// What can be rasterised.
pub trait Raster {
    /// Finds the nearest triangle at each sample `(column + 0.5 + offset.0, row + 0.5 + offset.1)`, with
    /// `front` among those behind what is seen there; `seen` is reused between calls.
    fn rasterise(&self, size: usize, offset: (f32, f32), front: Option<&Visibility>, seen: &mut Visibility);
}

impl Raster for ScreenTriangles {
    fn rasterise(&self, size: usize, offset: (f32, f32), front: Option<&Visibility>, seen: &mut Visibility) {
        match front {
            None => rasterise(self, size, offset, seen),
            Some(front) => rasterise_behind(self, size, offset, front, seen),
        }
    }
}

/// A mesh on the screen of one camera.
pub enum OnScreen<'a> {
    /// Every triangle is set up.
    All(ScreenTriangles),
    /// Triangles are set up where they are seen.
    Clustered(ClustersOnScreen<'a>),
}

/// Trees of a mesh's triangles on the screen of one camera.
pub struct ClustersOnScreen<'a> {
    pub(crate) clusters: Vec<&'a Clusters>,
    pub(crate) mesh: &'a Mesh,
    pub(crate) camera: Camera,
    pub(crate) size: usize,
}

impl OnScreen<'_> {
    /// A triangle on the screen. One that cannot be seen covers nothing.
    #[inline]
    pub fn triangle(&self, index: usize) -> ScreenTriangle {
        match self {
            Self::All(screen) => screen.triangles[index],
            Self::Clustered(own) => {
                let corners = own.mesh.corners(index);
                triangle_on_screen(&corners, &own.camera, own.size, None).unwrap_or_default()
            }
        }
    }
}

impl Raster for OnScreen<'_> {
    /// `size` is that of the screen.
    fn rasterise(&self, size: usize, offset: (f32, f32), front: Option<&Visibility>, seen: &mut Visibility) {
        match self {
            Self::All(screen) => screen.rasterise(size, offset, front, seen),
            Self::Clustered(own) => {
                seen.clear(size);
                own.clusters.iter().for_each(|c| c.rasterise(&own.camera, size, offset, front, seen));
            }
        }
    }
}
