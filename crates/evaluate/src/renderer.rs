//! Renders models for comparison: in the frame of one high-poly, by cameras around it, with one way to
//! read textures, one shading and one display curve.
//!
//! ```text
//! high-poly ─ frame, shading ─┬ place(model) ─┬ render(model, direction) ─┬ tonemap, on a background
//! options ────────────────────┴───────────────┘                           └ channels of its material
//! ```
//!
//! Contract: pictures are display-referred, row 0 on top, and depend on the arguments only. All
//! models of a renderer stand in the high-poly's frame, so their pictures lie on each other, and all are
//! shaded alike.

use crate::conventions::Shading;
use crate::error::EvaluateError;
use crate::options::EvaluateOptions;
use parbake_image::display::Display;
use parbake_image::{MapKind, MapValues};
use parbake_metric::Rgb;
use parbake_model::glam::Vec3;
use parbake_model::{Mesh, Model, Placement};
use parbake_render::camera::Camera;
use parbake_render::interpretation::Interpretation;
use parbake_render::lighting::Lighting;
use parbake_render::metallic_roughness::MetallicRoughness;
use parbake_render::scene::{Picture, Scene};
use parbake_render::scene_material::MaterialPicture;
use parbake_views::frame::{common_frame, needs_whole_material, placed as mesh_in_frame, scene};
use parbake_views::high_poly::HEADLIGHT_BRDF;

/// Renders models in one frame, all alike.
#[derive(Clone, Debug)]
pub struct Renderer {
    frame: Placement,
    options: EvaluateOptions,
    /// None where a headlight shines on matte surfaces.
    whole: Option<MetallicRoughness>,
    /// Whether roughness grows where vertex normals turn, as viewers do it.
    widens_highlights: bool,
}

/// A model in the renderer's frame.
pub struct PlacedModel(Scene);

/// A view whose background is still open.
pub struct RenderedView {
    picture: Picture,
    values: Vec<MapValues>,
}

impl Renderer {
    /// The renderer of a high-poly's frame; of `options` all but the number of views and the background.
    ///
    /// # Errors
    /// An option out of range; a model without extent.
    pub fn new(high: &Model, options: &EvaluateOptions) -> Result<Self, EvaluateError> {
        options.check()?;
        let is_whole = match options.shading {
            Shading::Auto => options.convention.decodes_srgb() && needs_whole_material(high),
            shading => shading == Shading::Pbr,
        };
        let whole = is_whole.then(MetallicRoughness::in_studio);
        Ok(Self { frame: common_frame(high)?, options: options.clone(), whole, widens_highlights: false })
    }

    /// The same with roughness raised where vertex normals turn from sample to sample, as three.js does.
    pub fn as_viewers_do(self) -> Self {
        Self { widens_highlights: true, ..self }
    }

    /// The same under another light, if whole materials are shown.
    pub fn under(mut self, lighting: Lighting) -> Self {
        if let Some(brdf) = &mut self.whole {
            brdf.lighting = lighting;
        }
        self
    }

    /// How it shades: [`Shading::Pbr`], or [`Shading::Lambert`].
    pub fn shading(&self) -> Shading {
        if self.whole.is_some() { Shading::Pbr } else { Shading::Lambert }
    }

    /// Places a model in the frame.
    pub fn place(&self, model: &Model) -> PlacedModel {
        let interpretation =
            Interpretation { extensions: self.whole.is_some(), ..self.options.interpretation() };
        PlacedModel(scene(model, &self.frame, interpretation))
    }

    /// Places a model that has the materials and images of one that stands there, and another mesh: textures are not unpacked again.
    pub fn place_like(&self, model: &Model, placed: &PlacedModel) -> PlacedModel {
        PlacedModel(placed.0.with_mesh(mesh_in_frame(model, &self.frame)))
    }

    /// Renders it from `direction`, of unit length: the camera stands there and looks at the
    /// middle, +Y up.
    pub fn render(&self, model: &PlacedModel, direction: Vec3) -> RenderedView {
        self.render_from(model, &self.camera(direction), self.size(), false)
    }

