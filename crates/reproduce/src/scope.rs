//! What a run covers: the data, and the settings that all its experiments share.

use crate::catalogue::{Catalogue, Level};
use crate::options::ReproduceOptions;
use parbake::{BakeOptions, Convention, ImageOptions, Parallax, Preset, ShapeMode, UvMode};

/// The data and the options.
#[derive(Clone, Debug)]
pub struct Scope {
    /// Models and pictures.
    pub catalogue: Catalogue,
    /// What was asked.
    pub options: ReproduceOptions,
}

impl Scope {
    /// Texture sizes of models.
    pub fn sizes(&self) -> &'static [usize] {
        if self.options.quick { &[128] } else { &[128, 256, 512] }
    }

    /// The size of figures that show one.
    pub fn shown_size(&self) -> usize {
        if self.options.quick { 128 } else { 512 }
    }

    /// Texture sizes of pictures.
    pub fn picture_sizes(&self) -> &'static [usize] {
        if self.options.quick { &[64] } else { &[64, 128, 256] }
    }

    /// Levels of models.
    pub fn levels(&self) -> &'static [Level] {
        if self.options.quick { &[Level::Three] } else { &Level::ALL }
    }

    /// A bake by the paper's convention, of which an experiment changes what it is about.
    pub fn bake(&self, texture_size: usize) -> BakeOptions {
        BakeOptions {
            texture_size,
            preset: if self.options.quick { Preset::Fast } else { Preset::Balanced },
            convention: Convention::Paper,
            ..BakeOptions::default()
        }
    }

    /// The fit of colours and normals alone: what NVDiffModeling is in the paper.
    pub fn fixed(&self, texture_size: usize) -> BakeOptions {
        BakeOptions { uv: UvMode::Keep, shape: ShapeMode::Keep, ..self.bake(texture_size) }
    }

    /// All that moves: what *Ours* is in the paper.
    pub fn all(&self, texture_size: usize) -> BakeOptions {
        BakeOptions { parallax: Parallax::Sh, ..self.bake(texture_size) }
    }

    /// A picture's plane.
    pub fn picture(&self, texture_size: usize) -> ImageOptions {
        ImageOptions { texture_size, ..ImageOptions::default() }
    }
}
