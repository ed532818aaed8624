//! A place to photograph models in: the frame of one high-poly, cameras around it, one way to
//! read textures, one shading and one display.
//!
//! ```text
//! high-poly ─ frame, shading ─┬ scene(model) ─┬ picture(scene, direction) ─ on a background
//! conventions ────────────────┴───────────────┘                           └ channels of its material
//! ```
//!
//! Contract: pictures are display-referred, row 0 on top, and depend on the arguments only. All
//! models of a studio stand in the high-poly's frame, so their pictures lie on each other, and all are
//! shaded alike.

use crate::error::BakeError;
use crate::evaluate::options::EvaluateOptions;
use crate::options::Shading;
use parbake_image::display::Display;
use parbake_image::{MapKind, MapValues};
use parbake_metric::Rgb;
use parbake_model::glam::Vec3;
use parbake_model::{Model, Placement};
use parbake_render::camera::Camera;
use parbake_render::lighting::Lighting;
use parbake_render::metallic_roughness::MetallicRoughness;
use parbake_render::scene::{Picture, Scene};
use parbake_render::scene_material::MaterialPicture;
use parbake_views::frame::{common_frame, needs_whole_material, scene};
use parbake_views::high_poly::HEADLIGHT_BRDF;

/// Where models are photographed.
#[derive(Clone, Debug)]
pub struct Studio {
    frame: Placement,
    options: EvaluateOptions,
    /// None where a headlight shines on matte surfaces.
    whole: Option<MetallicRoughness>,
    /// Whether roughness grows where vertex normals turn, as viewers do it.
    widens_highlights: bool,
}

/// A model made ready for its pictures.
pub struct Subject(Scene);

/// A picture whose background is still open.
pub struct Shot {
    picture: Picture,
    values: Vec<MapValues>,
}

impl Studio {
    /// The studio of a high-poly; of `options` all but the number of views and the background.
    ///
    /// # Errors
    /// An option out of range; a model without extent.
    pub fn new(high: &Model, options: &EvaluateOptions) -> Result<Self, BakeError> {
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

    /// Brings a model in.
    pub fn subject(&self, model: &Model) -> Subject {
        let mut scene = scene(model, &self.frame, self.options.interpretation());
        // As in the fit. What would stand in for an extension depends on how a file writes it.
        if self.whole.is_some() {
            scene.leave_out_extensions();
        }
        Subject(scene)
    }

    /// Photographs it from `direction`, of unit length: the camera stands there and looks at the
    /// middle, +Y up.
    pub fn shot(&self, subject: &Subject, direction: Vec3) -> Shot {
        self.photograph(subject, &self.camera(direction), self.size(), false)
    }

    /// The same with what its maps hold, for [`Channel`](crate::Channel)s; of matte surfaces nothing.
    pub fn shot_with_channels(&self, subject: &Subject, direction: Vec3) -> Shot {
        self.photograph(subject, &self.camera(direction), self.size(), true)
    }

    /// Photographs it with any camera, and with what its maps hold if `with_channels`. `size` is how many pixels a
    /// side of the picture has, and how many samples a side of a pixel.
    pub fn photograph(
        &self,
        subject: &Subject,
        camera: &Camera,
        size: (usize, usize),
        with_channels: bool,
    ) -> Shot {
        match &self.whole {
            None => Shot {
                picture: subject.0.render(&HEADLIGHT_BRDF, camera, size.0, size.1),
                values: Vec::new(),
            },
            Some(brdf) => {
                let MaterialPicture { light, values } =
                    subject.0.render_material(brdf, camera, size, self.widens_highlights, with_channels);
                Shot { picture: light, values }
            }
        }
    }

    /// The shot as a screen shows it before `background`, in linear light.
    pub fn develop(&self, shot: &Shot, background: [f32; 3]) -> Rgb {
        shown(&shot.picture, &self.options.display(), background)
    }

    /// Pixels along a side, and samples along a side of a pixel.
    fn size(&self) -> (usize, usize) {
        (self.options.resolution, self.options.supersample)
    }

    fn camera(&self, direction: Vec3) -> Camera {
        Camera::towards_origin(direction, self.options.radius, self.options.projection())
    }
}

impl Subject {
    /// The model in the studio's frame.
    pub fn scene(&self) -> &Scene {
        &self.0
    }

    /// Whether a material has more of this map than its neutral value.
    pub fn has(&self, kind: MapKind) -> bool {
        self.0.has(kind)
    }
}

impl Shot {
    /// Pixels along a side.
    pub fn size(&self) -> usize {
        self.picture.size
    }

    /// What the maps hold at each pixel, premultiplied by its coverage, and the coverage, 0 to 1; nothing where the
    /// shot was taken without.
    pub fn values(&self) -> impl ExactSizeIterator<Item = (&MapValues, f32)> {
        self.values.iter().zip(&self.picture.rgba).map(|(values, rgba)| (values, rgba[3]))
    }
}

/// A picture as a screen shows it; light strengthens the model and not what is behind it.
pub fn shown(picture: &Picture, display: &Display, background: [f32; 3]) -> Rgb {
    let after = Display { gain: 1.0, ..*display };
    let pixel = |p: &[f32; 4]| -> [f32; 3] {
        std::array::from_fn(|k| {
            after.encode(p[k] * display.gain + (1.0 - p[3]) * background[k]).clamp(0.0, 1.0)
        })
    };
    // Most pixels show nothing, and powers take long.
    let empty = pixel(&[0.0; 4]);
    let pixels = picture.rgba.iter().map(|p| if *p == [0.0; 4] { empty } else { pixel(p) }).collect();
    Rgb { width: picture.size, height: picture.size, pixels }
}
