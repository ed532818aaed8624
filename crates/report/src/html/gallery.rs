//! The pictures on the page: for each side the high-poly, both textures, and what is
//! left between them. Pointing at a picture (or tapping, or moving the focus there)
//! shows the high-poly in its place: the eye finds differences best in a flicker.

use super::pictures::{AMPLIFIED, PIXELS, Side};
use crate::page::embed_rgb;
use crate::page::text::{change, decimal, escape};
use parbake::BakeError;
use parbake_metric::Rgb;
use rayon::prelude::*;

/// All sides, one below the other.
pub fn gallery(sides: &[Side]) -> Result<String, BakeError> {
    let rows: Result<Vec<String>, BakeError> =
        sides.par_iter().enumerate().map(|(index, side)| row(index, side)).collect();
    Ok(rows?.concat())
}

fn row(index: usize, side: &Side) -> Result<String, BakeError> {
    let data = |what: &str, picture: &Rgb| Ok::<_, BakeError>(embed_rgb(what, picture)?.address);
    let name = escape(&side.name);
    // The high-poly's picture stands in the file once and is drawn three times.
    let high = format!(
        concat!(
            r#"<figure class="high"><div class="frame"><svg viewBox="0 0 {pixels} {pixels}" role="img" "#,
            r#"aria-label="high-poly, {name}"><image id="high{index}" width="{pixels}" height="{pixels}" "#,
            r#"href="{data}"/></svg></div><figcaption>high-poly</figcaption></figure>"#
        ),
        pixels = PIXELS,
        name = name,
        index = index,
        data = data("high-poly", &side.high)?
    );
    let low = |what: &str, picture: &Rgb, psnr: f64| {
        Ok::<_, BakeError>(format!(
            concat!(
                r#"<figure class="flicker" tabindex="0"><div class="frame">{img}"#,
                r##"<svg viewBox="0 0 {pixels} {pixels}" aria-hidden="true"><use href="#high{index}"/></svg></div>"##,
                r#"<figcaption>{what} <b>{psnr} dB</b></figcaption></figure>"#
            ),
            img = img(&data(what, picture)?, &format!("{what}, {name}")),
            pixels = PIXELS,
            index = index,
            what = what,
            psnr = decimal(psnr, 2),
        ))
    };
    let difference = |what: &str, picture: &Rgb| {
        Ok::<_, BakeError>(format!(
            r#"<figure><div class="frame">{}</div><figcaption>{what} − high, ×{AMPLIFIED}</figcaption></figure>"#,
            img(&data(what, picture)?, &format!("difference of {what} and high-poly, {name}"))
        ))
    };
    Ok(format!(
        r#"<section class="side"><h3>{name} <small>{} dB</small></h3><div class="pictures">{high}{}{}{}{}</div></section>"#,
        change(side.baked_psnr - side.ray_cast_psnr, 2),
        low("ray-cast", &side.ray_cast, side.ray_cast_psnr)?,
        low("baked", &side.baked, side.baked_psnr)?,
        difference("ray-cast", &side.ray_cast_difference)?,
        difference("baked", &side.baked_difference)?,
    ))
}

fn img(address: &str, alt: &str) -> String {
    format!(r#"<img src="{address}" width="{PIXELS}" height="{PIXELS}" alt="{alt}">"#)
}
