//! What the high-poly's material extensions say at a point of its surface, textures included.
//!
//! Values come in groups, each of which fits into one image as glTF reads it: what its red, green, blue and
//! alpha channel multiply in the extension.
//!
//! Contract: colours are linear; a material without an extension has the values at which the extension
//! shows nothing.

use parbake_image::FloatImage;
use parbake_image::display::decode_srgb;
use parbake_image::pyramid::Pyramid;
use parbake_model::glam::{Mat3, Vec2, Vec3, Vec4, vec4};
use parbake_model::{Image, Material, MaterialExtensions, Mesh, TextureSlot, Wrap};
use parbake_render::interpolate::interpolate;
use rayon::prelude::*;

/// Values that share an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// x: clearcoat factor; y: clearcoat roughness.
    Clearcoat,
    /// xyz: colour of the sheen; w: its roughness.
    Sheen,
    /// x: transmission factor; y: thickness.
    Passing,
    /// xyz: diffuse transmission colour; w: its factor.
    DiffuseTransmission,
    /// x: iridescence factor; y: thickness in nanometres.
    Iridescence,
    /// xyz: the direction in which highlights are stretched, a unit vector of the common frame; w: how much.
    Anisotropy,
    /// xyz: colour of a dielectric's reflection; w: its strength.
    Specular,
}

impl Group {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Clearcoat,
        Self::Sheen,
        Self::Passing,
        Self::DiffuseTransmission,
        Self::Iridescence,
        Self::Anisotropy,
        Self::Specular,
    ];

    /// How much of the extension a value shows; where it is 0, the value's other lanes say nothing.
    pub fn strength(self, value: Vec4) -> f32 {
        match self {
            Self::Clearcoat | Self::Passing | Self::Iridescence => value.x,
            Self::Sheen => value.truncate().max_element(),
            Self::DiffuseTransmission | Self::Anisotropy => value.w,
            // Without the extension there is a reflection as well.
            Self::Specular => 1.0,
        }
    }

    /// The textures of a group.
    pub fn slots(self, e: &MaterialExtensions) -> [Option<TextureSlot>; 2] {
        match self {
            Self::Clearcoat => e.clearcoat.map_or([None; 2], |c| [c.texture, c.roughness_texture]),
            Self::Sheen => e.sheen.map_or([None; 2], |s| [s.color_texture, s.roughness_texture]),
            Self::Passing => [e.transmission.and_then(|t| t.texture), e.volume.and_then(|v| v.texture)],
            Self::DiffuseTransmission => {
                e.diffuse_transmission.map_or([None; 2], |d| [d.color_texture, d.texture])
            }
            Self::Iridescence => e.iridescence.map_or([None; 2], |i| [i.texture, i.thickness_texture]),
            Self::Anisotropy => [e.anisotropy.and_then(|a| a.texture), None],
            Self::Specular => e.specular.map_or([None; 2], |s| [s.color_texture, s.texture]),
        }
    }

    /// Whether the first of its textures holds colours in sRGB; the second never does.
    pub fn has_colors(self) -> bool {
        matches!(self, Self::Sheen | Self::DiffuseTransmission | Self::Specular)
    }

    /// Whether textures vary the group in a material.
    pub fn is_textured(self, e: &MaterialExtensions) -> bool {
        self.slots(e).iter().any(Option::is_some)
    }

    /// The value, with what the group's textures say there (1 where there is none). Of anisotropy xy is the
    /// direction in tangent space. `folds_ior` has the index of refraction in the specular colour.
    pub fn value(self, e: &MaterialExtensions, textures: [Option<Vec4>; 2], folds_ior: bool) -> Vec4 {
        let [one, two] = textures.map(|t| t.unwrap_or(Vec4::ONE));
        let tinted = |color: [f32; 3], texture: Vec4| Vec3::from(color) * texture.truncate();
        match self {
            Self::Clearcoat => {
                e.clearcoat.map_or(Vec4::ZERO, |c| vec4(c.factor * one.x, c.roughness * two.y, 0.0, 0.0))
            }
            Self::Sheen => e.sheen.map_or(Vec4::ZERO, |s| tinted(s.color, one).extend(s.roughness * two.w)),
            Self::Passing => {
                let passes = e.transmission.map_or(0.0, |t| t.factor * one.x);
                vec4(passes, e.volume.map_or(0.0, |v| v.thickness * two.y), 0.0, 0.0)
            }
            Self::DiffuseTransmission => {
                e.diffuse_transmission.map_or(Vec4::ZERO, |d| tinted(d.color, one).extend(d.factor * two.w))
            }
            Self::Iridescence => e.iridescence.map_or(Vec4::ZERO, |i| {
                let [least, most] = i.thickness;
                vec4(i.factor * one.x, least + (most - least) * two.y, 0.0, 0.0)
            }),
            Self::Anisotropy => e.anisotropy.map_or(Vec4::ZERO, |a| {
                let direction = match textures[0] {
                    Some(t) => Vec2::new(2.0 * t.x - 1.0, 2.0 * t.y - 1.0).normalize_or(Vec2::X),
                    None => Vec2::X,
                };
                let turned = Vec2::from_angle(a.rotation).rotate(direction);
                vec4(turned.x, turned.y, 0.0, a.strength * one.z)
            }),
            Self::Specular => {
                let (factor, color) = e.specular.map_or((1.0, [1.0; 3]), |s| (s.factor, s.color));
                let ior = if folds_ior { reflection(e.ior) } else { 1.0 };
                (tinted(color, one) * ior).extend(factor * two.w)
            }
        }
    }
}

