//! What Bevy's glTF loader calls: materials with the extension become [`ParallaxMaterial`]s, and primitives that have them
//! get a mesh with the maps' vertices. Bevy's own material and mesh stay beside them, as the file is without the maps.

use crate::format::{CUTOUT_LAYERS, NAME, OwnTexture, ParallaxJson, SHIFT_LAYERS};
use crate::material::{ParallaxExtension, ParallaxMaterial};
use crate::{images, offsets};
use bevy::asset::LoadContext;
use bevy::camera::primitives::{Aabb, MeshAabb};
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy::gltf::{GltfAssetLabel, GltfLoaderSettings, GltfMaterial, GltfMesh, gltf};
use bevy::mesh::{MeshVertexAttribute, UvChannel};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;

/// Index of a mesh, and of a primitive of it.
type Place = (usize, usize);

/// Bevy makes a copy for each file, which lives as long as the file is loaded.
#[derive(Clone)]
pub(crate) struct Handler {
    smooth_borders: bool,
    /// Whether Bevy turns meshes by half a circle. The file's loader settings have the last word.
    turns_meshes: bool,
    /// The file's textures, by their index.
    textures: Vec<Handle<Image>>,
    /// Labels of the materials that have maps.
    labels: HashSet<String>,
    /// Materials whose maps were left out, by their index. Bevy makes some materials twice.
    left_out: HashSet<usize>,
    /// What primitives whose material has the extension have as offsets.
    offsets: HashMap<Place, Vec<Vec3>>,
    /// The bounds of primitives that have a mesh of their own for the maps.
    meshes: HashMap<Place, Aabb>,
}

impl Handler {
    pub(crate) fn new(smooth_borders: bool, turns_meshes: bool) -> Self {
        Self {
            smooth_borders,
            turns_meshes,
            textures: Vec::new(),
            labels: HashSet::default(),
            left_out: HashSet::default(),
            offsets: HashMap::default(),
            meshes: HashMap::default(),
        }
    }

    /// The material with the map, or why there is none.
    fn made(
        &self,
        load_context: &LoadContext<'_>,
        material_label: &str,
        json: &serde_json::Value,
    ) -> Result<ParallaxMaterial, String> {
        let map = ParallaxJson::read(json).map_err(|fault| fault.to_string())?;
        // Bevy's own handler has made it before.
        let standard = load_context.get_labeled(format!("{material_label}/std"));
        let standard = standard.and_then(|asset| asset.get::<StandardMaterial>());
        let mut base = standard.ok_or_else(|| "Bevy made no material of it".to_string())?.clone();
        if base.unlit {
            return Err("the material is not lit, and this reads lit ones".into());
        }
        if let Some(own) = &map.base_color_texture {
            base.base_color_texture = Some(self.texture(own.index)?);
            base.base_color_channel = channel(own)?;
            base.uv_transform = own.transform;
        }
        if let Some(own) = &map.normal_texture {
            base.normal_map_texture = Some(self.texture(own.index)?);
            base.normal_map_channel = channel(own)?;
            if base.base_color_texture.is_none() {
                base.uv_transform = own.transform;
            }
        }
        let channel = match (&base.base_color_texture, &base.normal_map_texture) {
            (Some(_), _) => &base.base_color_channel,
            (None, Some(_)) => &base.normal_map_channel,
            (None, None) => return Err("there is neither a base colour nor a normal texture to shift".into()),
        };
        let data = |index: usize, layers: u32| {
            let image = self.texture(index)?;
            // One that lies beside the file is not there yet, and is checked when it is.
            if let Some(asset) = load_context.get_labeled_by_id(image.id())
                && let Some(image) = asset.get::<Image>()
            {
                images::check(image, layers)?;
            }
            Ok::<_, String>(image)
        };
        let extension = ParallaxExtension {
            numbers: (&map).into(),
            shift: Some(data(map.texture, SHIFT_LAYERS)?),
            cutout: map.cutout.map(|(index, ..)| data(index, CUTOUT_LAYERS)).transpose()?,
            is_second_uv: matches!(channel, UvChannel::Uv1),
        };
        if extension.cutout.is_some() && matches!(base.alpha_mode, AlphaMode::Opaque) {
            // What may be discarded must say so, or passes of depth have no fragment shader. Every alpha reaches 0.
            base.alpha_mode =
                if self.smooth_borders { AlphaMode::AlphaToCoverage } else { AlphaMode::Mask(0.0) };
        }
        Ok(ParallaxMaterial { base, extension })
    }

    fn texture(&self, index: usize) -> Result<Handle<Image>, String> {
        self.textures.get(index).cloned().ok_or_else(|| "a texture of it is missing".into())
    }

