//! The channels of a whole material on the page: for each a row of pictures of the front and its figures.

use super::pictures::{AMPLIFIED, PIXELS, SUPERSAMPLE, front};
use super::scenes::Scenes;
use crate::page::text::{NOTHING, change, decimal, escape, verdict};
use crate::page::{amplified_difference, embed_rgb};
use parbake::{BakeError, Channel, Comparison, PlacedModel, Renderer};
use parbake_metric::Rgb;
use parbake_render::camera::Camera;
use rayon::prelude::*;
use std::fmt::Write;

/// What lies behind the models, display-referred: that of the page's other pictures.
const GREY: f32 = 0.22;

/// What the figures of channels are, for who reads them.
pub(crate) const MEANING: &str = "What each map holds where a camera looks. PSNR is that of pixels that both models cover; of opacity, \
                                  which is their coverage, of pixels that either covers. FLIP is for colours.";

/// The pictures of a channel.
pub struct ChannelRow {
    channel: Channel,
    high: Rgb,
    low: Rgb,
    difference: Rgb,
}

/// Renders the front of high-poly and result, channel by channel.
pub fn rows(scenes: &Scenes, compared: &Comparison) -> Vec<ChannelRow> {
    let channels: Vec<Channel> = compared.channels.iter().map(|on| on.channel).collect();
    rows_of(&scenes.renderer, [&scenes.high, &scenes.baked], &front(&scenes.all()), &channels)
}

/// The same of any two models, the high-poly first, as a camera sees them.
pub(crate) fn rows_of(
    renderer: &Renderer,
    models: [&PlacedModel; 2],
    camera: &Camera,
    channels: &[Channel],
) -> Vec<ChannelRow> {
    if channels.is_empty() {
        return Vec::new();
    }
    let [high, low] = models.map(|model| renderer.render_from(model, camera, (PIXELS, SUPERSAMPLE), true));
    let row = |&channel: &Channel| {
        let ([a, b], _) = channel.pair(&high, &low);
        ChannelRow {
            channel,
            high: channel.picture(&high, GREY),
            low: channel.picture(&low, GREY),
            difference: amplified_difference(&a, &b, AMPLIFIED),
        }
    };
    channels.par_iter().map(row).collect()
}

/// The figures of all channels, ray-cast and baked, and the pictures below them.
pub fn channels(compared: &Comparison, rows: &[ChannelRow]) -> Result<String, BakeError> {
    Ok(table(compared) + &pictures(rows, "baked")?)
}

/// The pictures of all channels; `low` is what the compared model is called.
pub(crate) fn pictures(rows: &[ChannelRow], low: &str) -> Result<String, BakeError> {
    let rows: Result<Vec<String>, BakeError> = rows.par_iter().map(|row| pictures_of(row, low)).collect();
    Ok(rows?.concat())
}

fn table(compared: &Comparison) -> String {
    let mut out = String::from(concat!(
        r#"<table class="figures"><thead><tr><th scope="col">channel</th><th scope="col">PSNR, ray-cast</th>"#,
        r#"<th scope="col">baked</th><th scope="col">change</th><th scope="col">MS-SSIM, ray-cast</th>"#,
        r#"<th scope="col">baked</th><th scope="col">FLIP, ray-cast</th><th scope="col">baked</th></tr></thead><tbody>"#
    ));
    for on in &compared.channels {
        let (before, after) = (on.mean.ray_cast, on.mean.baked);
        let text = |x: Option<f64>| x.map_or(NOTHING.into(), |x| decimal(x, 4));
        let _ = write!(
            out,
            concat!(
                r#"<tr><th scope="row">{}</th><td>{}</td><td>{}</td><td class="{}">{}</td>"#,
                "<td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>"
            ),
            on.channel.label(),
            decimal(before.psnr, 2),
            decimal(after.psnr, 2),
            verdict(after.psnr - before.psnr, 2, true),
            change(after.psnr - before.psnr, 2),
            text(before.ms_ssim),
            text(after.ms_ssim),
            text(before.flip),
            text(after.flip)
        );
    }
    out + "</tbody></table>"
}

fn pictures_of(row: &ChannelRow, low: &str) -> Result<String, BakeError> {
    let name = row.channel.label();
    let figure = |what: &str, picture: &Rgb| {
        let address = embed_rgb(what, picture)?.address;
        Ok::<_, BakeError>(format!(
            concat!(
                r#"<figure><div class="frame"><img src="{}" width="{}" height="{}" alt="{}"></div>"#,
                "<figcaption>{}</figcaption></figure>"
            ),
            address,
            PIXELS,
            PIXELS,
            escape(&format!("{name}, {what}")),
            escape(what)
        ))
    };
    Ok(format!(
        r#"<section class="side"><h3>{name}</h3><div class="pictures channel">{}{}{}</div></section>"#,
        figure("high-poly", &row.high)?,
        figure(low, &row.low)?,
        figure(&format!("{low} − high, ×{AMPLIFIED}"), &row.difference)?
    ))
}
