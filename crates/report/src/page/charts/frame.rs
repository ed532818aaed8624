//! The frame that the charts share: grid, vertical axis and titles, and where values stand.
//!
//! Contract: text is escaped here; coordinates are finite if the frame's edges are.

use super::scale::Scale;
use crate::page::text::escape;
use std::fmt::Write;

/// Narrowest and widest drawing.
pub(super) const WIDTHS: (f64, f64) = (480.0, 1200.0);
/// Distance of two lines of text.
pub(super) const LINE: f64 = 15.0;
/// Pixels that a unit may have at most, so that letters are of one size in all charts of a page.
const LARGEST_UNIT: f64 = 680.0 / 480.0;

/// Edges of the part of a chart that shows values, in the drawing's units.
pub(super) struct Frame {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    /// Room inside, above the largest value and below the smallest.
    pub(super) inside: (f64, f64),
}

impl Frame {
    /// Horizontal place of a value.
    pub(super) fn x(&self, scale: &Scale, value: f64) -> f64 {
        self.left + (self.right - self.left) * scale.share(value)
    }

    /// Vertical place of a value.
    pub(super) fn y(&self, scale: &Scale, value: f64) -> f64 {
        let (top, bottom) = (self.top + self.inside.0, self.bottom - self.inside.1);
        bottom - (bottom - top) * scale.share(value)
    }

    /// Ticks below the horizontal axis, and what it counts.
    pub(super) fn horizontal_axis(&self, scale: &Scale, title: &str) -> String {
        let mut out = String::from(r#"<g class="grid">"#);
        for tick in &scale.ticks {
            let x = self.x(scale, tick.value);
            let _ = write!(
                out,
                r#"<path d="M{x:.1} {:.1}v5"/><text x="{x:.1}" y="{:.1}" text-anchor="middle">{}</text>"#,
                self.bottom,
                self.bottom + LINE + 4.0,
                tick.label
            );
        }
        let _ = write!(
            out,
            r#"</g><g class="axis"><text x="{:.1}" y="{:.1}" text-anchor="end">{}</text></g>"#,
            self.right,
            self.height - 5.0,
            escape(&shortened(title, self.right - 4.0))
        );
        out
    }

    /// The drawing: the grid, then `content`. `title` names it for those who do not see it.
    pub(super) fn svg(&self, title: &str, y_title: &str, scale: &Scale, content: &str) -> String {
        let mut out = format!(
            r#"<svg class="chart" viewBox="0 0 {:.0} {:.0}" style="max-width:{:.0}px" role="img" aria-label="{}"><g class="grid">"#,
            self.width,
            self.height,
            self.width * LARGEST_UNIT,
            escape(title)
        );
        for tick in &scale.ticks {
            let y = self.y(scale, tick.value);
            let _ = write!(
                out,
                r#"<path d="M{:.1} {y:.1}H{:.1}"/><text x="{:.1}" y="{:.1}" text-anchor="end">{}</text>"#,
                self.left,
                self.right,
                self.left - 7.0,
                y + 4.0,
                tick.label
            );
        }
        let _ = write!(
            out,
            r#"</g><g class="axis"><text x="4" y="11">{}</text></g>{content}</svg>"#,
            escape(&shortened(y_title, self.width - 8.0))
        );
        out
    }
}

/// As many ticks as have labels that do not touch.
pub(super) fn x_scale(positions: impl Iterator<Item = f64> + Clone, width: f64) -> Scale {
    let mut scale = Scale::within(positions.clone(), 10);
    for steps in [8, 6, 5, 4, 3, 2, 1] {
        let widest = scale.ticks.iter().map(|tick| text_width(&tick.label)).fold(0.0, f64::max);
        let apart = |pair: &[super::scale::Tick]| scale.share(pair[1].value) - scale.share(pair[0].value);
        if scale.ticks.windows(2).all(|pair| width * apart(pair) > widest + 10.0) {
            break;
        }
        scale = Scale::within(positions.clone(), steps);
    }
    scale
}

/// Space that the vertical axis' labels need at its left.
pub(super) fn left_margin(scale: &Scale) -> f64 {
    scale.ticks.iter().map(|tick| text_width(&tick.label)).fold(32.0, f64::max) + 14.0
}

/// About how wide a text is in a page's font, rather more than less.
pub(super) fn text_width(text: &str) -> f64 {
    text.chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '|' | '\'' | '!' | ' ' | '\u{202f}' => 3.8,
            'm' | 'w' | 'M' | 'W' | '%' | '@' | '—' => 10.5,
            'A'..='Z' | '−' | '+' | '×' | '→' => 8.2,
            // East Asian letters are as wide as high.
            '\u{2e80}'.. => 12.5,
            _ => 7.0,
        })
        .sum()
}

/// A text that fits, its middle left out where it has to: names of a series of models differ
/// at their start, and units and resolutions stand at the end.
pub(super) fn shortened(text: &str, width: f64) -> String {
    if text_width(text) <= width {
        return text.into();
    }
    let room = (width - text_width("…")).max(0.0);
    let mut start: String = text.into();
    while text_width(&start) > 0.6 * room {
        start.pop();
    }
    let start = start.trim_end();
    let mut end = &text[start.len()..];
    while text_width(end) > room - text_width(start) {
        end = end.split_at(end.chars().next().map_or(0, char::len_utf8)).1;
    }
    format!("{start}…{}", end.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects neighbours from a label that is too long, and short ones from being cut.
    #[test]
    fn texts_are_cut_to_fit() {
        assert_eq!(shortened("LOD-3", 80.0), "LOD-3");
        let cut = shortened("a very long name of a thing, 512²", 90.0);
        assert!(cut.starts_with("a very") && cut.ends_with(" 512²") && text_width(&cut) <= 90.0, "{cut}");
        assert_eq!(shortened("面包", 1.0), "…");
    }
}
