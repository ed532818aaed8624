//! The baked textures on the page, the colours under the texture layout.
//!
//! Contract: the model's first image is its base colour and its second its normal
//! map, as a bake writes them; what is missing is left out.

use crate::page::text::escape;
use crate::page::{embed, uv_layout};
use parbake::BakeError;
use parbake_model::{Image, Model};

/// Both textures.
pub fn textures(model: &Model) -> Result<String, BakeError> {
    let layout = uv_layout(&model.mesh, "borders");
    let (lines, left_out) = layout.map_or((String::new(), None), |l| (l.svg, l.left_out));
    let mut out = String::new();
    if !lines.is_empty() {
        out += r#"<input type="checkbox" id="lines" checked><label for="lines">show the texture layout's lines</label>"#;
    }
    out += r#"<div class="textures">"#;
    if let Some(image) = model.images.first() {
        out += &texture(image, "base colour", &lines)?;
    }
    if let Some(image) = model.images.get(1) {
        out += &texture(image, "normals, in the low-poly's tangent space", "")?;
    }
    out += "</div>";
    if let Some(note) = left_out {
        out += &format!(r#"<p class="note">{}</p>"#, escape(note));
    }
    Ok(out)
}

fn texture(image: &Image, what: &str, over: &str) -> Result<String, BakeError> {
    let embedded = embed(image)?;
    let reduced = if embedded.width < image.width {
        format!(", shown at {} × {}", embedded.width, embedded.height)
    } else {
        String::new()
    };
    Ok(format!(
        concat!(
            r#"<figure><div class="frame"><img src="{data}" width="{width}" height="{height}" alt="{what}">{over}</div>"#,
            r#"<figcaption>{what}, {full_width} × {full_height}{reduced}</figcaption></figure>"#
        ),
        data = embedded.address,
        width = embedded.width,
        height = embedded.height,
        what = escape(what),
        over = over,
        full_width = image.width,
        full_height = image.height,
        reduced = reduced
    ))
}
