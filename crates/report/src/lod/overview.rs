//! The top of the page: the original and all levels side by side, their figures, and where each is shown.

use crate::page::section;
use crate::page::text::{NOTHING, count, decimal, duration, escape, share};
use parbake::LodOptions;
use parbake::lod::document::LodDocument;
use std::fmt::Write;

/// Name, all levels, facts, and the table of figures.
pub fn overview(
    name: &str,
    chain: &LodDocument,
    options: &LodOptions,
    original: &str,
    thumbnails: &[String],
) -> String {
    let mut out = format!(
        r#"<header><p class="kicker">Parbake levels of detail</p><h1>{name}</h1><div class="lineup">"#
    );
    let triangles = |number: usize| format!("{} triangles", count(number));
    let _ = write!(
        out,
        r#"<div><div class="frame">{original}</div><p>Original</p><p class="where">{}</p></div>"#,
        triangles(chain.source_triangles)
    );
    for (entry, thumbnail) in chain.levels.iter().zip(thumbnails) {
        let report = &entry.report;
        let _ = write!(
            out,
            concat!(
                r##"<a href="#section{level}"><div class="frame">{thumbnail}</div><p>Level {level}</p>"##,
                r#"<p class="where">{triangles}, {size}</p><p class="where">{psnr} dB at {pixels} pixels</p></a>"#
            ),
            level = report.level,
            thumbnail = thumbnail,
            triangles = triangles(report.triangles),
            size = kilobytes(entry.bytes),
            psnr = decimal(report.at_screen_size.psnr, 1),
            pixels = decimal(report.screen_size, 0)
        );
    }
    out += r#"</div><dl class="facts">"#;
    let sizes: Vec<String> = options.screen_size.iter().map(f64::to_string).collect();
    let mut facts = vec![
        ("levels", chain.levels.len().to_string()),
        ("made for", format!("{} pixels", sizes.join(", "))),
        ("all in one file", escape(&chain.all_levels)),
        ("made in", duration(chain.seconds)),
    ];
    if let Some(target) = options.target_psnr {
        facts.insert(2, ("target", format!("{} dB", decimal(target, 1))));
    }
    for (term, fact) in facts {
        let _ = write!(out, "<div><dt>{term}</dt><dd>{fact}</dd></div>");
    }
    out += "</dl></header>";
    out += &notes(chain, options);
    section(
        &mut out,
        "levels",
        "Levels",
        &format!(
            "PSNR, MS-SSIM and FLIP compare a level's file with the original at the size that it was made for, the mean over six \
             directions on grey. A level takes over where it agrees with the one before, and with the original, by {} dB.",
            decimal(chain.switch_psnr, 0)
        ),
        &format!(r#"<div class="wide">{}</div>{}"#, table(chain), ranges(chain)),
    );
    out
}

/// Bytes of a file of any size as people read them.
pub fn kilobytes(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e5 => format!("{}\u{202f}kB", decimal(b / 1e3, 1)),
        b if b < 1e6 => format!("{}\u{202f}kB", decimal(b / 1e3, 0)),
        b => format!("{}\u{202f}MB", decimal(b / 1e6, 2)),
    }
}

