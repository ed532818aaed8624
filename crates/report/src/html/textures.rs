//! The baked textures on the page, the first one under the texture layout.
//!
//! Contract: a bake's materials share their textures, so the first material says what each image is; images that
//! no map of it uses, as those of parallax maps and what viewers without these show, are left out.

use crate::page::text::escape;
use crate::page::{embed, uv_layout};
use parbake::BakeError;
use parbake_image::MapKind;
use parbake_image::material_maps::shifted_texture_slot;
use parbake_model::{Image, Model};

/// What a map is called; of an image that several maps share, each names its channels.
fn name(kind: MapKind) -> &'static str {
    match kind {
        MapKind::BaseColor => "base colour",
        MapKind::Normal => "normals, in the low-poly's tangent space",
        MapKind::MetallicRoughness => "roughness (green), metallic (blue)",
        MapKind::Emissive => "emission",
        MapKind::Occlusion => "occlusion (red)",
    }
}

/// The images that are maps, each once, with their names.
fn maps(model: &Model) -> Vec<(&Image, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let slots = MapKind::ALL.into_iter().filter_map(|kind| {
        let slot = shifted_texture_slot(model.materials.first()?, kind)?;
        Some((kind, slot.image))
    });
    for (kind, image) in slots {
        match found.iter_mut().find(|(own, _)| *own == image) {
            Some((_, names)) => *names = format!("{names}, {}", name(kind)),
            None => found.push((image, name(kind).into())),
        }
    }
    found.into_iter().filter_map(|(image, names)| Some((model.images.get(image)?, names))).collect()
}

/// All textures. `id` names the layout among the page's elements.
pub fn textures(model: &Model, id: &str) -> Result<String, BakeError> {
    let layout = uv_layout(&model.mesh, id);
    let (lines, left_out) = layout.map_or((String::new(), None), |l| (l.svg, l.left_out));
    let mut out = String::new();
    if !lines.is_empty() {
        out += &format!(
            r#"<input type="checkbox" class="lines" id="{id}-lines" checked><label for="{id}-lines">show the texture layout's lines</label>"#
        );
    }
    out += r#"<div class="textures">"#;
    for (index, (image, what)) in maps(model).into_iter().enumerate() {
        out += &texture(image, &what, if index == 0 { &lines } else { "" })?;
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
