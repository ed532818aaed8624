//! Bars from a zero line, in groups, each with its value and the paper's.
//!
//! Values stand at the bars' ends: upright along the bar where bars are narrow, and as
//! tooltips only where they are narrower than a letter is high. All have the same decimals.
//!
//! Contract: text is escaped with [`escape`] and numbers are printed through [`crate::page::text`];
//! a value that is no finite number is a dash without a bar, such a reference is none. The
//! same name has the same colour in every group. All coordinates are finite, the same chart
//! gives the same bytes, and it has `role="img"` and an `aria-label`.

use super::frame::{Frame, left_margin, text_width};
use super::looks::{colour, distinct, legend};
use super::places::Places;
use super::scale::Scale;
use crate::page::text::{NOTHING, escape, grouped, scientific};
use std::fmt::Write;

/// Height of the part that shows values.
const HEIGHT: f64 = 290.0;
/// Width that a bar wants beside what its value's text needs, and the part of its place it has.
const PLACE: (f64, f64) = (30.0, 0.8);
/// How much wider values are, which are bold, than other text.
const BOLD: f64 = 1.2;
/// Narrowest place whose value is written.
const NARROWEST: f64 = 10.5;
/// The drawing of the paper's value in the legend.
const REFERENCE: &str = r#"<path class="reference halo" d="M1 7H13"/><path class="reference" d="M1 7H13"/>"#;

/// Values in groups.
#[derive(Clone, Debug, Default)]
pub struct BarChart {
    /// Names the chart for those who do not see it.
    pub title: String,
    /// What the vertical axis measures, with its unit.
    pub y_title: String,
    /// The places on the horizontal axis.
    pub groups: Vec<BarGroup>,
}

/// A place on the horizontal axis of a [`BarChart`].
#[derive(Clone, Debug, Default)]
pub struct BarGroup {
    /// What stands below it.
    pub name: String,
    /// Its bars from left to right.
    pub bars: Vec<Bar>,
}

/// One value.
#[derive(Clone, Debug, Default)]
pub struct Bar {
    /// Its name in the legend.
    pub name: String,
    /// Where the bar ends.
    pub value: f64,
    /// The paper's value, if it states one.
    pub reference: Option<f64>,
}

impl Bar {
    /// Its reference if that is a number.
    fn stated(&self) -> Option<f64> {
        self.reference.filter(|value| value.is_finite())
    }
}

