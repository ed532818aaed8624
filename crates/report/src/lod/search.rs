//! How the smallest file of a PSNR was found: a sentence, a plot of bytes against decibels, and all trials.

use super::overview::kilobytes;
use crate::page::charts::{ScatterChart, ScatterPoint};
use crate::page::text::{count, decimal, escape};
use parbake::lod::search::WINDOW;
use parbake::{TargetReport, Trial, TrialMap, Verdict};
use std::fmt::Write;

/// The part of a level's section.
pub fn search(target: &TargetReport) -> String {
    let wanted = decimal(target.psnr, 1);
    let best = target.trials.iter().find(|trial| trial.chosen).map_or(f64::NAN, |trial| trial.psnr);
    let best = decimal(best, 2);
    let verdict = match target.verdict {
        Verdict::Reached => format!("The smallest file that reaches {wanted} dB has {best} dB."),
        Verdict::Above => {
            format!(
                "No smaller file was found than one of {best} dB, which is more than the target of {wanted} dB."
            )
        }
        Verdict::Missed => format!(
            "{wanted} dB cannot be reached: the best file has {best} dB, with up to {} triangles.",
            count(target.most_triangles)
        ),
        Verdict::Stopped => format!("The search ended early at {best} dB, before {wanted} dB were reached."),
    };
    let bakes = if target.bakes == 1 { "one bake".into() } else { format!("{} bakes", target.bakes) };
    let point = |trial: &Trial| ScatterPoint {
        group: trial.bake,
        at: (trial.bytes as f64 / 1e3, trial.psnr),
        name: format!("{} triangles, {}, {}", count(trial.triangles), maps(trial), kilobytes(trial.bytes)),
        chosen: trial.chosen,
    };
    let group = |bake: usize| {
        let own = target.trials.iter().find(|trial| trial.bake == bake);
        format!("bake {}: {} triangles", bake + 1, own.map_or("no".into(), |trial| count(trial.triangles)))
    };
    let chart = ScatterChart {
        title: "Bytes and PSNR of all files that were measured".into(),
        x_title: "kB".into(),
        y_title: "dB at its size".into(),
        groups: (0..target.bakes).map(group).collect(),
        points: target.trials.iter().map(point).collect(),
        target: Some((target.psnr, WINDOW, format!("target, {wanted} dB"))),
    };
    format!(
        concat!(
            r#"<h3>The smallest file of {wanted} dB</h3><p class="lead">{verdict} {bakes} and {trials} files were measured.</p>"#,
            r#"<div class="pair"><div>{chart}</div><div class="wide">{table}</div></div>"#
        ),
        wanted = wanted,
        verdict = verdict,
        bakes = capitalised(&bakes),
        trials = target.trials.len(),
        chart = chart.html(),
        table = table(&target.trials)
    )
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// The maps of a trial in words.
fn maps(trial: &Trial) -> String {
    let one = |map: &TrialMap| match map.size {
        0 => format!("no {}", map.name),
        size => format!("{} {size}²", map.name),
    };
    let quality = trial.texture_quality.map(|quality| format!("quality {quality}"));
    let all: Vec<String> = trial.maps.iter().map(one).chain(quality).collect();
    if all.is_empty() { "no maps".into() } else { all.join(", ") }
}

fn table(trials: &[Trial]) -> String {
    let mut out = String::from(concat!(
        r#"<table class="numbers-table"><caption>Files that were measured</caption><thead><tr><th scope="col">bake</th>"#,
        r#"<th scope="col">triangles</th><th scope="col">file</th><th scope="col">PSNR</th><th scope="col" class="words">maps</th></tr></thead><tbody>"#
    ));
    for trial in trials {
        let class = match (trial.chosen, trial.reached) {
            (true, _) => r#" class="chosen""#,
            (false, false) => r#" class="missed""#,
            _ => "",
        };
        let _ = write!(
            out,
            r#"<tr{class}><th scope="row">{}{}</th><td>{}</td><td>{}</td><td>{}{}dB</td><td class="words">{}</td></tr>"#,
            trial.bake + 1,
            if trial.chosen { " (the level)" } else { "" },
            count(trial.triangles),
            kilobytes(trial.bytes),
            decimal(trial.psnr, 2),
            '\u{202f}',
            escape(&maps(trial))
        );
    }
    out + "</tbody></table>"
}
