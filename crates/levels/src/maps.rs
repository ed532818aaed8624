//! The maps of a baked level, with fewer texels or as factors: what a smaller file is made of without a new bake.
//!
//! A factor is the map's mean over the surface. Normals and occlusion have none: their map goes.
//!
//! Contract: maps that extensions bring along stay; so does the base colour where its opacity shows.

use parbake_image::MapKind;
use parbake_image::material_maps::texture_slot;
use parbake_image::quantise::from_image;
use parbake_image::reduced::reduced;
use parbake_model::glam::Vec4;
use parbake_model::{AlphaMode, Image, Material, Model};

/// Sides of a map that are tried: its own, and half of that up to so many times.
pub(crate) const HALVINGS: usize = 3;
/// Texels along a side below which a map is not halved.
const LEAST_SIDE: usize = 8;
/// Points along a side of a triangle at which a map is read for its mean.
const POINTS: usize = 4;

/// What becomes of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// Its sides are halved so many times, along u and along v.
    Halved([usize; 2]),
    /// A factor stands for it.
    Factor,
}

/// A map of a level; materials share it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelMap {
    /// Index of its image.
    pub image: usize,
    /// What it is read as.
    pub kind: MapKind,
    /// What may become of it, from the most texels to the fewest.
    pub reductions: Vec<Reduction>,
}

/// The maps of a level that may be reduced, with both of their sides.
pub fn level_maps(model: &Model) -> Vec<LevelMap> {
    let mut maps = oblong_level_maps(model);
    let is_even = |reduction: &Reduction| !matches!(reduction, Reduction::Halved([u, v]) if u != v);
    maps.iter_mut().for_each(|map| map.reductions.retain(is_even));
    maps
}

/// The maps of a level that may be reduced, one side once more than the other one, too.
pub(crate) fn oblong_level_maps(model: &Model) -> Vec<LevelMap> {
    let mut maps: Vec<LevelMap> = Vec::new();
    let Some(material) = model.materials.first() else { return maps };
    let is_opaque = model.materials.iter().all(|material| material.alpha_mode == AlphaMode::Opaque);
    for kind in MapKind::ALL {
        let Some(slot) = texture_slot(material, kind) else { continue };
        let is_known = maps.iter().any(|map| map.image == slot.image);
        let Some(image) = model.images.get(slot.image).filter(|_| !is_known) else { continue };
        let steps = (0..=HALVINGS).flat_map(|k| [[k, k], [k + 1, k], [k, k + 1]]);
        let is_large_enough = |&[u, v]: &[usize; 2]| {
            let stays = |side: usize, times: usize| times == 0 || side >> times >= LEAST_SIDE;
            u.max(v) <= HALVINGS && stays(image.width, u) && stays(image.height, v)
        };
        let mut reductions: Vec<Reduction> = steps.filter(is_large_enough).map(Reduction::Halved).collect();
        if kind != MapKind::BaseColor || is_opaque {
            reductions.push(Reduction::Factor);
        }
        maps.push(LevelMap { image: slot.image, kind, reductions });
    }
    maps
}

/// Images that extensions alone bring along, and whether they are colours in sRGB; each once.
pub(crate) fn images_of_extensions(model: &Model) -> Vec<(usize, bool)> {
    let others: Vec<usize> = level_maps(model).iter().map(|map| map.image).collect();
    let mut images: Vec<(usize, bool)> = Vec::new();
    for (slot, is_color) in model.materials.iter().flat_map(|material| material.extensions.textures()) {
        match images.iter_mut().find(|(known, _)| *known == slot.image) {
            // A number in the fourth channel may share the image of a colour.
            Some((_, known)) => *known |= is_color,
            None if others.contains(&slot.image) || slot.image >= model.images.len() => {}
            None => images.push((slot.image, is_color)),
        }
    }
    images
}

