//! What a stage shows of itself, made a whole model: what would be written now.
//!
//! While vertices and coordinates move, the surface has the stage's own base colour, or the high-poly's, projected; while
//! maps are fitted, all of the material that is known so far.
//!
//! Contract: made only where someone looks; nothing that is computed depends on it.

use crate::bake::images;
use crate::look::Look;
use parbake_fit::parallax_maps::ParallaxMaps;
use parbake_image::reduced::{all_at_most, at_most};
use parbake_image::{FloatImage, MapKind, MapSet};
use parbake_model::glam::Vec4;
use parbake_model::{Material, Mesh, Model, Placement};
use parbake_progress::{MOST_TEXELS, PackedParallax, Snapshot};
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;
use parbake_views::projection::project;
use std::sync::Mutex;

/// Texels along a side of a projected base colour: it is made anew for each snapshot.
const PROJECTED: usize = 256;

/// Of a surface that moves: a model with its base colour alone. Other snapshots are left as they are.
pub(crate) fn of_surface(name: &str, high: &HighPoly, snapshot: Snapshot) -> Snapshot {
    let Snapshot::Surface { mut mesh, color } = snapshot else { return snapshot };
    unplace(&mut mesh, &high.frame);
    mesh.triangle_materials.fill(0);
    mesh.tangents.clear();
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

/// Of a surface whose maps are fitted.
pub(crate) struct OfMaps<'a> {
    look: &'a Look,
    low: &'a Model,
    mesh: &'a Mesh,
    srgb: bool,
    /// As last seen: stages show the maps that they move.
    known: Mutex<MapSet>,
}

impl<'a> OfMaps<'a> {
    /// Of `low`, written as `mesh`, whose maps are these to begin with; they count only where `is_seen`.
    pub fn new(
        look: &'a Look,
        low: &'a Model,
        mesh: &'a Mesh,
        start: &MapSet,
        srgb: bool,
        is_seen: bool,
    ) -> Self {
        let known = if is_seen { all_at_most(start, MOST_TEXELS) } else { MapSet::default() };
        Self { look, low, mesh, srgb, known: Mutex::new(known) }
    }

    /// The model with what is known of its maps. `parallax` is that of maps which are known, where the snapshot has none
    /// that moves.
    pub fn complete(&self, snapshot: Snapshot, parallax: Option<&ParallaxMaps>) -> Option<Snapshot> {
        let Snapshot::Maps { maps, parallax: moving } = snapshot else { return Some(snapshot) };
        // Nobody panics while holding it; if someone did, there is nothing to see.
        let mut known = self.known.lock().ok()?;
        if maps.size() != known.size() {
            *known = maps;
        } else {
            maps.iter().for_each(|(kind, map)| known.insert(kind, map.clone()));
        }
        let parallax =
            moving.or_else(|| parallax.map(|maps| PackedParallax::new(|images| maps.pack(images))));
        let maps = images(&known, self.srgb);
        let (map, before) = parallax.map_or((None, Vec::new()), |shift| (Some(shift.map), shift.images));
        Some(Snapshot::Model(self.look.dressed(self.low, self.mesh, maps, before, |_| map)))
    }
}
