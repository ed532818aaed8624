//! Everything on one page, as Markdown, and for a terminal.

use crate::exhibit::Exhibit;
use crate::exhibits::drawn::Drawn;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::Table;
use parbake_report::page::text::{count, duration, escape};
use parbake_report::page::{document, section};
use std::collections::BTreeMap;

/// What is known of a run as a whole.
pub struct Facts<'a> {
    /// Data and options.
    pub scope: &'a Scope,
    /// Experiments that were to be made.
    pub planned: usize,
    /// What came of them.
    pub results: &'a Results,
    /// Those that failed, a sentence each.
    pub failed: &'a [String],
    /// The digest of the program that ran.
    pub build: &'a str,
}

/// Where an exhibit stands: tables first, then figures, each by number.
pub fn order(exhibit: Exhibit) -> (bool, u32) {
    let name = exhibit.name();
    let number = name.rsplit(' ').next().and_then(|n| n.parse().ok()).unwrap_or(0);
    (name.starts_with("Figure"), number)
}

impl Facts<'_> {
    /// What a reader has to know, a sentence each.
    fn sentences(&self) -> Vec<String> {
        let made = self.results.all().count();
        let evaluate = self.scope.options.evaluate();
        let seconds: f64 = self.results.all().map(|o| o.seconds_in_all).sum();
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        if self.planned == 0 {
            let measured = "What was asked for measures the data; no experiment was needed.".to_string();
            return std::iter::once(measured).chain(self.scope.catalogue.left_out.iter().cloned()).collect();
        }
        let mut all = vec![format!(
            "{} of {} experiments in {} on {cores} cores; figures are means of {} views of {}².",
            count(made),
            count(self.planned),
            duration(seconds),
            evaluate.views,
            evaluate.resolution
        )];
        let unsound = self.results.all().filter(|o| o.unsound > 0 && !o.title.contains("fixed")).count();
        let moved = self.results.all().filter(|o| !o.title.contains("fixed")).count();
        all.push(match unsound {
            0 => format!(
                "No triangle flips or overlaps in any of the {} layouts that were not fixed.",
                count(moved)
            ),
            n => format!("{n} layouts that were not fixed have flipped, flat or overlapping triangles."),
        });
        let mut builds: BTreeMap<&str, usize> = BTreeMap::new();
        for outcome in self.results.all() {
            *builds.entry(outcome.build.as_str()).or_default() += 1;
        }
        let others: usize = builds.iter().filter(|(b, _)| **b != self.build).map(|(_, n)| n).sum();
        if others > 0 {
            all.push(format!("{} outcomes are another build's (--any-build).", count(others)));
        }
        if made + self.failed.len() < self.planned {
            all.push("The run was stopped; run the same command again to go on.".into());
        }
        all.extend(self.failed.iter().map(|f| format!("Failed: {f}")));
        all.extend(self.scope.catalogue.left_out.iter().cloned());
        all
    }
}

/// Tables of which anything was made.
fn shown(drawn: &Drawn) -> impl Iterator<Item = &Table> {
    drawn.tables.iter().filter(|table| !table.rows.is_empty())
}

/// The page.
pub fn html(facts: &Facts, drawn: &[(Exhibit, Drawn)]) -> String {
    let mut out = concat!(
        r#"<header><p class="kicker">Joint UV Optimization and Texture Baking, reproduced</p>"#,
        "<h1>The paper's tables and figures</h1></header>"
    )
    .to_string();
    let notes: String = facts.sentences().iter().map(|s| format!("<li>{}</li>", escape(s))).collect();
    out += &format!(r#"<ul class="notes">{notes}</ul>"#);
    for (exhibit, drawn) in drawn.iter().filter(|(_, drawn)| drawn.has_something()) {
        let tables: String = shown(drawn).map(|table| table.html()).collect();
        let id = exhibit.name().to_lowercase().replace(' ', "");
        section(&mut out, &id, exhibit.name(), &escape(exhibit.lead()), &(tables + &drawn.html));
    }
    document("The paper's tables and figures", &out)
}

/// The tables for a document.
pub fn markdown(facts: &Facts, drawn: &[(Exhibit, Drawn)]) -> String {
    let mut out: String = facts.sentences().iter().map(|s| format!("- {s}\n")).collect();
    for (exhibit, drawn) in drawn.iter().filter(|(_, drawn)| shown(drawn).count() > 0) {
        out += &format!("\n## {}\n\n{}\n", exhibit.name(), exhibit.lead());
        for table in shown(drawn) {
            out += &format!("\n{}", table.markdown());
        }
    }
    out
}

/// The tables for a terminal.
pub fn terminal(drawn: &[(Exhibit, Drawn)]) -> String {
    let mut out = String::new();
    for (exhibit, drawn) in drawn {
        for table in shown(drawn) {
            out += &format!("{}: {}\n", exhibit.name(), table.terminal());
        }
    }
    out
}
