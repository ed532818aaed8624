//! How much parts of a model count: materials, nodes and painted places that deserve more texels and triangles than their
//! surface alone would get, or fewer.
//!
//! A weight of 4 gives a surface about four times as many texels, and lets errors on it count four times where
//! triangles are chosen. Weights are those of the high-poly's triangles; a low-poly's triangle has the mean of what
//! lies nearest to it.
//!
//! Where several names fit a triangle, the last one counts. A node's weight goes to all that hangs below it as well. What
//! is painted, `a` from 0 to 1, multiplies that by
//!
//! ```text
//! 16^(2a − 1)        0: 1/16   ¼: ¼   ½: 1   ¾: 4   1: 16
//! ```
//!
//! so that half is neutral, as nothing painted is. The product is held within the range of weights.
//!
//! Contract: without any all counts alike, and nothing is computed.

use crate::high_poly::HighPoly;
use parbake_mesh::named_nodes::{NodeError, named_nodes};
use parbake_model::{Hierarchy, Mesh, Model};
use parbake_render::interpolate::interpolate;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use wildmatch::WildMatch;

/// Importances that a model cannot have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportanceError {
    /// A pattern that fits no node.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// A name that fits no material.
    #[error("--importance cannot be {name}: it may be {range}")]
    NoMaterial {
        /// What was asked for.
        name: String,
        /// What may be asked for.
        range: String,
    },
    /// A model that was read without what is painted on it.
    #[error(
        "--importance-attribute {attribute}: {model} was read without it; read it by read_painted_model with the same name"
    )]
    NotPainted {
        /// The model.
        model: String,
        /// The attribute.
        attribute: String,
    },
}

/// How much the materials or nodes of a name count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Importance {
    /// What has the name.
    pub of: Named,
    /// Name of materials or nodes of the high-poly; `*` stands for any letters, `?` for one.
    pub name: String,
    /// How much it counts, [`Importance::LEAST`] to [`Importance::MOST`]; what is not named has 1.
    pub weight: f32,
}

/// What can be named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// A material: a name as it is, or after `material:`.
    Material,
    /// A node, with all that hangs below it: a name after `node:`.
    Node,
}

impl Named {
    const ALL: [Self; 2] = [Self::Material, Self::Node];

    fn prefix(self) -> &'static str {
        match self {
            Self::Material => "material:",
            Self::Node => "node:",
        }
    }
}

impl Importance {
    /// The least weight.
    pub const LEAST: f32 = 0.01;
    /// The greatest weight.
    pub const MOST: f32 = 100.0;
}

/// What the most and the least that can be painted count.
const PAINTED: f32 = 16.0;

impl FromStr for Importance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            let (least, most) = (Self::LEAST, Self::MOST);
            format!(
                "{text:?} should be a material, or node: and a node, and its weight, {least} to {most}, as in \
                 \"Cloth*=0.25\" or \"node:Wheel*=3\""
            )
        };
        // Names may hold the sign, weights do not.
        let (named, weight) = text.rsplit_once('=').ok_or_else(wrong)?;
        let weight: f32 = weight.trim().parse().map_err(|_| wrong())?;
        let prefixed = |of: Named| named.strip_prefix(of.prefix()).map(|name| (of, name));
        let (of, name) = Named::ALL.into_iter().find_map(prefixed).unwrap_or((Named::Material, named));
        if name.is_empty() || !(Self::LEAST..=Self::MOST).contains(&weight) {
            return Err(wrong());
        }
        Ok(Self { of, name: name.into(), weight })
    }
}

impl TryFrom<String> for Importance {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl fmt::Display for Importance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_plain =
            self.of == Named::Material && !Named::ALL.iter().any(|of| self.name.starts_with(of.prefix()));
        let prefix = if is_plain { "" } else { self.of.prefix() };
        write!(f, "{prefix}{}={}", self.name, self.weight)
    }
}

impl From<Importance> for String {
    fn from(importance: Importance) -> Self {
        importance.to_string()
    }
}

