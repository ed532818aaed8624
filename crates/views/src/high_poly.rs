//! The high-poly, prepared once: its frame, its scene, its surface and its rendered views serve any
//! number of low-polys, levels of detail and passes.
//!
//! ```text
//! model ─ frame ─┬ scene (what cameras see) ─ references(view set) ─ kept, if asked for
//!                └ surface (what rays hit)
//! ```
//!
//! Contract: everything depends on the model and the [`Conventions`] alone, not on the low-poly.
//! Reference views depend on their [`ViewSet`] and not on the number of threads.

use crate::alpha_in_effect::with_alpha_in_effect;
use crate::contradicting_normals::contradicting_normals;
use crate::error::PrepareError;
use crate::extension_values::ExtensionSource;
use crate::frame::{common_frame, needs_whole_material, placed};
use crate::pool::{Rig, View, view_pool};
use crate::reference::{Reference, Sampling, render_references};
use crate::unlit::with_unlit_as_emission;
use parbake_image::MapKind;
use parbake_image::display::Display;
use parbake_mesh::HighSurface;
use parbake_model::{Model, Placement};
use parbake_progress::Watcher;
use parbake_render::interpretation::Interpretation;
use parbake_render::scene::Scene;
use parbake_render::shade::{Brdf, Lambert};
use std::borrow::Cow;
use std::sync::{Arc, Mutex};

/// The BRDF under a headlight. Reference views are rendered with it; vertices, parallax maps and, where whole
/// materials are not fitted, textures are fitted to these with it, and evaluation shows such bakes with it. All of
/// them take it from here, so that they agree.
pub const HEADLIGHT_BRDF: Lambert = Lambert;

/// How a bake sees its models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conventions {
    /// How textures are read.
    pub interpretation: Interpretation,
    /// Light strength and display curve of the comparison.
    pub display: Display,
    /// Whether the whole metallic-roughness material is fitted, and not only what a headlight shows of
    /// colours, normals and emission; none where the high-poly's materials decide.
    pub whole_material: Option<bool>,
    /// Where cameras stand.
    pub rig: Rig,
    /// How far to either side of the low-poly projection looks for the high-poly, in the common
    /// frame, in which the high-poly's longest side is 2.
    pub max_distance: f32,
}

impl Conventions {
    /// Whether base colour is decoded from sRGB before shading, and stored as sRGB.
    pub fn srgb(&self) -> bool {
        self.interpretation.decode_srgb
    }
}

/// A set of training views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewSet {
    /// How many views.
    pub count: usize,
    /// Random seed of the directions and of the shifts of the pixel grids.
    pub seed: u64,
    /// Whether each view's pixel grid is shifted by its own fraction of a pixel.
    pub jitter: bool,
    /// How pixels are sampled.
    pub sampling: Sampling,
}

impl ViewSet {
    /// The views themselves.
    pub fn views(&self, rig: &Rig) -> Vec<View> {
        let mut views = view_pool(self.count, rig, self.seed);
        if !self.jitter {
            views.iter_mut().for_each(|view| view.jitter = [0.0; 2]);
        }
        views
    }
}

/// A set of views with its pictures.
type KeptViews = (ViewSet, Arc<Vec<Reference>>);

/// A high-poly ready for bakes.
pub struct HighPoly {
    /// The model's name.
    pub name: String,
    /// Its triangles.
    pub triangles: usize,
    /// The common frame: the high-poly's box lies in [−1, 1]³.
    pub frame: Placement,
    /// How it is seen.
    pub conventions: Conventions,
    /// What cameras see.
    pub scene: Scene,
    /// What rays hit.
    pub surface: HighSurface,
    /// Whether the whole metallic-roughness material is fitted.
    pub is_whole_material: bool,
    /// What emission was divided by so that maps, which end at 1, can hold it; 1 where only a headlight's
    /// view is fitted.
    pub emissive_strength: f32,
    /// What its materials' extensions say.
    pub extensions: ExtensionSource,
    /// Sentences about what a bake does not show as the model's maker may expect: what asks for transparency and is
    /// opaque, what is unlit beside lit materials, normals that look to the back of their triangles.
    pub changed: Vec<String>,
    /// How much each triangle counts, for texels and for triangles of a low-poly; empty where all count alike.
    pub importances: Vec<f32>,
    /// Rendered view sets that are kept; none where they are not to be.
    kept: Option<Mutex<Vec<KeptViews>>>,
}

