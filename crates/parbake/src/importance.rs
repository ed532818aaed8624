//! How much parts of a model count: materials that deserve more texels and triangles than their surface alone
//! would get, or fewer.
//!
//! A weight of 4 gives a surface about four times as many texels, and lets errors on it count four times where
//! triangles are chosen. Weights are those of the high-poly's triangles; a low-poly's triangle has the mean of what
//! lies nearest to it.
//!
//! Contract: without any all counts alike, and nothing is computed.

use crate::error::BakeError;
use parbake_model::{Mesh, Model};
use parbake_render::interpolate::interpolate;
use parbake_views::high_poly::HighPoly;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use wildmatch::WildMatch;

/// How much the materials of a name count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Importance {
    /// Name of a material of the high-poly; `*` stands for any letters, `?` for one.
    pub material: String,
    /// How much it counts, [`Importance::LEAST`] to [`Importance::MOST`]; materials that are not named have 1.
    pub weight: f32,
}

impl Importance {
    /// The least weight.
    pub const LEAST: f32 = 0.01;
    /// The greatest weight.
    pub const MOST: f32 = 100.0;
}

impl FromStr for Importance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            let (least, most) = (Self::LEAST, Self::MOST);
            format!("{text:?} should be a material and its weight, {least} to {most}, as in \"Cloth*=0.25\"")
        };
        // Names may hold the sign, weights do not.
        let (material, weight) = text.rsplit_once('=').ok_or_else(wrong)?;
        let weight: f32 = weight.trim().parse().map_err(|_| wrong())?;
        if material.is_empty() || !(Self::LEAST..=Self::MOST).contains(&weight) {
            return Err(wrong());
        }
        Ok(Self { material: material.into(), weight })
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
        write!(f, "{}={}", self.material, self.weight)
    }
}

impl From<Importance> for String {
    fn from(importance: Importance) -> Self {
        importance.to_string()
    }
}

/// The weight of each of a model's triangles; empty where all count alike. Where several names fit, the last counts.
///
/// # Errors
/// A name that fits no material.
pub fn importances(model: &Model, options: &[Importance]) -> Result<Vec<f32>, BakeError> {
    if options.is_empty() {
        return Ok(Vec::new());
    }
    let mut of_material = vec![1.0; model.materials.len()];
    for Importance { material, weight } in options {
        let pattern = WildMatch::new(material);
        let mut is_found = false;
        for (own, _) in of_material.iter_mut().zip(&model.materials).filter(|(_, m)| pattern.matches(&m.name))
        {
            (*own, is_found) = (*weight, true);
        }
        if !is_found {
            let names: Vec<String> = model.materials.iter().map(|m| format!("{:?}", m.name)).collect();
            let range = format!("one of {}'s materials: {}", model.name, names.join(", "));
            return Err(BakeError::Option { option: "importance", value: material.clone(), range });
        }
    }
    let weight = |&material: &u32| of_material.get(material as usize).copied().unwrap_or(1.0);
    Ok(model.mesh.triangle_materials.iter().map(weight).collect())
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
mod tests {
    use super::*;
    use parbake_model::Material;

    fn parsed(text: &str) -> Result<Importance, String> {
        text.parse()
    }

    /// Protects what may be typed and what options files hold.
    #[test]
    fn names_and_weights_are_read() {
        let cloth = Importance { material: "a=b*".into(), weight: 0.25 };
        assert_eq!(parsed("a=b*=0.25"), Ok(cloth.clone()));
        assert_eq!(cloth.to_string().parse(), Ok(cloth));
        for wrong in ["cloth", "=2", "cloth=0", "cloth=101", "cloth=NaN", "cloth="] {
            assert!(parsed(wrong).is_err(), "{wrong}");
        }
    }

    /// Protects which triangles a name weighs, the last of several, and that a name in vain is told.
    #[test]
    fn weights_go_to_the_triangles_of_the_names() {
        let named = |name: &str| Material { name: name.into(), ..Material::default() };
        let mesh = Mesh {
            positions: vec![Default::default(); 3],
            triangles: vec![[0, 1, 2]; 3],
            triangle_materials: vec![2, 0, 1],
            ..Mesh::default()
        };
        let materials = vec![named("Glass"), named("Cloth red"), named("Cloth blue")];
        let model = Model { name: "car".into(), mesh, materials, ..Model::default() };
        let weights = |texts: &[&str]| {
            let options: Vec<Importance> =
                texts.iter().map(|text| text.parse().expect("as in the help")).collect();
            importances(&model, &options)
        };
        assert_eq!(weights(&["Cloth*=0.5", "*blue=3"]).expect("all are there"), [3.0, 1.0, 0.5]);
        assert!(weights(&[]).expect("nothing to find").is_empty());
        let message = weights(&["cloth=2"]).expect_err("no such name").to_string();
        assert!(message.contains("--importance cloth") && message.contains("\"Cloth blue\""), "{message}");
    }
}
