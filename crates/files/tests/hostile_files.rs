//! Every file of the folders `bad`, `extreme` and `feature` below `$PARBAKE_DATA`
//! gives either a model that keeps its contract or an error that names the file;
//! never a panic, and never much memory.

mod common;

use common::{check_model, data_folder, files_below};
use parbake_files::{Limits, read_image, read_model};
use std::time::Instant;

/// Small enough that nothing within them needs more than `MOST_MEMORY`.
const LIMITS: Limits = Limits {
    max_file_bytes: 64 << 20,
    max_vertices: 2_000_000,
    max_triangles: 2_000_000,
    max_image_side: 8192,
    max_image_pixels: 1 << 24,
    max_total_pixels: 1 << 26,
    max_json_objects: 200_000,
};

const MOST_MEMORY: u64 = 1_500_000_000;

/// The most memory this process has had in use so far, in bytes; 0 where the system does not tell.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap_or("0 kB");
    line.split_ascii_whitespace().next().and_then(|n| n.parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// Protects against crashes, hangs, memory bombs and models that break their contract.
#[test]
fn hostile_files_give_a_model_or_a_clean_error() {
    let Some(data) = data_folder() else { return };
    let before = peak_memory();
    let (mut good, mut bad) = (0, 0);
    for folder in ["bad", "extreme", "feature"] {
        for path in files_below(&data.join(folder)) {
            let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
            let start = Instant::now();
            let result = match extension.to_str().unwrap_or_default() {
                "obj" | "gltf" | "glb" => {
                    read_model(&path, &LIMITS).map(|loaded| check_model(&path, &loaded))
                }
                // Fuzzers' pictures have no extension: whatever is no model is tried as one.
                "json" | "md" | "txt" | "tsv" | "mtl" | "bin" => continue,
                _ => read_image(&path, &LIMITS).map(|image| {
                    assert_eq!(image.pixels.len(), image.width * image.height, "{}", path.display());
                }),
            };
            assert!(start.elapsed().as_secs() < 10, "{} took {:?}", path.display(), start.elapsed());
            match result {
                Ok(()) => good += 1,
                Err(error) => {
                    bad += 1;
                    let message = error.to_string();
                    let name = path.file_name().unwrap_or_default().to_string_lossy();
                    assert!(message.contains(&*name), "{message}");
                    assert!(!message.contains('\n'), "{message}");
                    if std::env::var_os("PARBAKE_SHOW").is_some() {
                        println!("{message}");
                    }
                }
            }
        }
    }
    println!("{good} files gave a model or picture, {bad} an error");
    let grown = peak_memory().saturating_sub(before);
    assert!(grown < MOST_MEMORY, "{grown} bytes");
}
