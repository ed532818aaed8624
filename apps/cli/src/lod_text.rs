//! What `lod` tells of a level: a line, and of a search for a PSNR a short table.

use parbake::{LevelReport, TargetReport, Trial, TrialMap, Verdict, Way};

/// What people want to know of a level.
pub fn line(report: &LevelReport, bytes: u64) -> String {
    let switch = match (report.switch_pixels, report.switch_coverage) {
        (Some(pixels), Some(coverage)) => {
            format!("takes over below {pixels:.0} pixels ({:.1} % of the screen)", 100.0 * coverage)
        }
        _ => "can be told from the one before at every size".into(),
    };
    let texels = match report.texture_size {
        0 => "no textures".into(),
        // Maps of a model's own textures need not be square.
        size if report.way == Way::Scaled => format!("textures of up to {size}² texels"),
        size => format!("{size}² texels"),
    };
    let own = match report.way {
        Way::New => "",
        Way::Delivered => " in the model's own layout",
        Way::Scaled => " of the model's own maps",
    };
    format!(
        "level {}: {} triangles, {texels}{own}, {:.1} kB; {:.1} dB at {:.0} pixels; {switch}",
        report.level,
        report.triangles,
        bytes as f64 / 1e3,
        report.at_screen_size.psnr,
        report.screen_size,
    )
}

/// How the search for a PSNR went: how it ended, then the best file of each bake; nothing where there was none.
pub fn target_lines(report: &LevelReport) -> Vec<String> {
    let Some(target) = &report.target else { return Vec::new() };
    let mut lines = vec![format!("  {}", ended(target, report.level))];
    lines.push("     bake  triangles        kB     dB  maps".into());
    for bake in 0..target.bakes {
        let own = || target.trials.iter().filter(|trial| trial.bake == bake);
        let best = own().filter(|trial| trial.reached).min_by_key(|trial| trial.bytes);
        if let Some(trial) = best.or_else(|| own().max_by(|a, b| a.psnr.total_cmp(&b.psnr))) {
            lines.push(row(trial));
        }
    }
    lines
}

/// The sentence about the end of a search.
fn ended(target: &TargetReport, level: usize) -> String {
    let TargetReport { psnr, verdict, bakes, most_triangles, trials } = target;
    let best = trials.iter().find(|trial| trial.chosen).map_or(0.0, |trial| trial.psnr);
    let texels = trials.iter().flat_map(|trial| &trial.maps).map(|map| map.size).max().unwrap_or(0);
    match verdict {
        Verdict::Reached => {
            format!("level {level}: the smallest file of {psnr} dB that {bakes} bakes found has {best:.2} dB")
        }
        Verdict::Above => format!(
            "level {level}: no smaller file than one of {best:.2} dB was found, which is more than {psnr} dB"
        ),
        Verdict::Missed => format!(
            "level {level}: {psnr} dB cannot be reached; the best of {bakes} bakes has {best:.2} dB, with up to \
             {most_triangles} triangles and {texels}² texels"
        ),
        Verdict::Stopped => {
            format!(
                "level {level}: time ended at {best:.2} dB, after {bakes} bakes, before {psnr} dB were reached"
            )
        }
    }
}

fn row(trial: &Trial) -> String {
    let map = |map: &TrialMap| match map.size {
        0 => format!("{}: none", map.name),
        size => format!("{} {size}²", map.name),
    };
    let quality = trial.texture_quality.map_or(String::new(), |quality| format!(", quality {quality}"));
    format!(
        "  {}  {:>4}  {:>9}  {:>8.1}  {:>5.2}  {}{quality}",
        if trial.chosen { "→" } else { " " },
        trial.bake + 1,
        trial.triangles,
        trial.bytes as f64 / 1e3,
        trial.psnr,
        trial.maps.iter().map(map).collect::<Vec<_>>().join(", "),
    )
}
