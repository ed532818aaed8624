//! What there is to run on: the models and pictures of a data folder.
//!
//! ```text
//! DATA/pairs/NAME/high/          one model, textured
//!               /low_simplygon/      LOD-1   (lod1 does as well)
//!               /low_simplygon100/   LOD-2   (lod2)
//!               /low_simplygon50/    LOD-3   (lod3)
//! DATA/pbr/NAME/                 one model, whose materials may have more than colour
//! DATA/images2d/PICTURE.png, .jpg, .webp
//! ```
//!
//! Contract: everything is in the order of its names. A folder in which a part is missing is left
//! out with a word about it, never an error: users add folders of their own.

use crate::error::ReproduceError;
use parbake::{Limits, read_model};
use parbake_image::material_maps::fitted_alpha;
use parbake_model::AlphaMode;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How far a low-poly is from its high-poly: Simplygon's screen sizes 300, 100 and 50.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Level {
    /// Small differences.
    One,
    /// Moderate ones.
    Two,
    /// Large ones.
    Three,
}

impl Level {
    /// All, from fine to coarse.
    pub const ALL: [Level; 3] = [Level::One, Level::Two, Level::Three];

    /// As the paper calls it.
    pub fn name(self) -> &'static str {
        match self {
            Level::One => "LOD-1",
            Level::Two => "LOD-2",
            Level::Three => "LOD-3",
        }
    }

    /// Folders that hold it.
    fn folders(self) -> [&'static str; 2] {
        match self {
            Level::One => ["low_simplygon", "lod1"],
            Level::Two => ["low_simplygon100", "lod2"],
            Level::Three => ["low_simplygon50", "lod3"],
        }
    }
}

/// A model with its coarse levels.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFolder {
    /// The folder's name.
    pub name: String,
    /// The high-poly.
    pub high: PathBuf,
    /// Those levels that there are.
    pub lows: Vec<(Level, PathBuf)>,
}

impl ModelFolder {
    /// A level's file.
    pub fn low(&self, level: Level) -> Option<&Path> {
        self.lows.iter().find(|(l, _)| *l == level).map(|(_, path)| path.as_path())
    }
}

/// All that a data folder holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Catalogue {
    /// Models with at least one level.
    pub models: Vec<ModelFolder>,
    /// Models without levels; see [`Catalogue::keep_mapped`].
    pub mapped: Vec<ModelFolder>,
    /// Pictures.
    pub pictures: Vec<PathBuf>,
    /// What was left out and why, a sentence each.
    pub left_out: Vec<String>,
}

impl Catalogue {
    /// Looks through a folder; `wanted` names parts of names, none for all.
    ///
    /// # Errors
    /// When the folder cannot be listed, or holds nothing that could be run.
    pub fn of(data: &Path, wanted: &[String]) -> Result<Self, ReproduceError> {
        let chosen = |name: &str| {
            wanted.is_empty() || wanted.iter().any(|w| name.to_lowercase().contains(&w.to_lowercase()))
        };
        let mut found = Self::default();
        list(data)?;
        for folder in list(&data.join("pairs")).unwrap_or_default() {
            let name = file_name(&folder);
            if folder.is_dir() && chosen(&name) {
                match model_folder(&folder, name) {
                    Ok(model) => found.models.push(model),
                    Err(reason) => found.left_out.push(reason),
                }
            }
        }
        for folder in list(&data.join("pbr")).unwrap_or_default() {
            let name = file_name(&folder);
            if let Some(high) = model_in(&folder).filter(|_| chosen(&name)) {
                found.mapped.push(ModelFolder { name, high, lows: Vec::new() });
            }
        }
        let is_picture = |path: &Path| has_ending(path, &["png", "jpg", "jpeg", "webp"]);
        found.pictures = list(&data.join("images2d")).unwrap_or_default();
        found.pictures.retain(|path| is_picture(path) && chosen(&file_name(path)));
        if found.models.is_empty() && found.pictures.is_empty() && found.mapped.is_empty() {
            return Err(ReproduceError::Nothing { path: data.to_path_buf() });
        }
        Ok(found)
    }

