//! How values spread: in each group one violin a method, side by side.
//!
//! A violin is a mirrored density: a sum of Gaussian kernels at the values, as wide as
//! Silverman's rule has it (0.9 · min(σ, interquartile range / 1.34) · n^−⅕) and no narrower
//! than [`NARROWEST`]. It ends two kernel widths beyond the values. All are equally wide at
//! their widest. Each value is a dot at its height, moved sideways where dots would hide each
//! other; the median is a hollow mark.
//!
//! Contract: text is escaped with [`escape`] and numbers are printed through [`crate::page::text`];
//! values that are no finite numbers are left out, and a violin without values is a dash. The
//! same method has the same colour in every group. All coordinates are finite, the same chart
//! gives the same bytes, and it has `role="img"` and an `aria-label`.

use super::frame::{Frame, left_margin, text_width};
use super::looks::{colour, distinct, legend, mark};
use super::places::Places;
use super::scale::{FARTHEST, Scale};
use crate::page::text::{NOTHING, escape, figures};
use std::fmt::Write;

/// Least width of a kernel, as a part of the vertical axis.
const NARROWEST: f64 = 0.012;
/// Height of the part that shows values.
const HEIGHT: f64 = 300.0;
/// Width that a violin wants, and the part of it that its widest place has.
const PLACE: (f64, f64) = (44.0, 0.86);
/// Radius of a value's dot.
const DOT: f64 = 1.9;

/// Spreads of values.
#[derive(Clone, Debug, Default)]
pub struct ViolinChart {
    /// Names the chart for those who do not see it.
    pub title: String,
    /// What the vertical axis measures, with its unit.
    pub y_title: String,
    /// The places on the horizontal axis.
    pub groups: Vec<ViolinGroup>,
    /// What 0 stands for, if the chart shows differences from it.
    pub baseline: Option<String>,
}

/// A place on the horizontal axis of a [`ViolinChart`].
#[derive(Clone, Debug, Default)]
pub struct ViolinGroup {
    /// What stands below it.
    pub name: String,
    /// Its violins from left to right.
    pub violins: Vec<Violin>,
}

/// The values of one method in one group.
#[derive(Clone, Debug, Default)]
pub struct Violin {
    /// The method's name in the legend.
    pub name: String,
    /// The values, in any order.
    pub values: Vec<f64>,
}

impl ViolinChart {
    /// The drawing and its legend.
    pub fn html(&self) -> String {
        let methods = distinct(self.groups.iter().flat_map(|g| g.violins.iter().map(|v| v.name.as_str())));
        let groups: Vec<Vec<Vec<f64>>> =
            self.groups.iter().map(|g| g.violins.iter().map(|v| sorted(&v.values)).collect()).collect();
        let zero = self.baseline.iter().map(|_| 0.0);
        let all = groups.iter().flatten().flatten().copied().chain(zero.clone());
        // The axis without the violins' ends says how narrow kernels may be.
        let narrowest = NARROWEST * Scale::around(all.clone(), 5).length();
        let ends = groups.iter().flatten().filter_map(|values| {
            let beyond = 2.0 * bandwidth(values, narrowest);
            Some([values.first()? - beyond, values.last()? + beyond])
        });
        let scale = Scale::around(all.chain(ends.flatten()), 5);
        let parts = self.groups.iter().map(|g| g.violins.len()).max().unwrap_or(0);
        let label = self.baseline.as_deref().map_or(0.0, |label| text_width(label) + 6.0).clamp(14.0, 130.0);
        let names = self.groups.iter().map(|g| g.name.as_str()).collect();
        let places = Places::new(names, parts, PLACE.0, (left_margin(&scale), label));
        let (top, bottom) = (22.0, 22.0 + HEIGHT);
        let frame = Frame {
            width: places.width,
            height: bottom + places.depth(),
            left: places.left,
            right: places.right,
            top,
            bottom,
            inside: (0.0, 0.0),
        };
        let mut content = places.svg(top, bottom);
        if let Some(name) = &self.baseline {
            let y = frame.y(&scale, 0.0);
            let _ = write!(
                content,
                r#"<g class="zero"><path d="M{:.1} {y:.1}H{:.1}"/><text x="{:.1}" y="{:.1}">{}</text></g>"#,
                frame.left,
                frame.right,
                frame.right + 4.0,
                y + 4.0,
                escape(&super::frame::shortened(name, label - 4.0))
            );
        }
        for (g, (group, sorted)) in self.groups.iter().zip(&groups).enumerate() {
            for (i, (violin, values)) in group.violins.iter().zip(sorted).enumerate() {
                let method = methods.iter().position(|name| *name == violin.name).unwrap_or(0);
                let one = Drawn {
                    method,
                    name: format!("{}, {}", escape(&group.name), escape(&violin.name)),
                    values,
                    bandwidth: bandwidth(values, narrowest),
                    x: places.part_centre(g, i, group.violins.len()),
                    half: 0.5 * PLACE.1 * places.part,
                };
                one.svg(&mut content, &frame, &scale);
            }
        }
        let entries = methods.iter().enumerate().map(|(i, name)| {
            let colour = colour(i);
            let drawing = format!(
                r#"<path class="violin series{colour} series{colour}-line" d="M.5 .5h13v13h-13z"/><path class="median series{colour}-line" d="{}"/>"#,
                mark(i, 7.0, 7.0)
            );
            (drawing, *name)
        });
        frame.svg(&self.title, &self.y_title, &scale, &content) + &legend(14, entries)
    }
}