impl HighPoly {
    /// Prepares a model for one bake: rendered views are freed when the last user drops them.
    ///
    /// # Errors
    /// Where the model has no extent.
    pub fn new(model: &Model, conventions: Conventions) -> Result<Self, PrepareError> {
        let frame = common_frame(model)?;
        let mesh = placed(model, &frame);
        let is_whole_material =
            conventions.whole_material.unwrap_or_else(|| conventions.srgb() && needs_whole_material(model));
        // A headlight on matte surfaces lights all materials, here and where bakes are judged.
        let (materials, alpha) = with_alpha_in_effect(model);
        let (materials, unlit) = match is_whole_material {
            true => with_unlit_as_emission(&materials, &model.mesh),
            false => (Cow::Borrowed(&materials[..]), None),
        };
        let (mut scene, surface) = rayon::join(
            || Scene::new(mesh.clone(), &materials, &model.images, conventions.interpretation),
            || HighSurface::new(&mesh),
        );
        let (name, triangles) = (model.name.clone(), model.mesh.triangles.len());
        let images = if is_whole_material { &model.images[..] } else { &[] };
        let extensions = ExtensionSource::new(&materials, images);
        if is_whole_material {
            scene.leave_out_extensions();
        }
        let emissive_strength = if is_whole_material { scene.strongest_emission().max(1.0) } else { 1.0 };
        if emissive_strength > 1.0 {
            scene.scale_emission(1.0 / emissive_strength);
        }
        Ok(Self {
            name,
            triangles,
            frame,
            conventions,
            scene,
            surface,
            is_whole_material,
            emissive_strength,
            extensions,
            changed: alpha.into_iter().chain(unlit).chain(contradicting_normals(&model.mesh)).collect(),
            importances: Vec::new(),
            kept: None,
        })
    }

    /// The same for several bakes: each set of views is rendered once and kept, 8 bytes a pixel.
    pub fn keeping_views(self) -> Self {
        Self { kept: Some(Mutex::default()), ..self }
    }

    /// The kinds of maps that a bake fits: base colour and normals, and those others that the
    /// high-poly's materials have and its BRDF reads; metallic-roughness always where the whole material
    /// is fitted.
    pub fn kinds(&self) -> impl Iterator<Item = MapKind> + '_ {
        let always = [MapKind::BaseColor, MapKind::Normal];
        let whole = self.is_whole_material;
        MapKind::ALL.into_iter().filter(move |kind| {
            let is_read = if whole { true } else { HEADLIGHT_BRDF.reads(*kind) };
            let is_there = self.scene.has(*kind) || (whole && *kind == MapKind::MetallicRoughness);
            is_read && (always.contains(kind) || is_there)
        })
    }

    /// The high-poly from each view of a set. Stops early, with fewer views, when asked to, but never
    /// before the first one is done.
    pub fn references(&self, set: &ViewSet, watcher: &dyn Watcher) -> Arc<Vec<Reference>> {
        let kept = || self.kept.as_ref().and_then(|kept| kept.lock().ok());
        let found = kept().and_then(|kept| kept.iter().find(|(own, _)| own == set).map(|(_, r)| r.clone()));
        if let Some(found) = found {
            return found;
        }
        let views = set.views(&self.conventions.rig);
        let rendered =
            Arc::new(render_references(&self.scene, &HEADLIGHT_BRDF, &views, &set.sampling, 1, watcher));
        // What was stopped early is not the whole set.
        if let Some(mut kept) = kept().filter(|_| rendered.len() == set.count) {
            kept.push((*set, rendered.clone()));
        }
        rendered
    }
}
