//! Which other files a model names: what has to be looked at to know whether a model is still the same, and what no output may
//! replace.
//!
//! glTF's buffers and images are in its JSON. An OBJ names libraries by `mtllib`, and these name pictures by lines that
//! end in a file's name after options; each end of such a line that is a file counts, since names may hold blanks.
//! What is not at its place is looked for where readers look for it ([`crate::search`]).
//!
//! Contract: files that exist, each once, sorted. A file more than the reader opens is better than one less; names in what
//! cannot be understood are left out, as the reader will say so.

use crate::gltf;
use crate::obj;
use crate::resources::{begins_with, read_file};
use crate::search;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Larger OBJ files and documents are not searched for names; the limit of the readers is below.
const MOST_BYTES: u64 = 4 << 30;

/// The files that a model names, without the model itself.
///
/// # Errors
/// When the model's own file cannot be read.
pub fn named_files(model: &Path) -> std::io::Result<Vec<PathBuf>> {
    let extension = model.extension().map(|e| e.to_ascii_lowercase()).unwrap_or_default();
    let is_binary = begins_with(model, gltf::MAGIC)?;
    let mut found = Found { model, files: BTreeSet::new() };
    if is_binary || extension == "gltf" {
        let bytes = read_file(model, MOST_BYTES)?;
        for name in gltf::named_files(&bytes) {
            found.add(&name, "");
        }
    } else if extension == "obj" {
        let bytes = read_file(model, MOST_BYTES)?;
        for name in obj::named_libraries(&bytes) {
            for library in found.add(&name, "") {
                let folder = name.rfind('/').map_or("", |at| &name[..=at]);
                let pictures = read_file(&library, MOST_BYTES).unwrap_or_default();
                for name in obj::named_pictures(&pictures) {
                    found.add(&name, folder);
                }
            }
        }
    }
    Ok(found.files.into_iter().collect())
}

struct Found<'a> {
    model: &'a Path,
    files: BTreeSet<PathBuf>,
}

impl Found<'_> {
    /// Takes in the files that a name may mean, and returns them.
    fn add(&mut self, name: &str, folder: &str) -> Vec<PathBuf> {
        let beside = self.model.parent().unwrap_or(Path::new(""));
        let mut places = vec![format!("{folder}{name}"), name.to_string()];
        places.extend(search::by_name(name, folder));
        let is_there = |place: &String| search::may_be_here(place) && !place.is_empty();
        let mut files: Vec<PathBuf> =
            places.iter().filter(|place| is_there(place)).map(|p| beside.join(p)).collect();
        files.retain(|file| file.is_file());
        // The first is the one that is read.
        files.truncate(1);
        self.files.extend(files.iter().cloned());
        files
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects results from being kept when a texture of their model changed: what OBJ files and their libraries
    /// name is found, with blanks, options and folders of other machines.
    #[test]
    fn an_objs_files_are_found() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        std::fs::create_dir(at("textures")).unwrap();
        std::fs::write(at("m.obj"), "mtllib my lib.mtl\nmtllib other.mtl gone.mtl\nv 0 0 0\n").unwrap();
        let library =
            "newmtl a\nmap_Kd -s 1 1 1 oak wood.png\r\nbump C:\\x\\bump.png\nnorm none.png\nKd 1 1 1\n";
        std::fs::write(at("my lib.mtl"), library).unwrap();
        std::fs::write(at("other.mtl"), "map_Pr rough.png # soft\n").unwrap();
        for name in ["oak wood.png", "textures/bump.png", "rough.png", "unused.png"] {
            std::fs::write(at(name), name).unwrap();
        }
        let found = named_files(&at("m.obj")).unwrap();
        let mut wanted =
            ["my lib.mtl", "other.mtl", "oak wood.png", "textures/bump.png", "rough.png"].map(at).to_vec();
        wanted.sort();
        assert_eq!(found, wanted);
    }

    /// Protects the same of glTF: buffers and images, decoded names, no data URIs; in a GLB too.
    #[test]
    fn a_gltfs_files_are_found() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        let document = serde_json::json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "uri": "a%20b.bin", "byteLength": 1 }, { "uri": "data:;base64,AA==" }, { "byteLength": 1 }],
            "images": [{ "uri": "p.png" }, { "uri": "gone.png" }, { "bufferView": 0 }],
        });
        std::fs::write(at("m.gltf"), document.to_string()).unwrap();
        std::fs::write(at("a b.bin"), "x").unwrap();
        std::fs::write(at("p.png"), "x").unwrap();
        assert_eq!(named_files(&at("m.gltf")).unwrap(), [at("a b.bin"), at("p.png")]);
        let text = document.to_string();
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        for word in [20 + text.len(), text.len()] {
            glb.extend((word as u32).to_le_bytes());
        }
        std::fs::write(at("m.glb"), [&glb[..], b"JSON", text.as_bytes()].concat()).unwrap();
        assert_eq!(named_files(&at("m.glb")).unwrap(), [at("a b.bin"), at("p.png")]);
        std::fs::write(at("cut.glb"), &glb).unwrap();
        assert!(named_files(&at("cut.glb")).unwrap().is_empty());
        std::fs::write(at("broken.gltf"), "{").unwrap();
        assert!(named_files(&at("broken.gltf")).unwrap().is_empty());
        assert!(named_files(&at("gone.gltf")).is_err());
    }
}
