//! What glTF's material extensions say beyond the metallic-roughness material: their factors, and
//! whether textures vary them. Parbake does not fit these; files carry the factors.
//!
//! The fields are those of the extensions, by their names, with the extensions' defaults. Textures
//! are not kept: `textured` says that the file had some, so that the factors alone are not the look.

/// The extensions that a material has; `Default` has none.
///
/// Contract: numbers are finite and in the extensions' ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialExtensions {
    /// A clear layer on top (`KHR_materials_clearcoat`).
    pub clearcoat: Option<Clearcoat>,
    /// The gloss of cloth at grazing angles (`KHR_materials_sheen`).
    pub sheen: Option<Sheen>,
    /// Light that passes a thin surface (`KHR_materials_transmission`).
    pub transmission: Option<Transmission>,
    /// Scattered light that passes a thin surface (`KHR_materials_diffuse_transmission`).
    pub diffuse_transmission: Option<DiffuseTransmission>,
    /// The inside of what light passes (`KHR_materials_volume`).
    pub volume: Option<Volume>,
    /// Colours of a thin film (`KHR_materials_iridescence`).
    pub iridescence: Option<Iridescence>,
    /// Highlights that are stretched, as on brushed metal (`KHR_materials_anisotropy`).
    pub anisotropy: Option<Anisotropy>,
    /// Strength and colour of a dielectric's reflection (`KHR_materials_specular`).
    pub specular: Option<Specular>,
    /// Index of refraction, 0 or from 1; without the extension 1.5 (`KHR_materials_ior`).
    pub ior: Option<f32>,
    /// 20 divided by the Abbe number, from 0 (`KHR_materials_dispersion`).
    pub dispersion: Option<f32>,
}

impl MaterialExtensions {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// `KHR_materials_clearcoat`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clearcoat {
    /// Strength of the layer, 0 to 1.
    pub factor: f32,
    /// Perceptual roughness of the layer, 0 to 1.
    pub roughness: f32,
    /// Whether textures vary it, its normals included.
    pub textured: bool,
}

/// `KHR_materials_sheen`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sheen {
    /// Linear RGB, each from 0 to 1.
    pub color: [f32; 3],
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// Whether textures vary it.
    pub textured: bool,
}

/// `KHR_materials_transmission`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transmission {
    /// Share of the light that is not reflected which passes, 0 to 1.
    pub factor: f32,
    /// Whether a texture varies it.
    pub textured: bool,
}

/// `KHR_materials_diffuse_transmission`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// Share of the scattered light that passes, 0 to 1.
    pub factor: f32,
    /// Linear RGB of the light that passes, each from 0 to 1.
    pub color: [f32; 3],
    /// Whether textures vary it.
    pub textured: bool,
}

impl Default for DiffuseTransmission {
    fn default() -> Self {
        Self { factor: 0.0, color: [1.0; 3], textured: false }
    }
}

/// `KHR_materials_volume`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Thickness beneath the surface in the mesh's own space, from 0; 0 is a thin surface. The
    /// nodes' scales, which a merged mesh no longer has, are not in it.
    pub thickness: f32,
    /// Distance in world space after which white light has the attenuation colour; infinite where
    /// nothing is absorbed.
    pub attenuation_distance: f32,
    /// Linear RGB, each from 0 to 1.
    pub attenuation_color: [f32; 3],
    /// Whether a texture varies the thickness.
    pub textured: bool,
}

impl Default for Volume {
    fn default() -> Self {
        Self {
            thickness: 0.0,
            attenuation_distance: f32::INFINITY,
            attenuation_color: [1.0; 3],
            textured: false,
        }
    }
}

/// `KHR_materials_iridescence`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescence {
    /// Strength, 0 to 1.
    pub factor: f32,
    /// Index of refraction of the film, from 1.
    pub ior: f32,
    /// Least and greatest thickness of the film in nanometres, from 0; without a texture it is the
    /// greatest.
    pub thickness: [f32; 2],
    /// Whether textures vary it.
    pub textured: bool,
}

impl Default for Iridescence {
    fn default() -> Self {
        Self { factor: 0.0, ior: 1.3, thickness: [100.0, 400.0], textured: false }
    }
}

/// `KHR_materials_anisotropy`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anisotropy {
    /// Strength, 0 to 1.
    pub strength: f32,
    /// Direction in tangent space in radians, counter-clockwise from the tangent.
    pub rotation: f32,
    /// Whether a texture varies it.
    pub textured: bool,
}

/// `KHR_materials_specular`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Strength of the reflection of dielectrics, 0 to 1.
    pub factor: f32,
    /// Linear RGB of their reflection at normal incidence, from 0; may exceed 1.
    pub color: [f32; 3],
    /// Whether textures vary it.
    pub textured: bool,
}

impl Default for Specular {
    fn default() -> Self {
        Self { factor: 1.0, color: [1.0; 3], textured: false }
    }
}