/// What a dielectric of this index reflects at normal incidence, against the 0.04 of an index of 1.5.
fn reflection(ior: Option<f32>) -> f32 {
    match ior {
        None => 1.0,
        Some(0.0) => 25.0,
        Some(ior) => (5.0 * (ior - 1.0) / (ior + 1.0)).powi(2),
    }
}

/// Strength from which on a clearcoat is one.
const NO_COAT: f32 = 0.01;

/// How an image is read: its index, whether it holds colours, wrap modes.
type Key = (usize, bool, [Wrap; 2]);

/// The materials of a high-poly with the textures of their extensions.
pub struct ExtensionSource {
    materials: Vec<Material>,
    pyramids: Vec<(Key, Pyramid<4>)>,
}

impl ExtensionSource {
    /// Unpacks the textures of all extensions; those that `images` does not have are left out.
    pub fn new(materials: &[Material], images: &[Image]) -> Self {
        let mut pyramids: Vec<(Key, Pyramid<4>)> = Vec::new();
        for (slot, is_color) in materials.iter().flat_map(|m| m.extensions.textures()) {
            let key = (slot.image, is_color, slot.wrap);
            let Some(image) = images.get(slot.image).filter(|_| !pyramids.iter().any(|(k, _)| *k == key))
            else {
                continue;
            };
            let mut pyramid = Pyramid::from_base(unpack(image, is_color));
            pyramid.wrap = slot.wrap;
            pyramids.push((key, pyramid));
        }
        Self { materials: materials.to_vec(), pyramids }
    }

    /// The materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// What a material says of a group where no texture varies it.
    pub fn factors(&self, group: Group, material: usize, folds_ior: bool) -> Vec4 {
        group.value(&self.materials[material].extensions, [None; 2], folds_ior)
    }

    /// What is said of a group at a point of a triangle, averaged over an area that is `width` wide;
    /// `folds_ior` has the index of refraction in the specular colour.
    pub fn at(
        &self,
        group: Group,
        mesh: &Mesh,
        triangle: usize,
        weights: [f32; 3],
        width: f32,
        folds_ior: bool,
    ) -> Vec4 {
        let e = &self.materials[mesh.triangle_materials[triangle] as usize].extensions;
        let fetch = |slot, is_color| self.fetch(slot, is_color, mesh, triangle, weights, width);
        let [one, two] = group.slots(e);
        let textures = [one.and_then(|s| fetch(s, group.has_colors())), two.and_then(|s| fetch(s, false))];
        let value = group.value(e, textures, folds_ior);
        if group != Group::Anisotropy || mesh.tangents.is_empty() {
            return value;
        }
        let frame = tangent_frame(mesh, triangle, weights);
        (frame.x_axis * value.x + frame.y_axis * value.y).normalize_or_zero().extend(value.w)
    }

    /// The unit normal of the clearcoat at a point of a triangle: that of its own map, else the mesh's. Averaged as
    /// [`ExtensionSource::at`]; none where there is no coat.
    pub fn coat_normal(&self, mesh: &Mesh, triangle: usize, weights: [f32; 3], width: f32) -> Option<Vec3> {
        let coat = self.materials[mesh.triangle_materials[triangle] as usize].extensions.clearcoat?;
        let fetch = |slot| self.fetch(slot, false, mesh, triangle, weights, width);
        if coat.factor * coat.texture.and_then(fetch).map_or(1.0, |strength| strength.x) < NO_COAT {
            return None;
        }
        let normals = mesh.triangles[triangle].map(|i| mesh.normals[i as usize]);
        let normal: Vec3 = interpolate(normals, weights);
        let map = coat.normal_texture.filter(|_| !mesh.tangents.is_empty()).and_then(fetch);
        let turned = map.map_or(normal, |stored| {
            let slope = coat.normal_scale * (2.0 * stored.truncate().truncate() - 1.0);
            tangent_frame(mesh, triangle, weights) * slope.extend(2.0 * stored.z - 1.0)
        });
        Some(turned.normalize_or(Vec3::Z))
    }

