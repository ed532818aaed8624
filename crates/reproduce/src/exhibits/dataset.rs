//! Table 5 and Figures 4 and 5: what the models are like, and how far the levels are from the high-polys. These
//! measure the data and need no bake.

use super::drawn::Drawn;
use crate::catalogue::{Level, ModelFolder};
use crate::paper;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use parbake::{Limits, Model, StatsOptions, model_distance, read_model};
use parbake_mesh::topology::{Topology, topology};
use parbake_report::page::charts::{Violin, ViolinChart, ViolinGroup};
use std::path::Path;

/// How to read Table 5.
pub const LEAD_EACH: &str = "Vertices and components are counted as the paper counts them: vertices are split at seams \
of the texture, and components are what shares them. Models are those of the data folder; where a figure differs from \
the paper's, so do the files.";

/// How to read Figure 4.
pub const LEAD_DISTANCES: &str = "Chamfer distance of each low-poly from its high-poly: the mean of both ways' mean \
distance, from 200,000 samples on each surface, in the high-poly's frame with a longest side of 1. A dot is a model. The \
paper draws the same figure for 26 models without numbers, and does not say whether its distances are squared.";

/// How to read Figure 5.
pub const LEAD_ALL: &str = "Least, median and greatest of all models, the paper's 26 below ours. Components and vertices as in \
Table 5; manifold, genus and holes are of the surface welded by position, genus and holes summed over its components. The \
paper does not say what it welds; its high-polys have no handles and are mostly not manifold.";

/// One model of a data set; none where its file cannot be read, which a bake of it reports.
fn read(path: &Path) -> Option<Model> {
    Some(read_model(path, &Limits::default()).ok()?.model)
}

/// What a set of meshes is called, the paper's number for it (0 for high-polys), and its files.
type Set<'a> = (&'static str, u8, Vec<(&'a ModelFolder, &'a Path)>);

/// The high-polys, then each level.
fn sets(scope: &Scope) -> Vec<Set<'_>> {
    let models = &scope.catalogue.models;
    let level = |level: Level| models.iter().filter_map(|m| Some((m, m.low(level)?))).collect();
    vec![
        ("High-poly", 0, models.iter().map(|m| (m, m.high.as_path())).collect()),
        (Level::One.name(), 1, level(Level::One)),
        (Level::Two.name(), 2, level(Level::Two)),
        (Level::Three.name(), 3, level(Level::Three)),
    ]
}

/// Table 5.
pub fn draw_each(scope: &Scope) -> Drawn {
    let columns = ["model", "components", "paper's", "vertices", "paper's", "triangles", "paper's"];
    let tables = sets(scope).into_iter().map(|(name, level, files)| {
        let mut table = Table::new(name, &columns);
        for (model, path) in files {
            let Some(found) = read(path).map(|model| topology(&model.mesh)) else { continue };
            let papers = paper::counts(&model.name, level);
            let theirs = |of: fn(&paper::PaperCounts) -> usize| {
                Cell::or_missing(papers.as_ref().map(|papers| Cell::PaperNumber(of(papers) as f64, 0)))
            };
            let ours = |number: usize| Cell::Number(number as f64, 0);
            let row = vec![
                ours(found.split_components),
                theirs(|papers| papers.components),
                ours(found.split_vertices),
                theirs(|papers| papers.vertices),
                ours(found.triangles),
                theirs(|papers| papers.faces),
            ];
            table.push(&model.name, row);
        }
        table
    });
    Drawn { tables: tables.collect(), ..Drawn::default() }
}

/// Figure 5.
pub fn draw_all(scope: &Scope) -> Drawn {
    let columns = ["models", "components", "vertices", "triangles", "manifold", "genus", "holes"];
    let mut table = Table::new("Least / median / greatest", &columns);
    for ((name, _, files), papers) in sets(scope).into_iter().zip(paper::DATASET) {
        let all: Vec<Topology> =
            files.into_iter().filter_map(|(_, path)| Some(topology(&read(path)?.mesh))).collect();
        if all.is_empty() {
            continue;
        }
        let spread = |of: fn(&Topology) -> usize| {
            let mut values: Vec<usize> = all.iter().map(of).collect();
            values.sort_unstable();
            Cell::Text(format!("{} / {} / {}", values[0], middle(&values), values[values.len() - 1]))
        };
        let manifold = all.iter().filter(|found| found.manifold).count();
        let row = vec![
            spread(|found| found.split_components),
            spread(|found| found.split_vertices),
            spread(|found| found.triangles),
            Cell::Text(format!("{manifold} of {}", all.len())),
            spread(|found| found.genus.unwrap_or(0) as usize),
            spread(|found| found.boundary_loops),
        ];
        table.push(name, row);
        let theirs = papers[1..].iter().map(|text| Cell::Text((*text).into())).collect();
        table.push(&format!("{}, the paper's", papers[0]), theirs);
    }
    Drawn { tables: vec![table], ..Drawn::default() }
}

/// The median of sorted values, the lower of two in the middle.
fn middle(sorted: &[usize]) -> usize {
    sorted[(sorted.len() - 1) / 2]
}

/// Figure 4.
pub fn draw_distances(scope: &Scope) -> Drawn {
    let columns = ["model", "Chamfer", "root mean square", "Hausdorff", "Chamfer, of the diagonal"];
    let mut table = Table::new("Distances from the high-poly, whose longest side is 1", &columns);
    let mut groups = Vec::new();
    for level in Level::ALL {
        let mut values = Vec::new();
        for model in &scope.catalogue.models {
            let pair = model.low(level).and_then(|low| Some((read(&model.high)?, read(low)?)));
            let found = pair.and_then(|(high, low)| {
                let longest = parbake_model::Bounds::of(&high.mesh)?.size().max_element();
                let distance = model_distance(&high, &low, &StatsOptions::default())?;
                Some((distance, f64::from(longest)))
            });
            let Some((distance, longest)) = found else { continue };
            let of = |length: f64| Cell::Number(length / longest, 5);
            let share = Cell::Text(format!("{:.3} %", 100.0 * distance.chamfer_share));
            let row = vec![of(distance.chamfer), of(distance.rms), of(distance.hausdorff), share];
            table.push(&format!("{} {}", model.name, level.name()), row);
            values.push(distance.chamfer / longest);
        }
        let violins = vec![Violin { name: "Chamfer distance".into(), values }];
        groups.push(ViolinGroup { name: level.name().into(), violins });
    }
    let (title, y_title) = ("Chamfer distance by level".into(), "longest sides".into());
    let html = ViolinChart { title, y_title, groups, baseline: None }.html();
    Drawn { tables: vec![table], html, ..Drawn::default() }
}