fn notes(chain: &LodDocument, options: &LodOptions) -> String {
    let mut notes = Vec::new();
    let missing = options.screen_size.len().saturating_sub(chain.levels.len());
    if missing > 0 {
        notes.push(format!("The chain was stopped: {missing} of its levels are missing."));
    }
    let cut = chain.levels.iter().filter(|entry| entry.report.stopped_early);
    let cut: Vec<String> = cut.map(|entry| entry.report.level.to_string()).collect();
    if !cut.is_empty() {
        notes.push(format!("Time ended before all steps of level {} were done.", cut.join(", ")));
    }
    match notes.is_empty() {
        true => String::new(),
        false => format!(r#"<ul class="notes"><li>{}</li></ul>"#, notes.join("</li><li>")),
    }
}

fn table(chain: &LodDocument) -> String {
    let mut out =
        String::from(r#"<table class="numbers-table"><caption>Figures of all levels</caption><thead><tr>"#);
    for head in [
        "level",
        "made for",
        "triangles",
        "of the original",
        "largest map",
        "texels",
        "draw calls",
        "file",
        "PSNR",
        "MS-SSIM",
        "FLIP",
        "takes over below",
        "shown down to",
    ] {
        let _ = write!(out, r#"<th scope="col">{head}</th>"#);
    }
    out += "</tr></thead><tbody>";
    for entry in &chain.levels {
        let report = &entry.report;
        let optional = |x: Option<f64>| x.map_or(NOTHING.into(), |x| decimal(x, 4));
        let percent = |share: f64| format!("{}\u{202f}%", decimal(100.0 * share, 1));
        let takes_over = match (report.switch_pixels, report.switch_coverage) {
            (Some(pixels), Some(coverage)) => {
                format!("{}\u{202f}px ({})", decimal(pixels, 0), percent(coverage))
            }
            _ => NOTHING.into(),
        };
        let cells = [
            format!("{}\u{202f}px", decimal(report.screen_size, 0)),
            count(report.triangles),
            share(report.triangles, chain.source_triangles),
            if report.texture_size > 0 { format!("{}²", report.texture_size) } else { "none".into() },
            count(report.texels),
            report.draw_calls.to_string(),
            kilobytes(entry.bytes),
            format!("{}\u{202f}dB", decimal(report.at_screen_size.psnr, 2)),
            optional(report.at_screen_size.ms_ssim),
            optional(report.at_screen_size.flip),
            takes_over,
            percent(entry.min_coverage),
        ];
        let _ = write!(out, r#"<tr><th scope="row">{}</th>"#, report.level);
        cells.iter().for_each(|cell| {
            let _ = write!(out, "<td>{cell}</td>");
        });
        out += "</tr>";
    }
    out + "</tbody></table>"
}

/// The drawing's width, and heights of the bar and of all.
const SIZE: [f64; 3] = [1000.0, 34.0, 92.0];
/// The least share of the screen's height that the drawing shows.
const LEAST: f64 = 0.005;

/// Which level is shown at which share of the screen's height, near to the left and far to the right.
fn ranges(chain: &LodDocument) -> String {
    let place = |share: f64| {
        let share = if share.is_finite() { share.clamp(LEAST, 1.0) } else { 1.0 };
        10.0 + (SIZE[0] - 20.0) * share.ln() / LEAST.ln()
    };
    let first = chain.levels.first().and_then(|entry| entry.report.switch_coverage);
    let mut bars = vec![("original".to_string(), 1.0, first.unwrap_or(LEAST))];
    for entry in &chain.levels {
        let begin = bars.last().map_or(1.0, |bar| bar.2);
        bars.push((format!("level {}", entry.report.level), begin, entry.min_coverage.max(LEAST)));
    }
    let mut out = format!(
        concat!(
            r#"<h3>Where each is shown</h3><svg class="ranges" viewBox="0 0 {} {}" role="img" "#,
            r#"aria-label="Which level is shown at which share of the screen's height">"#
        ),
        SIZE[0], SIZE[2]
    );
    let count = bars.len().max(2) as f64;
    for (k, (name, from, to)) in bars.iter().enumerate() {
        let (left, right) = (place(*from), place(*to));
        if right - left < 0.5 {
            continue;
        }
        let opacity = if k == 0 { 0.12 } else { 0.75 - 0.5 * (k as f64 - 1.0) / count };
        let _ = write!(
            out,
            r#"<rect class="range" x="{left:.1}" y="24" width="{:.1}" height="{}" rx="4" fill-opacity="{opacity:.2}"><title>{name}</title></rect>"#,
            (right - left - 2.0).max(0.5),
            SIZE[1]
        );
        if right - left > 62.0 {
            let _ = write!(out, r#"<text class="label" x="{:.1}" y="17">{name}</text>"#, left + 2.0);
        }
    }
    for percent in [100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5] {
        let x = place(percent / 100.0);
        let anchor = if percent > 99.0 {
            "start"
        } else if percent < 0.6 {
            "end"
        } else {
            "middle"
        };
        let _ = write!(
            out,
            r#"<path d="M{x:.1} 58v6"/><text x="{x:.1}" y="80" text-anchor="{anchor}">{percent}{}%</text>"#,
            '\u{202f}'
        );
    }
    out + r#"</svg><p class="note">Share of the screen's height that the model's longest side spans.</p>"#
}
