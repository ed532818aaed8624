//! Lines over a continuous axis, with the borders of stages.
//!
//! A series of at most [`MOST_MARKS`] points has its mark at each of them and a solid line,
//! a longer one a dash of its own. Very long ones are thinned: of each run of points its
//! lowest and its highest stay, so that no spike is lost.
//!
//! Contract: text is escaped with [`escape`] and numbers are printed through [`crate::page::text`];
//! points without two finite coordinates, and on a logarithmic axis those at or below 0, are
//! left out and the line goes on without them. All coordinates are finite, the same chart
//! gives the same bytes, and it has `role="img"` and an `aria-label`.

use super::frame::{Frame, LINE, left_margin, shortened, text_width, x_scale};
use super::looks::{colour, dash, legend, mark};
use super::scale::Scale;
use crate::page::text::{escape, figures};
use std::fmt::Write;

/// A series with more points has no marks: they would be all that is seen.
const MOST_MARKS: usize = 40;
/// Runs of which a thinned series keeps two points each.
const MOST_RUNS: usize = 150;
/// The drawing's width, and the height of its part that shows values.
const SIZE: (f64, f64) = (720.0, 270.0);
/// Most lines of boundaries' labels; labels beyond are tooltips only.
const MOST_ROWS: usize = 4;

/// Values over a continuous axis.
#[derive(Clone, Debug, Default)]
pub struct LineChart {
    /// Names the chart for those who do not see it.
    pub title: String,
    /// What the horizontal axis counts, with its unit.
    pub x_title: String,
    /// What the vertical axis measures, with its unit.
    pub y_title: String,
    /// The lines, in the legend's order.
    pub series: Vec<Series>,
    /// Vertical lines with a label each: where a stage begins.
    pub boundaries: Vec<(f64, String)>,
    /// Whether the vertical axis is logarithmic.
    pub logarithmic: bool,
}

/// One line of a [`LineChart`].
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Its points, in the order in which the line joins them.
    pub points: Vec<(f64, f64)>,
}

