//! What the fuzz targets share: limits that keep each run small, and the contract
//! that every model must keep which a reader hands out; models built from any bytes,
//! and what must hold of them after writing and after repair.

pub mod built;
pub mod compressed;
pub mod repaired;
pub mod written;

use parbake_files::{FileError, Limits, Loaded, Resources};
use std::io;

/// Nothing within these takes more than a few hundred megabytes, so that libFuzzer's
/// own memory limit finds what goes beyond them.
pub const LIMITS: Limits = Limits {
    max_file_bytes: 1 << 20,
    max_vertices: 100_000,
    max_triangles: 100_000,
    max_image_side: 4096,
    max_image_pixels: 1 << 20,
    max_total_pixels: 1 << 22,
    max_json_objects: 10_000,
    confine: true,
};

/// One file that stands beside the model under every name.
pub struct Everywhere<'a>(pub &'a [u8]);

impl Resources for Everywhere<'_> {
    fn read(&self, _relative: &str, max_bytes: u64) -> io::Result<Vec<u8>> {
        let fits = self.0.len() as u64 <= max_bytes;
        if fits { Ok(self.0.to_vec()) } else { Err(io::ErrorKind::FileTooLarge.into()) }
    }
}

/// Panics where a reader breaks its promises: a model that keeps the contracts of
/// `Model` and `Mesh`, or an error on one line that begins with the file's name.
pub fn check(result: Result<Loaded, FileError>) {
    let model = match result {
        Ok(loaded) => loaded.model,
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("fuzz") && !message.contains('\n'), "{message}");
            return;
        }
    };
    let mesh = &model.mesh;
    let count = mesh.positions.len();
    assert!(!mesh.triangles.is_empty());
    assert_eq!(mesh.triangle_materials.len(), mesh.triangles.len());
    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < count));
    assert!(mesh.triangle_materials.iter().all(|&m| (m as usize) < model.materials.len()));
    for length in
        [mesh.normals.len(), mesh.tangents.len(), mesh.uvs.len(), mesh.uvs1.len(), mesh.colors.len()]
    {
        assert!(length == 0 || length == count);
    }
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3));
    assert!(mesh.tangents.iter().all(|t| (t.truncate().length() - 1.0).abs() < 1e-3 && t.w.abs() == 1.0));
    assert!(mesh.uvs.iter().chain(&mesh.uvs1).all(|uv| uv.is_finite()));
    assert!(mesh.colors.iter().all(|c| c.is_finite()));
    for material in &model.materials {
        for slot in [material.base_color_texture, material.normal_texture].into_iter().flatten() {
            assert!(slot.image < model.images.len() && slot.uv_set < 2);
        }
    }
    assert!(model.images.iter().all(|i| !i.pixels.is_empty() && i.pixels.len() == i.width * i.height));
}