/// The weight of each of a model's triangles; empty where all count alike. `attribute` is the one that importances are
/// painted in, if there is one: the model was read with it.
///
/// # Errors
/// A name that fits no material or node; a model that was read without the attribute.
pub fn importances(
    model: &Model,
    options: &[Importance],
    attribute: Option<&str>,
) -> Result<Vec<f32>, ImportanceError> {
    if options.is_empty() && attribute.is_none() {
        return Ok(Vec::new());
    }
    let mut weights = vec![1.0; model.mesh.triangles.len()];
    for Importance { of, name, weight } in options {
        let (keys, is_named) = match of {
            Named::Material => (&model.mesh.triangle_materials, named_materials(model, name)?),
            Named::Node => {
                let Some(nodes) = &model.nodes else {
                    return Ok(named_nodes(model, name, OPTION).map(|_| weights)?);
                };
                (&nodes.of_triangles, with_those_below(nodes, named_nodes(model, name, OPTION)?))
            }
        };
        for (own, &key) in weights.iter_mut().zip(keys) {
            if is_named.get(key as usize).is_some_and(|&named| named) {
                *own = *weight;
            }
        }
    }
    if let Some(attribute) = attribute {
        if model.painted.len() != weights.len() {
            let (model, attribute) = (model.name.clone(), attribute.into());
            return Err(ImportanceError::NotPainted { model, attribute });
        }
        for (weight, &painted) in weights.iter_mut().zip(&model.painted) {
            let times = PAINTED.powf(2.0 * painted - 1.0);
            *weight = (*weight * times).clamp(Importance::LEAST, Importance::MOST);
        }
    }
    Ok(weights)
}

/// The option, for errors.
const OPTION: &str = "importance";

fn named_materials(model: &Model, name: &str) -> Result<Vec<bool>, ImportanceError> {
    let pattern = WildMatch::new(name);
    let is_named: Vec<bool> = model.materials.iter().map(|m| pattern.matches(&m.name)).collect();
    if is_named.contains(&true) {
        return Ok(is_named);
    }
    let names: Vec<String> = model.materials.iter().map(|m| format!("{:?}", m.name)).collect();
    let range =
        format!("one of {}'s materials: {}; for a node write node:{name}", model.name, names.join(", "));
    Err(ImportanceError::NoMaterial { name: name.into(), range })
}

/// These nodes and all below them.
fn with_those_below(hierarchy: &Hierarchy, mut is_named: Vec<bool>) -> Vec<bool> {
    for (index, node) in hierarchy.nodes.iter().enumerate() {
        if node.parent.is_some_and(|parent| is_named[parent]) {
            is_named[index] = true;
        }
    }
    is_named
}

/// Places on a triangle at which the high-poly is asked: points within it, as barycentrics.
const PLACES: [[f32; 3]; 4] =
    [[1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0], [0.6, 0.2, 0.2], [0.2, 0.6, 0.2], [0.2, 0.2, 0.6]];