impl LineChart {
    /// The drawing and its legend.
    pub fn html(&self) -> String {
        let shown: Vec<Vec<(f64, f64)>> = self.series.iter().map(|series| self.shown(series)).collect();
        let values = shown.iter().flatten().map(|point| point.1);
        let y_scale = if self.logarithmic { Scale::logarithmic(values) } else { Scale::around(values, 5) };
        let boundaries: Vec<&(f64, String)> = self.boundaries.iter().filter(|b| b.0.is_finite()).collect();
        let positions = shown.iter().flatten().map(|p| p.0).chain(boundaries.iter().map(|b| b.0));
        let left = left_margin(&y_scale);
        let x_scale = x_scale(positions, SIZE.0 - left - 20.0);
        let right = right_edge(&boundaries, &x_scale, left);
        let mut frame =
            Frame { width: SIZE.0, height: 0.0, left, right, top: 22.0, bottom: 0.0, inside: (0.0, 0.0) };
        let rows = rows(&boundaries, &x_scale, &frame);
        let lines = rows.iter().map(|&row| row + 1).filter(|&row| row <= MOST_ROWS).max().unwrap_or(0);
        frame.top += LINE * lines as f64;
        frame.bottom = frame.top + SIZE.1;
        frame.height = frame.bottom + 2.0 * LINE + 12.0;

        let mut content = frame.horizontal_axis(&x_scale, &self.x_title);
        for (&(at, label), &row) in boundaries.iter().zip(&rows) {
            let x = frame.x(&x_scale, *at);
            let drawn = row < MOST_ROWS;
            let y = frame.top - if drawn { LINE * row as f64 + 4.0 } else { 0.0 };
            let name = escape(label);
            let _ = write!(
                content,
                r#"<g class="boundary"><title>{name}: {}</title><path d="M{x:.1} {:.1}V{:.1}"/>"#,
                figures(*at, 4),
                if drawn { y - 9.0 } else { y },
                frame.bottom
            );
            if drawn {
                let fitting = escape(&shortened(label, SIZE.0 - x - 6.0));
                let _ = write!(content, r#"<text x="{:.1}" y="{y:.1}">{fitting}</text>"#, x + 4.0);
            }
            content.push_str("</g>");
        }
        for (i, points) in shown.iter().enumerate() {
            let places: Vec<(f64, f64)> =
                points.iter().map(|p| (frame.x(&x_scale, p.0), frame.y(&y_scale, p.1))).collect();
            self.line(&mut content, i, points, &places);
        }
        frame.svg(&self.title, &self.y_title, &y_scale, &content) + &self.legend(&shown)
    }

    fn shown(&self, series: &Series) -> Vec<(f64, f64)> {
        let fits = |&(x, y): &(f64, f64)| x.is_finite() && y.is_finite() && (y > 0.0 || !self.logarithmic);
        series.points.iter().copied().filter(fits).collect()
    }

    /// Appends the line of a series and its marks, which stand at `places`.
    fn line(&self, out: &mut String, index: usize, points: &[(f64, f64)], places: &[(f64, f64)]) {
        let (name, marked) = (escape(&self.series[index].name), points.len() <= MOST_MARKS);
        if points.len() > 1 {
            let _ = write!(out, r#"<path class="curve series{}-line""#, colour(index));
            let _ = write!(out, r#"{} d=""#, if marked { "" } else { dash(index) });
            for (i, (x, y)) in thinned(places).into_iter().enumerate() {
                let _ = write!(out, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
            }
            let _ = write!(out, r#""><title>{name}</title></path>"#);
        }
        if marked {
            for (point, &(x, y)) in points.iter().zip(places) {
                let _ = write!(
                    out,
                    r#"<path class="mark series{}" d="{}"><title>{name}: {} at {}</title></path>"#,
                    colour(index),
                    mark(index, x, y),
                    figures(point.1, 4),
                    figures(point.0, 4)
                );
            }
        }
    }

    fn legend(&self, shown: &[Vec<(f64, f64)>]) -> String {
        let entries = self.series.iter().enumerate().map(|(i, series)| {
            let (marked, colour) = (shown[i].len() <= MOST_MARKS, colour(i));
            let dash = if marked { "" } else { dash(i) };
            let mut drawing = format!(r#"<path class="curve series{colour}-line"{dash} d="M0 7H40"/>"#);
            if marked {
                let _ = write!(drawing, r#"<path class="mark series{colour}" d="{}"/>"#, mark(i, 20.0, 7.0));
            }
            (drawing, series.name.as_str())
        });
        legend(40, entries)
    }
}

/// Right edge that leaves room for the labels of the last boundaries.
fn right_edge(boundaries: &[&(f64, String)], scale: &Scale, left: f64) -> f64 {
    let room = |boundary: &&(f64, String)| {
        let share = scale.share(boundary.0);
        (left + share * (SIZE.0 - left) + text_width(&boundary.1) + 8.0 - SIZE.0) / share.max(0.5)
    };
    SIZE.0 - boundaries.iter().map(room).fold(20.0, f64::max).min(170.0)
}

/// For each boundary the line of its label, counted upwards. One that would run into the next
/// boundary's label stands above it, so that no vertical line crosses a label either.
fn rows(boundaries: &[&(f64, String)], scale: &Scale, frame: &Frame) -> Vec<usize> {
    let starts: Vec<f64> = boundaries.iter().map(|boundary| frame.x(scale, boundary.0)).collect();
    let mut order: Vec<usize> = (0..boundaries.len()).collect();
    order.sort_by(|&a, &b| starts[b].total_cmp(&starts[a]).then(b.cmp(&a)));
    let mut rows = vec![0; boundaries.len()];
    for (done, &i) in order.iter().enumerate() {
        let end = starts[i] + text_width(&boundaries[i].1) + 10.0;
        let above = order[..done].iter().filter(|&&j| starts[j] < end).map(|&j| rows[j] + 1);
        rows[i] = above.max().unwrap_or(0);
    }
    rows
}

/// The points, or of many those that a reader would miss.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 2 * MOST_RUNS {
        return points.to_vec();
    }
    let mut out = vec![points[0]];
    let inner = &points[1..points.len() - 1];
    for run in inner.chunks(inner.len().div_ceil(MOST_RUNS)) {
        let (mut low, mut high) = (0, 0);
        for (i, point) in run.iter().enumerate() {
            low = if point.1 < run[low].1 { i } else { low };
            high = if point.1 > run[high].1 { i } else { high };
        }
        out.push(run[low.min(high)]);
        if low != high {
            out.push(run[low.max(high)]);
        }
    }
    out.push(points[points.len() - 1]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(name: &str, points: Vec<(f64, f64)>) -> Series {
        Series { name: name.into(), points }
    }

    /// Protects the page from odd numbers and odd names.
    #[test]
    fn odd_charts_stay_finite() {
        let odd = [f64::NAN, f64::INFINITY, f64::MAX, f64::MIN, 5e-324, -1.0, 0.0, 7.0];
        let pairs: Vec<(f64, f64)> = odd.iter().flat_map(|&x| odd.iter().map(move |&y| (x, y))).collect();
        for points in [vec![], vec![(1.0, f64::NAN)], vec![(3.0, 5.0)], vec![(0.0, -1.0); 90], pairs] {
            for logarithmic in [false, true] {
                let chart = LineChart {
                    title: "\"<t>".into(),
                    x_title: "<x>".into(),
                    y_title: "<y>".into(),
                    series: vec![series("<a>", points.clone()), Series::default()],
                    boundaries: odd.iter().map(|&x| (x, "<b>".into())).collect(),
                    logarithmic,
                };
                let html = chart.html();
                assert!(
                    !html.contains("NaN") && !html.contains("inf") && !html.contains('\u{fffd}'),
                    "{html}"
                );
                for tag in ["<a>", "<b>", "<t>", "<x>", "<y>"] {
                    assert!(!html.contains(tag), "{html}");
                }
                assert!(html.contains(r#"role="img" aria-label="&quot;&lt;t&gt;""#), "{html}");
                assert_eq!(html, chart.html());
            }
        }
        assert!(LineChart::default().html().starts_with(r#"<svg class="chart""#));
    }

    /// Protects the page's size, and the spike that tells of a bad step.
    #[test]
    fn long_series_are_thinned() {
        let mut points: Vec<(f64, f64)> =
            (0..50_000).map(|i| (f64::from(i), (f64::from(i) * 0.1).sin())).collect();
        points[31_234].1 = 9.0;
        let thin = thinned(&points);
        assert!((200..=2 * MOST_RUNS + 2).contains(&thin.len()), "{}", thin.len());
        assert!(thin.contains(&(31_234.0, 9.0)) && thin.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert_eq!((thin[0], thin[thin.len() - 1]), (points[0], points[49_999]));
        let html = LineChart { series: vec![series("a", points)], ..LineChart::default() }.html();
        assert!(html.len() < 10_000 && !html.contains("class=\"mark"), "{}", html.len());
    }

    /// Protects what is left out of a logarithmic axis, and only there.
    #[test]
    fn logarithms_leave_out_what_has_none() {
        let mut chart = LineChart {
            series: vec![series("a", vec![(0.0, 0.01), (1.0, 0.0), (2.0, -3.0), (3.0, 10.0)])],
            ..LineChart::default()
        };
        assert_eq!(chart.html().matches(" at ").count(), 4);
        chart.logarithmic = true;
        assert_eq!(chart.html().matches(" at ").count(), 2);
        assert!(chart.html().contains(">0.1</text>"));
    }

    /// Protects the labels of stages that begin close to each other.
    #[test]
    fn close_boundaries_stand_above_each_other() {
        let boundaries = [(0.0, "colours".into()), (2.0, "normals".into()), (90.0, "end".into())];
        let scale = Scale::within([0.0, 100.0].into_iter(), 10);
        let frame = Frame {
            width: 720.0,
            height: 0.0,
            left: 0.0,
            right: 700.0,
            top: 0.0,
            bottom: 0.0,
            inside: (0.0, 0.0),
        };
        assert_eq!(rows(&boundaries.each_ref(), &scale, &frame), [1, 0, 0]);
    }
}
