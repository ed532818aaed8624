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
    let row = |(index, side): (usize, &Side)| {
        let gain = format!("{} dB", change(side.baked_psnr - side.ray_cast_psnr, 2));
        let beside = [
            Beside {
                what: "ray-cast",
                picture: &side.ray_cast,
                difference: &side.ray_cast_difference,
                psnr: side.ray_cast_psnr,
            },
            Beside {
                what: "baked",
                picture: &side.baked,
                difference: &side.baked_difference,
                psnr: side.baked_psnr,
            },
        ];
        row(index, (&side.name, &gain), &side.high, &beside)
    };
    let rows: Result<Vec<String>, BakeError> = sides.par_iter().enumerate().map(row).collect();
    Ok(rows?.concat())
}

/// A picture beside the high-poly's.
pub(crate) struct Beside<'a> {
    /// What it shows.
    pub what: &'static str,
    /// The picture.
    pub picture: &'a Rgb,
    /// Its difference from the high-poly's, amplified.
    pub difference: &'a Rgb,
    /// PSNR in dB.
    pub psnr: f64,
}

/// A row: the high-poly, the pictures beside it, and their differences. `index` is another one for each row of a page; names may hold
/// anything.
pub(crate) fn row(
    index: usize,
    (name, small): (&str, &str),
    high: &Rgb,
    beside: &[Beside],
) -> Result<String, BakeError> {
    let name = &escape(name);
    // The high-poly's picture stands in the file once and is drawn again where others are pointed at.
    let high = format!(
        concat!(
            r#"<figure class="high"><div class="frame"><svg viewBox="0 0 {pixels} {pixels}" role="img" "#,
            r#"aria-label="high-poly, {name}"><image id="high{index}" width="{pixels}" height="{pixels}" "#,
            r#"href="{data}"/></svg></div><figcaption>high-poly</figcaption></figure>"#
        ),
        pixels = PIXELS,
        name = name,
        index = index,
        data = embed_rgb("high-poly", high)?.address
    );
    let shown = |low: &Beside| {
        Ok::<_, BakeError>(format!(
            concat!(
                r#"<figure class="flicker" tabindex="0"><div class="frame">{img}"#,
                r##"<svg viewBox="0 0 {pixels} {pixels}" aria-hidden="true"><use href="#high{index}"/></svg></div>"##,
                r#"<figcaption>{what} <b>{psnr} dB</b></figcaption></figure>"#
            ),
            img = img(low.what, low.picture, &format!("{}, {name}", low.what))?,
            pixels = PIXELS,
            index = index,
            what = low.what,
            psnr = decimal(low.psnr, 2),
        ))
    };
    let difference = |low: &Beside| {
        let alt = format!("difference of {} and high-poly, {name}", low.what);
        Ok::<_, BakeError>(format!(
            r#"<figure><div class="frame">{}</div><figcaption>{} − high, ×{AMPLIFIED}</figcaption></figure>"#,
            img(low.what, low.difference, &alt)?,
            low.what
        ))
    };
    let figures: Result<Vec<String>, BakeError> =
        beside.iter().map(shown).chain(beside.iter().map(difference)).collect();
    let columns = if beside.len() == 1 { " channel" } else { "" };
    Ok(format!(
        r#"<section class="side"><h3>{name} <small>{}</small></h3><div class="pictures{columns}">{high}{}</div></section>"#,
        escape(small),
        figures?.concat()
    ))
}

fn img(what: &str, picture: &Rgb, alt: &str) -> Result<String, BakeError> {
    let address = embed_rgb(what, picture)?.address;
    Ok(format!(r#"<img src="{address}" width="{PIXELS}" height="{PIXELS}" alt="{alt}">"#))
}
