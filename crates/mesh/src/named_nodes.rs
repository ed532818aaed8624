//! Nodes of a model that a user names.
//!
//! Contract: `named_nodes` looks only among nodes on which triangles hang, by themselves or below. A name in vain is told
//! with the names that there are, the most similar ones first.

use parbake_model::{Hierarchy, Model};
use std::cmp::Reverse;
use wildmatch::WildMatch;

/// A pattern that fits no node.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("--{option} {pattern:?}: {model} has no node of that name with triangles; {has}")]
pub struct NodeError {
    /// The option that names it.
    pub option: &'static str,
    /// What was asked for.
    pub pattern: String,
    /// The model.
    pub model: String,
    /// What there is.
    pub has: String,
}

/// Names that an error shows.
const SHOWN: usize = 8;

/// Which nodes with triangles a pattern names; in it `*` stands for any letters and `?` for one. `option` is what asks,
/// as typed.
///
/// # Errors
/// A pattern that names none.
pub fn named_nodes(model: &Model, pattern: &str, option: &'static str) -> Result<Vec<bool>, NodeError> {
    named_among(model, pattern, option, with_triangles)
}

/// The same among all nodes, also those without triangles: sockets and markers.
///
/// # Errors
/// A pattern that names none.
pub(crate) fn all_named_nodes(
    model: &Model,
    pattern: &str,
    option: &'static str,
) -> Result<Vec<bool>, NodeError> {
    named_among(model, pattern, option, |hierarchy| vec![true; hierarchy.nodes.len()])
}

fn named_among(
    model: &Model,
    pattern: &str,
    option: &'static str,
    among: impl Fn(&Hierarchy) -> Vec<bool>,
) -> Result<Vec<bool>, NodeError> {
    let none = Hierarchy::default();
    let hierarchy = model.nodes.as_ref().unwrap_or(&none);
    let is_used = among(hierarchy);
    let wild = WildMatch::new(pattern);
    let named: Vec<bool> =
        hierarchy.nodes.iter().zip(&is_used).map(|(node, &used)| used && wild.matches(&node.name)).collect();
    if named.contains(&true) {
        return Ok(named);
    }
    let names = hierarchy.nodes.iter().zip(&is_used).filter(|(_, used)| **used).map(|(n, _)| n.name.as_str());
    Err(NodeError {
        option,
        pattern: pattern.into(),
        model: model.name.clone(),
        has: similar(names.collect(), &pattern_letters(pattern)),
    })
}

/// Whether triangles hang on a node or on one below it.
fn with_triangles(hierarchy: &Hierarchy) -> Vec<bool> {
    let mut is_used: Vec<bool> = hierarchy.counts().iter().map(|&count| count > 0).collect();
    for (index, node) in hierarchy.nodes.iter().enumerate().rev() {
        if let Some(parent) = node.parent.filter(|_| is_used[index]) {
            is_used[parent] = true;
        }
    }
    is_used
}

/// What of a pattern can be like a name.
fn pattern_letters(pattern: &str) -> String {
    pattern.chars().filter(|c| !matches!(c, '*' | '?')).collect::<String>().to_lowercase()
}

/// Some of these names in words, the most similar ones first.
fn similar(mut names: Vec<&str>, wanted: &str) -> String {
    names.retain(|name| !name.is_empty());
    names.sort_unstable();
    names.dedup();
    if names.is_empty() {
        return "its nodes have no names; only glTF files name them".into();
    }
    let likeness = |name: &&str| (1e6 * strsim::jaro_winkler(&name.to_lowercase(), wanted)) as u32;
    names.sort_by_key(|name| Reverse(likeness(name)));
    let more = names.len().saturating_sub(SHOWN);
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("{name:?}")).collect();
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("it has {}{rest}", shown.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::{Node, NodeTransform};

    fn model() -> Model {
        let node = |name: &str, parent| Node { name: name.into(), parent, rest: NodeTransform::IDENTITY };
        let nodes = vec![
            node("car", None),
            node("Wheel L", Some(0)),
            node("tyre", Some(1)),
            node("Wheel R", Some(0)),
            node("lamp", None),
        ];
        let nodes = Some(Hierarchy { nodes, of_triangles: vec![2, 3] });
        Model { name: "car.glb".into(), nodes, ..Model::default() }
    }

    /// Protects patterns: groups count by what hangs below, what has no triangles cannot be named, and the names that
    /// there are are told, the closest first.
    #[test]
    fn nodes_are_named_by_patterns() {
        let model = model();
        let named = |pattern: &str| named_nodes(&model, pattern, "keep-parts");
        assert_eq!(named("Wheel*").unwrap_or_default(), [false, true, false, true, false]);
        assert_eq!(named("c?r").unwrap_or_default(), [true, false, false, false, false]);
        let message = named("wheels").expect_err("no such node").to_string();
        assert!(
            message.starts_with("--keep-parts \"wheels\": car.glb has no node of that name"),
            "{message}"
        );
        assert!(
            message.contains("it has \"Wheel L\", \"Wheel R\", ") && !message.contains("lamp"),
            "{message}"
        );
        assert!(named("lamp").is_err());
        let all = all_named_nodes(&model, "l*", "keep-parts").unwrap_or_default();
        assert_eq!(all, [false, false, false, false, true]);
        let message = named_nodes(&Model::default(), "a", "keep-parts").expect_err("no nodes").to_string();
        assert!(message.contains("only glTF"), "{message}");
    }
}
