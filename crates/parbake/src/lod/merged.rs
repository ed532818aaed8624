//! The materials of a model on one common set of maps, without a new layout.
//!
//! ```text
//! materials ─┬ textures: the parts that are used ──┬ blocks of one texture (atlas/blocks.rs) ─ maps of all materials
//!            └ factors alone: a few equal texels ──┘
//! ```
//!
//! Factors are multiplied into texels, so that materials which differ in nothing else are one: a draw call for each way in which
//! alpha is understood and light passes. What no map says (extensions, unlit, a cutoff) keeps a material apart, as long as that
//! leaves at most half of the model's.
//!
//! Contract: vertices, normals and tangents stay. Where a model has no tangents none are made up, so that each viewer makes up
//! the same for the level as for the model. Texels of a texture that keeps its scale are the same numbers, but for the factors.

use crate::look::Look;
use parbake_atlas::blocks::{Block, Blocks, Source, blocks};
use parbake_image::material_maps::{factors, texture_slot, transmits};
use parbake_image::quantise::{from_image, to_image};
use parbake_image::window::window;
use parbake_image::{FloatImage, MapKind};
use parbake_model::glam::{DVec2, Vec2, Vec4};
use parbake_model::{AlphaMode, Image, Material, MaterialExtensions, Model, TextureSlot, Wrap};
use parbake_views::extension_maps::ExtensionMaps;
use std::collections::BTreeMap;

/// Most texels along a line for each pixel that the surface covers; textures that have more are halved.
const DENSITY: f64 = 4.0;

/// A model with one set of maps for all of its materials, each of at most `most_texels` texels and `most_side` along a side;
/// `side` is how many pixels along a line its whole surface covers, laid flat. Where its triangles have one material, the model
/// as it is. None where textures cannot be moved (parallax maps, several mappings in one material, vertices that
/// materials share) or where too many materials would stay.
pub(crate) fn with_common_maps(
    model: &Model,
    side: f64,
    most_side: usize,
    most_texels: usize,
) -> Option<Model> {
    let used = used_materials(model);
    if used.iter().any(|&index| model.materials.get(index).is_none_or(|own| own.parallax.is_some())) {
        return None;
    }
    if let [own] = used[..] {
        let mut model = Model { materials: vec![model.materials[own].clone()], ..model.clone() };
        model.mesh.triangle_materials.fill(0);
        return Some(model);
    }
    let groups = groups(model, &used)?;
    let (sources, uvs) = sources(model, &used, side)?;
    let laid_out = blocks(&sources, &uvs, most_side, most_texels)?;
    let (maps, strength) = maps(model, &used, &laid_out);
    let look = Look {
        kinds: Vec::new(),
        extensions: ExtensionMaps::default(),
        is_whole: true,
        emissive_strength: strength,
        is_unlit: used.iter().all(|&index| model.materials[index].unlit),
    };
    let (mut material, mut images) = (Material::default(), Vec::new());
    look.add_maps(&mut material, &mut images, maps);
    let mut out = Model { images, materials: Vec::new(), ..model.clone() };
    for members in &groups {
        let first = &model.materials[members[0]];
        let own = Material {
            name: name_of(model, members),
            alpha_mode: first.alpha_mode,
            alpha_cutoff: first.alpha_cutoff,
            unlit: first.unlit,
            extensions: extensions(model, &used, members, &laid_out, &mut out.images),
            double_sided: members.iter().any(|&index| model.materials[index].double_sided),
            ..material.clone()
        };
        out.materials.push(own);
    }
    let group_of: BTreeMap<usize, u32> = (groups.iter().zip(0..))
        .flat_map(|(members, group)| members.iter().map(move |&index| (index, group)))
        .collect();
    for own in &mut out.mesh.triangle_materials {
        *own = group_of[&(*own as usize)];
    }
    out.mesh.uvs = laid_out.uvs;
    out.mesh.uvs1.clear();
    if !material.has_normal_map() {
        out.mesh.tangents.clear();
    }
    Some(out)
}

/// Materials that triangles have, ascending.
fn used_materials(model: &Model) -> Vec<usize> {
    let mut used: Vec<usize> = model.mesh.triangle_materials.iter().map(|&own| own as usize).collect();
    used.sort_unstable();
    used.dedup();
    used
}

