//! The channels of a material, each as a picture, compared by the same figures as what is seen.
//!
//! At a pixel with coverages `c` and `c'` of both models (what lies behind a pane counts as it shows through), both
//! pictures of a channel are shown with the lesser of the two, `m = min(c, c')`, on black: outlines count in opacity
//! alone. PSNR is that of the pixels that both cover, `MSE = Σ m |x − x'|² / (3 Σ m)`; MS-SSIM and FLIP are of the
//! whole pictures. Opacity is the coverage itself; its PSNR is that of the pixels that either model covers.
//!
//! Contract: values are display-referred, 0 to 1: colours with sRGB's curve, clipped at 1; normals of the common
//! frame as `(n + 1) / 2`; all else as it is, in grey.

use crate::figures::{Metrics, PIXELS_PER_DEGREE, ViewFigures};
use crate::renderer::{PlacedModel, RenderedView};
use parbake_image::display::encode_srgb;
use parbake_image::{MapKind, MapValues};
use parbake_metric::Rgb;
use serde::{Deserialize, Serialize};

/// A channel of glTF's metallic-roughness material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Base colour.
    BaseColor,
    /// Normals as they are seen, those of the surface and of its map together.
    Normal,
    /// Roughness.
    Roughness,
    /// Metallic.
    Metallic,
    /// Emission.
    Emission,
    /// Occlusion.
    Occlusion,
    /// Opacity, outlines included.
    Opacity,
}

/// Figures of a channel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelFigures {
    /// Which.
    pub channel: Channel,
    /// Averages over the views.
    pub mean: ViewFigures,
    /// Each view's figures.
    pub views: Vec<ViewFigures>,
}

/// Less coverage than this is none.
const NOTHING: f32 = 1e-4;

impl Channel {
    /// All of them, in the order in which they are shown.
    pub const ALL: [Self; 7] = [
        Self::BaseColor,
        Self::Normal,
        Self::Roughness,
        Self::Metallic,
        Self::Emission,
        Self::Occlusion,
        Self::Opacity,
    ];

    /// Those that are worth a look: emission and occlusion only where one of the models has any.
    pub fn of<'a>(models: impl Iterator<Item = &'a PlacedModel> + Clone) -> Vec<Self> {
        let is_there = |channel: &Self| match channel {
            Self::Emission => models.clone().any(|model| model.has(MapKind::Emissive)),
            Self::Occlusion => models.clone().any(|model| model.has(MapKind::Occlusion)),
            _ => true,
        };
        Self::ALL.into_iter().filter(is_there).collect()
    }

    /// Its name in words.
    pub fn label(self) -> &'static str {
        match self {
            Self::BaseColor => "base color",
            Self::Normal => "normal",
            Self::Roughness => "roughness",
            Self::Metallic => "metallic",
            Self::Emission => "emission",
            Self::Occlusion => "occlusion",
            Self::Opacity => "opacity",
        }
    }

    /// Whether it is a colour, for which FLIP means something.
    fn is_color(self) -> bool {
        matches!(self, Self::BaseColor | Self::Emission)
    }

    /// The channel's value at a pixel of this coverage, by premultiplied values.
    fn shown(self, values: &MapValues, coverage: f32) -> [f32; 3] {
        let of = |kind: MapKind| values[kind].truncate() / coverage.max(NOTHING);
        let color = |kind| of(kind).to_array().map(|x| encode_srgb(x.clamp(0.0, 1.0)));
        let shown = match self {
            Self::BaseColor => color(MapKind::BaseColor),
            Self::Emission => color(MapKind::Emissive),
            Self::Normal => of(MapKind::Normal).to_array().map(|x| 0.5 + 0.5 * x),
            Self::Roughness => [of(MapKind::MetallicRoughness).y; 3],
            Self::Metallic => [of(MapKind::MetallicRoughness).z; 3],
            Self::Occlusion => [of(MapKind::Occlusion).x; 3],
            Self::Opacity => [coverage; 3],
        };
        shown.map(|x| x.clamp(0.0, 1.0))
    }

    /// The channel's picture before a grey, display-referred; of a view with channels.
    pub fn picture(self, view: &RenderedView, grey: f32) -> Rgb {
        let pixel = |(values, coverage): (&MapValues, f32)| match self {
            Self::Opacity => [coverage.clamp(0.0, 1.0); 3],
            _ => self.shown(values, coverage).map(|x| x * coverage + grey * (1.0 - coverage)),
        };
        Rgb { width: view.size(), height: view.size(), pixels: view.values().map(pixel).collect() }
    }

    /// Both models' pictures as they are compared, and their mean squared error; of views with channels.
    pub fn pair(self, high: &RenderedView, low: &RenderedView) -> ([Rgb; 2], f64) {
        let mut pictures = [0, 1].map(|_| Rgb {
            width: high.size(),
            height: high.size(),
            pixels: Vec::with_capacity(high.values().len()),
        });
        let (mut error, mut weight) = (0.0, 0.0);
        for ((high, c), (low, d)) in high.values().zip(low.values()) {
            let [x, y] = [self.shown(high, c), self.shown(low, d)];
            let (counts, common) = match self {
                Self::Opacity => (if c.max(d) > NOTHING { 1.0 } else { 0.0 }, 1.0),
                _ if c.min(d) > NOTHING => (f64::from(c.min(d)), c.min(d)),
                _ => (0.0, 0.0),
            };
            let square: f64 = (0..3).map(|k| (f64::from(x[k]) - f64::from(y[k])).powi(2)).sum();
            error += counts * square;
            weight += 3.0 * counts;
            for (picture, shown) in pictures.iter_mut().zip([x, y]) {
                picture.pixels.push(shown.map(|x| x * common));
            }
        }
        // Where nothing can be compared nothing agrees.
        (pictures, if weight > 0.0 { error / weight } else { 1.0 })
    }

    /// The figures of two views with channels.
    pub fn compare(self, high: &RenderedView, low: &RenderedView, metrics: Metrics) -> ViewFigures {
        let ([high, low], error) = self.pair(high, low);
        let flip = || parbake_metric::flip(&high, &low, PIXELS_PER_DEGREE).ok();
        ViewFigures {
            psnr: parbake_metric::psnr_from_mse(error),
            ms_ssim: metrics.ms_ssim.then(|| parbake_metric::ms_ssim(&high, &low).ok()).flatten().flatten(),
            flip: (metrics.flip && self.is_color()).then(flip).flatten(),
        }
    }
}
