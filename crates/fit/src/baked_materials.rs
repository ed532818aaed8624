//! From fitted maps to the low-poly's materials, one for each layer in use (opaque, cut out, blended, and
//! what transmits light), all on one atlas, with the extensions of their layers.
//!
//! Factors and textures of the maps are those of `image/written_maps.rs`.

use crate::parallax_maps::ParallaxMaps;
use parbake_image::MapKind;
use parbake_image::written_maps::add_maps;
use parbake_model::{AlphaMode, Image, Material, Mesh, Model, ParallaxMap, TextureSlot};
use parbake_views::alpha_layers::LayerKind;
use parbake_views::backs::sides;
use parbake_views::extension_maps::{ExtensionMaps, LayerLook, extension_maps};
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;

/// What the materials of a bake have besides maps.
pub struct Look {
    /// The layer of each triangle.
    pub kinds: Vec<LayerKind>,
    /// What the layers have of the high-poly's material extensions.
    pub extensions: ExtensionMaps,
    /// Layers, and whether their materials are double-sided; those that are not in the list are.
    pub sides: Vec<(LayerKind, bool)>,
    /// What emission was divided by.
    pub emissive_strength: f32,
    /// Whether the high-poly shows its base colour without lights.
    pub is_unlit: bool,
}

impl Look {
    /// Of a low-poly whose triangles are in these layers. With `keeps_sides` layers are double-sided only where most of
    /// the high-poly's is ([`sides`]).
    pub fn new(high: &HighPoly, low: &LowPoly, kinds: Vec<LayerKind>, keeps_sides: bool) -> Self {
        let extensions = match high.is_whole_material {
            true => extension_maps(low, &kinds, high),
            false => ExtensionMaps::default(),
        };
        Self { extensions, sides: sides(high, keeps_sides), ..Self::without_extensions(high, kinds) }
    }

    /// The same without the high-poly's material extensions.
    pub fn without_extensions(high: &HighPoly, kinds: Vec<LayerKind>) -> Self {
        Self {
            kinds,
            extensions: ExtensionMaps::default(),
            sides: Vec::new(),
            emissive_strength: high.emissive_strength,
            is_unlit: high.is_whole_material && high.scene.is_unlit(),
        }
    }

    /// The low-poly with materials of these images and these parallax maps.
    pub fn textured(
        &self,
        low: &Model,
        mesh: &Mesh,
        maps: Vec<(MapKind, Image)>,
        parallax: Option<&ParallaxMaps>,
    ) -> Model {
        self.dressed(low, mesh, maps, Vec::new(), |images| parallax.map(|maps| maps.pack(images)))
    }

    /// The same with a parallax map that `parallax` gives, which may add its images to those of the maps; `images` are
    /// there before these.
    pub fn dressed(
        &self,
        low: &Model,
        mesh: &Mesh,
        maps: Vec<(MapKind, Image)>,
        mut images: Vec<Image>,
        parallax: impl FnOnce(&mut Vec<Image>) -> Option<ParallaxMap>,
    ) -> Model {
        let mut mesh = mesh.clone();
        mesh.colors.clear();
        mesh.uvs1.clear();
        let mut material = Material { name: low.name.clone(), ..Material::default() };
        self.add_maps(&mut material, &mut images, maps);
        material.parallax = parallax(&mut images);
        if material.parallax.is_none() {
            mesh.parallax_offsets.clear();
        }
        let mut kinds: Vec<LayerKind> = Vec::new();
        for (own, kind) in mesh.triangle_materials.iter_mut().zip(&self.kinds) {
            let index = kinds.iter().position(|k| k == kind).unwrap_or_else(|| {
                kinds.push(*kind);
                kinds.len() - 1
            });
            *own = index as u32;
        }
        let first = images.len();
        images.extend(self.extensions.images.iter().cloned());
        let materials = kinds.iter().map(|&kind| self.of_layer(&material, kind, first));
        Model { name: low.name.clone(), mesh, materials: materials.collect(), images, ..Model::default() }
    }

    /// The material of a layer; the images of extensions begin at `first`.
    fn of_layer(&self, material: &Material, kind: LayerKind, first: usize) -> Material {
        let double_sided = self.sides.iter().find(|(own, _)| *own == kind).is_none_or(|(_, double)| *double);
        let mut material = Material { alpha_mode: kind.mode, double_sided, ..material.clone() };
        let found: Option<&LayerLook> = self.extensions.layers.iter().find(|layer| layer.kind == kind);
        if let Some(look) = found {
            material.extensions = look.extensions.clone();
            let slots = material.extensions.textures_mut().into_iter().filter_map(|(slot, _)| slot.as_mut());
            slots
                .for_each(|slot| *slot = TextureSlot { image: first + slot.image, ..TextureSlot::default() });
            if let Some(clearcoat) = material.extensions.clearcoat.as_mut().filter(|_| look.coats_normals) {
                clearcoat.normal_texture = material.normal_texture;
            }
        }
        let alpha = match kind.mode {
            AlphaMode::Opaque => "",
            AlphaMode::Mask => " (cut out)",
            AlphaMode::Blend => " (blended)",
        };
        let passing = if kind.transmits { " (transmitting light)" } else { "" };
        material.name = format!("{}{alpha}{passing}", material.name);
        material
    }