/// Materials that may be one; none where more would stay than half of them, and than there are layers.
fn groups(model: &Model, used: &[usize]) -> Option<Vec<Vec<usize>>> {
    let layer = |material: &Material| (material.alpha_mode as u8, transmits(material));
    let is_one = |a: &Material, b: &Material| {
        let has_backs = |m: &Material| m.alpha_mode == AlphaMode::Blend || transmits(m);
        layer(a) == layer(b)
            && a.unlit == b.unlit
            && without_textures(&a.extensions) == without_textures(&b.extensions)
            && (a.alpha_mode != AlphaMode::Mask || a.alpha_cutoff == b.alpha_cutoff)
            && (!has_backs(a) || a.double_sided == b.double_sided)
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for &index in used {
        let own = &model.materials[index];
        match groups.iter_mut().find(|group| is_one(&model.materials[group[0]], own)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    let mut layers: Vec<(u8, bool)> = used.iter().map(|&index| layer(&model.materials[index])).collect();
    layers.sort_unstable();
    layers.dedup();
    (groups.len() <= layers.len().max(used.len() / 2)).then_some(groups)
}

/// What extensions say beside their textures, of which a missing one is as good as white. Where it is not, whether there is
/// one remains.
fn without_textures(extensions: &MaterialExtensions) -> MaterialExtensions {
    let mut out = extensions.clone();
    let told = |slot: Option<TextureSlot>| slot.map(|_| TextureSlot::default());
    let coat = out.clearcoat.map(|coat| told(coat.normal_texture));
    let brushed = out.anisotropy.map(|brushed| told(brushed.texture));
    out.textures_mut().into_iter().for_each(|(slot, _)| *slot = None);
    if let (Some(own), Some(slot)) = (&mut out.clearcoat, coat) {
        own.normal_texture = slot;
    }
    if let (Some(own), Some(slot)) = (&mut out.anisotropy, brushed) {
        own.texture = slot;
    }
    out
}

/// The extensions of materials that become one, whose textures are added to the images: white where a material has none.
fn extensions(
    model: &Model,
    used: &[usize],
    members: &[usize],
    laid_out: &Blocks,
    images: &mut Vec<Image>,
) -> MaterialExtensions {
    let mut out = model.materials[members[0]].extensions.clone();
    for (place, (slot, is_color)) in out.textures_mut().into_iter().enumerate() {
        let of = |index: usize| {
            let mut own = model.materials[index].extensions.clone();
            let slot = own.textures_mut().into_iter().nth(place).and_then(|(slot, _)| *slot);
            slot.and_then(|slot| Some((model.images.get(slot.image)?, slot)))
        };
        let Some((first, _)) = members.iter().find_map(|&index| of(index)) else { continue };
        let name = first.name.clone();
        // Their fourth channel may say something, too: they are read as a base colour is.
        let texture = |source: usize| {
            let (image, slot) = members.contains(&used[source]).then(|| of(used[source])).flatten()?;
            Some((floats(from_image(MapKind::BaseColor, image, is_color)), slot.wrap))
        };
        let parts = parts(used.len(), laid_out, texture, |_, block, texture| part(texture, block, Vec4::ONE));
        let map = joined(laid_out, &parts);
        *slot = Some(TextureSlot { image: images.len(), ..TextureSlot::default() });
        images.push(Image { name, ..to_image(MapKind::BaseColor, &map, is_color) });
    }
    out
}

/// A material's own name, or that of the model.
fn name_of(model: &Model, members: &[usize]) -> String {
    match members {
        [only] => model.materials[*only].name.clone(),
        _ => model.name.clone(),
    }
}

/// The materials as sources of blocks, and the coordinates of all vertices as their material reads them.
fn sources(model: &Model, used: &[usize], side: f64) -> Option<(Vec<Source>, Vec<Vec2>)> {
    let mesh = &model.mesh;
    let mut uvs = vec![Vec2::ZERO; mesh.positions.len()];
    let area = |t: usize| f64::from(mesh.area_normal(t).length());
    // Texels for each unit of the surface's doubled area, where a line of it has as many as pixels.
    let pixels = side * side / (0..mesh.triangles.len()).map(area).sum::<f64>().max(f64::MIN_POSITIVE);
    let mut sources = Vec::new();
    for &index in used {
        let material = &model.materials[index];
        let of: Vec<usize> =
            (0..mesh.triangles.len()).filter(|&t| mesh.triangle_materials[t] as usize == index).collect();
        let triangles: Vec<[u32; 3]> = of.iter().map(|&t| mesh.triangles[t]).collect();
        let Some(slot) = material.all_texture_slots().next() else {
            sources.push(Source { triangles, texels: None, wrap: Default::default() });
            continue;
        };
        let reads_alike =
            |other: TextureSlot| (other.uv_set, other.transform) == (slot.uv_set, slot.transform);
        let set = if slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
        if !material.all_texture_slots().all(reads_alike) || set.is_empty() {
            return None;
        }
        for &v in triangles.as_flattened() {
            uvs[v as usize] = slot.transform.apply(set[v as usize]);
        }
        let images = material.all_texture_slots().filter_map(|slot| model.images.get(slot.image));
        let texels = images
            .fold(DVec2::ONE, |most, image| most.max(DVec2::new(image.width as f64, image.height as f64)));
        let in_texture = |t: usize| {
            let [a, b, c] = mesh.triangles[t].map(|v| uvs[v as usize].as_dvec2());
            (b - a).perp_dot(c - a).abs()
        };
        let read: f64 = of.iter().map(|&t| in_texture(t)).sum::<f64>() * texels.x * texels.y;
        let shown = of.iter().map(|&t| area(t)).sum::<f64>() * pixels;
        let halvings =
            if shown > 0.0 { (0.5 * (read / shown).log2() - DENSITY.log2()).floor().max(0.0) } else { 0.0 };
        // Charts move by tiles where every texture repeats.
        let wraps = material.all_texture_slots().map(|slot| slot.wrap);
        let wrap =
            wraps.reduce(|all, own| [0, 1].map(|k| if all[k] == own[k] { own[k] } else { Wrap::Clamp }));
        let wrap = wrap.unwrap_or_default();
        sources.push(Source { triangles, texels: Some(texels / halvings.exp2()), wrap });
    }
    Some((sources, uvs))
}

type Floats = FloatImage<[f32; 4]>;
/// A texture, and what lies outside of it.
type Texture = (Floats, [Wrap; 2]);

/// The common maps, those of one value included, and what emission was divided by.
fn maps(model: &Model, used: &[usize], laid_out: &Blocks) -> (Vec<(MapKind, Image)>, f32) {
    let emitted = used.iter().map(|&index| factors(&model.materials[index])[MapKind::Emissive].max_element());
    let strength = emitted.fold(1.0, f32::max);
    let map = |kind: MapKind| {
        let texture = |source: usize| {
            let slot = texture_slot(&model.materials[used[source]], kind)?;
            Some((floats(from_image(kind, model.images.get(slot.image)?, true)), slot.wrap))
        };
        let parts = parts(used.len(), laid_out, texture, |source, block, texture| {
            let none = if kind == MapKind::Normal { Vec4::Z } else { Vec4::ONE };
            let mut part = part(texture, block, none);
            multiply(&mut part, &model.materials[used[source]], kind, strength);
            part
        });
        (kind, to_image(kind, &joined(laid_out, &parts), true))
    };
    (MapKind::ALL.into_iter().map(map).collect(), strength)
}

/// The texels of all blocks. A texture is read once for all of its blocks.
fn parts(
    sources: usize,
    laid_out: &Blocks,
    texture: impl Fn(usize) -> Option<Texture>,
    of: impl Fn(usize, &Block, Option<&Texture>) -> Floats,
) -> Vec<(&Block, Floats)> {
    let mut parts = Vec::new();
    for source in 0..sources {
        let texture = texture(source);
        let own = laid_out.blocks.iter().filter(|block| block.source == source);
        parts.extend(own.map(|block| (block, of(source, block, texture.as_ref()))));
    }
    parts
}

/// A texture's texels in a block; `none` where there is no texture.
fn part(texture: Option<&Texture>, block: &Block, none: Vec4) -> Floats {
    match (texture, block.shows) {
        (Some((texture, wrap)), Some(shows)) => window(texture, *wrap, shows, block.size),
        _ => {
            let [width, height] = block.size;
            FloatImage { width, height, texels: vec![none.to_array(); width * height] }
        }
    }
}

/// Multiplies a texture by its material's factor.
fn multiply(part: &mut Floats, material: &Material, kind: MapKind, strength: f32) {
    let factor = factors(material)[kind];
    for texel in &mut part.texels {
        let value = Vec4::from(*texel);
        let value = match kind {
            MapKind::Occlusion => Vec4::ONE + factor * (value - Vec4::ONE),
            MapKind::Emissive => value * factor / strength,
            MapKind::BaseColor | MapKind::Normal | MapKind::MetallicRoughness => value * factor,
        };
        *texel = value.to_array();
        if kind == MapKind::BaseColor && material.alpha_mode == AlphaMode::Opaque {
            texel[3] = 1.0;
        }
    }
}

/// One map of all blocks; between them is what they have in the mean.
fn joined(laid_out: &Blocks, parts: &[(&Block, Floats)]) -> FloatImage<Vec4> {
    let [width, height] = laid_out.size;
    let sum: Vec4 = parts.iter().flat_map(|(_, part)| &part.texels).map(|&t| Vec4::from(t)).sum();
    let count: usize = parts.iter().map(|(_, part)| part.texels.len()).sum();
    let mut texels = vec![sum / count.max(1) as f32; width * height];
    for (block, part) in parts {
        for (y, row) in part.texels.chunks_exact(part.width).enumerate() {
            let first = (block.place[1] + y) * width + block.place[0];
            texels[first..first + part.width]
                .iter_mut()
                .zip(row)
                .for_each(|(to, from)| *to = Vec4::from(*from));
        }
    }
    FloatImage { width, height, texels }
}

fn floats(map: FloatImage<Vec4>) -> Floats {
    let FloatImage { width, height, texels } = map;
    FloatImage { width, height, texels: texels.into_iter().map(|t| t.to_array()).collect() }
}

#[cfg(test)]
#[path = "merged_tests.rs"]
mod tests;
