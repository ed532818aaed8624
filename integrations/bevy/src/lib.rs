//! Parallax maps and cut outlines of `PARBAKE_materials_parallax`, version 2, for Bevy.
//!
//! [`ParallaxPlugin`] teaches Bevy's glTF loader the extension: materials that have it become [`ParallaxMaterial`]s,
//! which are Bevy's `StandardMaterial` with a [`ParallaxExtension`]. Lights, shadows, skins and instances go on as they
//! are.
//!
//! `format.rs` reads the extension's JSON, `loader.rs` is called by Bevy's glTF loader, `offsets.rs`
//! moves vertices to where the maps have them, `images.rs` makes the images of
//! numbers what shaders want, `material.rs` is the material. `parallax.wgsl` has the formulas, `parallax_seen.wgsl`
//! what both passes do with them, `parallax_material.wgsl` and `parallax_prepass.wgsl` are the passes.

mod format;
mod images;
mod loader;
mod material;
mod offsets;

pub use format::{NAME, OwnTexture, ParallaxFault, ParallaxJson};
pub use material::{ParallaxExtension, ParallaxMaterial, ParallaxNumbers};

use bevy::asset::embedded_asset;
use bevy::gltf::GltfPlugin;
use bevy::gltf::extensions::GltfExtensionHandlers;
use bevy::prelude::*;
use bevy::shader::load_shader_library;

/// Adds the material, and the reader of the extension. To be added after Bevy's own plug-ins.
#[derive(Clone, Copy, Debug)]
pub struct ParallaxPlugin {
    /// Borders of cutouts are smooth where a camera has several samples a pixel. With it, a depth prepass of such a
    /// camera does not cut: turn it off if there is one.
    pub smooth_borders: bool,
}

impl Default for ParallaxPlugin {
    fn default() -> Self {
        Self { smooth_borders: true }
    }
}

impl Plugin for ParallaxPlugin {
    fn build(&self, app: &mut App) {
        load_shader_library!(app, "parallax.wgsl");
        load_shader_library!(app, "parallax_seen.wgsl");
        embedded_asset!(app, "parallax_material.wgsl");
        embedded_asset!(app, "parallax_prepass.wgsl");
        app.add_plugins(MaterialPlugin::<ParallaxMaterial>::default());
        // As late as can be in a frame, and so before the renderer sees an image that came with it.
        app.add_systems(Last, images::prepare);
        let Some(handlers) = app.world().get_resource::<GltfExtensionHandlers>() else {
            warn!("parallax maps are not loaded: ParallaxPlugin was added before Bevy's own plug-ins");
            return;
        };
        let default = app.get_added_plugins::<GltfPlugin>().first().map(|gltf| gltf.convert_coordinates);
        let handler = loader::Handler::new(self.smooth_borders, default.unwrap_or_default().rotate_meshes);
        handlers.0.write_blocking().push(Box::new(handler));
    }
}
