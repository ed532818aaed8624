//! The page: its head, what is most important, its sections in order.

use super::channels::{ChannelRow, MEANING, channels};
use super::gallery::gallery;
use super::loss_curve::loss_curve;
use super::model_view::{SCRIPT, model_view};
use super::pictures::{AMPLIFIED, Side};
use super::settings::settings;
use super::tables;
use super::textures::textures;
use super::uv_check::uv_check;
use super::uv_moves::uv_moves;
use super::view_chart::view_chart;
use crate::page::text::{bytes, change, count, decimal, duration, escape, model_name, verdict};
use crate::page::{document_with_script, section};
use parbake::BakeError;
use parbake::BakeReport;
use parbake::{Baked, BeforeAndAfter, Comparison, Parallax, Shading};
use parbake_model::Model;
use std::fmt::Write;

/// Puts everything together.
pub fn page(
    high: &Model,
    baked: &Baked,
    compared: &Comparison,
    sides: &[Side],
    rows: &[ChannelRow],
) -> Result<String, BakeError> {
    let report = &baked.report;
    let name = model_name(&baked.model.name);
    let mut out = header(&name, high, report, compared);
    out += &notes(report, compared);
    section(
        &mut out,
        "looks",
        "Before and after",
        &format!(
            "Ray-cast is {}, baked is the result. Point at a picture, or tap it, to see \
             the high-poly in its place. Differences are those of the values on screen, {AMPLIFIED} times as strong. \
             The decibels are PSNR of these very pictures, on dark grey. {}",
            report.start(),
            lighting(compared.shading)
        ),
        &gallery(sides)?,
    );
    section(
        &mut out,
        "model",
        "The model",
        &format!(
            "Drag to turn it. Click it, then use the wheel, the arrow keys, + and − to come closer; two fingers do so, too. \
             Light comes from a room. Maps have 1024 texels along a side at most here.{}",
            match report.options.parallax {
                Parallax::Sh => " Maps of spherical harmonics are not shown.",
                Parallax::None | Parallax::Tangent => "",
            }
        ),
        &model_view(&baked.model)?,
    );
    section(
        &mut out,
        "figures",
        "Figures",
        "",
        &format!(
            r#"<div class="pair"><div>{}</div><div><h3>Each view, on {}</h3>{}</div></div>"#,
            tables::figures(compared),
            compared.options.background,
            view_chart(compared)
        ),
    );
    if !compared.channels.is_empty() {
        section(&mut out, "channels", "Channel by channel", MEANING, &channels(compared, rows)?);
    }
    section(
        &mut out,
        "textures",
        "Textures",
        "",
        &format!(
            r#"{}<div class="pair"><div><h3>Texture layout</h3>{}</div><div><h3>Texels</h3>{}{}</div></div>"#,
            textures(&baked.model, "borders")?,
            uv_check(&report.uv),
            tables::texels(report),
            uv_moves(baked.uv_moves.as_ref())?
        ),
    );
    if let Some(written) = &report.written {
        section(
            &mut out,
            "file",
            "The file",
            "Size of each part, and what its format lost. PSNR compares a texture as readers decode it with the baked one, \
             over all channels. Figures and pictures above are of the bake before it was compressed.",
            &tables::written(written),
        );
    }
    section(
        &mut out,
        "run",
        "The run",
        "",
        &format!(
            concat!(
                r#"<div class="pair"><div><h3>Agreement with the training views</h3>{}</div>"#,
                r#"<div><h3>Times</h3>{}</div></div><h3>Settings</h3>{}"#
            ),
            loss_curve(&report.losses),
            tables::stages(report),
            settings(&report.options, report.work, &report.used())
        ),
    );
    Ok(document_with_script(&name, &out, SCRIPT))
}

/// How pictures and figures are lit.
pub(crate) fn lighting(shading: Shading) -> &'static str {
    match shading {
        Shading::Pbr => {
            "The whole material is shown, under a built-in light: a room with soft lamps, and one far away."
        }
        _ => "Light comes from the camera, on matte surfaces.",
    }
}

