//! Reads the models below the folders that are named, and says of each what was read, or why not:
//! `cargo run -p parbake-files --example read_models -- FOLDER…`

use parbake_files::{Limits, read_model};
use std::path::{Path, PathBuf};
use std::time::Instant;

fn models(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut paths: Vec<_> = entries.flatten().map(|e| e.path()).collect();
    paths.sort();
    for path in paths {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if path.is_dir() {
            models(&path, found);
        } else if ["obj", "gltf", "glb"].iter().any(|e| extension == *e) {
            found.push(path);
        }
    }
}

fn main() {
    let mut found = Vec::new();
    for argument in std::env::args_os().skip(1).map(PathBuf::from) {
        if argument.is_dir() { models(&argument, &mut found) } else { found.push(argument) }
    }
    for path in found {
        let start = Instant::now();
        match read_model(&path, &Limits::default()) {
            Ok(loaded) => {
                let model = &loaded.model;
                let texels: usize = model.images.iter().map(|i| i.pixels.len()).sum();
                println!(
                    "{}: {} triangles, {} materials, {} images of {texels} texels, {:.2} s",
                    path.display(),
                    model.mesh.triangles.len(),
                    model.materials.len(),
                    model.images.len(),
                    start.elapsed().as_secs_f64(),
                );
                loaded.warnings.iter().for_each(|warning| println!("  {warning}"));
            }
            Err(error) => println!("REFUSED {error}"),
        }
    }
}
