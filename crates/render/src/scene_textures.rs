//! A scene's materials, ready to be fetched from: factors, textures (`scene_pyramids.rs`), parallax maps and cutouts with
//! their coefficients, and what extensions add (`scene_layers.rs`).
//!
//! Contract: one interpretation goes for all of them; parallax maps that it leaves out, or
//! that break their contract, are not there.

use crate::cutout::CutoutCoefficients;
use crate::directions::{VertexFrame, ViewDirection, view_direction};
use crate::interpolate::{Barycentrics, interpolate};
use crate::parallax::ParallaxCoefficients;
use crate::scene_layers::SurfaceLayers;
use crate::scene_pyramids::{Map, Pyramids, Use};
use parbake_image::display::encode_srgb;
use parbake_image::maps::KINDS;
use parbake_image::material_maps::{
    factors, fitted_alpha, sheen_albedo, shifted_texture_slot, texture_slot, transmits,
};
use parbake_image::{Encoding, MapKind, MapValues};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{AlphaMode, Material, Mesh};

/// The textures of a look, one of each kind at most.
pub(crate) type Textures = [Option<Map>; KINDS];

/// A look whose coordinates shift, by what, and what is left out of it.
#[derive(Clone)]
pub(crate) struct Shifted {
    pub textures: Textures,
    pub parallax: ParallaxCoefficients,
    pub cutout: Option<CutoutCoefficients>,
    /// As in [`parbake_model::ParallaxMap`].
    pub fade: f32,
}

/// A point of a triangle on the screen, and from where it is seen.
#[derive(Clone, Copy)]
pub(crate) struct SeenPoint<'a> {
    pub mesh: &'a Mesh,
    pub corners: [usize; 3],
    pub at: &'a Barycentrics,
    /// Unit vector.
    pub to_viewer: Vec3,
    /// Scales the pixel that `at` knows.
    pub footprint: f32,
}

impl SeenPoint<'_> {
    /// The interpolated vertex frame; without tangents one with no tangent, in which lines stand upright.
    fn frame(&self) -> VertexFrame {
        let Self { mesh, corners, at, .. } = *self;
        let of = |i: usize| mesh.tangents.get(i).copied().unwrap_or_default();
        VertexFrame {
            normal: interpolate(corners.map(|i| mesh.normals[i]), at.weights),
            tangent: interpolate(corners.map(|i| of(i).truncate()), at.weights),
            handedness: of(corners[0]).w,
        }
    }
}

impl Shifted {
    /// That of a material's parallax map, if it has a sound one that the interpretation asks for.
    fn new(material: &Material, pyramids: &mut Pyramids) -> Option<Self> {
        let map = material.parallax.as_ref().filter(|_| pyramids.interpretation.parallax)?;
        let parallax = ParallaxCoefficients::unpack(map, pyramids.images)?;
        let cutout =
            map.cutout.as_ref().and_then(|c| CutoutCoefficients::unpack(c, map.wrap, pyramids.images));
        let textures = MapKind::ALL.map(|kind| pyramids.map(kind, shifted_texture_slot(material, kind)));
        Some(Self { textures, parallax, cutout, fade: map.fade })
    }

    /// Where the maps are fetched at a point of a triangle: at the base colour's coordinate,
    /// or at the normal's where there is no colour.
    /// With from where that is seen, and how much of the maps is left under this pixel, 0 … 1: the more, the smaller
    /// its footprint, as if the surface were seen face on. At grazing angles, where maps are worth most, footprints grow.
    fn anchor(&self, seen: &SeenPoint) -> Option<(Vec2, ViewDirection, f32)> {
        let [color, normal] = [MapKind::BaseColor, MapKind::Normal].map(|kind| &self.textures[kind as usize]);
        let map = color.as_ref().or(normal.as_ref())?;
        let uvs = map.uvs(seen.mesh, seen.corners);
        let along = |w: [f32; 3]| -> Vec2 { interpolate(uvs, w) };
        let reach = along(seen.at.per_x).length().max(along(seen.at.per_y).length()) * seen.footprint;
        let view_direction = view_direction(self.parallax.basis, &seen.frame(), seen.to_viewer);
        let left = (2.0 - view_direction.cosine.abs() * reach / self.fade).clamp(0.0, 1.0);
        Some((along(seen.at.weights), view_direction, left))
    }

    /// How far coordinates move at a point of a triangle.
    pub fn at(&self, seen: &SeenPoint) -> Vec2 {
        self.anchor(seen)
            .map_or(Vec2::ZERO, |(uv, view_direction, left)| left * self.parallax.shift(uv, &view_direction))
    }

