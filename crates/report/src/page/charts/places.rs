//! A horizontal axis of groups side by side: how wide the drawing is, where each group and
//! each of its parts stands, and the groups' names below.
//!
//! Contract: names never overlap; one that does not fit is tilted, one that then still does
//! not loses its middle (its tooltip has all of it), and where even that is too dense some are left out.

use super::frame::{LINE, WIDTHS, shortened, text_width};
use crate::page::text::escape;
use std::fmt::Write;

/// Part of a group's width that stays free, in widths of a part.
const GAP: f64 = 0.8;
/// Tilted names fall by this angle's sine and go as far as its cosine: 35 degrees.
const TILT: (f64, f64) = (0.574, 0.819);
/// Longest tilted name.
const LONGEST: f64 = 190.0;

/// Places of the groups.
pub(super) struct Places<'a> {
    names: Vec<&'a str>,
    /// Width of the drawing.
    pub(super) width: f64,
    /// Where the first group begins and the last ends.
    pub(super) left: f64,
    pub(super) right: f64,
    /// Width of a group.
    group: f64,
    /// Width of each part of a group.
    pub(super) part: f64,
    tilted: bool,
}

impl<'a> Places<'a> {
    /// Places for groups of at most `parts` parts, which want `part` units each; `margins` are
    /// what has to stay free at the left and right.
    pub(super) fn new(names: Vec<&'a str>, parts: usize, part: f64, margins: (f64, f64)) -> Self {
        let count = names.len().max(1) as f64;
        let shares = parts.max(1) as f64 + GAP;
        let widest = names.iter().map(|name| text_width(name)).fold(0.0, f64::max);
        let (mut left, most) = (margins.0, WIDTHS.1 - margins.0 - margins.1);
        let plain = count * (widest + 16.0).max(shares * part);
        let tilted = plain > most && count * (widest + 10.0) > most;
        let wanted = if tilted { count * shares * part } else { plain };
        let mut width = (wanted + margins.0 + margins.1).clamp(WIDTHS.0, WIDTHS.1);
        if tilted {
            // The first names begin left of their group.
            let group = (width - margins.0 - margins.1) / count;
            let beyond = names
                .iter()
                .enumerate()
                .map(|(i, name)| text_width(name).min(LONGEST) * TILT.1 + 8.0 - group * (i as f64 + 0.5));
            left = beyond.fold(left, f64::max).min(left + 80.0);
            width = (width + left - margins.0).min(WIDTHS.1);
        }
        let right = width - margins.1;
        let group = (right - left) / count;
        // Few narrow parts in a wide group stay together.
        let part = (group / shares).min(1.6 * part);
        Self { names, width, left, right, group, part, tilted }
    }

    /// Middle of a group.
    pub(super) fn centre(&self, group: usize) -> f64 {
        self.left + self.group * (group as f64 + 0.5)
    }

    /// Middle of one of a group's `parts` parts.
    pub(super) fn part_centre(&self, group: usize, part: usize, parts: usize) -> f64 {
        self.centre(group) + self.part * (part as f64 + 0.5 - 0.5 * parts as f64)
    }

    /// Height that the names need.
    pub(super) fn depth(&self) -> f64 {
        if self.tilted {
            let widest = self.names.iter().map(|name| text_width(name)).fold(0.0, f64::max);
            widest.min(LONGEST) * TILT.0 + LINE + 8.0
        } else {
            LINE + 10.0
        }
    }

    /// The groups' names below `bottom`, and the lines between the groups up to `top`.
    pub(super) fn svg(&self, top: f64, bottom: f64) -> String {
        let mut out = String::from(r#"<g class="grid">"#);
        if self.group > 8.0 {
            for i in 1..self.names.len() {
                let x = self.left + self.group * i as f64;
                let _ = write!(out, r#"<path d="M{x:.1} {top:.1}V{:.1}"/>"#, bottom + 4.0);
            }
        }
        let apart = if self.tilted { LINE / TILT.0 } else { 1.0 };
        let every = (apart / self.group).ceil().max(1.0) as usize;
        for (i, name) in self.names.iter().enumerate().step_by(every) {
            let x = self.centre(i);
            let (shown, place) = if self.tilted {
                let (x, y) = (x + 4.0, bottom + 14.0);
                let room = LONGEST.min((x - 2.0) / TILT.1);
                let place = format!(r#"text-anchor="end" transform="translate({x:.1} {y:.1})rotate(-35)""#);
                (shortened(name, room), place)
            } else {
                let place = format!(r#"text-anchor="middle" x="{x:.1}" y="{:.1}""#, bottom + LINE + 2.0);
                (shortened(name, self.group - 4.0), place)
            };
            let _ = write!(out, r#"<text {place}>{}"#, escape(&shown));
            if shown != **name {
                let _ = write!(out, "<title>{}</title>", escape(name));
            }
            out.push_str("</text>");
        }
        out + "</g>"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects names from overlapping, however many and however long.
    #[test]
    fn names_do_not_overlap() {
        for (count, name) in
            [(1, "LOD-3, 512²"), (12, "LOD-3, 512²"), (26, "a_rather_long_name, 512²"), (400, "x")]
        {
            let names = vec![name; count];
            let places = Places::new(names, 3, 30.0, (46.0, 14.0));
            assert!((WIDTHS.0..=WIDTHS.1).contains(&places.width));
            let svg = places.svg(20.0, 300.0);
            let shown = svg.matches("<text").count() as f64;
            let apart = (places.right - places.left) / shown;
            if places.tilted {
                assert!(apart * TILT.0 > 11.0, "{count}: {apart}");
            } else {
                assert!(apart > text_width(name), "{count}: {apart}");
            }
            assert!(places.part_centre(count - 1, 2, 3) + places.part / 2.0 < places.right);
        }
    }

    /// Protects against charts of no groups and of groups without parts.
    #[test]
    fn nothing_has_a_place() {
        let places = Places::new(vec![], 0, 30.0, (46.0, 14.0));
        assert!(places.part > 0.0 && places.width == WIDTHS.0 && !places.svg(0.0, 9.0).contains("NaN"));
    }
}