/// The level with those images halved so many times along u and along v.
pub(crate) fn with_halved_extensions(mut model: Model, halvings: [usize; 2]) -> Model {
    for (image, is_color) in images_of_extensions(&model) {
        let own = &model.images[image];
        let [u, v] = halvings;
        let times = [u.min(own.width.ilog2() as usize), v.min(own.height.ilog2() as usize)];
        // Their fourth channel may say something, too: they are read as a base colour is.
        model.images[image] = reduced(MapKind::BaseColor, own, is_color, times);
    }
    model
}

/// Texels along a side of a reduced map; 0 for a factor.
pub fn size_of(model: &Model, map: &LevelMap, reduction: Reduction) -> usize {
    match reduction {
        Reduction::Factor => 0,
        Reduction::Halved([times, _]) => (model.images[map.image].width >> times).max(1),
    }
}

/// The level with its maps reduced, one reduction for each of `maps`; images that nothing uses any more are gone.
pub fn with_reductions(model: &Model, maps: &[LevelMap], reductions: &[Reduction]) -> Model {
    let mut out = Model { images: Vec::new(), ..model.clone() };
    let mut images: Vec<Option<Image>> = model.images.iter().cloned().map(Some).collect();
    for (map, reduction) in maps.iter().zip(reductions) {
        let image = &model.images[map.image];
        match reduction {
            Reduction::Halved(times) => images[map.image] = Some(reduced(map.kind, image, true, *times)),
            Reduction::Factor => {
                let mean = mean_on_surface(model, map.kind, image);
                out.materials.iter_mut().for_each(|material| take_factor(material, map, mean));
                images[map.image] = None;
            }
        }
    }
    let mut places = vec![None; images.len()];
    for material in &mut out.materials {
        material.for_each_image(|index| {
            let place = *places[*index].get_or_insert_with(|| {
                out.images.extend(images[*index].take());
                out.images.len() - 1
            });
            *index = place;
        });
    }
    out
}

/// A material without a map, of which the mean is left.
fn take_factor(material: &mut Material, map: &LevelMap, mean: Vec4) {
    let own = |slot: &Option<parbake_model::TextureSlot>| slot.is_some_and(|slot| slot.image == map.image);
    if own(&material.base_color_texture) {
        material.base_color_texture = None;
        material.base_color =
            (Vec4::from(material.base_color) * mean).clamp(Vec4::ZERO, Vec4::ONE).to_array();
    }
    if own(&material.metallic_roughness_texture) {
        material.metallic_roughness_texture = None;
        material.roughness *= mean.y;
        material.metallic *= mean.z;
    }
    if own(&material.emissive_texture) {
        material.emissive_texture = None;
        material.emissive = std::array::from_fn(|k| (material.emissive[k] * mean[k]).clamp(0.0, 1.0));
    }
    for slot in [&mut material.normal_texture, &mut material.occlusion_texture] {
        if own(slot) {
            *slot = None;
        }
    }
    let extensions = material.extensions.textures_mut().into_iter();
    extensions.filter(|(slot, _)| own(slot)).for_each(|(slot, _)| *slot = None);
}

/// The mean of a map where it lies on the surface, by area.
fn mean_on_surface(model: &Model, kind: MapKind, image: &Image) -> Vec4 {
    let map = from_image(kind, image, true);
    let texel = |share: f32, side: usize| ((share.rem_euclid(1.0) * side as f32) as usize).min(side - 1);
    let (mut sum, mut weight) = (Vec4::ZERO, 0.0);
    for triangle in 0..model.mesh.triangles.len() {
        let area = model.mesh.area_normal(triangle).length();
        let [a, b, c] = model.mesh.corner_uvs(triangle);
        for (i, j) in (0..POINTS).flat_map(|i| (0..POINTS - i).map(move |j| (i, j))) {
            let [s, t] = [i, j].map(|k| (k as f32 + 1.0 / 3.0) / POINTS as f32);
            let uv = a + (b - a) * s + (c - a) * t;
            if uv.is_finite() {
                sum += area * map.texels[texel(uv.y, map.height) * map.width + texel(uv.x, map.width)];
                weight += area;
            }
        }
    }
    if weight > 0.0 { sum / weight } else { kind.spec().neutral }
}