    /// Makes the mesh that the maps are shown on, and tells its bounds.
    fn make_mesh(
        &mut self,
        load_context: &mut LoadContext<'_>,
        (mesh, primitive): Place,
        offsets: &[Vec3],
    ) -> Result<Aabb, String> {
        let label = GltfAssetLabel::Primitive { mesh, primitive }.to_string();
        let plain = load_context.get_labeled(&label).and_then(|asset| asset.get::<Mesh>());
        let plain = plain.ok_or_else(|| "Bevy made no mesh of it".to_string())?;
        let moved = offsets::moved(plain, offsets)?;
        let bounds = moved.compute_aabb().ok_or_else(|| "it has no vertices".to_string())?;
        load_context.add_labeled_asset(of(&label), moved);
        Ok(bounds)
    }
}

fn channel(texture: &OwnTexture) -> Result<UvChannel, String> {
    match texture.tex_coord {
        0 => Ok(UvChannel::Uv0),
        1 => Ok(UvChannel::Uv1),
        other => Err(format!("a texture of it has set {other} of the coordinates, and Bevy knows 0 and 1")),
    }
}

/// The label of what is made of Bevy's own.
fn of(label: &str) -> String {
    format!("{label}/parallax")
}

impl GltfExtensionHandler for Handler {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_root(
        &mut self,
        _: &mut LoadContext<'_>,
        _: &bevy::gltf::gltf::Gltf,
        settings: &GltfLoaderSettings,
    ) {
        if let Some(convert) = settings.convert_coordinates {
            self.turns_meshes = convert.rotate_meshes;
        }
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
        let index = gltf_material.index().unwrap_or_default();
        if self.left_out.contains(&index) {
            return;
        }
        match self.made(load_context, material_label, json) {
            Ok(material) => {
                load_context.add_labeled_asset(of(material_label), material);
                self.labels.insert(material_label.into());
            }
            Err(reason) => {
                let name = gltf_material.name().unwrap_or_default();
                warn!("the parallax map of material \"{name}\" was left out: {reason}");
                self.left_out.insert(index);
            }
        }
    }

    // Here are the file's bytes, and in the next call Bevy's mesh.
    async fn on_gltf_primitive(
        &mut self,
        _: &mut LoadContext<'_>,
        _: &gltf::Gltf,
        gltf_mesh: &gltf::Mesh<'_>,
        gltf_primitive: &gltf::Primitive<'_>,
        buffer_data: &[Vec<u8>],
        _: &HashMap<Box<str>, MeshVertexAttribute>,
        _: bool,
        _: bool,
        _: &mut Option<Mesh>,
    ) {
        if gltf_primitive.material().extension_value(NAME).is_none() {
            return;
        }
        match offsets::read(gltf_primitive, buffer_data, self.turns_meshes) {
            Ok(offsets) => {
                self.offsets.insert((gltf_mesh.index(), gltf_primitive.index()), offsets);
            }
            Err(reason) => warn!("mesh {} is shown without parallax maps: {reason}", gltf_mesh.index()),
        }
    }

    fn on_gltf_mesh(
        &mut self,
        load_context: &mut LoadContext<'_>,
        gltf_mesh: &gltf::Mesh,
        _: Handle<GltfMesh>,
    ) {
        for primitive in gltf_mesh.primitives() {
            let place = (gltf_mesh.index(), primitive.index());
            let Some(offsets) = self.offsets.remove(&place) else { continue };
            match self.make_mesh(load_context, place, &offsets) {
                Ok(bounds) => {
                    self.meshes.insert(place, bounds);
                }
                Err(reason) => warn!("mesh {} is shown without parallax maps: {reason}", place.0),
            }
        }
    }

    fn on_spawn_mesh_and_material(
        &mut self,
        load_context: &mut LoadContext<'_>,
        primitive: &gltf::Primitive,
        mesh: &gltf::Mesh,
        _: &gltf::Material,
        entity: &mut EntityWorldMut,
        material_label: &str,
    ) {
        let (mesh, primitive) = (mesh.index(), primitive.index());
        // Without its map a material's primitives stay where they are.
        if let Some(&bounds) = self.meshes.get(&(mesh, primitive))
            && self.labels.contains(material_label)
        {
            let material = load_context.get_label_handle::<ParallaxMaterial>(of(material_label));
            let label = GltfAssetLabel::Primitive { mesh, primitive }.to_string();
            let moved = load_context.get_label_handle::<Mesh>(of(&label));
            entity.remove::<MeshMaterial3d<StandardMaterial>>();
            entity.insert((MeshMaterial3d(material), Mesh3d(moved), bounds));
        }
    }
}
