//! Each compared view's decibels before and after, on the first of the backgrounds,
//! so that no bad view hides behind a mean.

use crate::page::Axes;
use crate::page::text::{change, decimal};
use parbake::Comparison;
use std::fmt::Write;

/// The chart with its legend.
pub fn view_chart(compared: &Comparison) -> String {
    let pairs: Vec<(f64, f64)> =
        compared.backgrounds[0].views.iter().map(|v| (v.ray_cast.psnr, v.baked.psnr)).collect();
    // A free place at either end keeps the marks off the frame.
    let axes = Axes::new(pairs.len() + 1, pairs.iter().flat_map(|&(a, b)| [a, b]));
    let mut content = String::new();
    for (i, &(before, after)) in pairs.iter().enumerate() {
        let (x, from, to) = (axes.x(i + 1), axes.y(before), axes.y(after));
        let _ = write!(
            content,
            concat!(
                r#"<g><title>view {}: {} dB ray-cast, {} dB baked ({} dB)</title>"#,
                r#"<path class="gain" d="M{:.1} {:.1}V{:.1}"/><circle class="ring" cx="{:.1}" cy="{:.1}" r="5.5"/>"#,
                r#"<circle class="baked" cx="{:.1}" cy="{:.1}" r="4"/></g>"#
            ),
            i + 1,
            decimal(before, 2),
            decimal(after, 2),
            change(after - before, 2),
            x,
            from,
            to,
            x,
            from,
            x,
            to
        );
    }
    let labels: Vec<String> =
        (0..=pairs.len()).map(|i| if i == 0 { String::new() } else { i.to_string() }).collect();
    axes.svg("PSNR of each view before and after", ("view", "dB"), &labels, &content)
        + concat!(
            r#"<ul class="legend"><li><svg viewBox="0 0 14 14" aria-hidden="true"><circle class="ring" cx="7" cy="7" r="5.5"/></svg>ray-cast</li>"#,
            r#"<li><svg viewBox="0 0 14 14" aria-hidden="true"><circle class="baked" cx="7" cy="7" r="4"/></svg>baked</li></ul>"#
        )
}
