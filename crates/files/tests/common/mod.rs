//! What the integration tests share.

#![allow(dead_code, reason = "every test file uses another part of it")]

use parbake_files::Loaded;
use std::io::Write;
use std::path::{Path, PathBuf};

/// `$PARBAKE_DATA`, or `None` after saying that the test is skipped. A variable
/// that leads nowhere is a failure, lest a test passes by looking at nothing.
pub fn data_folder() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("PARBAKE_DATA").map(PathBuf::from) else {
        let test = std::thread::current().name().unwrap_or_default().to_string();
        let line = format!("SKIPPED {test}: set PARBAKE_DATA to the folder of test data to run it\n");
        // Not eprintln!, which the test runner swallows when a test passes; and in
        // one piece, as tests run side by side.
        let _ = std::io::stderr().write_all(line.as_bytes());
        return None;
    };
    assert!(folder.is_dir(), "PARBAKE_DATA is {}, which is no folder", folder.display());
    Some(folder)
}

/// The most memory this process has had in use so far, in bytes; 0 where the system does not tell.
pub fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap_or("0 kB");
    line.split_ascii_whitespace().next().and_then(|n| n.parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// All files below a folder, in a fixed order.
pub fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.flatten().map(|e| e.path()) {
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}

/// Leaves a GLB file in `$PARBAKE_GLB_OUT`, if it is set, for the validator.
pub fn keep(path: &Path, name: &str) -> std::io::Result<()> {
    if let Some(folder) = std::env::var_os("PARBAKE_GLB_OUT").map(PathBuf::from) {
        std::fs::create_dir_all(&folder)?;
        std::fs::copy(path, folder.join(name))?;
    }
    Ok(())
}

/// Asserts the contracts of `Model` and `Mesh`.
pub fn check_model(path: &Path, loaded: &Loaded) {
    let path = path.display();
    let (mesh, model) = (&loaded.model.mesh, &loaded.model);
    let count = mesh.positions.len();
    assert!(!mesh.triangles.is_empty(), "{path}");
    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < count), "{path}");
    assert_eq!(mesh.triangle_materials.len(), mesh.triangles.len(), "{path}");
    assert!(mesh.triangle_materials.iter().all(|&m| (m as usize) < model.materials.len()), "{path}");
    let lengths =
        [&mesh.normals.len(), &mesh.tangents.len(), &mesh.uvs.len(), &mesh.uvs1.len(), &mesh.colors.len()];
    assert!(lengths.iter().all(|&&n| n == 0 || n == count), "{path}: {count} {lengths:?}");
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "{path}");
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "{path}");
    assert!(mesh.tangents.iter().all(|t| (t.truncate().length() - 1.0).abs() < 1e-3), "{path}");
    assert!(mesh.tangents.iter().all(|t| t.w.abs() == 1.0), "{path}");
    assert!(mesh.uvs.iter().chain(&mesh.uvs1).all(|uv| uv.is_finite()), "{path}");
    assert!(mesh.colors.iter().all(|c| c.is_finite()), "{path}");
    for material in &model.materials {
        for slot in material.all_texture_slots() {
            assert!(slot.image < model.images.len() && slot.uv_set < 2, "{path}");
        }
        if let Some(map) = &material.parallax {
            assert_eq!(map.check(&model.images), Ok(()), "{path}");
        }
        let (color, emissive) = (&material.base_color, &material.emissive);
        let factors = [material.metallic, material.roughness, material.occlusion_strength];
        let mut factors = color.iter().chain(emissive).chain(&factors);
        assert!(factors.all(|x| (0.0..=1.0).contains(x)), "{path}");
        let unbounded = [material.emissive_strength, material.alpha_cutoff];
        assert!(unbounded.iter().all(|x| *x >= 0.0 && x.is_finite()), "{path}");
    }
    for image in &model.images {
        assert_eq!(image.pixels.len(), image.width * image.height, "{path}");
    }
}