/// A violin with its place.
struct Drawn<'a> {
    method: usize,
    /// Group and method, escaped.
    name: String,
    /// Finite and sorted.
    values: &'a [f64],
    bandwidth: f64,
    x: f64,
    /// Half of the greatest width.
    half: f64,
}

impl Drawn<'_> {
    fn svg(&self, out: &mut String, frame: &Frame, scale: &Scale) {
        let (Some(low), Some(high)) = (self.values.first(), self.values.last()) else {
            let _ = write!(
                out,
                r#"<text text-anchor="middle" x="{:.1}" y="{:.1}">{NOTHING}<title>{}: no values</title></text>"#,
                self.x,
                frame.bottom - 5.0,
                self.name
            );
            return;
        };
        let (low, high) = (low - 2.0 * self.bandwidth, high + 2.0 * self.bandwidth);
        // Three heights a kernel, so that none falls between two of them.
        let steps = (3.0 * (high - low) / self.bandwidth).ceil().clamp(12.0, 400.0) as usize;
        let heights: Vec<f64> = (0..=steps).map(|i| low + (high - low) * i as f64 / steps as f64).collect();
        let densities: Vec<f64> = heights.iter().map(|&height| self.density(height)).collect();
        let densest = densities.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let colour = colour(self.method);
        let _ = write!(out, r#"<g><path class="violin series{colour} series{colour}-line" d="M"#);
        let right = heights.iter().zip(&densities).map(|(h, d)| (h, d / densest));
        let left = heights.iter().zip(&densities).rev().map(|(h, d)| (h, -d / densest));
        for (i, (height, width)) in right.chain(left).enumerate() {
            let (x, y) = (self.x + self.half * width, frame.y(scale, *height));
            let _ = write!(out, "{}{x:.1} {y:.1}", if i == 0 { "" } else { "L" });
        }
        let count = self.values.len();
        let _ = write!(out, r#"z"><title>{}: {}</title></path>"#, self.name, crate::page::text::count(count));
        let ys: Vec<f64> = self.values.iter().map(|&value| frame.y(scale, value)).collect();
        let rooms = self.values.iter().map(|&v| self.half * (self.density(v) / densest).min(1.0));
        for ((value, x), y) in self.values.iter().zip(swarm(&ys, rooms)).zip(&ys) {
            let _ = write!(
                out,
                r#"<circle class="dot series{colour}" cx="{:.1}" cy="{y:.1}" r="{DOT}"><title>{}: {}</title></circle>"#,
                self.x + x,
                self.name,
                figures(*value, 4)
            );
        }
        let median = quantile(self.values, 0.5);
        let _ = write!(
            out,
            r#"<path class="median series{colour}-line" d="{}"><title>{}: median {}</title></path></g>"#,
            mark(self.method, self.x, frame.y(scale, median)),
            self.name,
            figures(median, 4)
        );
    }

    /// Sum of the kernels at a height, not normalised.
    fn density(&self, height: f64) -> f64 {
        self.values.iter().map(|value| (-0.5 * ((height - value) / self.bandwidth).powi(2)).exp()).sum()
    }
}

/// Sideways places of dots at heights in order, each with its room to either side: the
/// nearest to the middle that no earlier dot has.
fn swarm(ys: &[f64], rooms: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::with_capacity(ys.len());
    for (i, room) in rooms.enumerate() {
        let room = (room - DOT).max(0.0);
        let free = |x: f64| {
            // Among thousands it is enough not to hide the last few.
            let near = (i.saturating_sub(40)..i).rev().take_while(|&j| (ys[j] - ys[i]).abs() < 2.0 * DOT);
            near.into_iter().all(|j| (ys[j] - ys[i]).hypot(out[j] - x) >= 2.0 * DOT)
        };
        let steps = (1..=(room / DOT) as usize).flat_map(|k| [k as f64 * DOT, k as f64 * -DOT]);
        let x = std::iter::once(0.0).chain(steps).find(|&x| free(x)).unwrap_or(0.0);
        out.push(x);
    }
    out
}

/// The finite values in order.
fn sorted(values: &[f64]) -> Vec<f64> {
    let finite = values.iter().filter(|v| v.is_finite()).map(|v| v.clamp(-FARTHEST, FARTHEST));
    let mut out: Vec<f64> = finite.collect();
    out.sort_by(f64::total_cmp);
    out
}

/// Silverman's rule.
fn bandwidth(sorted: &[f64], narrowest: f64) -> f64 {
    let count = sorted.len().max(1) as f64;
    let mean = sorted.iter().sum::<f64>() / count;
    let squares: f64 = sorted.iter().map(|value| (value - mean).powi(2)).sum();
    let deviation = (squares / (count - 1.0).max(1.0)).sqrt();
    let quartiles = (quantile(sorted, 0.75) - quantile(sorted, 0.25)) / 1.34;
    // More than half of the values may be equal though not all are.
    let spread = if quartiles > 0.0 { deviation.min(quartiles) } else { deviation };
    (0.9 * spread * count.powf(-0.2)).max(narrowest)
}

/// Linear between the values; 0 of none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let at = |place: f64| sorted.get(place as usize).copied().unwrap_or(0.0);
    at(place.floor()) + (at(place.ceil()) - at(place.floor())) * place.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(all: &[Vec<f64>]) -> ViolinChart {
        let violin =
            |(i, values): (usize, &Vec<f64>)| Violin { name: format!("m{i}"), values: values.clone() };
        let group = |name: &str| ViolinGroup {
            name: name.into(),
            violins: all.iter().enumerate().map(violin).collect(),
        };
        ViolinChart {
            title: "t".into(),
            y_title: "dB".into(),
            groups: vec![group("a"), group("b")],
            baseline: Some("the baseline".into()),
        }
    }

    /// Protects medians of odd and even counts, in any order.
    #[test]
    fn medians_are_right() {
        for (values, median) in
            [(vec![7.0], 7.0), (vec![3.0, 1.0], 2.0), (vec![5.0, 1.0, 2.0, f64::NAN], 2.0)]
        {
            assert_eq!(quantile(&sorted(&values), 0.5), median);
            assert!(chart(&[values]).html().contains(&format!("b, m0: median {median}<")));
        }
    }

    /// Protects against too few values, equal ones, and ones that are no numbers.
    #[test]
    fn odd_values_stay_finite() {
        let odd = [f64::NAN, f64::INFINITY, f64::MAX, f64::MIN, 5e-324];
        let many: Vec<f64> = (0..26).map(|i| (f64::from(i) * 1.7).sin()).collect();
        let sets = [vec![], vec![1.0], vec![1.0, 2.0], vec![0.3; 4], many, odd.to_vec(), vec![0.0; 2]];
        let mut charts: Vec<ViolinChart> = sets.iter().map(|set| chart(std::slice::from_ref(set))).collect();
        charts.extend([chart(&sets), chart(&[]), ViolinChart::default()]);
        for chart in &mut charts {
            for baseline in [Some("0".to_string()), None] {
                chart.baseline = baseline;
                let html = chart.html();
                assert!(!html.contains("NaN") && !html.contains("inf"), "{html}");
                assert_eq!(html, chart.html());
            }
        }
        let html = chart(&sets[..5]).html();
        assert_eq!(html.matches("<circle").count(), 2 * (1 + 2 + 4 + 26));
        assert_eq!(html.matches("no values").count(), 2);
    }

    /// Protects the page from names that look like HTML.
    #[test]
    fn names_are_escaped() {
        let violins = vec![
            Violin { name: "<v>".into(), values: vec![1.0] },
            Violin { name: "<w>".into(), values: vec![] },
        ];
        let groups = vec![ViolinGroup { name: "<g>".into(), violins }];
        let html =
            ViolinChart { title: "<t>".into(), y_title: "<y>".into(), groups, baseline: Some("<b>".into()) }
                .html();
        for tag in ["<v>", "<w>", "<t>", "<y>", "<b>"] {
            assert!(!html.contains(tag), "{html}");
        }
        assert!(!html.contains("<g>&") && html.contains("&lt;g&gt;, &lt;v&gt;: 1<"), "{html}");
    }

    /// Protects comparisons across groups: a method has one colour and one entry.
    #[test]
    fn methods_keep_their_colour() {
        let mut chart = chart(&[vec![1.0], vec![2.0]]);
        chart.groups[1].violins.remove(0);
        let html = chart.html();
        assert_eq!(html.matches("<li>").count(), 2);
        assert!(
            html.contains(r#"class="dot series1" cx="#)
                && html.matches(r#"class="dot series1""#).count() == 2
        );
        assert_eq!(html.matches(r#"class="dot series0""#).count(), 1);
    }

    /// Protects the shape: the violin is widest where most values are.
    #[test]
    fn densities_follow_the_values() {
        let values = sorted(&[0.0, 0.1, 0.2, 0.1, 5.0]);
        let one = Drawn {
            method: 0,
            name: String::new(),
            values: &values,
            bandwidth: bandwidth(&values, 0.05),
            x: 0.0,
            half: 10.0,
        };
        assert!(one.density(0.1) > 2.0 * one.density(5.0) && one.density(2.5) < 0.01);
        assert_eq!(bandwidth(&[0.3; 9], 0.05), 0.05);
    }

    /// Protects dots from hiding each other where there is room.
    #[test]
    fn equal_values_stand_side_by_side() {
        let xs = swarm(&[9.0; 3], [20.0; 3].into_iter());
        assert!(xs[0] == 0.0 && xs[1] >= 2.0 * DOT && xs[2] <= -2.0 * DOT, "{xs:?}");
    }
}
