//! Names and helper files with which engines read levels of detail.
//!
//! What each engine picks up by itself, and what the helper does, is on the page docs/levels-of-detail.md. Helpers
//! read `lods.json`, so that they serve any number of models.

use serde::{Deserialize, Serialize};

/// For which engine files are laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// GLB files and lods.json
    #[default]
    Files,
    /// Names with _LOD0, _LOD1, …, and an importer that makes a prefab with a LODGroup
    Unity,
    /// A scene that switches levels by visibility ranges
    Godot,
    /// An import script that makes one static mesh with levels
    Unreal,
    /// A plug-in source file with visibility ranges
    Bevy,
    /// A module that makes a THREE.LOD
    Three,
}

impl Layout {
    /// The name of a level's file.
    pub fn level_file(self, name: &str, level: usize) -> String {
        match self {
            Self::Unity | Self::Unreal => format!("{name}_LOD{level}.glb"),
            _ => format!("{name}_lod{level}.glb"),
        }
    }

    /// The name of the file with all levels.
    pub fn all_levels_file(self, name: &str) -> String {
        format!("{name}_lods.glb")
    }

    /// Files that help the engine, with their names; `name` is the model's in file names.
    pub fn helpers(self, name: &str) -> Vec<(String, String)> {
        let file = |file: &str, text: &str| (file.to_string(), text.replace("@NAME@", name));
        match self {
            Self::Files => Vec::new(),
            Self::Unity => vec![file("Editor/ParbakeLods.cs", include_str!("engines/ParbakeLods.cs"))],
            Self::Godot => vec![
                file("parbake_lods.gd", include_str!("engines/parbake_lods.gd")),
                file(&format!("{name}.tscn"), include_str!("engines/scene.tscn")),
            ],
            Self::Unreal => vec![file("import_lods.py", include_str!("engines/import_lods.py"))],
            Self::Bevy => vec![file("parbake_lods.rs", include_str!("engines/parbake_lods.rs"))],
            Self::Three => vec![file("parbake_lods.js", include_str!("engines/parbake_lods.js"))],
        }
    }
}
