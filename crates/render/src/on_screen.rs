//! A mesh on the screen of one camera: all of its triangles set up in advance, or, where they are many,
//! those that are asked for (`raster_clusters.rs`).
//!
//! Contract: both ways see the same.

use crate::camera::Camera;
use crate::raster::{
    ScreenTriangle, ScreenTriangles, Visibility, rasterise, rasterise_behind, rasterise_some,
    triangle_on_screen,
};
use crate::raster_clusters::Clusters;
use parbake_model::{AlphaMode, Mesh};
use rayon::prelude::*;

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
    clusters: Vec<&'a Clusters>,
    mesh: &'a Mesh,
    camera: Camera,
    size: usize,
}

/// Meshes of at least as many triangles are rasterised by clusters.
pub(crate) const MANY_TRIANGLES: usize = 100_000;

/// Sides of pictures that clusters can number the samples of.
const MOST_CLUSTERED: usize = u16::MAX as usize;

/// What a triangle is drawn with: its alpha mode, and whether light passes it.
pub(crate) type Kind = (AlphaMode, bool);

/// The triangles of each kind that a mesh uses.
pub(crate) struct AlphaClusters(Vec<(Kind, Clusters)>);

impl AlphaClusters {
    /// Where a mesh has many triangles; `kind` is that of a triangle.
    pub fn of_many(mesh: &Mesh, kind: impl Fn(usize) -> Kind + Sync) -> Option<Self> {
        let count = mesh.triangles.len();
        let of = |wanted: Kind| {
            let all = (0..count as u32).into_par_iter();
            let own: Vec<u32> = all.filter(|&t| kind(t as usize) == wanted).collect();
            let clusters = || Clusters::new(&mesh.positions, &mesh.triangles, &own);
            (!own.is_empty()).then(|| (wanted, clusters()))
        };
        let modes = [AlphaMode::Opaque, AlphaMode::Mask, AlphaMode::Blend];
        let kinds = modes.into_iter().flat_map(|mode| [(mode, false), (mode, true)]);
        (count >= MANY_TRIANGLES).then(|| Self(kinds.filter_map(of).collect()))
    }

    /// The triangles of some kinds; none where the picture is too large for clusters. `mesh` is that
    /// which they are of.
    pub fn on_screen<'a>(
        &'a self,
        mesh: &'a Mesh,
        camera: &Camera,
        size: usize,
        is_meant: impl Fn(Kind) -> bool,
    ) -> Option<OnScreen<'a>> {
        let meant = self.0.iter().filter(|(kind, _)| is_meant(*kind));
        let clusters = meant.map(|(_, clusters)| clusters).collect();
        let own = ClustersOnScreen { clusters, mesh, camera: *camera, size };
        (size <= MOST_CLUSTERED).then_some(OnScreen::Clustered(own))
    }
}

impl OnScreen<'_> {
    /// A triangle on the screen. One that cannot be seen covers nothing.
    #[inline]
    pub fn triangle(&self, index: usize) -> ScreenTriangle {
        match self {
            Self::All(screen) => screen.triangles[index],
            Self::Clustered(own) => {
                let corners = own.mesh.corners(index);
                triangle_on_screen(&corners, &own.camera, own.size, None).unwrap_or(ScreenTriangle::HIDDEN)
            }
        }
    }

    /// What `samples`² samples in each pixel see, which fill it evenly: a picture of as many more samples along a side,
    /// moved by `jitter` pixels. Only where one walk over the triangles is cheaper than one for each sample of a
    /// pixel. `size` is that of the screen.
    pub fn see_finely(&self, size: usize, samples: usize, jitter: [f32; 2]) -> Option<Visibility> {
        let Self::Clustered(own) = self else { return None };
        let fine = size * samples;
        let offset = jitter.map(|shift| shift * samples as f32);
        let mut seen = (fine <= MOST_CLUSTERED).then(|| Visibility::empty(fine))?;
        let (camera, offset) = (&own.camera, (offset[0], offset[1]));
        own.clusters.iter().for_each(|c| c.rasterise(camera, fine, offset, None, &|_| true, &mut seen));
        Some(seen)
    }

    /// Finds the nearest of the triangles that are meant at the middle of each pixel; `size` is that of the screen.
    pub(crate) fn rasterise_some(&self, size: usize, is_meant: impl Fn(u32) -> bool, seen: &mut Visibility) {
        match self {
            Self::All(screen) => rasterise_some(screen, size, is_meant, seen),
            Self::Clustered(own) => {
                seen.clear(size);
                own.clusters
                    .iter()
                    .for_each(|c| c.rasterise(&own.camera, size, (0.0, 0.0), None, &is_meant, seen));
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
                let all = |_: u32| true;
                own.clusters.iter().for_each(|c| c.rasterise(&own.camera, size, offset, front, &all, seen));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::raster::NOTHING;
    use parbake_model::glam::Vec3;

    /// Waves of 2 × 60 × 60 triangles.
    fn waves() -> Mesh {
        let mut mesh = Mesh::default();
        for (row, column) in (0..=60u32).flat_map(|row| (0..=60u32).map(move |column| (row, column))) {
            let (x, y) = (row as f32 / 30.0 - 1.0, column as f32 / 30.0 - 1.0);
            mesh.positions.push(Vec3::new(x, y, 0.3 * (5.0 * x).sin() * (4.0 * y).cos()));
        }
        for (row, column) in (0..60).flat_map(|row| (0..60).map(move |column| (row, column))) {
            let first = row * 61 + column;
            mesh.triangles.extend([[first, first + 61, first + 62], [first, first + 62, first + 1]]);
        }
        mesh
    }

    /// Protects views that are means of many samples: one walk finds for each sample of each pixel what a walk
    /// for the samples at its place in their pixels finds.
    #[test]
    fn one_walk_sees_what_many_see() {
        let mesh = waves();
        let which: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let clusters = Clusters::new(&mesh.positions, &mesh.triangles, &which);
        let camera =
            Camera::towards_origin(Vec3::new(0.4, 0.8, 1.0), 3.5, Projection::Perspective(1.0 / 3.0));
        let (size, samples, jitter) = (40, 3, [0.2f32, -0.3]);
        let clusters = vec![&clusters];
        let screen = OnScreen::Clustered(ClustersOnScreen { clusters, mesh: &mesh, camera, size });
        let fine = screen.see_finely(size, samples, jitter).expect("there are clusters");
        assert_eq!(fine.size, size * samples);
        let mut seen = Visibility::default();
        let (mut covered, mut different) = (0, 0);
        for sample in 0..samples * samples {
            let within = [sample % samples, sample / samples];
            let at = |k: usize| jitter[k] + (within[k] as f32 + 0.5) / samples as f32 - 0.5;
            screen.rasterise(size, (at(0), at(1)), None, &mut seen);
            for (pixel, &triangle) in seen.triangle.iter().enumerate() {
                let [column, row] = [pixel % size, pixel / size];
                let place = (row * samples + within[1]) * fine.size + column * samples + within[0];
                covered += usize::from(triangle != NOTHING);
                different += usize::from(fine.triangle[place] != triangle);
            }
        }
        assert!(covered > 1000 && different * 1000 < covered, "{different} of {covered}");
    }
}
