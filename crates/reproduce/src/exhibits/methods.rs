//! What moves in a bake: the columns of the tables of low-polys, with their names in the paper.

use crate::catalogue::{Level, ModelFolder};
use crate::experiment::{Experiment, Subject};
use crate::scope::Scope;
use parbake::{BakeOptions, Parallax, ShapeMode, UvMode};

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moves {
    /// Nothing: colours and normals are projected, as ordinary bakers do.
    Nothing,
    /// Colours and normals: the fit with fixed coordinates that all gains are over.
    Textures,
    /// Texture coordinates besides.
    Coordinates,
    /// Vertices besides the textures.
    Vertices,
    /// SH shifts besides the textures, without a cutout.
    Shifts,
    /// Coordinates and SH shifts, without a cutout: the paper's Ours with UV and SH.
    CoordinatesAndShifts,
    /// SH shifts, cutout and vertices.
    ShiftsAndVertices,
    /// Coordinates and vertices: the default, which writes plain glTF.
    Plain,
    /// All of it.
    All,
}

impl Moves {
    /// The columns of the tables of levels.
    pub const LEVELS: [Moves; 5] =
        [Moves::Nothing, Moves::Textures, Moves::CoordinatesAndShifts, Moves::Plain, Moves::All];

    /// What people read.
    pub fn label(self) -> &'static str {
        match self {
            Moves::Nothing => "projected",
            Moves::Textures => "fixed UV",
            Moves::Coordinates => "UV",
            Moves::Vertices => "V",
            Moves::Shifts => "SH",
            Moves::CoordinatesAndShifts => "UV, SH",
            Moves::ShiftsAndVertices => "SH, V",
            Moves::Plain => "UV, V (plain glTF)",
            Moves::All => "all",
        }
    }

    /// The paper's name for what comes closest.
    pub fn papers(self) -> Option<&'static str> {
        match self {
            Moves::Nothing => Some("Blender"),
            Moves::Textures => Some("NV"),
            Moves::Vertices => Some("Ours_V"),
            Moves::Shifts => Some("Ours_SH"),
            Moves::CoordinatesAndShifts => Some("Ours_UV,SH"),
            Moves::ShiftsAndVertices => Some("Ours_SH,V"),
            Moves::All => Some("Ours"),
            Moves::Coordinates | Moves::Plain => None,
        }
    }

    /// The bake's options.
    pub fn options(self, scope: &Scope, size: usize) -> BakeOptions {
        let fixed = scope.fixed(size);
        let sh = Parallax::Sh;
        match self {
            Moves::Nothing => BakeOptions { rounds: Some(0), ..fixed },
            Moves::Textures => fixed,
            Moves::Coordinates => BakeOptions { uv: UvMode::Optimize, ..fixed },
            Moves::Vertices => BakeOptions { shape: ShapeMode::Free, ..fixed },
            Moves::Shifts => BakeOptions { parallax: sh, no_cutout: true, ..fixed },
            Moves::CoordinatesAndShifts => {
                BakeOptions { parallax: sh, no_cutout: true, uv: UvMode::Optimize, ..fixed }
            }
            Moves::ShiftsAndVertices => BakeOptions { parallax: sh, shape: ShapeMode::Free, ..fixed },
            Moves::Plain => scope.bake(size),
            Moves::All => scope.all(size),
        }
    }

    /// The experiment on a model's level, if it has that.
    pub fn on(self, scope: &Scope, model: &ModelFolder, level: Level, size: usize) -> Option<Experiment> {
        let subject = Subject::pair(model, level)?;
        Some(Experiment::bake(subject, self.label(), self.options(scope, size)))
    }
}
