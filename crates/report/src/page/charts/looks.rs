//! What tells series apart: a colour, a mark and a dash for each; and the legend.
//!
//! Contract: the first six have a colour each that colour-blind people tell apart, and the
//! first 36 a pair of colour and mark (or dash) that no other has. Names are escaped here.

use crate::page::text::escape;
use std::fmt::Write;

/// Colours, marks and dashes.
const KINDS: usize = 6;

/// Index of a series' colour: its classes are `series0` for areas, `series0-line` for lines.
pub(super) fn colour(series: usize) -> usize {
    series % KINDS
}

/// Outline of a series' mark.
pub(super) fn mark(series: usize, x: f64, y: f64) -> String {
    match kind(series) {
        0 => format!("M{:.1} {y:.1}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z", x - 4.5),
        1 => format!("M{:.1} {:.1}h8v8h-8z", x - 4.0, y - 4.0),
        2 => format!("M{x:.1} {:.1}l5 9h-10z", y - 5.5),
        3 => format!("M{x:.1} {:.1}l5.5 5.5l-5.5 5.5l-5.5 -5.5z", y - 5.5),
        4 => format!("M{x:.1} {:.1}l5 -9h-10z", y + 5.5),
        _ => format!("M{:.1} {:.1}h4v3h3v4h-3v3h-4v-3h-3v-4h3z", x - 2.0, y - 5.0),
    }
}

/// Attribute that dashes a series' line; the first one's is solid.
pub(super) fn dash(series: usize) -> &'static str {
    [
        "",
        r#" stroke-dasharray="8 4""#,
        r#" stroke-dasharray="2 3""#,
        r#" stroke-dasharray="10 3 2 3""#,
        r#" stroke-dasharray="16 5""#,
        r#" stroke-dasharray="6 3 2 3 2 3""#,
    ][kind(series)]
}

/// Shifted by one with each round through the colours.
fn kind(series: usize) -> usize {
    (series + series / KINDS) % KINDS
}

/// Each name once, as first met.
pub(super) fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut out = Vec::new();
    for name in names {
        if !out.contains(&name) {
            out.push(name);
        }
    }
    out
}

/// A legend: for each entry a drawing so many units wide and 14 high, and a name.
pub(super) fn legend<'a>(width: usize, entries: impl Iterator<Item = (String, &'a str)>) -> String {
    let mut out = String::from(r#"<ul class="legend">"#);
    let class = if width > 14 { r#" class="long""# } else { "" };
    for (drawing, name) in entries {
        let _ = write!(
            out,
            r#"<li><svg{class} viewBox="0 0 {width} 14" aria-hidden="true">{drawing}</svg>{}</li>"#,
            escape(name)
        );
    }
    out + "</ul>"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects readers who see no colours.
    #[test]
    fn no_two_series_look_the_same() {
        let looks = |i| (colour(i), mark(i, 7.0, 7.0), dash(i));
        for i in 0..36 {
            assert!((0..i).all(|j| looks(j) != looks(i)), "{i}");
            assert!((i / 6 * 6..i).all(|j| looks(j).1 != looks(i).1 && looks(j).2 != looks(i).2), "{i}");
        }
    }

    /// Protects the page from colours that its style does not define.
    #[test]
    fn all_colours_are_defined_in_light_and_dark() {
        let style = include_str!("../style.css");
        for i in 0..KINDS {
            assert_eq!(style.matches(&format!("--series{i}:")).count(), 2);
            assert!(
                style.contains(&format!(".series{i} {{")) && style.contains(&format!(".series{i}-line {{"))
            );
        }
    }
}
