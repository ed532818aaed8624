//! The maps of a material as values: which there are, what their texels may be, and how files store
//! them (glTF 2.0, section 3.9).
//!
//! Everything that reads, shades, fits or writes a map asks its [`MapSpec`]; a further map is a
//! further row of the table.

use crate::FloatImage;
use glam::{Vec3, Vec4};
use std::ops::{Index, IndexMut};
use std::sync::Arc;

/// A map of glTF's metallic-roughness material. Opacity is the base colour's fourth channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MapKind {
    /// Albedo or, on metal, F₀; linear.
    BaseColor,
    /// Unit normal in the tangent frame, +Y up.
    Normal,
    /// Roughness in the second channel, metallic in the third.
    MetallicRoughness,
    /// Light that the surface sends out by itself; linear.
    Emissive,
    /// Share of ambient light that arrives, in the first channel.
    Occlusion,
}

/// What a texel of a map may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Channels within [0, 1], each by itself.
    Box,
    /// Unit vectors with z of at least [`Domain::LEAST_Z`].
    Hemisphere,
}

/// How 8 bits store a channel, s = stored / 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// sRGB's curve of s, unless a convention says that colours are stored as they are.
    Srgb,
    /// s itself.
    Linear,
    /// 2 s − 1.
    Signed,
}

/// What a map is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapSpec {
    /// Name of the written image.
    pub name: &'static str,
    /// What its texels may be.
    pub domain: Domain,
    /// How files store them.
    pub encoding: Encoding,
    /// The value of a material without this map and with glTF's default factor; a map of this value
    /// alone is not worth writing.
    pub neutral: Vec4,
}

/// How many kinds there are.
pub const KINDS: usize = 5;

const SPECS: [MapSpec; KINDS] = [
    MapSpec { name: "base color", domain: Domain::Box, encoding: Encoding::Srgb, neutral: Vec4::ONE },
    MapSpec { name: "normal", domain: Domain::Hemisphere, encoding: Encoding::Signed, neutral: Vec4::Z },
    MapSpec {
        name: "metallic roughness",
        domain: Domain::Box,
        encoding: Encoding::Linear,
        neutral: Vec4::new(0.0, 1.0, 1.0, 0.0),
    },
    MapSpec { name: "emissive", domain: Domain::Box, encoding: Encoding::Srgb, neutral: Vec4::ZERO },
    MapSpec { name: "occlusion", domain: Domain::Box, encoding: Encoding::Linear, neutral: Vec4::ONE },
];

impl MapKind {
    /// All kinds, in the order of a round of the texture solve.
    pub const ALL: [Self; KINDS] =
        [Self::BaseColor, Self::Normal, Self::MetallicRoughness, Self::Emissive, Self::Occlusion];

    /// What this map is.
    pub const fn spec(self) -> &'static MapSpec {
        &SPECS[self as usize]
    }
}

impl Domain {
    /// The least z of a mapped normal: it stays on its side of the surface.
    pub const LEAST_Z: f32 = 0.02;

    /// The value of the domain that is meant by this one.
    #[inline]
    pub fn clamp(self, value: Vec4) -> Vec4 {
        match self {
            Self::Box => value.clamp(Vec4::ZERO, Vec4::ONE),
            Self::Hemisphere => clamp_to_hemisphere(value),
        }
    }
}

/// A unit vector on the outer side of the surface.
#[inline]
pub fn clamp_to_hemisphere(m: Vec4) -> Vec4 {
    let unit = m.truncate().normalize_or(Vec3::Z);
    if unit.z >= Domain::LEAST_Z {
        return unit.extend(0.0);
    }
    Vec3::new(unit.x, unit.y, Domain::LEAST_Z).normalize_or(Vec3::Z).extend(0.0)
}

/// The unit vector of this direction, its z raised to [`Domain::LEAST_Z`] first: for values that a
/// gradient moves a little at a time.
#[inline]
pub fn lift_to_hemisphere(m: Vec3) -> Vec3 {
    Vec3::new(m.x, m.y, m.z.max(Domain::LEAST_Z)).normalize()
}

/// One value for each kind of map: what a point of a surface is made of, or the derivative by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapValues([Vec4; KINDS]);

impl MapValues {
    /// Zeros, for derivatives.
    pub const ZERO: Self = Self([Vec4::ZERO; KINDS]);

    /// The neutral value of every map.
    pub const NEUTRAL: Self =
        Self([SPECS[0].neutral, SPECS[1].neutral, SPECS[2].neutral, SPECS[3].neutral, SPECS[4].neutral]);

    /// A surface of this colour and mapped normal; all else is neutral.
    #[inline]
    pub fn of(base_color: Vec3, normal: Vec3) -> Self {
        let mut values = Self::NEUTRAL;
        values[MapKind::BaseColor] = base_color.extend(0.0);
        values[MapKind::Normal] = normal.extend(0.0);
        values
    }
}

impl Default for MapValues {
    fn default() -> Self {
        Self::NEUTRAL
    }
}

impl Index<MapKind> for MapValues {
    type Output = Vec4;

    #[inline(always)]
    fn index(&self, kind: MapKind) -> &Vec4 {
        &self.0[kind as usize]
    }
}

