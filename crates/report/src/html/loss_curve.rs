//! The fit's progress as a chart: decibels on the training views after each step.

use crate::page::Axes;
use crate::page::text::{decimal, duration};
use parbake::LossStep;
use parbake_metric::psnr_from_mse;
use std::fmt::Write;

/// What can move in a step: its name in the report, its name for people.
const MOVES: [(&str, &str); 6] = [
    ("start", "projected onto the moved low-poly"),
    ("color", "colours"),
    ("normal", "normals"),
    ("rounding", "rounding to 8 bits"),
    ("delivered", "coordinates as delivered"),
    ("repaired", "UVs repaired"),
];

/// The chart with its legend, or a sentence when nothing was measured.
pub fn loss_curve(losses: &[LossStep]) -> String {
    let points: Vec<(usize, f64, &LossStep)> = losses
        .iter()
        .filter(|l| l.mean_square.is_finite() && l.mean_square >= 0.0)
        .enumerate()
        .map(|(i, l)| (i, psnr_from_mse(l.mean_square), l))
        .collect();
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return r#"<p class="note">The run ended before the first step was measured.</p>"#.into();
    };
    let axes = Axes::new(points.len() - 1, points.iter().map(|p| p.1));
    let mut content = String::from(r#"<path class="line" d=""#);
    for (i, decibels, _) in &points {
        let letter = if *i == 0 { 'M' } else { 'L' };
        let _ = write!(content, "{letter}{:.1} {:.1}", axes.x(*i), axes.y(*decibels));
    }
    content.push_str(r#""/>"#);
    for (i, decibels, step) in &points {
        let kind = kind(&step.moved);
        let _ = write!(
            content,
            r#"<path class="mark move{kind}" d="{}"><title>step {i}, {}: {} dB after {}</title></path>"#,
            mark(kind, axes.x(*i), axes.y(*decibels)),
            MOVES[kind].1,
            decimal(*decibels, 2),
            duration(step.seconds)
        );
    }
    let label = |(i, decibels, _): &(usize, f64, &LossStep), (dx, dy): (f64, f64), anchor: &str| {
        format!(
            r#"<text class="value" x="{:.1}" y="{:.1}" text-anchor="{anchor}">{}</text>"#,
            axes.x(*i) + dx,
            axes.y(*decibels) + dy,
            decimal(*decibels, 2)
        )
    };
    // Below the mark, away from a line that rises, where there is room for it.
    let room = axes.y(f64::MIN) - axes.y(first.1) > 22.0;
    content += &label(first, if room { (2.0, 19.0) } else { (10.0, 4.0) }, "start");
    if points.len() > 1 {
        content += &label(last, (4.0, -10.0), "end");
    }
    let labels: Vec<String> = points.iter().map(|p| p.0.to_string()).collect();
    axes.svg("Agreement after each step of the fit", ("step", "dB"), &labels, &content) + &legend(&points)
}

/// Those kinds that occur.
fn legend(points: &[(usize, f64, &LossStep)]) -> String {
    let mut out = String::from(r#"<ul class="legend">"#);
    for (k, (_, name)) in MOVES.iter().enumerate() {
        if points.iter().any(|p| kind(&p.2.moved) == k) {
            let _ = write!(
                out,
                r#"<li><svg viewBox="0 0 14 14" aria-hidden="true"><path class="mark move{k}" d="{}"/></svg>{name}</li>"#,
                mark(k, 7.0, 7.0)
            );
        }
    }
    out + "</ul>"
}

fn kind(moved: &str) -> usize {
    MOVES.iter().position(|m| m.0 == moved).unwrap_or(0)
}

/// A shape for each kind, so that colour is not all that tells them apart.
fn mark(kind: usize, x: f64, y: f64) -> String {
    match kind {
        0 | 4 | 5 => format!("M{:.1} {y:.1}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z", x - 5.0),
        1 => format!("M{:.1} {:.1}h9v9h-9z", x - 4.5, y - 4.5),
        2 => format!("M{x:.1} {:.1}l5.4 9.6h-10.8z", y - 6.0),
        _ => format!("M{x:.1} {:.1}l6 6l-6 6l-6 -6z", y - 6.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(moved: &str, mean_square: f64) -> LossStep {
        LossStep { moved: moved.into(), seconds: 0.5, mean_square }
    }

    /// Protects the page from runs that ended at once or went wrong.
    #[test]
    fn odd_losses_do_not_break_the_chart() {
        let runs = [
            vec![],
            vec![step("start", 1e-3)],
            vec![step("start", f64::NAN), step("color", f64::INFINITY), step("normal", -1.0)],
            vec![step("start", 0.0), step("<script>", 1e-2), step("rounding", f64::NAN)],
        ];
        for run in &runs {
            let html = loss_curve(run);
            assert!(!html.contains("NaN") && !html.contains("inf") && !html.contains("<script"), "{html}");
        }
        assert!(loss_curve(&runs[1]).contains("30.00"));
        assert!(loss_curve(&runs[2]).contains("ended before"));
    }
}
