//! The materials of a model on one common set of maps, without a new layout.
//!
//! ```text
//! materials ─┬ textures: the parts that are used ──┬ blocks of one texture (atlas/blocks.rs) ─ maps of all materials
//!            └ factors alone: a few equal texels ──┘
//! ```
//!
//! Factors are multiplied into texels, those of extensions as well, so that materials which differ in nothing else are one: a draw
//! call for each way in which alpha is understood and light passes. What no map says (unlit, the inside of glass) keeps a material apart, as long as that leaves at most half of the model's.
//!
//! Contract: vertices, normals and tangents stay. Where a model has no tangents none are made up, so that each viewer makes up
//! the same for the level as for the model. Texels of a texture that keeps its scale are the same numbers, but for the factors.

use parbake_atlas::blocks::{Block, Blocks, Source, blocks};
use parbake_image::material_maps::{factors, texture_slot, transmits};
use parbake_image::quantise::{from_image, to_image};
use parbake_image::window::window;
use parbake_image::written_maps::add_maps;
use parbake_image::{FloatImage, MapKind};
use parbake_model::glam::{DVec2, Vec2, Vec4};
use parbake_model::{AlphaMode, Image, Material, MaterialExtensions, Model, TextureSlot, Wrap};
use parbake_views::extension_values::Group;
use parbake_views::joint_extensions::{agree, joint_extensions};
use std::collections::BTreeMap;

/// Most texels along a line for each pixel that the surface covers; textures that have more are halved.
const DENSITY: f64 = 4.0;