/// A model's name, materials and maps without its surface; no map of the
/// metallic-roughness material has more than `side` texels along a side.
pub fn with_maps_at_most(model: &Model, side: usize) -> Model {
    let mut images = model.images.clone();
    for (index, kind) in kinds_of_images(&model.materials) {
        if let Some(image) = images.get_mut(index) {
            let times = (0..).take_while(|&times| image.width.max(image.height) >> times > side).count();
            *image = reduced(kind, image, true, [times; 2]);
        }
    }
    Model { name: model.name.clone(), materials: model.materials.clone(), images, ..Model::default() }
}

/// What images hold, each once.
fn kinds_of_images(materials: &[Material]) -> Vec<(usize, MapKind)> {
    let mut kinds: Vec<(usize, MapKind)> = Vec::new();
    for (material, kind) in materials.iter().flat_map(|m| MapKind::ALL.map(|kind| (m, kind))) {
        let image = texture_slot(material, kind).map(|slot| slot.image);
        let is_new = |image: &usize| kinds.iter().all(|(known, _)| known != image);
        kinds.extend(image.filter(is_new).map(|image| (image, kind)));
    }
    kinds
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_image::material_maps::set_texture;
    use parbake_model::glam::{Vec3, vec2};
    use parbake_model::{Mesh, TextureSlot};

    /// Two triangles of the left half of a texture whose right half nothing uses.
    fn level() -> Model {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let positions = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(x, y)| corner(x, y));
        let mesh = Mesh {
            uvs: positions.iter().map(|p| vec2(0.48 * p.x, p.y)).collect(),
            positions: positions.to_vec(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        let mut material = Material::default();
        let half = |left: [u8; 4], right: [u8; 4]| Image {
            name: "map".into(),
            width: 16,
            height: 16,
            pixels: (0..256).map(|k| if k % 16 < 8 { left } else { right }).collect(),
        };
        let slot = |image| TextureSlot { image, ..TextureSlot::default() };
        set_texture(&mut material, MapKind::BaseColor, slot(0));
        set_texture(&mut material, MapKind::Normal, slot(1));
        set_texture(&mut material, MapKind::MetallicRoughness, slot(2));
        material.occlusion_texture = Some(slot(2));
        let images = vec![
            half([255, 0, 0, 255], [0, 0, 0, 255]),
            half([128, 128, 255, 255], [0, 0, 255, 255]),
            half([9, 51, 255, 255], [0; 4]),
        ];
        Model { mesh, materials: vec![material], images, ..Model::default() }
    }

    /// Protects looks: a factor is the mean of what is on the surface, whatever lies beside it in the texture; a map
    /// that two slots share goes from both, and its image from the file.
    #[test]
    fn factors_are_means_of_the_surface() {
        let model = level();
        let maps = level_maps(&model);
        assert_eq!(maps.iter().map(|map| map.image).collect::<Vec<_>>(), [0, 1, 2]);
        let chosen = [Reduction::Halved([1; 2]), Reduction::Factor, Reduction::Factor];
        let out = with_reductions(&model, &maps, &chosen);
        let material = &out.materials[0];
        assert_eq!((out.images.len(), out.images[0].width), (1, 8));
        assert_eq!(out.images[0].pixels[0], [255, 0, 0, 255]);
        assert_eq!(material.base_color_texture.map(|slot| slot.image), Some(0));
        assert!((material.roughness - 0.2).abs() < 0.01 && material.metallic == 1.0);
        assert_eq!(material.all_texture_slots().count(), 1);
    }

    /// Protects cut-outs: their outline is in the base colour's alpha, which stays.
    #[test]
    fn a_base_color_with_opacity_stays() {
        let mut model = level();
        let factor = |model: &Model| level_maps(model)[0].reductions.contains(&Reduction::Factor);
        assert!(factor(&model));
        model.materials[0].alpha_mode = AlphaMode::Mask;
        assert!(!factor(&model));
    }
}
