//! The model on the page, to be turned: a canvas, the file in base 64, and the script that shows it
//! (`apps/viewer/src/embed.js`, built with three.js into one).
//!
//! Contract: the page's Content-Security-Policy names this script by its hash, and lets no other run. Maps have
//! 1024 texels along a side at most, so that pages can be sent; images that only extensions of materials use stay.

use crate::page::{base64, text::escape};
use parbake::BakeError;
use parbake_files::quick_glb_bytes;
use parbake_image::MapKind;
use parbake_image::material_maps::{shifted_texture_slot, texture_slot};
use parbake_image::reduced::reduced;
use parbake_model::Model;

/// Texels along a side of a texture on the page, at most.
const MOST_TEXELS: usize = 1024;

/// The script.
pub const SCRIPT: &str = include_str!("../../../../apps/viewer/dist/embed.js");

/// The view of a model.
pub fn model_view(model: &Model) -> Result<String, BakeError> {
    let mut data = String::new();
    base64(&quick_glb_bytes(&small(model))?, &mut data);
    Ok(format!(
        concat!(
            r#"<div class="view"><canvas id="view-canvas" tabindex="0" role="img" aria-label="{name}, to be turned"></canvas>"#,
            r#"<p id="view-told" role="status"></p><div id="view-controls">"#,
            r#"<label><input type="checkbox" id="view-wireframe" disabled>triangles</label>"#,
            r#"<label hidden><input type="checkbox" id="view-parallax" checked disabled>parallax maps</label>"#,
            r#"<button id="view-whole" disabled>whole model</button></div></div>"#,
            r#"<script type="text/plain" id="view-model">{data}</script>"#
        ),
        name = escape(&model.name),
        data = data
    ))
}

/// The model with textures that are not too large for a page.
fn small(model: &Model) -> Model {
    let mut model = Model { rig: None, parts: None, ..model.clone() };
    let mut kinds = vec![None; model.images.len()];
    for material in &model.materials {
        for kind in MapKind::ALL {
            let slots = [texture_slot(material, kind), shifted_texture_slot(material, kind)];
            for slot in slots.into_iter().flatten() {
                kinds[slot.image].get_or_insert(kind);
            }
        }
    }
    for (image, kind) in model.images.iter_mut().zip(kinds) {
        // What no map is may be numbers, which must not be averaged.
        let Some(kind) = kind else { continue };
        let halvings =
            image.width.max(image.height).div_ceil(MOST_TEXELS).next_power_of_two().ilog2() as usize;
        *image = reduced(kind, image, true, [halvings; 2]);
    }
    model
}
