//! Images of numbers. Bevy's glTF loader takes what it does not know for colours; here they become linear arrays of
//! layers, before the renderer sees them.

use crate::format::{CUTOUT_LAYERS, SHIFT_LAYERS};
use crate::material::{ParallaxExtension, ParallaxMaterial};
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{TextureFormat, TextureViewDescriptor, TextureViewDimension};

/// Each frame, since images may come after their material.
pub(crate) fn prepare(mut materials: ResMut<Assets<ParallaxMaterial>>, mut images: ResMut<Assets<Image>>) {
    let mut faulty = Vec::new();
    for (id, material) in materials.iter() {
        let ParallaxExtension { shift, cutout, .. } = &material.extension;
        let wanted = [(shift, SHIFT_LAYERS), (cutout, CUTOUT_LAYERS)];
        let wanted = wanted.into_iter().filter_map(|(handle, layers)| Some((handle.as_ref()?, layers)));
        for (handle, layers) in wanted {
            let Some(image) = images.get(handle) else { continue };
            if image.texture_descriptor.array_layer_count() == layers {
                continue;
            }
            if let Some(mut image) = images.get_mut(handle)
                && let Err(reason) = make_data(&mut image, layers)
            {
                faulty.push((id, reason));
            }
        }
        // A texture of the extension's own: Bevy knows linear ones by where the material has them.
        if let Some(normals) = &material.base.normal_map_texture
            && images.get(normals).is_some_and(|image| image.texture_descriptor.format.is_srgb())
            && let Some(mut image) = images.get_mut(normals)
        {
            image.texture_descriptor.format = image.texture_descriptor.format.remove_srgb_suffix();
        }
    }
    for (id, reason) in faulty {
        warn!("a parallax map was left out: {reason}");
        if let Some(mut material) = materials.get_mut(id) {
            material.extension = ParallaxExtension::default();
        }
    }
}

/// Whether an image has so many layers of four channels, one below the other.
pub(crate) fn check(image: &Image, layers: u32) -> Result<(), String> {
    let format = image.texture_descriptor.format;
    if format.components() != 4 {
        return Err(format!("an image of it has the format {format:?}, which has not four channels"));
    }
    if !image.height().is_multiple_of(layers) || image.texture_descriptor.size.depth_or_array_layers != 1 {
        return Err(format!("an image of {} rows has no {layers} layers of one height", image.height()));
    }
    Ok(())
}

/// An image of so many layers, one below the other, as a linear array. The rows of a layer follow each other in memory.
fn make_data(image: &mut Image, layers: u32) -> Result<(), String> {
    // Before anything is changed, since the image may be a picture of the material as well.
    check(image, layers)?;
    let format = image.texture_descriptor.format.remove_srgb_suffix();
    image.texture_descriptor.format = format;
    if format == TextureFormat::Rgba16Unorm {
        // Not every GPU filters numbers of 16 bits, and 8 are what Parbake writes.
        let narrow =
            |pair: &[u8]| (u32::from(u16::from_ne_bytes([pair[0], pair[1]])) * 255 + 32_767) / 65_535;
        image.data =
            image.data.take().map(|data| data.chunks_exact(2).map(|pair| narrow(pair) as u8).collect());
        image.texture_descriptor.format = TextureFormat::Rgba8Unorm;
    }
    image.reinterpret_stacked_2d_as_array(layers).map_err(|error| error.to_string())?;
    image.texture_descriptor.mip_level_count = 1;
    image.texture_view_descriptor =
        Some(TextureViewDescriptor { dimension: Some(TextureViewDimension::D2Array), ..default() });
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::ClampToEdge,
        address_mode_v: ImageAddressMode::ClampToEdge,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        ..default()
    });
    Ok(())
}
