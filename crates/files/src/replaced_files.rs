//! Which files a model that is about to be written takes the place of.
//!
//! Contract: paths that exist, folders included, which cannot be replaced.

use crate::obj;
use std::path::{Path, PathBuf};

/// The existing paths that writing a model to `output` may replace: the file itself; beside an OBJ also its material
/// file and its pictures, whatever their number, and files whose names differ from these in their case alone.
pub fn replaced_files(output: &Path) -> Vec<PathBuf> {
    match output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj")) {
        true => obj::replaced(output),
        false => output.exists().then(|| output.to_path_buf()).into_iter().collect(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use std::fs::write;

    /// Protects artists' files: what an OBJ takes with it is found, and nothing else that has a similar name.
    #[test]
    fn files_beside_an_obj_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let ours = ["m.mtl", "m.obj", "m_base_color.png", "m_base_color_2.png", "m_emissive.png"];
        let others =
            ["m.glb", "m.png", "m_base_color.jpg", "m_base_color_1.png", "m_occlusion.png", "mm_normal.png"];
        assert!(replaced_files(&at("m.obj")).is_empty());
        ours.iter().chain(&others).for_each(|name| write(at(name), "").unwrap());
        let mut found = replaced_files(&at("m.obj"));
        found.sort();
        assert_eq!(found, ours.map(at));
        assert_eq!(replaced_files(&at("m.glb")), [at("m.glb")]);
        // A folder is in the way, too, and blanks of a stem are not written.
        std::fs::create_dir(at("a_b.mtl")).unwrap();
        assert_eq!(replaced_files(&at("a b.obj")), [at("a_b.mtl")]);
    }
}
