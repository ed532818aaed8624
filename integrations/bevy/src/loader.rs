//! What Bevy's glTF loader calls: materials with the extension become [`ParallaxMaterial`]s.

use crate::format::{NAME, ParallaxJson};
use crate::material::{ParallaxExtension, ParallaxMaterial};
use bevy::asset::LoadContext;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy::gltf::{GltfMaterial, gltf};
use bevy::mesh::UvChannel;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;

/// Bevy makes a copy for each file, which lives as long as the file is loaded.
#[derive(Clone)]
pub(crate) struct Handler {
    smooth_borders: bool,
    /// The file's textures, by their index.
    textures: Vec<Handle<Image>>,
    /// Labels of the materials that have maps.
    labels: HashSet<String>,
}

impl Handler {
    pub(crate) fn new(smooth_borders: bool) -> Self {
        Self { smooth_borders, textures: Vec::new(), labels: HashSet::default() }
    }

    /// The material with the map, or why there is none.
    fn made(
        &self,
        standard: &StandardMaterial,
        json: &serde_json::Value,
    ) -> Result<ParallaxMaterial, String> {
        let map = ParallaxJson::read(json).map_err(|fault| fault.to_string())?;
        if standard.unlit {
            return Err("the material is not lit, and this reads lit ones".into());
        }
        let texture = |index: usize| {
            self.textures.get(index).cloned().ok_or_else(|| "a texture of it is missing".to_string())
        };
        let mut base = standard.clone();
        if let Some(index) = map.base_color_texture {
            base.base_color_texture = Some(texture(index)?);
        }
        if let Some(index) = map.normal_texture {
            base.normal_map_texture = Some(texture(index)?);
        }
        let channel = match (&base.base_color_texture, &base.normal_map_texture) {
            (Some(_), _) => &base.base_color_channel,
            (None, Some(_)) => &base.normal_map_channel,
            (None, None) => return Err("there is neither a base colour nor a normal texture to shift".into()),
        };
        let extension = ParallaxExtension {
            numbers: (&map).into(),
            shift: Some(texture(map.texture)?),
            cutout: map.cutout.map(|(index, ..)| texture(index)).transpose()?,
            is_second_uv: matches!(channel, UvChannel::Uv1),
        };
        if extension.cutout.is_some() && matches!(base.alpha_mode, AlphaMode::Opaque) {
            // What may be discarded must say so, or passes of depth have no fragment shader. Every alpha reaches 0.
            base.alpha_mode =
                if self.smooth_borders { AlphaMode::AlphaToCoverage } else { AlphaMode::Mask(0.0) };
        }
        Ok(ParallaxMaterial { base, extension })
    }
}

fn of(material_label: &str) -> String {
    format!("{material_label}/parallax")
}

impl GltfExtensionHandler for Handler {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_texture(&mut self, texture: &gltf::Texture, image: Handle<Image>) {
        if self.textures.len() <= texture.index() {
            self.textures.resize(texture.index() + 1, Handle::default());
        }
        self.textures[texture.index()] = image;
    }

    fn on_material(
        &mut self,
        load_context: &mut LoadContext<'_>,
        gltf_material: &gltf::Material,
        _: Handle<GltfMaterial>,
        _: &GltfMaterial,
        material_label: &str,
    ) {
        let Some(json) = gltf_material.extension_value(NAME) else { return };
        // Bevy's own handler has made it before.
        let standard = load_context.get_labeled(format!("{material_label}/std"));
        let standard = standard.and_then(|asset| asset.get::<StandardMaterial>());
        let made = standard.ok_or_else(|| "Bevy made no material of it".to_string());
        match made.and_then(|standard| self.made(standard, json)) {
            Ok(material) => {
                load_context.add_labeled_asset(of(material_label), material);
                self.labels.insert(material_label.into());
            }
            Err(reason) => {
                let name = gltf_material.name().unwrap_or_default();
                warn!("the parallax map of material \"{name}\" was left out: {reason}");
            }
        }
    }

    fn on_spawn_mesh_and_material(
        &mut self,
        load_context: &mut LoadContext<'_>,
        _: &gltf::Primitive,
        _: &gltf::Mesh,
        _: &gltf::Material,
        entity: &mut EntityWorldMut,
        material_label: &str,
    ) {
        if self.labels.contains(material_label) {
            let handle = load_context.get_label_handle::<ParallaxMaterial>(of(material_label));
            entity.remove::<MeshMaterial3d<StandardMaterial>>().insert(MeshMaterial3d(handle));
        }
    }
}