impl BarChart {
    /// The drawing and its legend.
    pub fn html(&self) -> String {
        let bars = || self.groups.iter().flat_map(|group| &group.bars);
        let names = distinct(bars().map(|bar| bar.name.as_str()));
        let numbers = Numbers::of(bars().map(|bar| bar.value));
        let widest = bars().map(|bar| BOLD * text_width(&numbers.text(bar.value))).fold(0.0, f64::max);
        let values = bars().flat_map(|bar| [Some(bar.value), bar.stated()]).flatten();
        let scale = Scale::around(values.clone().chain([0.0]), 5);

        let parts = self.groups.iter().map(|group| group.bars.len()).max().unwrap_or(0);
        let wanted = PLACE.0.max(widest + 4.0);
        let titles = self.groups.iter().map(|group| group.name.as_str()).collect();
        let places = Places::new(titles, parts, wanted, (left_margin(&scale), 14.0));
        let upright = places.part < widest + 2.0;
        // What a value's text takes away from the axis.
        let room = if upright { widest } else { 12.0 } + 10.0;
        let (top, bottom) = (22.0, 22.0 + HEIGHT + room);
        let frame = Frame {
            width: places.width,
            height: bottom + places.depth(),
            left: places.left,
            right: places.right,
            top,
            bottom,
            inside: (room, if values.clone().any(|value| value < 0.0) { room } else { 0.0 }),
        };
        let zero = frame.y(&scale, 0.0);
        let mut content = places.svg(top, bottom);
        let _ = write!(
            content,
            r#"<g class="zero"><path d="M{:.1} {zero:.1}H{:.1}"/></g>"#,
            frame.left, frame.right
        );
        for (g, group) in self.groups.iter().enumerate() {
            for (i, bar) in group.bars.iter().enumerate() {
                let one = Drawn {
                    bar,
                    group: &group.name,
                    colour: colour(names.iter().position(|name| *name == bar.name).unwrap_or(0)),
                    x: places.part_centre(g, i, group.bars.len()),
                    half: 0.5 * PLACE.1 * places.part,
                    zero,
                    end: if bar.value.is_finite() { frame.y(&scale, bar.value) } else { zero },
                    reference: bar.stated().map(|value| frame.y(&scale, value)),
                };
                one.svg(&mut content, &numbers, places.part, upright);
            }
        }
        let named = names
            .iter()
            .enumerate()
            .map(|(i, name)| (format!(r#"<path class="series{}" d="M1 1h12v12h-12z"/>"#, colour(i)), *name));
        let stated = bars().any(|bar| bar.stated().is_some()).then(|| (REFERENCE.into(), "the paper's"));
        frame.svg(&self.title, &self.y_title, &scale, &content) + &legend(14, named.chain(stated))
    }
}

/// A bar with its place.
struct Drawn<'a> {
    bar: &'a Bar,
    group: &'a str,
    colour: usize,
    x: f64,
    half: f64,
    /// Heights of the zero line, of the value and of the reference.
    zero: f64,
    end: f64,
    reference: Option<f64>,
}

impl Drawn<'_> {
    fn svg(&self, out: &mut String, numbers: &Numbers, place: f64, upright: bool) {
        let value = numbers.text(self.bar.value);
        let _ = write!(out, r#"<g><title>{}, {}: {value}"#, escape(self.group), escape(&self.bar.name));
        if let Some(reference) = self.bar.stated() {
            let _ = write!(out, ", the paper's {}", numbers.text(reference));
        }
        let _ = write!(
            out,
            r#"</title><path class="series{}" d="M{:.1} {:.1}h{:.1}V{:.1}h{:.1}z"/>"#,
            self.colour,
            self.x - self.half,
            self.zero,
            2.0 * self.half,
            self.end,
            -2.0 * self.half
        );
        if let Some(y) = self.reference {
            let line = format!("M{:.1} {y:.1}h{:.1}", self.x - 1.18 * self.half, 2.36 * self.half);
            let _ = write!(
                out,
                r#"<path class="reference halo" d="{line}"/><path class="reference" d="{line}"/>"#
            );
        }
        if place >= NARROWEST {
            let length = if upright { BOLD * text_width(&value) } else { 11.0 };
            let down = self.end > self.zero;
            let start = self.text_start(length, if down { 1.0 } else { -1.0 });
            let _ = if upright {
                let anchor = if down { "end" } else { "start" };
                let (x, size) = (self.x + 4.0, if place < 13.0 { r#" font-size="10""# } else { "" });
                write!(
                    out,
                    r#"<text class="value" text-anchor="{anchor}"{size} transform="translate({x:.1} {start:.1})rotate(-90)">{value}</text>"#
                )
            } else {
                let baseline = if down { start + 9.5 } else { start };
                write!(
                    out,
                    r#"<text class="value" text-anchor="middle" x="{:.1}" y="{baseline:.1}">{value}</text>"#,
                    self.x
                )
            };
        }
        out.push_str("</g>");
    }

    /// Where the value's text of so much height begins, in the direction of the bar: at its
    /// end, or behind the reference where that would cross the text.
    fn text_start(&self, length: f64, direction: f64) -> f64 {
        let start = self.end + 4.0 * direction;
        match self.reference {
            Some(y) if (-7.0..length + 3.0).contains(&((y - start) * direction)) => y + 5.0 * direction,
            _ => start,
        }
    }
}

/// How all values of a chart are written.
struct Numbers {
    /// Power of ten of the largest.
    power: i32,
}

impl Numbers {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let largest = values.filter(|value| value.is_finite()).fold(0.0, |a: f64, b| a.max(b.abs()));
        Self { power: if largest > 0.0 { largest.log10().floor() as i32 } else { 0 } }
    }

    /// Two decimals for numbers like decibels; more where they are small, fewer where large.
    fn text(&self, value: f64) -> String {
        match self.power {
            _ if !value.is_finite() => NOTHING.into(),
            -5..=0 => grouped(value, (2 - self.power) as usize),
            1 => grouped(value, 2),
            2 => grouped(value, 1),
            3..=6 => grouped(value, 0),
            _ => scientific(value, 2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(name: &str, value: f64, reference: Option<f64>) -> Bar {
        Bar { name: name.into(), value, reference }
    }

    fn chart(bars: Vec<Bar>) -> BarChart {
        let groups = vec![BarGroup { name: "g".into(), bars }];
        BarChart { title: "t".into(), y_title: "dB".into(), groups }
    }

    /// The numbers of the first path that begins so.
    fn path(html: &str, start: &str) -> Vec<f64> {
        let path = html.split(start).nth(1).unwrap().split('"').next().unwrap();
        path.split(|c: char| !"0123456789.-".contains(c)).filter_map(|number| number.parse().ok()).collect()
    }

    /// Protects the zero line: bars of positive values go up from it, negative ones down.
    #[test]
    fn bars_start_at_zero() {
        let zero =
            path(&chart(vec![bar("a", 2.0, None), bar("b", -1.0, None)]).html(), r#"class="zero"><path d=""#)
                [1];
        let html = chart(vec![bar("a", 2.0, None), bar("b", -1.0, None)]).html();
        let (up, down) = (path(&html, r#"class="series0" d=""#), path(&html, r#"class="series1" d=""#));
        assert!(up[1] == zero && down[1] == zero && up[3] < zero && down[3] > zero);
        assert!(((zero - up[3]) - 2.0 * (down[3] - zero)).abs() < 0.3, "twice as long");
        assert!(html.contains(">2.00</text>") && html.contains(">−1.00</text>"));
    }

    /// Protects the comparison with the paper: its tick stands where a bar of its value ends.
    #[test]
    fn references_stand_at_their_value() {
        let html = chart(vec![bar("a", 2.0, Some(3.0)), bar("b", 3.0, None)]).html();
        let (reference, end) =
            (path(&html, r#"class="reference" d=""#)[1], path(&html, r#"class="series1" d=""#)[3]);
        assert_eq!(reference, end);
        assert_eq!(html.matches("the paper").count(), 2, "a tooltip and the legend");
        assert!(html.contains("g, a: 2.00, the paper's 3.00"));
        let without = chart(vec![bar("a", 2.0, None), bar("b", 3.0, Some(f64::NAN))]).html();
        assert!(!without.contains("the paper") && !without.contains("reference"));
    }

    /// Protects values from being crossed by the reference's tick.
    #[test]
    fn values_step_aside() {
        let one = bar("a", 1.0, None);
        let mut drawn = Drawn {
            bar: &one,
            group: "",
            colour: 0,
            x: 0.0,
            half: 9.0,
            zero: 90.0,
            end: 50.0,
            reference: None,
        };
        assert_eq!(drawn.text_start(11.0, -1.0), 46.0);
        for (reference, start) in [(80.0, 46.0), (50.0, 45.0), (40.0, 35.0), (20.0, 46.0)] {
            drawn.reference = Some(reference);
            assert_eq!(drawn.text_start(11.0, -1.0), start, "{reference}");
        }
    }

    /// Protects the page from odd numbers and odd names.
    #[test]
    fn odd_charts_stay_finite() {
        let odd = [f64::NAN, f64::INFINITY, f64::MAX, f64::MIN, 5e-324, 0.0, -0.0];
        let mut charts = vec![BarChart::default(), chart(vec![]), chart(vec![bar("a", f64::NAN, None)])];
        charts.push(chart(odd.iter().flat_map(|&a| odd.map(|b| bar("<b>", a, Some(b)))).collect()));
        charts.extend(odd.map(|value| chart(vec![bar("<b>", value, Some(value))])));
        for chart in &mut charts {
            (chart.title, chart.y_title) = ("<t>".into(), "<y>".into());
            chart.groups.push(BarGroup { name: "<n>".into(), bars: vec![] });
            let html = chart.html();
            assert!(!html.contains("NaN") && !html.contains("inf"), "{html}");
            assert!(["<b>", "<t>", "<y>", "<n>"].iter().all(|tag| !html.contains(tag)), "{html}");
            assert!(html.contains(r#"role="img" aria-label="&lt;t&gt;""#));
            assert_eq!(html, chart.html());
        }
    }
}