    /// Reads the models without levels, and keeps those that are opaque and whose roughness or metal is a texture.
    pub fn keep_mapped(&mut self) {
        let left_out = &mut self.left_out;
        self.mapped.retain(|folder| match read_model(&folder.high, &Limits::default()) {
            Ok(read) => {
                let materials = &read.model.materials;
                materials.iter().any(|m| m.metallic_roughness_texture.is_some())
                    && materials.iter().all(|m| fitted_alpha(m).0 == AlphaMode::Opaque)
            }
            Err(error) => {
                left_out.push(format!("{}: left out: {error}", folder.name));
                false
            }
        });
    }
}

/// A pair folder's models, or why it has none.
fn model_folder(folder: &Path, name: String) -> Result<ModelFolder, String> {
    let high = model_in(&folder.join("high"))
        .ok_or(format!("{name}: left out, for there is no high/ with an .obj, .glb or .gltf in it"))?;
    let lows: Vec<_> = Level::ALL
        .into_iter()
        .filter_map(|level| {
            let file = level.folders().iter().find_map(|low| model_in(&folder.join(low)))?;
            Some((level, file))
        })
        .collect();
    if lows.is_empty() {
        return Err(format!("{name}: left out, for it has none of the levels' folders"));
    }
    let read = read_model(&high, &Limits::default()).map_err(|e| format!("{name}: left out: {e}"))?;
    let textured = read.model.materials.iter().any(|m| m.base_color_texture.is_some());
    if !textured && read.model.mesh.colors.is_empty() {
        return Err(format!("{name}: left out, for its high-poly has no texture to move"));
    }
    Ok(ModelFolder { name, high, lows })
}

/// The first model file in a folder.
fn model_in(folder: &Path) -> Option<PathBuf> {
    list(folder).ok()?.into_iter().find(|path| has_ending(path, &["obj", "glb", "gltf"]))
}

/// Whether a file is of one of these kinds, in small letters or capitals.
pub fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    endings.contains(&ending.as_str())
}

/// The last part of a path, as text.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What lies in a folder, in the order of names.
pub fn list(folder: &Path) -> Result<Vec<PathBuf>, ReproduceError> {
    let entries = std::fs::read_dir(folder).map_err(ReproduceError::disk(folder))?;
    let mut paths = Vec::new();
    for entry in entries {
        paths.push(entry.map_err(ReproduceError::disk(folder))?.path());
    }
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: &str =
        "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

    fn write(path: PathBuf, text: &str) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// Protects users' own folders: what is whole is found, what is not is named, nothing stops.
    #[test]
    fn folders_are_found_and_gaps_are_told() {
        let data = tempfile::tempdir().unwrap();
        let pairs = data.path().join("pairs");
        let picture = image::RgbaImage::from_pixel(2, 2, image::Rgba([9, 9, 9, 255]));
        for name in ["b_mine", "a_whole"] {
            write(pairs.join(name).join("high/h.obj"), TRIANGLE);
            write(pairs.join(name).join("high/a.mtl"), "newmtl m\nmap_Kd a.png\n");
            picture.save(pairs.join(name).join("high/a.png")).unwrap();
        }
        write(pairs.join("a_whole/low_simplygon50/l.obj"), TRIANGLE);
        write(pairs.join("b_mine/lod1/l.obj"), TRIANGLE);
        write(pairs.join("c_plain/high/h.obj"), TRIANGLE);
        write(pairs.join("c_plain/lod3/h.obj"), TRIANGLE);
        write(pairs.join("d_empty/readme.txt"), "");
        write(data.path().join("images2d/p.PNG"), "");
        write(data.path().join("images2d/p.obj"), "");
        let found = Catalogue::of(data.path(), &[]).unwrap();
        let names: Vec<&str> = found.models.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["a_whole", "b_mine"]);
        assert!(found.models[0].low(Level::Three).is_some() && found.models[0].low(Level::One).is_none());
        assert!(found.models[1].low(Level::One).is_some());
        assert_eq!(found.pictures.len(), 1);
        assert_eq!(found.left_out.len(), 2, "{:?}", found.left_out);
        assert_eq!(Catalogue::of(data.path(), &["MINE".into()]).unwrap().models.len(), 1);
        assert!(matches!(Catalogue::of(&pairs.join("d_empty"), &[]), Err(ReproduceError::Nothing { .. })));
        assert!(matches!(Catalogue::of(&pairs.join("none"), &[]), Err(ReproduceError::Disk { .. })));
    }
}