    /// Gives a material these maps, whose images are added to the model's.
    pub fn add_maps(&self, material: &mut Material, images: &mut Vec<Image>, maps: Vec<(MapKind, Image)>) {
        add_maps(material, images, maps, self.emissive_strength, self.is_unlit);
    }
}

/// Gives a model with parallax maps textures for viewers that do not know these: what it has then goes with the maps.
pub fn add_fallback(model: &mut Model, maps: Vec<(MapKind, Image)>) {
    for (kind, image) in maps {
        let index = model.images.len();
        let mut is_used = false;
        for material in &mut model.materials {
            let Some(map) = &mut material.parallax else { continue };
            let (own, of_map) = match kind {
                MapKind::BaseColor => (&mut material.base_color_texture, &mut map.base_color_texture),
                MapKind::Normal => (&mut material.normal_texture, &mut map.normal_texture),
                MapKind::MetallicRoughness | MapKind::Emissive | MapKind::Occlusion => continue,
            };
            // A map of one value became a factor, which serves all viewers.
            let Some(own) = own else { continue };
            let with_map = std::mem::replace(own, TextureSlot { image: index, ..*own });
            *of_map = Some(with_map);
            is_used = true;
            // A coat has one texture for all viewers.
            let coat = material.extensions.clearcoat.as_mut().and_then(|coat| coat.normal_texture.as_mut());
            if let Some(coat) = coat.filter(|coat| kind == MapKind::Normal && coat.image == with_map.image) {
                coat.image = index;
            }
        }
        if is_used {
            model.images.push(Image { name: format!("{} without parallax", image.name), ..image });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(modes: Vec<AlphaMode>) -> Look {
        let kinds = modes.into_iter().map(|mode| LayerKind { mode, transmits: false }).collect();
        let extensions = ExtensionMaps::default();
        Look { kinds, extensions, sides: Vec::new(), emissive_strength: 3.0, is_unlit: false }
    }

    fn image(pixels: [[u8; 4]; 2]) -> Image {
        Image { name: "map".into(), width: 2, height: 1, pixels: pixels.to_vec() }
    }

    fn two_triangles() -> Model {
        let mesh = Mesh { triangles: vec![[0, 0, 0]; 2], triangle_materials: vec![0; 2], ..Mesh::default() };
        Model { name: "low".into(), mesh, ..Model::default() }
    }

    /// Protects viewers without parallax maps, and those with them: each has its own textures; a map that became a
    /// factor serves both.
    #[test]
    fn textures_without_maps_take_the_materials_place() {
        let maps = vec![(MapKind::BaseColor, image([[255, 188, 0, 9], [0, 0, 0, 255]]))];
        let low = two_triangles();
        let mut model = whole(vec![AlphaMode::Opaque, AlphaMode::Mask]).textured(&low, &low.mesh, maps, None);
        for material in &mut model.materials {
            material.parallax = Some(parbake_model::ParallaxMap::default());
        }
        let plain = image([[1, 2, 3, 4]; 2]);
        add_fallback(&mut model, vec![(MapKind::BaseColor, plain.clone()), (MapKind::Normal, plain.clone())]);
        assert_eq!((model.images.len(), &model.images[1].pixels), (2, &plain.pixels));
        for material in &model.materials {
            let map = material.parallax.as_ref().expect("a map");
            let textures =
                [material.base_color_texture, map.base_color_texture].map(|slot| slot.map(|s| s.image));
            assert_eq!(textures, [Some(1), Some(0)]);
            assert!(material.normal_texture.is_none() && map.normal_texture.is_none());
        }
    }

    /// Protects draw calls: there is one material for each alpha mode in use, on the same textures.
    #[test]
    fn each_alpha_mode_has_one_material() {
        let maps = vec![(MapKind::BaseColor, image([[255, 188, 0, 9], [0, 0, 0, 255]]))];
        let low = two_triangles();
        let modes = vec![AlphaMode::Blend, AlphaMode::Opaque];
        let model = whole(modes.clone()).textured(&low, &low.mesh, maps, None);
        let found: Vec<AlphaMode> = model
            .mesh
            .triangle_materials
            .iter()
            .map(|&material| model.materials[material as usize].alpha_mode)
            .collect();
        assert_eq!((found, model.images.len()), (modes, 1));
    }
}
