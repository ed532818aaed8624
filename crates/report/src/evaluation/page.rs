//! The page of a comparison: what is most important, then pictures, then tables.

use super::views::ShownView;
use crate::html::channels::{ChannelRow, MEANING, pictures};
use crate::html::flags;
use crate::html::gallery::{Beside, row};
use crate::html::page::lighting;
use crate::html::pictures::{AMPLIFIED, PIXELS};
use crate::page::text::{NOTHING, count, decimal, escape, model_name};
use crate::page::{Axes, document, section};
use parbake::{BakeError, EvaluateOptions, Evaluation, ViewFigures};
use parbake_model::Model;
use std::fmt::Write;

/// What the model that is compared is called.
const LOW: &str = "low-poly";

/// Puts everything together; `resolution` is that of the views' pictures.
pub fn page(
    models: [&Model; 2],
    evaluation: &Evaluation,
    resolution: usize,
    shown: &[ShownView],
    rows: &[ChannelRow],
) -> Result<String, BakeError> {
    let [high, low] = models.map(|model| model_name(&model.name));
    let title = match low == high {
        true => format!("{high}: {LOW} beside high-poly"),
        false => format!("{low} beside {high}"),
    };
    let mut out = header(&title, models, evaluation);
    let measured = evaluation.options.resolution;
    let how = if resolution == measured {
        String::new()
    } else {
        format!(" Pictures here are {resolution} pixels wide, those that were measured {measured}.")
    };
    section(
        &mut out,
        "looks",
        "Views",
        &format!(
            "The views in which both differ most come first. Point at a low-poly's picture, or tap it, to see the high-poly \
             in its place. Differences are those of the values on screen, {AMPLIFIED} times as strong. {}{how}",
            lighting(evaluation.shading)
        ),
        &gallery(shown, resolution)?,
    );
    section(
        &mut out,
        "figures",
        "PSNR of each view",
        "",
        &(chart(&evaluation.views) + &again(&evaluation.options)),
    );
    if !evaluation.channels.is_empty() {
        section(
            &mut out,
            "channels",
            "Channel by channel",
            &format!("{MEANING} The pictures are of the front."),
            &(channels(evaluation) + &pictures(rows, LOW)?),
        );
    }
    Ok(document(&title, &out))
}

/// Name, headline figures and facts.
fn header(title: &str, models: [&Model; 2], evaluation: &Evaluation) -> String {
    let background = escape(&evaluation.options.background);
    let least = evaluation.views.iter().map(|view| view.psnr).fold(f64::INFINITY, f64::min);
    let mut out = format!(
        concat!(
            r#"<header><p class="kicker">Parbake comparison</p><h1>{title}</h1><div class="headline">"#,
            r#"<div><p class="where"><i class="{background}"></i>PSNR on {background}</p>"#,
            r#"<p class="numbers"><span class="after">{mean}</span> dB</p><p>{least} dB in the view that differs most</p></div>"#
        ),
        title = title,
        background = background,
        mean = decimal(evaluation.mean.psnr, 2),
        least = decimal(least, 2)
    );
    let others = [
        ("MS-SSIM, 0 to 1, more is better", evaluation.mean.ms_ssim),
        ("FLIP, 0 to 1, less is better", evaluation.mean.flip),
    ];
    for (what, value) in others {
        let Some(value) = value else { continue };
        let _ = write!(
            out,
            r#"<div><p class="where">{what}</p><p class="numbers"><span class="after">{}</span></p></div>"#,
            decimal(value, 4)
        );
    }
    out += r#"</div><dl class="facts">"#;
    for (what, model) in ["high-poly", LOW].into_iter().zip(models) {
        let texels: usize = model.images.iter().map(|image| image.width * image.height).sum();
        let _ = write!(
            out,
            "<div><dt>{what}</dt><dd>{} triangles, {} <small>({})</small></dd></div>",
            count(model.mesh.triangles.len()),
            textures(model.images.len(), texels),
            model_name(&model.name)
        );
    }
    out + "</dl></header>"
}

fn textures(images: usize, texels: usize) -> String {
    match images {
        0 => "no textures".into(),
        1 => format!("1 texture of {} texels", count(texels)),
        _ => format!("{} textures of {} texels", count(images), count(texels)),
    }
}

/// All views that are shown, one below the other.
fn gallery(shown: &[ShownView], resolution: usize) -> Result<String, BakeError> {
    let mut out = String::new();
    for (index, view) in shown.iter().enumerate() {
        let low = Beside { what: LOW, picture: &view.low, difference: &view.difference, psnr: view.psnr };
        out += &row(index, (&view.name, ""), &view.high, &[low])?;
    }
    // Of small pictures each pixel is to be seen.
    Ok(match 2 * resolution <= PIXELS {
        true => format!(r#"<div class="pixels">{out}</div>"#),
        false => out,
    })
}

/// What all figures are of, and how to get them again.
fn again(options: &EvaluateOptions) -> String {
    // As it can be typed.
    let options = EvaluateOptions { background: options.background.replace(' ', ""), ..options.clone() };
    format!(
        concat!(
            r#"<p class="note">The figures at the top are means over {} views around the model, {} pixels wide. "#,
            "The same by <code>parbake eval HIGH LOW{}</code>.</p>"
        ),
        options.views,
        options.resolution,
        flags(&options, &EvaluateOptions::default())
    )
}

/// A mark for each view.
fn chart(views: &[ViewFigures]) -> String {
    // A free place at either end keeps the marks off the frame.
    let axes = Axes::new(views.len() + 1, views.iter().map(|view| view.psnr));
    let mut content = String::new();
    for (i, view) in views.iter().enumerate() {
        let _ = write!(
            content,
            r#"<g><title>view {}: {} dB</title><circle class="baked" cx="{:.1}" cy="{:.1}" r="4"/></g>"#,
            i + 1,
            decimal(view.psnr, 2),
            axes.x(i + 1),
            axes.y(view.psnr)
        );
    }
    let label = |i: usize| if i == 0 { String::new() } else { i.to_string() };
    let labels: Vec<String> = (0..=views.len()).map(label).collect();
    axes.svg("PSNR of each view", ("view", "dB"), &labels, &content)
}

/// The figures of each channel.
fn channels(evaluation: &Evaluation) -> String {
    let mut out = String::from(concat!(
        r#"<table class="numbers-table"><thead><tr><th scope="col">channel</th><th scope="col">PSNR</th>"#,
        r#"<th scope="col">MS-SSIM</th><th scope="col">FLIP</th></tr></thead><tbody>"#
    ));
    for of in &evaluation.channels {
        let optional = |x: Option<f64>| x.map_or(NOTHING.into(), |x| decimal(x, 4));
        let _ = write!(
            out,
            r#"<tr><th scope="row">{}</th><td>{}</td><td>{}</td><td>{}</td></tr>"#,
            of.channel.label(),
            decimal(of.mean.psnr, 2),
            optional(of.mean.ms_ssim),
            optional(of.mean.flip)
        );
    }
    out + "</tbody></table>"
}