    /// What a texture of an extension has at a point of a triangle; none where there is no such image.
    fn fetch(
        &self,
        slot: TextureSlot,
        is_color: bool,
        mesh: &Mesh,
        triangle: usize,
        weights: [f32; 3],
        width: f32,
    ) -> Option<Vec4> {
        let key = (slot.image, is_color, slot.wrap);
        let (_, pyramid) = self.pyramids.iter().find(|(k, _)| *k == key)?;
        let set = if slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let uvs = corners.map(|i| slot.transform.apply(set.get(i).copied().unwrap_or_default()));
        let area = mesh.area_normal(triangle).length().max(1e-20);
        let density = ((uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs() / area).sqrt();
        let along = Vec2::new(density * width, 0.0);
        Some(Vec4::from(pyramid.fetch(interpolate(uvs, weights), pyramid.lod(along, along))))
    }

    /// Whether the clearcoat of a material has the normals that the surface below it has.
    pub fn coats_normals(&self, material: usize) -> bool {
        let material = &self.materials[material];
        material.extensions.clearcoat.is_some_and(|c| c.normal_texture == material.normal_texture)
    }
}

/// Tangent, bitangent and normal of a mesh at a point of a triangle, interpolated and not of unit length.
pub(crate) fn tangent_frame(mesh: &Mesh, triangle: usize, weights: [f32; 3]) -> Mat3 {
    let corners = mesh.triangles[triangle].map(|i| i as usize);
    let normal: Vec3 = interpolate(corners.map(|i| mesh.normals[i]), weights);
    let tangent: Vec3 = interpolate(corners.map(|i| mesh.tangents[i].truncate()), weights);
    Mat3::from_cols(tangent, normal.cross(tangent) * mesh.tangents[corners[0]].w, normal)
}

fn unpack(image: &Image, is_color: bool) -> FloatImage<[f32; 4]> {
    let curve: [f32; 256] = std::array::from_fn(|i| match is_color {
        true => decode_srgb(i as f32 / 255.0),
        false => i as f32 / 255.0,
    });
    let texels = image.pixels.par_iter().map(|p| {
        let [r, g, b] = [0, 1, 2].map(|k| curve[usize::from(p[k])]);
        [r, g, b, f32::from(p[3]) / 255.0]
    });
    FloatImage { width: image.width, height: image.height, texels: texels.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::{Sheen, Specular};

    /// Protects the two kinds of numbers in one picture: colours are decoded, roughness is not; and what
    /// has no extension says so.
    #[test]
    fn textures_multiply_factors() {
        let slot = Some(TextureSlot::default());
        let mut cloth = Material::default();
        cloth.extensions.sheen = Some(Sheen {
            color: [1.0, 0.5, 0.0],
            color_texture: slot,
            roughness: 0.5,
            roughness_texture: slot,
        });
        let image = Image::solid("sheen", 2, 2, [188, 188, 188, 51]);
        let source = ExtensionSource::new(&[cloth, Material::default()], &[image]);
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            triangles: vec![[0, 1, 2]; 2],
            triangle_materials: vec![0, 1],
            ..Mesh::default()
        };
        let at = |triangle| source.at(Group::Sheen, &mesh, triangle, [0.4, 0.3, 0.3], 0.01, false);
        assert!((at(0) - vec4(0.503, 0.251, 0.0, 0.1)).length() < 2e-3, "{}", at(0));
        assert_eq!(Group::Sheen.strength(at(1)), 0.0);
        assert_eq!(source.at(Group::Specular, &mesh, 1, [0.4, 0.3, 0.3], 0.01, true), Vec4::ONE);
    }

    /// Protects glass and diamonds in one layer: what their index reflects becomes a specular colour.
    #[test]
    fn the_index_of_refraction_is_a_reflection() {
        let mut diamond = MaterialExtensions { ior: Some(2.42), ..MaterialExtensions::default() };
        diamond.specular = Some(Specular { factor: 0.5, ..Specular::default() });
        let value = Group::Specular.value(&diamond, [None; 2], true);
        assert!((value.x - 0.1724 / 0.04).abs() < 0.01 && value.w == 0.5, "{value}");
        assert_eq!(Group::Specular.value(&diamond, [None; 2], false).x, 1.0);
        assert_eq!(reflection(Some(1.5)), 1.0);
    }
}
