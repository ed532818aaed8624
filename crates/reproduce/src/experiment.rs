//! One run of the product: on what, and with which recipe.

use crate::catalogue::{Level, ModelFolder, file_name};
use crate::variants::VariantsOptions;
use parbake::{BakeOptions, ImageOptions, UvMode};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What it is run on.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    /// A high-poly and one of its levels.
    Pair {
        /// The model's name.
        model: String,
        /// Which level.
        level: Level,
        /// The high-poly's file.
        high: PathBuf,
        /// The low-poly's file.
        low: PathBuf,
    },
    /// A model by itself.
    Model {
        /// Its name.
        model: String,
        /// Its file.
        path: PathBuf,
    },
    /// A picture.
    Picture {
        /// Its file.
        path: PathBuf,
    },
    /// The built-in brick wall over its plain cube.
    Wall,
}

impl Subject {
    /// A model with a level; none where the folder has not got it.
    pub fn pair(folder: &ModelFolder, level: Level) -> Option<Self> {
        let low = folder.low(level)?.to_path_buf();
        Some(Self::Pair { model: folder.name.clone(), level, high: folder.high.clone(), low })
    }

    /// A model by itself.
    pub fn model(folder: &ModelFolder) -> Self {
        Self::Model { model: folder.name.clone(), path: folder.high.clone() }
    }

    /// A picture.
    pub fn picture(path: &Path) -> Self {
        Self::Picture { path: path.to_path_buf() }
    }

    /// What people read.
    pub fn name(&self) -> String {
        match self {
            Subject::Pair { model, level, .. } => format!("{model} {}", level.name()),
            Subject::Model { model, .. } => model.clone(),
            Subject::Picture { path } => stem(path),
            Subject::Wall => "brick wall".into(),
        }
    }

    /// Files whose content it depends on, by folders: materials and textures lie beside a model.
    pub fn files(&self) -> Vec<&Path> {
        match self {
            Subject::Pair { high, low, .. } => vec![high, low],
            Subject::Model { path, .. } | Subject::Picture { path } => vec![path],
            Subject::Wall => Vec::new(),
        }
    }
}

/// A file's name without its ending.
pub fn stem(path: &Path) -> String {
    let name = file_name(path);
    name.rsplit_once('.').map_or(name.clone(), |(stem, _)| stem.into())
}

/// What is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Recipe {
    /// A bake.
    Bake {
        /// Its options.
        options: Box<BakeOptions>,
        /// How the low-poly's coordinates are made anew before, where they are.
        start: Option<UvMode>,
        /// Whether each of the low-poly's triangles is split into four before.
        subdivided: bool,
    },
    /// The same model with a smaller texture.
    Compress {
        /// Its options.
        options: Box<BakeOptions>,
    },
    /// A plane for a picture.
    Picture {
        /// Its options.
        options: ImageOptions,
    },
    /// A picture scaled down with a triangle filter, on a plane.
    Downsample {
        /// Texels along a side.
        texture_size: usize,
    },
    /// A bake of a model onto a coarser copy of itself, under random lights.
    Relit {
        /// Its options.
        options: Box<BakeOptions>,
        /// Triangles of the copy; no more than half of the model's own.
        triangles: usize,
    },
    /// All kinds of parallax mapping.
    Variants {
        /// Their options.
        options: VariantsOptions,
    },
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// On what.
    pub subject: Subject,
    /// What.
    pub recipe: Recipe,
    /// What people call the recipe.
    pub label: String,
}

impl Experiment {
    /// A bake as it is, from the delivered coordinates.
    pub fn bake(subject: Subject, label: &str, options: BakeOptions) -> Self {
        let recipe = Recipe::Bake { options: Box::new(options), start: None, subdivided: false };
        Self { subject, recipe, label: label.into() }
    }

    /// What people read: "mask LOD-3, 512², all".
    pub fn title(&self) -> String {
        format!("{}, {}², {}", self.subject.name(), self.texture_size(), self.label)
    }

    /// Texels along a side.
    pub fn texture_size(&self) -> usize {
        match &self.recipe {
            Recipe::Bake { options, .. } | Recipe::Compress { options } | Recipe::Relit { options, .. } => {
                options.texture_size
            }
            Recipe::Picture { options } => options.texture_size,
            Recipe::Downsample { texture_size } => *texture_size,
            Recipe::Variants { options } => options.texture_size,
        }
    }
}
