//! Every file of the folders `bad`, `extreme` and `feature` below `$PARBAKE_DATA`
//! gives either a model that keeps its contract or an error that names the file;
//! never a panic, never much time, and never much memory.

mod common;

use common::{check_model, data_folder, files_below, peak_memory};
use parbake_files::{
    FileError, Limits, NoResources, decode_image, read_gltf_bytes, read_image, read_model, read_obj_bytes,
};
use std::path::Path;
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
    confine: true,
};

const MOST_MEMORY: u64 = 1_000_000_000;

fn is_model(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    ["obj", "gltf", "glb"].iter().any(|e| extension == *e)
}

/// Reads a file as what its name says; a picture where it says nothing, as
/// fuzzers' pictures have no extension.
fn read(path: &Path) -> Result<(), FileError> {
    if is_model(path) {
        return read_model(path, &LIMITS).map(|loaded| check_model(path, &loaded));
    }
    read_image(path, &LIMITS).map(|image| {
        assert_eq!(image.pixels.len(), image.width * image.height, "{}", path.display());
    })
}

/// Protects against crashes, hangs, memory bombs and models that break their contract.
#[test]
fn hostile_files_give_a_model_or_a_clean_error() {
    let Some(data) = data_folder() else { return };
    let before = peak_memory();
    let (mut good, mut bad) = (0, 0);
    for path in ["bad", "extreme", "feature"].iter().flat_map(|folder| files_below(&data.join(folder))) {
        let start = Instant::now();
        let result = read(&path);
        assert!(start.elapsed().as_secs() < 10, "{} took {:?}", path.display(), start.elapsed());
        let Err(error) = result else {
            good += 1;
            continue;
        };
        bad += 1;
        let message = error.to_string();
        assert!(message.starts_with(&*path.to_string_lossy()), "{message}");
        assert!(!message.chars().any(char::is_control) && message.len() < 1000, "{message}");
    }
    println!("{good} files gave a model or picture, {bad} an error");
    assert!(good + bad > 1000, "PARBAKE_DATA is not complete");
    let grown = peak_memory().saturating_sub(before);
    assert!(grown < MOST_MEMORY, "{grown} bytes");
}

/// Protects every parser from the files that were made to break the others.
#[test]
fn every_parser_meets_every_file() {
    let Some(data) = data_folder() else { return };
    for path in files_below(&data.join("bad")) {
        let Ok(bytes) = std::fs::read(&path) else { continue };
        let start = Instant::now();
        let name = Path::new("name");
        for result in [
            read_obj_bytes(name, &bytes, &NoResources, &LIMITS),
            read_gltf_bytes(name, &bytes, &NoResources, &LIMITS),
        ] {
            match result {
                Ok(loaded) => check_model(&path, &loaded),
                Err(error) => assert!(error.to_string().starts_with("name"), "{error}"),
            }
        }
        if let Err(error) = decode_image("name", &bytes, &LIMITS) {
            assert!(error.to_string().starts_with("name"), "{error}");
        }
        assert!(start.elapsed().as_secs() < 10, "{} took {:?}", path.display(), start.elapsed());
    }
}

/// Protects what the folders' own names and notes promise.
#[test]
fn folders_keep_their_promises() {
    let Some(data) = data_folder() else { return };
    let outcome = |folder: &str, good: bool, exceptions: &[&str]| {
        let files = files_below(&data.join(folder));
        let is_case = |p: &&std::path::PathBuf| is_model(p) || p.extension().is_some_and(|e| e == "png");
        let cases: Vec<_> = files.iter().filter(is_case).collect();
        assert!(!cases.is_empty(), "{folder}");
        for path in cases {
            let excepted = exceptions.iter().any(|e| path.ends_with(e));
            let result = read(path);
            assert_eq!(result.is_ok(), good != excepted, "{}: {result:?}", path.display());
        }
    };
    outcome("bad/png/pngsuite_valid", true, &[]);
    outcome("bad/png/pngsuite_corrupt_must_fail", false, &[]);
    outcome("bad/png/image-png_bugfixes_must_fail", false, &[]);
    // Points and lines, which have no surface.
    let surfaceless =
        [0, 2, 8, 10].map(|mode| format!("Mesh_PrimitiveMode/Mesh_PrimitiveMode_{mode:02}.gltf"));
    outcome("extreme", true, &surfaceless.each_ref().map(String::as_str));
    // It has more triangles than the limits of this test allow.
    outcome("feature", true, &["TeapotsInstanced/teapots_galore.gltf"]);
    // Models without a whole library of theirs, and without pictures, are whole models.
    outcome("bad/preservation-samples/invalid/obj", true, &[]);
    outcome("bad/preservation-samples/invalid/gltf", false, &[]);
    outcome("bad/tinygltf/models/BoundsChecking", false, &[]);
}

/// Protects the words that tell a user where to look.
#[test]
fn errors_name_the_place() {
    let Some(data) = data_folder() else { return };
    let root = "bad/glTF-Validator/errors/base";
    for (path, expected) in [
        (
            "bad/tobj/obj/invalid_index.obj",
            ", line 12: the face uses v number 7, but the file defines only 6",
        ),
        ("bad/tinyobjloader/models/test-nan.obj", ", line 12: the position is not finite"),
        ("bad/tinyobjloader/models/issue-140-zero-face-idx.obj", ", line 16: the face uses v number 0"),
        ("bad/tinyobjloader/models/invalid-relative-vertex-index.obj", ", line 1: the face uses v number -4"),
        ("bad/trimesh/emptyIO/obj_wireframe.obj", ": the model has no triangles; it has 8 positions"),
        (
            "bad/tinygltf/models/BoundsChecking/invalid-primitive-indices.gltf",
            ", at /meshes/0/primitives/0/indices: accessor 1",
        ),
        (
            "bad/tinygltf/models/BoundsChecking/invalid-buffer-view-index.gltf",
            ", at /accessors/0/bufferView: buffer view 1",
        ),
        (
            "bad/tinygltf/models/BoundsChecking/invalid-buffer-index.gltf",
            ", at /bufferViews/1/buffer: buffer 1",
        ),
        (
            "bad/tinygltf/models/BoundsChecking/integer-out-of-bounds.gltf",
            ", at /bufferViews/0/byteLength: invalid value",
        ),
        (&format!("{root}/node/unresolved_child_node.gltf"), ", at /nodes/0/children/0: node 1"),
        (
            &format!("{root}/node/node_parent_override.gltf"),
            ", at /nodes/1/children/0: node 2 is reached twice",
        ),
        (&format!("{root}/scene/unresolved_default_scene.gltf"), ", at /scene: scene"),
        (&format!("{root}/texture/unresolved_source.gltf"), ", at /textures/0/source: image"),
        (
            &format!("{root}/material/unresolved_normal.gltf"),
            ", at /materials/0/normalTexture/index: texture",
        ),
        (&format!("{root}/mesh/empty_object.gltf"), ", at /meshes/1/primitives: invalid type: object"),
        (&format!("{root}/mesh/indices_invalid_format.gltf"), "indices are unsigned integers"),
        (&format!("{root}/glb/invalid_magic.glb"), ": the file is not GLB"),
        (&format!("{root}/image/png_eos.png"), ": the picture cannot be decoded: unexpected end of file"),
    ] {
        let path = data.join(path);
        let message = read(&path).expect_err(&path.to_string_lossy()).to_string();
        let rest = message.strip_prefix(&*path.to_string_lossy()).unwrap_or_default();
        assert!(rest.contains(expected), "{expected}\nis not in\n{message}");
    }
}