/// The weight of each of a low-poly's triangles, which lie in the high-poly's own space; empty where all count alike.
pub fn importances_of(low: &Mesh, high: &HighPoly) -> Vec<f32> {
    if high.importances.is_empty() {
        return Vec::new();
    }
    let mut mesh = low.clone();
    high.frame.apply(&mut mesh);
    let at = |triangle: usize, place: [f32; 3]| {
        let point = interpolate(mesh.corners(triangle), place);
        let hit =
            high.surface.closest_on_side(point, mesh.area_normal(triangle), high.conventions.max_distance);
        hit.map_or(1.0, |hit| high.importances[hit.triangle as usize])
    };
    let mean = |triangle| PLACES.iter().map(|&place| at(triangle, place)).sum::<f32>() / PLACES.len() as f32;
    (0..mesh.triangles.len()).into_par_iter().map(mean).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::{Material, Node, NodeTransform};

    fn parsed(text: &str) -> Result<Importance, String> {
        text.parse()
    }

    /// Protects what may be typed and what options files hold.
    #[test]
    fn names_and_weights_are_read() {
        let of = |of, name: &str, weight| Importance { of, name: name.into(), weight };
        for (text, wanted) in [
            ("a=b*=0.25", of(Named::Material, "a=b*", 0.25)),
            ("node:Wheel*=3", of(Named::Node, "Wheel*", 3.0)),
            ("material:node:x=2", of(Named::Material, "node:x", 2.0)),
        ] {
            assert_eq!(parsed(text), Ok(wanted.clone()));
            assert_eq!(wanted.to_string(), text);
        }
        assert_eq!(parsed("material:x=2"), parsed("x=2"));
        for wrong in ["cloth", "=2", "cloth=0", "cloth=101", "cloth=NaN", "cloth=", "node:=2"] {
            assert!(parsed(wrong).is_err(), "{wrong}");
        }
    }

    /// Three triangles of as many materials; the last two hang on nodes, one below the other.
    fn car() -> Model {
        let named = |name: &str| Material { name: name.into(), ..Material::default() };
        let mesh = Mesh {
            positions: vec![Default::default(); 3],
            triangles: vec![[0, 1, 2]; 3],
            triangle_materials: vec![2, 0, 1],
            ..Mesh::default()
        };
        let node = |name: &str, parent| Node { name: name.into(), parent, rest: NodeTransform::IDENTITY };
        let nodes = vec![node("seat", None), node("cover", Some(0))];
        Model {
            name: "car".into(),
            mesh,
            materials: vec![named("Glass"), named("Cloth red"), named("Cloth blue")],
            nodes: Some(Hierarchy { nodes, of_triangles: vec![Hierarchy::NONE, 0, 1] }),
            ..Model::default()
        }
    }

    fn weights(model: &Model, texts: &[&str], attribute: Option<&str>) -> Result<Vec<f32>, String> {
        let options: Vec<Importance> =
            texts.iter().map(|text| text.parse().expect("as in the help")).collect();
        importances(model, &options, attribute).map_err(|error| error.to_string())
    }

    /// Protects which triangles a name weighs, the last of several, and that a name in vain is told.
    #[test]
    fn weights_go_to_the_triangles_of_the_names() {
        let model = car();
        assert_eq!(weights(&model, &["Cloth*=0.5", "*blue=3"], None), Ok(vec![3.0, 1.0, 0.5]));
        assert_eq!(weights(&model, &["node:seat=2", "*red=5"], None), Ok(vec![1.0, 2.0, 5.0]));
        assert_eq!(weights(&model, &["*red=5", "node:seat=2"], None), Ok(vec![1.0, 2.0, 2.0]));
        assert_eq!(weights(&model, &["node:cover=2"], None), Ok(vec![1.0, 1.0, 2.0]));
        assert_eq!(weights(&model, &[], None), Ok(vec![]));
        let message = weights(&model, &["cloth=2"], None).unwrap_err();
        assert!(
            message.contains("--importance cannot be cloth") && message.contains("\"Cloth blue\""),
            "{message}"
        );
        let message = weights(&model, &["node:cower=2"], None).unwrap_err();
        assert!(message.contains("\"cower\"") && message.contains("it has \"cover\""), "{message}");
        assert!(weights(&Model { nodes: None, ..model }, &["node:cover=2"], None).is_err());
    }

    /// Protects the formula of what is painted: half is neutral, a quarter more is four times as much.
    #[test]
    fn paint_multiplies_weights() {
        let model = Model { painted: vec![0.5, 0.75, 1.0], ..car() };
        assert_eq!(weights(&model, &[], Some("COLOR_1")), Ok(vec![1.0, 4.0, 16.0]));
        assert_eq!(weights(&model, &["*blue=0.5", "*red=50"], Some("COLOR_1")), Ok(vec![0.5, 4.0, 100.0]));
        let message = weights(&car(), &[], Some("COLOR_1")).unwrap_err();
        assert!(message.contains("COLOR_1"), "{message}");
    }
}
