//! What the images of a model are used for, which decides how they are stored.

use crate::ktx2_out::Content;
use crate::texture_out::{Purpose, Use};
use parbake_model::{AlphaMode, Material, Model, ParallaxMap, TextureSlot};

/// What an image is used for: by the strictest of the materials' slots that have it, and as colours if any slot
/// reads them as such.
pub(super) fn purpose_of(model: &Model, image: usize) -> Purpose {
    let is = |slot: &Option<TextureSlot>| slot.is_some_and(|s| s.image == image);
    let materials = || model.materials.iter();
    let maps = || materials().filter_map(|m| m.parallax.as_ref());
    let is_exact = |map: &ParallaxMap| {
        map.images.contains(&image)
            || map.depth.as_ref().is_some_and(|depth| depth.image == image)
            || map.cutout.as_ref().is_some_and(|cutout| cutout.images.contains(&image))
    };
    let extensions = || materials().flat_map(|m| m.extensions.textures()).filter(|(s, _)| s.image == image);
    let is_normal = materials().any(|m| {
        is(&m.normal_texture) || m.extensions.clearcoat.is_some_and(|coat| is(&coat.normal_texture))
    }) || maps().any(|map| is(&map.normal_texture));
    let is_data = is_normal
        || materials().any(|m| is(&m.metallic_roughness_texture) || is(&m.occlusion_texture))
        || extensions().any(|(_, is_color)| !is_color);
    let base_color = |m: &Material| {
        is(&m.base_color_texture) || m.parallax.as_ref().is_some_and(|map| is(&map.base_color_texture))
    };
    let is_color = materials().any(|m| base_color(m) || is(&m.emissive_texture))
        || extensions().any(|(_, is_color)| is_color);
    // Where a parallax map has a texture of its own, only viewers that do not know the map see the material's.
    let stands_in = |m: &Material| {
        let of_maps = m.parallax.as_ref().map(|map| [map.base_color_texture, map.normal_texture]);
        let own = [m.base_color_texture, m.normal_texture];
        own.iter().zip(of_maps.into_iter().flatten()).any(|(own, of_map)| is(own) && of_map.is_some())
    };
    let is_shown = |m: &Material| {
        let of_maps = m.parallax.iter().flat_map(|map| [map.base_color_texture, map.normal_texture]);
        let own = [m.metallic_roughness_texture, m.occlusion_texture, m.emissive_texture];
        of_maps.chain(own).any(|slot| is(&slot))
            || (m.parallax.is_none() && m.texture_slots().any(|s| s.image == image))
    };
    let is_fallback =
        materials().any(stands_in) && !materials().any(is_shown) && extensions().next().is_none();
    let masked = |m: &&Material| m.alpha_mode == AlphaMode::Mask && base_color(m) && m.base_color[3] > 0.0;
    Purpose {
        of: match () {
            () if maps().any(is_exact) => Use::Exact,
            () if is_fallback => Use::Fallback,
            () if is_data => Use::Data,
            () => Use::Color,
        },
        content: match () {
            () if is_color => Content::Color,
            () if is_normal => Content::Normal,
            () => Content::Values,
        },
        cutoff: materials().find(masked).map(|m| m.alpha_cutoff / m.base_color[3]),
    }
}
