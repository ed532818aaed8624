//! The models of `$PARBAKE_DATA/pbr` and `pairs` are read without loss, survive a
//! way through GLB and OBJ, or are refused with a way out.

mod common;

use common::{check_model, data_folder, files_below};
use parbake_files::{FileError, Limits, Loaded, read_geometry, read_model, write_glb, write_obj};
use std::path::Path;

/// All models of a folder that can be read, after checking them; the others must
/// say what is not supported and what to do.
fn load_all(folder: &Path) -> Vec<Loaded> {
    let mut all = Vec::new();
    for path in files_below(folder) {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if !["obj", "gltf", "glb"].iter().any(|e| extension == *e) {
            continue;
        }
        match read_model(&path, &Limits::default()) {
            Ok(loaded) => {
                check_model(&path, &loaded);
                all.push(loaded);
            }
            Err(error @ FileError::Unsupported { .. }) => println!("{error}"),
            Err(error) => panic!("{error}"),
        }
    }
    all
}

/// Protects real models on the way in and, through both formats, out and in again.
#[test]
fn real_models_survive_both_formats() {
    let Some(data) = data_folder() else { return };
    let folder = tempfile::tempdir().unwrap();
    for source in ["pbr", "pairs"] {
        let models = load_all(&data.join(source));
        assert!(!models.is_empty(), "{source}");
        for Loaded { model, .. } in models {
            let glb = folder.path().join("a.glb");
            write_glb(&glb, &model).unwrap();
            let back = read_model(&glb, &Limits::default()).unwrap();
            check_model(&glb, &back);
            assert_eq!(back.model.mesh.triangles.len(), model.mesh.triangles.len());
            if model.materials.len() == 1 {
                assert_eq!(back.model.mesh, model.mesh, "{}", model.name);
            }
            for (a, b) in back.model.images.iter().zip(&model.images) {
                assert_eq!(a.pixels, b.pixels, "{}", b.name);
            }
            let obj = folder.path().join("a.obj");
            match write_obj(&obj, &model) {
                Ok(()) => {
                    let back = read_geometry(&obj, &Limits::default()).unwrap().model;
                    for i in 0..model.mesh.triangles.len() {
                        assert_eq!(back.mesh.corners(i), model.mesh.corners(i), "{}", model.name);
                        assert_eq!(back.mesh.corner_uvs(i), model.mesh.corner_uvs(i), "{}", model.name);
                    }
                }
                Err(FileError::Unsupported { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
    }
}

/// Protects the counts that the data's own notes give.
#[test]
fn real_models_have_the_known_counts() {
    let Some(data) = data_folder() else { return };
    for (path, triangles, materials) in [
        ("pbr/Avocado-Quantized/Avocado.gltf", 682, 1),
        ("pbr/GlassVaseFlowers/GlassVaseFlowers.glb", 14_036, 3),
        ("pbr/TransmissionTest/TransmissionTest.glb", 128_775, 14),
        ("pbr/VintageFan/vintageFan_animated.gltf", 21_080, 1),
        ("pbr/LowPolyTree/low-poly-tree.glb", 1126, 1),
        ("pairs/lego_figure/high/hp.obj", 3680, 1),
        ("pairs/koala/koala.obj", 99_994, 1),
    ] {
        let loaded = read_geometry(&data.join(path), &Limits::default()).unwrap();
        assert_eq!(loaded.model.mesh.triangles.len(), triangles, "{path}");
        assert_eq!(loaded.model.materials.len(), materials, "{path}");
    }
}