    /// The same with what its maps hold, for [`Channel`](crate::channels::Channel)s; of matte surfaces nothing.
    pub fn render_with_channels(&self, model: &PlacedModel, direction: Vec3) -> RenderedView {
        self.render_from(model, &self.camera(direction), self.size(), true)
    }

    /// Renders it with any camera, and with what its maps hold if `with_channels`. `size` is how many pixels a
    /// side of the picture has, and how many samples a side of a pixel.
    pub fn render_from(
        &self,
        model: &PlacedModel,
        camera: &Camera,
        size: (usize, usize),
        with_channels: bool,
    ) -> RenderedView {
        match &self.whole {
            None => RenderedView {
                picture: model.0.render(&HEADLIGHT_BRDF, camera, size.0, size.1),
                values: Vec::new(),
            },
            Some(brdf) => {
                let MaterialPicture { light, values } =
                    model.0.render_material(brdf, camera, size, self.widens_highlights, with_channels);
                RenderedView { picture: light, values }
            }
        }
    }

    /// The view as a screen shows it on `background`, which is in linear light.
    pub fn tonemap(&self, view: &RenderedView, background: [f32; 3]) -> Rgb {
        tonemapped(&view.picture, &self.options.display(), background)
    }

    /// The same on each background. What covers a pixel looks the same on all.
    pub(crate) fn tonemap_on(&self, view: &RenderedView, backgrounds: &[[f32; 3]]) -> Vec<Rgb> {
        let mut shown: Vec<Rgb> = Vec::with_capacity(backgrounds.len());
        for &background in backgrounds {
            let next = tonemapped_as(&view.picture, &self.options.display(), background, shown.first());
            shown.push(next);
        }
        shown
    }

    /// The positions of a mesh in the frame of all.
    pub(crate) fn in_frame(&self, mesh: &Mesh) -> Vec<Vec3> {
        let mut placed = Mesh { positions: mesh.positions.clone(), ..Mesh::default() };
        self.frame.apply(&mut placed);
        placed.positions
    }

    /// Pixels along a side, and samples along a side of a pixel.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.options.resolution, self.options.supersample)
    }

    /// The camera of a direction, of unit length.
    pub(crate) fn camera(&self, direction: Vec3) -> Camera {
        Camera::towards_origin(direction, self.options.radius, self.options.projection())
    }
}

impl PlacedModel {
    /// The model in the renderer's frame.
    pub fn scene(&self) -> &Scene {
        &self.0
    }

    /// Whether a material has more of this map than its neutral value.
    pub fn has(&self, kind: MapKind) -> bool {
        self.0.has(kind)
    }
}

impl RenderedView {
    /// Pixels along a side.
    pub fn size(&self) -> usize {
        self.picture.size
    }

    /// What the maps hold at each pixel, premultiplied by its coverage, and the coverage, 0 to 1; nothing where the
    /// view was rendered without.
    pub fn values(&self) -> impl ExactSizeIterator<Item = (&MapValues, f32)> {
        self.values.iter().zip(&self.picture.rgba).map(|(values, rgba)| (values, rgba[3]))
    }
}

/// A picture as a screen shows it; the gain brightens the model, not what is behind it.
pub fn tonemapped(picture: &Picture, display: &Display, background: [f32; 3]) -> Rgb {
    tonemapped_as(picture, display, background, None)
}

/// The same; pixels without background are taken from `known`, the same picture on another one.
fn tonemapped_as(picture: &Picture, display: &Display, background: [f32; 3], known: Option<&Rgb>) -> Rgb {
    let after = Display { gain: 1.0, ..*display };
    let pixel = |p: &[f32; 4]| -> [f32; 3] {
        std::array::from_fn(|k| {
            after.encode(p[k] * display.gain + (1.0 - p[3]) * background[k]).clamp(0.0, 1.0)
        })
    };
    // Most pixels show nothing, and powers take long.
    let empty = pixel(&[0.0; 4]);
    let shown = |(index, p): (usize, &[f32; 4])| match known {
        _ if *p == [0.0; 4] => empty,
        Some(known) if p[3] == 1.0 => known.pixels[index],
        _ => pixel(p),
    };
    let pixels = picture.rgba.iter().enumerate().map(shown).collect();
    Rgb { width: picture.size, height: picture.size, pixels }
}
