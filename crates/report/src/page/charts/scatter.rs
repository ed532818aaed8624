//! Points over two axes, in groups, with a line that is to be reached, a band above it, and one point that was chosen.
//!
//! Contract: as of the module; points without two finite coordinates are left out.

use super::frame::{Frame, LINE, left_margin, text_width, x_scale};
use super::looks::{colour, legend, mark};
use super::scale::Scale;
use crate::page::text::{decimal, escape};
use std::fmt::Write;

/// The drawing's width, and the height of its part that shows values.
const SIZE: (f64, f64) = (720.0, 290.0);

/// Points of a few groups.
#[derive(Clone, Debug, Default)]
pub struct ScatterChart {
    /// Names the chart for those who do not see it.
    pub title: String,
    /// What the horizontal axis counts, with its unit.
    pub x_title: String,
    /// What the vertical axis measures, with its unit.
    pub y_title: String,
    /// Names of the groups, in the legend's order.
    pub groups: Vec<String>,
    /// The points.
    pub points: Vec<ScatterPoint>,
    /// A value of the vertical axis that is to be reached, how far above it points should end, and its name.
    pub target: Option<(f64, f64, String)>,
}

/// A point of a [`ScatterChart`].
#[derive(Clone, Debug, Default)]
pub struct ScatterPoint {
    /// Its group.
    pub group: usize,
    /// Where it stands.
    pub at: (f64, f64),
    /// What a tooltip says of it.
    pub name: String,
    /// Whether it is the chosen one.
    pub chosen: bool,
}

impl ScatterChart {
    /// The drawing and its legend.
    pub fn html(&self) -> String {
        let is_shown = |p: &&ScatterPoint| p.at.0.is_finite() && p.at.1.is_finite();
        let shown: Vec<&ScatterPoint> = self.points.iter().filter(is_shown).collect();
        let target = self.target.as_ref().filter(|t| t.0.is_finite() && t.1.is_finite());
        let ends = target.into_iter().flat_map(|t| [t.0, t.0 + t.1]);
        let y_scale = Scale::around(shown.iter().map(|p| p.at.1).chain(ends), 5);
        let left = left_margin(&y_scale);
        let positions = shown.iter().map(|p| p.at.0).chain([0.0]);
        let right = SIZE.0 - 24.0;
        let x_scale = x_scale(positions, right - left);
        let (top, bottom) = (22.0, 22.0 + SIZE.1);
        let height = bottom + 2.0 * LINE + 12.0;
        let frame = Frame { width: SIZE.0, height, left, right, top, bottom, inside: (6.0, 6.0) };
        let mut content = frame.horizontal_axis(&x_scale, &self.x_title);
        if let Some((value, above, name)) = target {
            let (line, band) = (frame.y(&y_scale, *value), frame.y(&y_scale, value + above));
            let _ = write!(
                content,
                concat!(
                    r#"<g class="goal"><path class="band" d="M{left:.1} {line:.1}H{right:.1}V{band:.1}H{left:.1}z"/>"#,
                    r#"<path d="M{left:.1} {line:.1}H{right:.1}"/><text x="{x:.1}" y="{y:.1}">{name}</text></g>"#
                ),
                left = left,
                right = right,
                line = line,
                band = band,
                x = right - text_width(name),
                y = line + 14.0,
                name = escape(name)
            );
        }
        for point in &shown {
            let (x, y) = (frame.x(&x_scale, point.at.0), frame.y(&y_scale, point.at.1));
            if point.chosen {
                let _ = write!(content, r#"<circle class="choice" cx="{x:.1}" cy="{y:.1}" r="10"/>"#);
            }
            let _ = write!(
                content,
                r#"<path class="mark series{}" d="{}"><title>{}: {}</title></path>"#,
                colour(point.group),
                mark(point.group, x, y),
                escape(&point.name),
                decimal(point.at.1, 2)
            );
        }
        let groups = self.groups.iter().enumerate().map(|(group, name)| {
            let drawing =
                format!(r#"<path class="mark series{}" d="{}"/>"#, colour(group), mark(group, 7.0, 7.0));
            (drawing, name.as_str())
        });
        let choice = shown
            .iter()
            .any(|p| p.chosen)
            .then(|| (r#"<circle class="choice" cx="7" cy="7" r="5.5"/>"#.to_string(), "the level"));
        frame.svg(&self.title, &self.y_title, &y_scale, &content) + &legend(14, groups.chain(choice))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the page from odd numbers and odd names, and the reader's eye: one ring, and it is in the legend.
    #[test]
    fn odd_points_stay_finite() {
        let odd = [f64::NAN, f64::INFINITY, f64::MAX, f64::MIN, -1.0, 0.0, 7.0];
        let point = |k: usize, at| ScatterPoint { group: k % 9, at, name: "<p>".into(), chosen: false };
        let points = odd.iter().flat_map(|&x| odd.iter().map(move |&y| (x, y))).enumerate();
        let mut chart = ScatterChart {
            title: "<t>".into(),
            groups: vec!["<g>".into()],
            points: points.map(|(k, at)| point(k, at)).collect(),
            target: Some((30.0, 0.5, "<n>".into())),
            ..ScatterChart::default()
        };
        chart.points.last_mut().into_iter().for_each(|point| point.chosen = true);
        let html = chart.html();
        for bad in ["NaN", "inf", "<p>", "<t>", "<g>", "<n>"] {
            assert!(!html.contains(bad), "{bad}");
        }
        assert_eq!(html.matches(r#"class="choice""#).count(), 2);
        chart.target = Some((f64::NAN, 0.5, String::new()));
        assert!(!chart.html().contains("NaN"));
        assert!(ScatterChart::default().html().starts_with(r#"<svg class="chart""#));
    }
}