/// A model with one set of maps for all of its materials, each of at most `most_texels` texels and `most_side` along a side;
/// `side` is how many pixels along a line its whole surface covers, laid flat. Where its triangles have one material, the model
/// as it is. None where textures cannot be moved (parallax maps, several mappings in one material, vertices that
/// materials share) or where too many materials would stay.
pub fn with_common_maps(model: &Model, side: f64, most_side: usize, most_texels: usize) -> Option<Model> {
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
    let aspect = aspect_of_relief(model, &used, &sources);
    let laid_out = blocks(&sources, &uvs, most_side, most_texels, aspect)?;
    let merge = Merge { model, used: &used, laid_out: &laid_out };
    let (maps, strength) = merge.maps();
    let is_unlit = used.iter().all(|&index| model.materials[index].unlit);
    let (mut material, mut images) = (Material::default(), Vec::new());
    add_maps(&mut material, &mut images, maps, strength, is_unlit);
    let mut out = Model { images, materials: Vec::new(), ..model.clone() };
    for members in &groups {
        let first = &model.materials[members[0]];
        let own = Material {
            name: name_of(model, members),
            alpha_mode: first.alpha_mode,
            alpha_cutoff: merge.cutoff(),
            unlit: first.unlit,
            extensions: merge.extensions(members, material.normal_texture, &mut out.images),
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
    if !out.materials.iter().any(Material::has_normal_map) {
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
            && agree(&a.extensions, &b.extensions, transmits(a))
            && (!has_backs(a) || a.double_sided == b.double_sided)
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for &index in used {
        let own = &model.materials[index];
        let is_of = |group: &Vec<usize>| group.iter().all(|&other| is_one(&model.materials[other], own));
        match groups.iter_mut().find(|group| is_of(group)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    let mut layers: Vec<(u8, bool)> = used.iter().map(|&index| layer(&model.materials[index])).collect();
    layers.sort_unstable();
    layers.dedup();
    (groups.len() <= layers.len().max(used.len() / 2)).then_some(groups)
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
        let set = if slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
        if set.is_empty() {
            return None;
        }
        // How the coordinates of each texture follow from the first one's.
        let moves: Vec<[DVec2; 2]> =
            material.all_texture_slots().map(|own| between(slot, own)).collect::<Option<_>>()?;
        for &v in triangles.as_flattened() {
            uvs[v as usize] = slot.transform.apply(set[v as usize]);
        }
        let texels = material.all_texture_slots().zip(&moves).fold(DVec2::ONE, |most, (slot, [scale, _])| {
            let image = model.images.get(slot.image);
            most.max(image.map_or(DVec2::ONE, |i| DVec2::new(i.width as f64, i.height as f64)) * *scale)
        });
        let in_texture = |t: usize| {
            let [a, b, c] = mesh.triangles[t].map(|v| uvs[v as usize].as_dvec2());
            (b - a).perp_dot(c - a).abs()
        };
        let read: f64 = of.iter().map(|&t| in_texture(t)).sum::<f64>() * texels.x * texels.y;
        let shown = of.iter().map(|&t| area(t)).sum::<f64>() * pixels;
        let halvings =
            if shown > 0.0 { (0.5 * (read / shown).log2() - DENSITY.log2()).floor().max(0.0) } else { 0.0 };
        // Charts move by tiles where every texture repeats with the same ones.
        let is_same = moves.iter().all(|own| *own == UNMOVED);
        let wraps = material.all_texture_slots().map(|slot| slot.wrap);
        let wrap = wraps
            .reduce(|all, own| [0, 1].map(|k| if all[k] == own[k] { own[k] } else { Wrap::Clamp }))
            .filter(|_| is_same)
            .unwrap_or([Wrap::Clamp; 2]);
        sources.push(Source { triangles, texels: Some(texels / halvings.exp2()), wrap });
    }
    Some((sources, uvs))
}

/// The aspect of textures with which viewers that make up tangents show the same relief: they take directions and strength of a normal
/// map from coordinates (`face_frames.rs`), which have to be scaled alike along u and v. None where a model has tangents or no
/// normal maps, or where textures differ.
fn aspect_of_relief(model: &Model, used: &[usize], sources: &[Source]) -> Option<f64> {
    if !model.mesh.tangents.is_empty() {
        return None;
    }
    let relief = used.iter().zip(sources).filter(|(index, _)| model.materials[**index].has_normal_map());
    let mut aspects = relief.filter_map(|(_, source)| source.texels).map(|texels| texels.x / texels.y);
    let first = aspects.next()?;
    (first.log2().fract() == 0.0 && aspects.all(|other| other == first)).then_some(first)
}

/// Scale and offset of coordinates that are not moved.
const UNMOVED: [DVec2; 2] = [DVec2::ONE, DVec2::ZERO];

/// Scale and offset by which the coordinates of one texture become those of another one of the same material; none where they are
/// of another set, turned or mirrored.
fn between(from: TextureSlot, to: TextureSlot) -> Option<[DVec2; 2]> {
    if from.uv_set != to.uv_set {
        return None;
    }
    if from.transform == to.transform {
        return Some(UNMOVED);
    }
    let scale = to.transform.scale.as_dvec2() / from.transform.scale.as_dvec2();
    let is_plain = from.transform.rotation == 0.0 && to.transform.rotation == 0.0;
    let offset = to.transform.offset.as_dvec2() - from.transform.offset.as_dvec2() * scale;
    (is_plain && scale.is_finite() && scale.min_element() > 0.0).then_some([scale, offset])
}

type Floats = FloatImage<[f32; 4]>;
/// A texture, what lies outside of it, and how its coordinates follow from the source's.
type Texture = (Floats, [Wrap; 2], [DVec2; 2]);

/// Materials on their way into a common texture.
struct Merge<'a> {
    model: &'a Model,
    /// Those that triangles have; each is a source of blocks.
    used: &'a [usize],
    laid_out: &'a Blocks,
}

impl Merge<'_> {
    /// The common maps, those of one value included, and what emission was divided by.
    fn maps(&self) -> (Vec<(MapKind, Image)>, f32) {
        let Self { model, used, .. } = *self;
        let emitted =
            used.iter().map(|&index| factors(&model.materials[index])[MapKind::Emissive].max_element());
        let strength = emitted.fold(1.0, f32::max);
        let map = |kind: MapKind| {
            let texture = |source: usize| {
                self.texture_of(source, texture_slot(&model.materials[used[source]], kind)?, kind, true)
            };
            let parts = self.parts(texture, |source, block, texture| {
                let none = if kind == MapKind::Normal { Vec4::Z } else { Vec4::ONE };
                let mut part = part(texture, block, none);
                let material = &model.materials[used[source]];
                multiply(&mut part, material, kind, strength);
                if kind == MapKind::BaseColor {
                    self.set_alpha(&mut part, material);
                }
                part
            });
            (kind, to_image(kind, &joined(self.laid_out, &parts), true))
        };
        (MapKind::ALL.into_iter().map(map).collect(), strength)
    }

    /// The least cutoff of all that is cut out: alpha that is scaled to it is never more than 1.
    fn cutoff(&self) -> f32 {
        let cut = self.used.iter().map(|&index| &self.model.materials[index]);
        let cutoffs = cut.filter(|own| own.alpha_mode == AlphaMode::Mask).map(|own| own.alpha_cutoff);
        cutoffs.filter(|&cutoff| cutoff > 0.0).reduce(f32::min).unwrap_or(Material::default().alpha_cutoff)
    }

    /// Alpha as the common material understands it: outlines stay where they cross their own cutoff.
    fn set_alpha(&self, part: &mut Floats, material: &Material) {
        let scale = match material.alpha_mode {
            AlphaMode::Mask if material.alpha_cutoff > 0.0 => self.cutoff() / material.alpha_cutoff,
            AlphaMode::Mask | AlphaMode::Opaque => f32::INFINITY,
            AlphaMode::Blend => return,
        };
        for texel in &mut part.texels {
            texel[3] = if scale.is_finite() { texel[3] * scale } else { 1.0 };
        }
    }

    /// The extensions of materials that become one, whose textures are added to the images; `normals` is the common normal map.
    fn extensions(
        &self,
        members: &[usize],
        normals: Option<TextureSlot>,
        images: &mut Vec<Image>,
    ) -> MaterialExtensions {
        let Self { model, used, laid_out } = *self;
        let all: Vec<&MaterialExtensions> =
            members.iter().map(|&index| &model.materials[index].extensions).collect();
        let values = |group: Group, folds: bool| {
            let mut texels = vec![None; laid_out.size[0] * laid_out.size[1]];
            for (source, index) in used.iter().enumerate().filter(|(_, index)| members.contains(index)) {
                let own = &model.materials[*index].extensions;
                let [one, two] = group.slots(own);
                let textures = [(one, group.has_colors()), (two, false)].map(|(slot, is_color)| {
                    slot.and_then(|slot| self.texture_of(source, slot, MapKind::BaseColor, is_color))
                });
                for block in laid_out.blocks.iter().filter(|block| block.source == source) {
                    let parts = textures
                        .each_ref()
                        .map(|texture| texture.as_ref().map(|texture| part(Some(texture), block, Vec4::ONE)));
                    for texel in 0..block.size[0] * block.size[1] {
                        let read =
                            parts.each_ref().map(|part| part.as_ref().map(|p| Vec4::from(p.texels[texel])));
                        let (x, y) = (texel % block.size[0], texel / block.size[0]);
                        let place = (block.place[1] + y) * laid_out.size[0] + block.place[0] + x;
                        texels[place] = Some(group.value(own, read, folds));
                    }
                }
            }
            texels
        };
        let (mut out, own) = joint_extensions(&all, laid_out.size, images.len(), values);
        images.extend(own);
        if let Some(coat) = &mut out.clearcoat {
            coat.normal_texture = self.coat_normals(members, normals, images);
        }
        out
    }

    /// The normals of the clearcoat of materials that become one: those of the surface below it, where they have these, or a map that is
    /// added to the images; none where they have none.
    fn coat_normals(
        &self,
        members: &[usize],
        normals: Option<TextureSlot>,
        images: &mut Vec<Image>,
    ) -> Option<TextureSlot> {
        let Self { model, used, .. } = *self;
        let materials = members.iter().map(|&index| &model.materials[index]);
        let coated = materials.filter_map(|material| {
            let coat = material.extensions.clearcoat.filter(|coat| coat.factor > 0.0)?;
            Some((
                coat,
                coat.normal_texture == material.normal_texture && coat.normal_scale == material.normal_scale,
            ))
        });
        if coated.clone().all(|(coat, _)| coat.normal_texture.is_none()) {
            return None;
        }
        if coated.clone().all(|(_, is_below)| is_below) {
            return normals;
        }
        let coat = |source: usize| {
            let index = Some(used[source]).filter(|index| members.contains(index))?;
            model.materials[index].extensions.clearcoat
        };
        let texture =
            |source: usize| self.texture_of(source, coat(source)?.normal_texture?, MapKind::Normal, false);
        let parts = self.parts(texture, |source, block, texture| {
            let mut part = part(texture, block, Vec4::Z);
            let scale = coat(source).map_or(1.0, |coat| coat.normal_scale);
            part.texels.iter_mut().flat_map(|texel| &mut texel[..2]).for_each(|x| *x *= scale);
            part
        });
        let image = to_image(MapKind::Normal, &joined(self.laid_out, &parts), false);
        images.push(Image { name: "clearcoat normal".into(), ..image });
        Some(TextureSlot { image: images.len() - 1, ..TextureSlot::default() })
    }

    /// The texels of all blocks. A texture is read once for all of its blocks.
    fn parts(
        &self,
        texture: impl Fn(usize) -> Option<Texture>,
        of: impl Fn(usize, &Block, Option<&Texture>) -> Floats,
    ) -> Vec<(&Block, Floats)> {
        let mut parts = Vec::new();
        for source in 0..self.used.len() {
            let texture = texture(source);
            let own = self.laid_out.blocks.iter().filter(|block| block.source == source);
            parts.extend(own.map(|block| (block, of(source, block, texture.as_ref()))));
        }
        parts
    }

    /// A texture, read as a kind of map; as a base colour all of its channels.
    fn texture_of(&self, source: usize, slot: TextureSlot, kind: MapKind, srgb: bool) -> Option<Texture> {
        let first = self.model.materials[self.used[source]].all_texture_slots().next()?;
        let FloatImage { width, height, texels } = from_image(kind, self.model.images.get(slot.image)?, srgb);
        let texels = texels.into_iter().map(|t| t.to_array()).collect();
        Some((FloatImage { width, height, texels }, slot.wrap, between(first, slot)?))
    }
}

/// A texture's texels in a block; `none` where there is no texture.
fn part(texture: Option<&Texture>, block: &Block, none: Vec4) -> Floats {
    match (texture, block.shows) {
        (Some((texture, wrap, [scale, offset])), Some(shows)) => {
            window(texture, *wrap, shows.map(|corner| corner * *scale + *offset), block.size)
        }
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

#[cfg(test)]
#[path = "merged_tests.rs"]
mod tests;
