//! The tables of the page: figures, texels, and what each stage took.

use super::settings::flags;
use crate::page::text::{NOTHING, change, count, decimal, duration, escape, share, verdict};
use parbake::{BakeReport, Comparison, Written};
use parbake::{EvaluateOptions, ViewFigures};
use std::fmt::Write;

/// A figure: its name, decimals, whether more is better, and where it stands.
type Metric = (&'static str, usize, bool, fn(&ViewFigures) -> Option<f64>);

const METRICS: [Metric; 3] = [
    ("PSNR\u{a0}↑", 2, true, |f| Some(f.psnr)),
    ("MS-SSIM\u{a0}↑", 4, true, |f| f.ms_ssim),
    ("FLIP\u{a0}↓", 4, false, |f| f.flip),
];

/// Mean figures before and after, on each background.
pub fn figures(compared: &Comparison) -> String {
    let mut out = String::from(concat!(
        r#"<table class="figures"><thead><tr><th scope="col">on</th><th scope="col">figure</th>"#,
        r#"<th scope="col">ray-cast</th><th scope="col">baked</th><th scope="col">change</th></tr></thead>"#
    ));
    for on in &compared.backgrounds {
        let background = &on.background;
        out += "<tbody>";
        for (i, (name, decimals, more_is_better, of)) in METRICS.iter().enumerate() {
            let (before, after) = (of(&on.mean.ray_cast), of(&on.mean.baked));
            let text = |x: Option<f64>| x.map_or(NOTHING.into(), |x| decimal(x, *decimals));
            let gain = before.zip(after).map(|(before, after)| after - before);
            let verdict = gain.map_or("", |gain| verdict(gain, *decimals, *more_is_better));
            let head = match i {
                0 => {
                    format!(
                        r#"<th scope="rowgroup" rowspan="{}"><i class="{background}"></i>{background}</th>"#,
                        METRICS.len()
                    )
                }
                _ => String::new(),
            };
            let _ = write!(
                out,
                r#"<tr>{head}<th scope="row">{name}</th><td>{}</td><td>{}</td><td class="{verdict}">{}</td></tr>"#,
                text(before),
                text(after),
                gain.map_or(NOTHING.into(), |gain| change(gain, *decimals))
            );
        }
        out += "</tbody>";
    }
    let _ = write!(
        out,
        concat!(
            r#"</table><p class="note">Means over {} views around the model, {} pixels wide; PSNR in decibels; ↑ more is better, ↓ less. "#,
            "The same figures by <code>parbake eval HIGH BAKED{}</code>, and with <code>--background grey</code> or ",
            "<code>white</code>.</p>"
        ),
        compared.options.views,
        compared.options.resolution,
        flags(&compared.options, &EvaluateOptions::default())
    );
    out
}

/// Texel counts, with what they mean.
pub fn texels(report: &BakeReport) -> String {
    let all = report.options.texture_size.saturating_mul(report.options.texture_size);
    let covered = report.covered_texels;
    let rows = [
        ("covered", covered, all, "lie on the surface; the share is that of the texture"),
        (
            "unseen",
            report.unseen_texels,
            covered,
            "of those no training view saw, filled from their neighbours",
        ),
        (
            "missed",
            report.missed_texels,
            covered,
            "of those projection found no high-poly for within --max-distance",
        ),
        (
            "overlapping",
            report.overlapping_texels,
            covered,
            "are shared by several triangles and show a compromise",
        ),
    ];
    let mut out = String::from(r#"<table class="texels"><tbody>"#);
    for (name, number, whole, meaning) in rows {
        let _ = write!(
            out,
            r#"<tr><th scope="row">{name}</th><td>{}</td><td>{}</td><td class="meaning">{meaning}</td></tr>"#,
            count(number),
            share(number, whole)
        );
    }
    out + "</tbody></table>"
}

/// What the written file holds, and what its formats lost.
pub fn written(written: &Written) -> String {
    let mut out = String::from(concat!(
        r#"<table class="figures written"><thead><tr><th scope="col">part</th><th scope="col">format</th>"#,
        r#"<th scope="col">bytes</th><th scope="col">loss</th></tr></thead><tbody>"#
    ));
    let mut row = |name: &str, format: &str, size: u64, loss: &str| {
        let _ = write!(
            out,
            r#"<tr><th scope="row">{}</th><td class="words">{}</td><td>{}</td><td>{loss}</td></tr>"#,
            escape(name),
            escape(format),
            count(usize::try_from(size).unwrap_or(usize::MAX))
        );
    };
    for texture in &written.textures {
        let reason = texture.reason.as_ref().map_or(String::new(), |reason| format!(": {reason}"));
        let loss = texture.psnr.map_or("none".into(), |psnr| format!("PSNR {} dB", decimal(psnr, 1)));
        row(&texture.name, &format!("{}{reason}", texture.format.label()), texture.bytes, &loss);
    }
    let mesh = &written.mesh;
    let loss = match mesh.position_error {
        0.0 => "none".into(),
        error => format!("positions within {error:.2e} units"),
    };
    row("mesh", mesh.compression.label(), mesh.bytes, &loss);
    row("whole file", "GLB", written.bytes, "");
    out + "</tbody></table>"
}

/// Seconds of all stages together.
pub fn total_seconds(report: &BakeReport) -> f64 {
    report.stages.iter().map(|s| s.seconds).sum()
}

/// What each stage took, with bars.
pub fn stages(report: &BakeReport) -> String {
    let total = total_seconds(report);
    let mut out = String::from(r#"<table class="stages"><tbody>"#);
    for stage in &report.stages {
        let percent = (100.0 * stage.seconds / total).clamp(0.0, 100.0);
        let _ = write!(
            out,
            r#"<tr><th scope="row">{}</th><td>{}</td><td class="bar"><i style="width:{:.1}%"></i></td></tr>"#,
            stage.stage.label(),
            duration(stage.seconds),
            if percent.is_finite() { percent } else { 0.0 }
        );
    }
    let _ = write!(
        out,
        concat!(
            r#"<tr class="total"><th scope="row">together</th><td>{}</td><td></td></tr></tbody></table>"#,
            r#"<p class="note">Without writing this report.</p>"#
        ),
        duration(total)
    );
    out
}
