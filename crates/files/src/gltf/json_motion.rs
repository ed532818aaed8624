//! What moves, in a glTF document: skins, morph targets and animations (glTF 2.0, 3.7.2.2, 3.7.3, 3.11).

use super::integer::{integers, optional_integer};
use serde::Deserialize;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Skin {
    #[serde(deserialize_with = "integers")]
    pub joints: Vec<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub inverse_bind_matrices: Option<usize>,
}

/// Accessors of a morph target.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct Target {
    #[serde(deserialize_with = "optional_integer")]
    pub position: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub normal: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Animation {
    pub name: String,
    pub channels: Vec<Channel>,
    pub samplers: Vec<AnimationSampler>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Channel {
    #[serde(deserialize_with = "optional_integer")]
    pub sampler: Option<usize>,
    pub target: ChannelTarget,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct ChannelTarget {
    #[serde(deserialize_with = "optional_integer")]
    pub node: Option<usize>,
    pub path: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct AnimationSampler {
    #[serde(deserialize_with = "optional_integer")]
    pub input: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub output: Option<usize>,
    pub interpolation: Option<String>,
}

/// What a mesh says beyond the specification; exporters name morph targets there.
#[derive(Debug, Default)]
pub(super) struct TargetNames(pub Vec<String>);

impl<'de> Deserialize<'de> for TargetNames {
    /// Extras may be anything.
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let extras = serde_json::Value::deserialize(deserializer)?;
        let names = extras.get("targetNames").and_then(|names| names.as_array());
        let name = |name: &serde_json::Value| name.as_str().unwrap_or_default().to_owned();
        Ok(Self(names.into_iter().flatten().map(name).collect()))
    }
}