impl IndexMut<MapKind> for MapValues {
    #[inline(always)]
    fn index_mut(&mut self, kind: MapKind) -> &mut Vec4 {
        &mut self.0[kind as usize]
    }
}

/// Maps of one size, at most one of each kind. Copies share their maps until one of them is changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapSet {
    /// Texels along a side.
    size: usize,
    maps: [Option<Arc<FloatImage<Vec4>>>; KINDS],
}

impl MapSet {
    /// No maps yet, of size² texels each.
    pub fn new(size: usize) -> Self {
        Self { size, maps: Default::default() }
    }

    /// A base colour and a normal map of the same size.
    pub fn of(base_color: FloatImage<Vec4>, normal: FloatImage<Vec4>) -> Self {
        let mut set = Self::new(base_color.width);
        set.insert(MapKind::BaseColor, base_color);
        set.insert(MapKind::Normal, normal);
        set
    }

    /// Texels along a side of every map.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Puts a map of the set's size in the place of the one of its kind.
    pub fn insert(&mut self, kind: MapKind, map: FloatImage<Vec4>) {
        debug_assert_eq!([map.width, map.height], [self.size; 2]);
        self.maps[kind as usize] = Some(Arc::new(map));
    }

    /// This set's map of a kind alone, not copied before it changes; no map where there is none.
    pub fn only(&self, kind: MapKind) -> Self {
        let mut only = Self::new(self.size);
        only.maps[kind as usize].clone_from(&self.maps[kind as usize]);
        only
    }

    /// The map of a kind.
    #[inline]
    pub fn get(&self, kind: MapKind) -> Option<&FloatImage<Vec4>> {
        self.maps[kind as usize].as_deref()
    }

    /// The map of a kind, to be changed.
    #[inline]
    pub fn get_mut(&mut self, kind: MapKind) -> Option<&mut FloatImage<Vec4>> {
        self.maps[kind as usize].as_mut().map(Arc::make_mut)
    }

    /// The kinds that are there, in the order of [`MapKind::ALL`].
    pub fn kinds(&self) -> impl Iterator<Item = MapKind> + '_ {
        MapKind::ALL.into_iter().filter(|kind| self.get(*kind).is_some())
    }

    /// The maps that are there, in the same order.
    pub fn iter(&self) -> impl Iterator<Item = (MapKind, &FloatImage<Vec4>)> {
        MapKind::ALL.into_iter().filter_map(|kind| Some((kind, self.get(kind)?)))
    }

    /// The maps that are there, to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (MapKind, &mut FloatImage<Vec4>)> {
        MapKind::ALL
            .into_iter()
            .zip(&mut self.maps)
            .filter_map(|(kind, map)| Some((kind, Arc::make_mut(map.as_mut()?))))
    }

    /// The bilinear blend of all maps: four texels and their weights. Maps that are not there are
    /// neutral.
    #[inline]
    pub fn blend(&self, texels: [usize; 4], weights: [f32; 4]) -> MapValues {
        let mut values = MapValues::NEUTRAL;
        for (value, map) in values.0.iter_mut().zip(&self.maps) {
            if let Some(map) = map {
                *value = map.blend(texels, weights);
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects what is written: texels of any value end in their map's domain, and those in it stay.
    #[test]
    fn domains_hold_what_is_clamped_to_them() {
        for x in [-2.0f32, -0.3, 0.0, 0.7, 5.0] {
            let value = Vec4::new(x, 0.4 * x, -0.2 * x, 0.0);
            let normal = Domain::Hemisphere.clamp(value);
            assert!((normal.length() - 1.0).abs() < 1e-6 && normal.z >= 0.019, "{normal}");
            assert!((Domain::Hemisphere.clamp(normal) - normal).length() < 1e-6);
            let boxed = Domain::Box.clamp(value);
            assert!(boxed.min_element() >= 0.0 && boxed.max_element() <= 1.0);
        }
    }

    /// Protects a state that is kept while another goes on from it.
    #[test]
    fn copies_share_until_one_is_changed() {
        let kept = MapSet::of(FloatImage::solid(2, Vec4::ONE), FloatImage::solid(2, Vec4::Z));
        let mut other = kept.clone();
        other.get_mut(MapKind::BaseColor).expect("it is there").texels[0] = Vec4::ZERO;
        let texels = |set: &MapSet, kind| set.get(kind).expect("it is there").texels.clone();
        assert_eq!(texels(&kept, MapKind::BaseColor)[0], Vec4::ONE);
        assert_eq!(texels(&other, MapKind::BaseColor)[0], Vec4::ZERO);
        let address = |set: &MapSet| set.get(MapKind::Normal).expect("it is there").texels.as_ptr();
        assert_eq!(address(&kept), address(&other));
    }

    /// Protects materials without a map: it reads as its neutral value.
    #[test]
    fn absent_maps_are_neutral() {
        let mut set = MapSet::new(2);
        set.insert(MapKind::Emissive, FloatImage::solid(2, Vec4::splat(0.5)));
        let values = set.blend([0, 1, 2, 3], [0.25; 4]);
        assert_eq!(values[MapKind::Emissive], Vec4::splat(0.5));
        assert_eq!(values[MapKind::Normal], Vec4::Z);
        assert_eq!(set.kinds().collect::<Vec<_>>(), [MapKind::Emissive]);
    }
}
