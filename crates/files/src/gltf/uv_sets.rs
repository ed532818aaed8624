//! Which of a primitive's texture coordinate sets become the mesh's two.
//!
//! Sets 0 and 1 stay where they are; a material whose textures ask for others gets these in the
//! places that it does not use. Textures of a material that asks for three sets or more are looked
//! at in the order of what is lost without them, and those that ask for a third go without.

use super::json_material::Material;
use super::json_texture::TextureInfo;

/// The document's set for each of the mesh's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct UvSets([usize; 2]);

impl Default for UvSets {
    fn default() -> Self {
        Self([0, 1])
    }
}

impl UvSets {
    /// Those that the textures of a material ask for.
    pub fn of(material: &Material) -> Self {
        let mut asked: Vec<usize> = Vec::new();
        for set in textures(material).map(set) {
            if !asked.contains(&set) && asked.len() < 2 {
                asked.push(set);
            }
        }
        let mut sets = Self::default();
        for &set in asked.iter().filter(|&&set| set > 1) {
            // The second place first: layouts are looked for in the first.
            let free = [1, 0].into_iter().find(|&place| !asked.contains(&sets.0[place]));
            if let Some(free) = free {
                sets.0[free] = set;
            }
        }
        sets
    }

    /// The document's set that the mesh has as its first or second.
    pub fn document_set(self, place: usize) -> usize {
        self.0[place & 1]
    }

    /// Where the mesh has the document's set.
    pub fn place(self, set: usize) -> Option<u8> {
        self.0.iter().position(|&own| own == set).map(|place| place as u8)
    }
}

/// The set that a texture's coordinates are of; KHR_texture_transform may name another.
pub(super) fn set(info: &TextureInfo) -> usize {
    info.extensions.transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(info.tex_coord)
}

/// All textures that are read, those first without which most is lost.
fn textures(material: &Material) -> impl Iterator<Item = &TextureInfo> {
    let pbr = material.pbr_metallic_roughness.as_ref();
    let glossy = material.extensions.specular_glossiness.as_ref();
    let own = [
        glossy.and_then(|g| g.diffuse_texture.as_ref()),
        pbr.and_then(|p| p.base_color_texture.as_ref()),
        material.normal_texture.as_ref(),
        glossy.and_then(|g| g.specular_glossiness_texture.as_ref()),
        pbr.and_then(|p| p.metallic_roughness_texture.as_ref()),
        material.emissive_texture.as_ref(),
        material.occlusion_texture.as_ref(),
    ];
    let parallax = material.extensions.parallax_sh.iter().flat_map(|map| {
        let cutout = map.cutout.iter().flat_map(|c| &c.coefficient_textures);
        let shown = map.base_color_texture.iter().chain(&map.normal_texture);
        shown.chain(&map.coefficient_textures).chain(cutout).chain(&map.depth_texture)
    });
    let tangent = material.extensions.parallax.iter().flat_map(|map| {
        let shown = map.base_color_texture.iter().chain(&map.normal_texture);
        shown.chain(&map.texture).chain(map.cutout.iter().filter_map(|c| c.texture.as_ref()))
    });
    own.into_iter().flatten().chain(parallax).chain(tangent).chain(extensions(material))
}

/// The textures of extensions.
fn extensions(material: &Material) -> impl Iterator<Item = &TextureInfo> {
    let e = &material.extensions;
    let (clearcoat, sheen, specular) = (e.clearcoat.as_ref(), e.sheen.as_ref(), e.specular.as_ref());
    let (diffuse, iridescence) = (e.diffuse_transmission.as_ref(), e.iridescence.as_ref());
    [
        e.transmission.as_ref().and_then(|t| t.transmission_texture.as_ref()),
        clearcoat.and_then(|c| c.clearcoat_texture.as_ref()),
        sheen.and_then(|s| s.sheen_color_texture.as_ref()),
        specular.and_then(|s| s.specular_color_texture.as_ref()),
        specular.and_then(|s| s.specular_texture.as_ref()),
        e.volume.as_ref().and_then(|v| v.thickness_texture.as_ref()),
        diffuse.and_then(|d| d.diffuse_transmission_color_texture.as_ref()),
        diffuse.and_then(|d| d.diffuse_transmission_texture.as_ref()),
        iridescence.and_then(|i| i.iridescence_texture.as_ref()),
        iridescence.and_then(|i| i.iridescence_thickness_texture.as_ref()),
        clearcoat.and_then(|c| c.clearcoat_roughness_texture.as_ref()),
        clearcoat.and_then(|c| c.clearcoat_normal_texture.as_ref()),
        sheen.and_then(|s| s.sheen_roughness_texture.as_ref()),
        e.anisotropy.as_ref().and_then(|a| a.anisotropy_texture.as_ref()),
    ]
    .into_iter()
    .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn sets(color: usize, normal: usize, occlusion: usize) -> (UvSets, [Option<u8>; 3]) {
        let text = json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": color } },
            "normalTexture": {
                "index": 0, "extensions": { "KHR_texture_transform": { "texCoord": normal } },
            },
            "occlusionTexture": { "index": 0, "texCoord": occlusion },
        });
        let material: Material = serde_json::from_slice(text.to_string().as_bytes()).unwrap();
        let sets = UvSets::of(&material);
        (sets, [color, normal, occlusion].map(|set| sets.place(set)))
    }

    /// Protects the usual materials from any change, and finds a place for every pair of sets.
    #[test]
    fn two_sets_of_any_number_have_a_place() {
        for (asked, places) in [
            ([0, 0, 0], [Some(0), Some(0), Some(0)]),
            ([1, 1, 1], [Some(1), Some(1), Some(1)]),
            ([0, 1, 1], [Some(0), Some(1), Some(1)]),
            ([3, 3, 3], [Some(1), Some(1), Some(1)]),
            ([0, 2, 2], [Some(0), Some(1), Some(1)]),
            ([1, 2, 1], [Some(1), Some(0), Some(1)]),
            ([2, 3, 2], [Some(1), Some(0), Some(1)]),
            // Occlusion is what is lost.
            ([0, 1, 2], [Some(0), Some(1), None]),
            ([2, 3, 1], [Some(1), Some(0), None]),
        ] {
            let [color, normal, occlusion] = asked;
            assert_eq!(sets(color, normal, occlusion).1, places, "{asked:?}");
        }
    }
}