/// Name, headline figures and facts.
fn header(name: &str, high: &Model, report: &BakeReport, compared: &Comparison) -> String {
    let mut out =
        format!(r#"<header><p class="kicker">Parbake report</p><h1>{name}</h1><div class="headline">"#);
    for on in &compared.backgrounds {
        let (before, after) = (on.mean.ray_cast.psnr, on.mean.baked.psnr);
        let _ = write!(
            out,
            concat!(
                r#"<div><p class="where"><i class="{background}"></i>PSNR on {background}</p>"#,
                r#"<p class="numbers"><span class="before">{before}</span> → <span class="after">{after}</span> dB</p>"#,
                r#"<p class="gain"><span class="{verdict}">{gain} dB</span> <small>ray-cast → baked</small></p></div>"#
            ),
            background = on.background,
            before = decimal(before, 2),
            after = decimal(after, 2),
            verdict = verdict(after - before, 2, true),
            gain = change(after - before, 2)
        );
    }
    out += r#"</div><dl class="facts">"#;
    let high_name = match high.name.trim() {
        "" => String::new(),
        name => format!(" <small>({})</small>", escape(name)),
    };
    let size = report.options.texture_size;
    let mut facts = vec![
        ("high-poly", format!("{} triangles{high_name}", count(report.high_triangles))),
        ("low-poly", format!("{} triangles", count(report.low_triangles))),
        ("textures", format!("{size} × {size}")),
        ("training", format!("{} views, {} samples", count(report.views), count(report.samples))),
        ("baked in", duration(tables::total_seconds(report))),
    ];
    if let Some(shape) = report.shape.as_ref().filter(|shape| shape.moved[1] > 0.0) {
        let [mean, most] = shape.moved.map(|share| 100.0 * f64::from(share));
        facts.push(("vertices", format!("moved {mean:.2} % of the length, {most:.2} % at most")));
    }
    if let Some([before, after]) = report.parallax_maps.as_ref().and_then(|depth| depth.misplaced) {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        facts.push(("outline", format!("{} → {} of its pixels wrong", percent(before), percent(after))));
    }
    if report.parallax_maps.is_some() {
        let options = &report.options;
        let kind = match options.parallax {
            Parallax::Sh => format!("harmonics of order {}", options.parallax_order),
            _ => "tangent frame".into(),
        };
        facts.push(("parallax", format!("{kind}, {}²", options.parallax_size)));
    }
    if let Some(fallback) = &report.fallback {
        let textures =
            fallback.side.map_or("the maps' textures".into(), |side| format!("textures of {side} × {side}"));
        facts.push(("viewers without the maps show", textures));
    }
    if let Some(peak) = report.peak_memory {
        facts.push(("peak memory", bytes(peak)));
    }
    for (term, fact) in facts {
        let _ = write!(out, "<div><dt>{term}</dt><dd>{fact}</dd></div>");
    }
    out + "</dl></header>"
}

/// What a reader must not miss.
fn notes(report: &BakeReport, compared: &Comparison) -> String {
    let mut notes: Vec<String> = report.warnings.iter().map(|w| escape(w)).collect();
    if report.stopped_early {
        notes.push("The run was stopped early; this is the best state it had reached.".into());
    }
    let is_worse = |mean: &BeforeAndAfter| verdict(mean.baked.psnr - mean.ray_cast.psnr, 2, true) == "worse";
    let backgrounds = compared.backgrounds.iter();
    let worse: Vec<&str> =
        backgrounds.filter(|on| is_worse(&on.mean)).map(|on| on.background.as_str()).collect();
    if worse.len() == compared.backgrounds.len() {
        notes.push(
            "The baked textures measure below those of a ray-cast bake. That happens where training views are too few for \
             the textures' size: try more <code>--views</code>, a slower <code>--preset</code> or a smaller \
             <code>--texture-size</code>."
                .into(),
        );
    } else if !worse.is_empty() {
        let advice = if report.options.silhouette_weight() > 0.0 {
            " Where the low-poly reaches beyond the high-poly's outline it was fitted to another background; a lower \
             <code>--silhouette</code> treats all backgrounds more alike."
        } else {
            ""
        };
        notes.push(format!(
            "On {} the baked textures measure below those of a ray-cast bake.{advice}",
            worse.join(" and ")
        ));
    }
    if notes.is_empty() {
        return String::new();
    }
    format!(r#"<ul class="notes"><li>{}</li></ul>"#, notes.join("</li><li>"))
}