    /// Whether a point of a triangle is there.
    pub fn is_opaque(&self, seen: &SeenPoint) -> bool {
        let Some(cutout) = &self.cutout else { return true };
        let is_there = |(uv, view_direction, left): (Vec2, ViewDirection, f32)| {
            1.0 + left * (cutout.opacity(uv, view_direction.direction) - 1.0) >= 0.0
        };
        self.anchor(seen).is_none_or(is_there)
    }
}

/// The gloss of cloth.
#[derive(Clone)]
pub(crate) struct Sheen {
    /// Linear.
    pub color: Vec3,
    /// That of a white sheen of the same roughness.
    pub albedo: f32,
    /// Multiplies the colour.
    pub texture: Option<Map>,
}

/// One material.
#[derive(Clone)]
pub(crate) struct Surface {
    /// What multiplies the textures, as they are read.
    pub factors: MapValues,
    /// What is added to the base colour for the gloss of cloth; none where layers show it.
    pub sheen: Option<Sheen>,
    /// What extensions show.
    pub layers: Option<SurfaceLayers>,
    /// Whether light passes it.
    pub transmits: bool,
    /// Alpha mode and factor of opacity as the material says.
    pub own_alpha: (AlphaMode, f32),
    /// How alpha is to be understood.
    pub alpha_mode: AlphaMode,
    /// Below this it is cut out, where it is a mask.
    pub alpha_cutoff: f32,
    /// Whether the base colour is shown as it is.
    pub is_unlit: bool,
    /// Whether its back is seen.
    pub is_double_sided: bool,
    /// The base colour's alpha in all three channels, where it counts.
    pub opacity: Option<Map>,
    /// As viewers see it that know no parallax.
    pub plain: Textures,
    /// As all others do.
    pub shifted: Option<Shifted>,
}

impl Surface {
    /// A material's, with its textures unpacked.
    pub fn new(material: &Material, pyramids: &mut Pyramids) -> Self {
        let mut factors = factors(material);
        if !pyramids.interpretation.decode_srgb {
            for kind in MapKind::ALL.into_iter().filter(|kind| kind.spec().encoding == Encoding::Srgb) {
                factors[kind] = Vec4::from(factors[kind].to_array().map(encode_srgb));
            }
        }
        let plain = MapKind::ALL.map(|kind| pyramids.map(kind, texture_slot(material, kind)));
        let shows_layers = pyramids.interpretation.extensions;
        let (alpha_mode, opacity) =
            if shows_layers { (material.alpha_mode, 1.0) } else { fitted_alpha(material) };
        let alpha_cutoff = material.alpha_cutoff;
        let own = if material.alpha_mode == AlphaMode::Opaque { 1.0 } else { factors[MapKind::BaseColor].w };
        factors[MapKind::BaseColor].w = own * opacity;
        let color = material.base_color_texture.filter(|_| material.alpha_mode != AlphaMode::Opaque);
        let opacity = pyramids.pyramid(color, Use::Opacity);
        let (is_unlit, shifted) = (material.unlit, Shifted::new(material, pyramids));
        let layers = if shows_layers { SurfaceLayers::new(material, pyramids) } else { None };
        let sheen = material.extensions.sheen.filter(|s| !shows_layers && s.color != [0.0; 3]);
        let sheen = sheen.map(|sheen| Sheen {
            color: Vec3::from(sheen.color),
            albedo: sheen_albedo(sheen.roughness),
            texture: pyramids.map(MapKind::BaseColor, sheen.color_texture),
        });
        Self {
            factors,
            sheen,
            layers,
            transmits: transmits(material),
            own_alpha: (material.alpha_mode, own),
            alpha_mode,
            alpha_cutoff,
            is_unlit,
            is_double_sided: material.double_sided,
            opacity,
            plain,
            shifted,
        }
    }

    /// Whether what is behind it shows: it is blended, or glass.
    pub fn is_blended(&self) -> bool {
        self.alpha_mode == AlphaMode::Blend || self.is_glass()
    }

    /// Whether light passes it in a way that is shown.
    pub fn is_glass(&self) -> bool {
        self.layers.as_ref().is_some_and(SurfaceLayers::transmits)
    }

    /// Whether it takes more than a look at depths to say what is seen of it: it is cut out, or blended.
    pub fn is_special(&self) -> bool {
        self.is_blended()
            || self.alpha_mode != AlphaMode::Opaque
            || self.shifted.as_ref().is_some_and(|own| own.cutout.is_some())
    }
}
