//! What a stage shows of itself, made a whole model: what would be written now.
//!
//! While vertices and coordinates move, the surface has the stage's own base colour, or the high-poly's, projected; while
//! maps are fitted, all of the material that is known so far.
//!
//! Contract: made only where someone looks; nothing that is computed depends on it.

use crate::map_images::images;
use parbake_fit::baked_materials::Look;
use parbake_fit::parallax_maps::ParallaxMaps;
use parbake_image::quantise::to_image;
use parbake_image::reduced::at_most;
use parbake_image::{FloatImage, MapKind, MapSet};
use parbake_model::glam::Vec4;
use parbake_model::{Material, Mesh, Model, Placement};
use parbake_progress::{MOST_TEXELS, PackedParallax, Snapshot, Watcher};
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;
use parbake_views::projection::project;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Texels along a side of a projected base colour: it is made anew for each snapshot.
const PROJECTED: usize = 256;

/// Of a surface that moves: a model with its base colour alone. Other snapshots are left as they are.
pub(crate) fn of_surface(name: &str, high: &HighPoly, snapshot: Snapshot) -> Snapshot {
    let Snapshot::Surface { mut mesh, color } = snapshot else { return snapshot };
    unplace(&mut mesh, &high.frame);
    mesh.triangle_materials.fill(0);
    mesh.tangents.clear();
    mesh.colors.clear();
    mesh.uvs1.clear();
    let mut model =
        Model { name: name.into(), mesh, materials: vec![Material::default()], ..Model::default() };
    let color = color.or_else(|| projected(&model, high)).map(|color| at_most(&color, MOST_TEXELS));
    if let Some(color) = color {
        let mut maps = MapSet::new(color.width);
        maps.insert(MapKind::BaseColor, color);
        let look = Look::without_extensions(high, Vec::new());
        let images = images(&maps, high.conventions.srgb());
        look.add_maps(&mut model.materials[0], &mut model.images, images);
    }
    Snapshot::Model(model)
}

/// The high-poly's base colour on this model; none without coordinates.
fn projected(model: &Model, high: &HighPoly) -> Option<FloatImage<Vec4>> {
    let low = LowPoly::new(model, &high.frame, PROJECTED).ok()?;
    project(&low, high).maps.get_mut(MapKind::BaseColor).map(std::mem::take)
}

/// Takes a mesh out of the common frame.
fn unplace(mesh: &mut Mesh, frame: &Placement) {
    for point in &mut mesh.positions {
        *point = *point / frame.scale + frame.centre;
    }
    for offset in &mut mesh.parallax_offsets {
        *offset /= frame.scale;
    }
}

/// Shows a low-poly that no stage moves now, if someone wants to see it.
pub(crate) fn show(low: &Model, high: &HighPoly, watcher: &dyn Watcher) {
    if watcher.wants_snapshot() {
        let mut mesh = low.mesh.clone();
        high.frame.apply(&mut mesh);
        watcher.snapshot(of_surface(&low.name, high, Snapshot::Surface { mesh, color: None }));
    }
}

/// Of a surface whose maps are fitted.
pub(crate) struct OfMaps<'a> {
    look: &'a Look,
    low: &'a Model,
    mesh: &'a Mesh,
    srgb: bool,
    start: &'a MapSet,
    /// As last seen, since stages show the maps that they move; nothing before the first snapshot.
    known: Mutex<BTreeMap<MapKind, FloatImage<Vec4>>>,
}

impl<'a> OfMaps<'a> {
    /// Of `low`, written as `mesh`, whose maps are these to begin with.
    pub fn new(look: &'a Look, low: &'a Model, mesh: &'a Mesh, start: &'a MapSet, srgb: bool) -> Self {
        Self { look, low, mesh, srgb, start, known: Mutex::default() }
    }

    /// The model with what is known of its maps. `parallax` is that of maps which are known, where the snapshot has none
    /// that moves.
    pub fn complete(&self, snapshot: Snapshot, parallax: Option<&ParallaxMaps>) -> Option<Snapshot> {
        let Snapshot::Maps { maps, parallax: moving } = snapshot else { return Some(snapshot) };
        // Nobody panics while holding it; if someone did, there is nothing to see.
        let mut known = self.known.lock().ok()?;
        if known.is_empty() {
            let start = self.start.iter().map(|(kind, map)| (kind, at_most(map, MOST_TEXELS)));
            known.extend(start);
        }
        known.extend(maps.iter().map(|(kind, map)| (kind, map.clone())));
        // Some share an image, and stages move maps of other sizes than are written.
        let side = known.values().map(|map| map.width).max().unwrap_or(0);
        let image = |(&kind, map): (&MapKind, &FloatImage<Vec4>)| {
            (kind, to_image(kind, &enlarged(map, side), self.srgb))
        };
        let images = known.iter().map(image).collect();
        let parallax =
            moving.or_else(|| parallax.map(|maps| PackedParallax::new(|images| maps.pack(images))));
        let (map, before) = parallax.map_or((None, Vec::new()), |shift| (Some(shift.map), shift.images));
        Some(Snapshot::Model(self.look.dressed(self.low, self.mesh, images, before, |_| map)))
    }
}

/// A square map with texels repeated to fill `side`².
fn enlarged(map: &FloatImage<Vec4>, side: usize) -> FloatImage<Vec4> {
    let at = |i: usize| i * map.width / side;
    let texel = |i: usize| map.texels[at(i / side) * map.width + at(i % side)];
    match map.width == side || map.texels.is_empty() {
        true => map.clone(),
        false => FloatImage::square(side, (0..side * side).map(texel).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::conventions;
    use crate::options::BakeOptions;

    /// Protects the look of a running bake: a stage that moves one map, of another size than the others, leaves these as
    /// they were.
    #[test]
    fn what_a_stage_does_not_move_stays() {
        let (high, low) = crate::demo_pair();
        let high = HighPoly::new(&high, conventions(&BakeOptions::default())).expect("it has extent");
        let look = Look::without_extensions(&high, Vec::new());
        let solid = |side: usize, value: f32| FloatImage::solid(side, Vec4::splat(value));
        let mut color = solid(4, 1.0);
        // Of one value it would become a factor.
        color.texels[15] = Vec4::ZERO;
        let start = MapSet::of(color, FloatImage::solid(4, Vec4::Z));
        let shown = OfMaps::new(&look, &low, &low.mesh, &start, false);
        let mut maps = MapSet::new(8);
        maps.insert(MapKind::Normal, FloatImage::solid(8, Vec4::X));
        let Some(Snapshot::Model(model)) = shown.complete(Snapshot::Maps { maps, parallax: None }, None)
        else {
            panic!("there is a model");
        };
        let images: Vec<_> = model.images.iter().map(|i| (i.width, i.pixels[0])).collect();
        assert_eq!(images, [(8, [255; 4]), (8, [255, 128, 128, 255])]);
    }
}
