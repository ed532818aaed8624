//! What the materials of a layer of the high-poly say together of their extensions, and how that is
//! written into one material.
//!
//! Contract: materials count by their area in the layer.

use crate::alpha_layers::LayerKind;
use crate::extension_values::Group;
use crate::high_poly::HighPoly;
use parbake_model::glam::{Vec3, Vec4};
use parbake_model::{
    Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, MaterialExtensions, Sheen, Specular,
    TextureSlot, Transmission, Volume,
};

/// One of a group's two parts, each of which has a factor of its own: a colour or a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Part {
    /// 0 or 1.
    pub place: usize,
    /// The lane of a number; none of a colour.
    lane: Option<usize>,
    /// Whether it tells how much of the extension there is.
    pub is_strength: bool,
}

impl Part {
    /// The part's value; a number in all three lanes.
    pub fn of(self, value: Vec4) -> Vec3 {
        self.lane.map_or(value.truncate(), |lane| Vec3::splat(value[lane]))
    }

    /// The same, for a whole layer.
    pub fn said(self, value: Vec4) -> Said {
        let value = self.of(value);
        let (place, largest) = (self.place, value.max_element());
        Said { place, value, spread: 0.0, largest, is_textured: false, is_there: true }
    }
}

/// What is said of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Said {
    pub place: usize,
    /// The factor.
    pub value: Vec3,
    /// Between the least and the largest value.
    pub spread: f32,
    /// The largest value.
    pub largest: f32,
    /// Whether an image says how much of the factor is where.
    pub is_textured: bool,
    /// Whether any texel says it.
    pub is_there: bool,
}

impl Group {
    /// The parts of the group.
    pub(crate) fn parts(self) -> [Part; 2] {
        let (lanes, strength) = match self {
            Self::Clearcoat | Self::Passing | Self::Iridescence => ([Some(0), Some(1)], 0),
            Self::Sheen => ([None, Some(3)], 0),
            Self::DiffuseTransmission => ([None, Some(3)], 1),
            Self::Anisotropy => ([Some(3), Some(3)], 0),
            Self::Specular => ([None, Some(3)], 1),
        };
        [0, 1].map(|place| Part { place, lane: lanes[place], is_strength: place == strength })
    }

    /// The name of its image.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Clearcoat => "clearcoat",
            Self::Sheen => "sheen",
            Self::Passing => "transmission thickness",
            Self::DiffuseTransmission => "diffuse transmission",
            Self::Iridescence => "iridescence",
            Self::Anisotropy => "anisotropy",
            Self::Specular => "specular",
        }
    }
}

/// Writes what is said of a group into a layer's extensions; `image` is the group's.
pub(crate) fn set(out: &mut MaterialExtensions, group: Group, [one, two]: [Said; 2], image: usize) {
    let texture = |said: Said| said.is_textured.then(|| TextureSlot { image, ..TextureSlot::default() });
    let (color, number) = (one.value.to_array(), two.value.x);
    match group {
        Group::Clearcoat if one.value.x > 0.0 => {
            out.clearcoat = Some(Clearcoat {
                factor: one.value.x,
                texture: texture(one),
                roughness: number,
                roughness_texture: texture(two),
                ..Clearcoat::default()
            });
        }
        Group::Sheen if one.largest > 0.0 => {
            let (color_texture, roughness_texture) = (texture(one), texture(two));
            out.sheen = Some(Sheen { color, color_texture, roughness: number, roughness_texture });
        }
        Group::Passing if one.value.x > 0.0 => {
            out.transmission = Some(Transmission { factor: one.value.x, texture: texture(one) });
            if let Some(volume) = &mut out.volume {
                (volume.thickness, volume.texture) = (number, texture(two));
            }
        }
        Group::DiffuseTransmission if number > 0.0 => {
            let (factor, own) = (number, texture(two));
            let color_texture = texture(one);
            out.diffuse_transmission =
                Some(DiffuseTransmission { factor, texture: own, color, color_texture });
        }
        Group::Iridescence if one.value.x > 0.0 => {
            let film = out.iridescence.get_or_insert_default();
            (film.factor, film.texture) = (one.value.x, texture(one));
            film.thickness = if two.is_textured { [0.0, number] } else { [number.min(100.0), number] };
            film.thickness_texture = texture(two);
        }
        Group::Anisotropy if one.value.x > 0.0 => {
            out.anisotropy = Some(Anisotropy { strength: one.value.x, rotation: 0.0, texture: texture(one) });
        }
        Group::Specular => {
            let (factor, own) = (number, texture(two));
            let specular = Specular { factor, texture: own, color, color_texture: texture(one) };
            out.specular = Some(specular).filter(|s| *s != Specular::default());
        }
        _ => {}
    }
}

/// The materials of a layer with their areas; those without area are left out.
pub(crate) struct Shares(Vec<(usize, f32)>);

impl Shares {
    /// Of these triangles of the high-poly.
    pub fn of(triangles: &[u32], high: &HighPoly) -> Self {
        let mesh = high.scene.mesh();
        let mut areas = vec![0.0f64; high.extensions.materials().len()];
        for &triangle in triangles {
            let material = mesh.triangle_materials[triangle as usize] as usize;
            areas[material] += f64::from(mesh.area_normal(triangle as usize).length());
        }
        Self(areas.iter().map(|&a| a as f32).enumerate().filter(|(_, area)| *area > 0.0).collect())
    }

    fn materials<'h>(&'h self, high: &'h HighPoly) -> impl Iterator<Item = (&'h Material, f32)> + Clone {
        self.0.iter().map(move |&(material, area)| (&high.extensions.materials()[material], area))
    }

    /// Whether any material has something of a group to show.
    pub fn has(&self, group: Group, high: &HighPoly) -> bool {
        let folds = group == Group::Specular && self.iors_differ(high);
        self.0.iter().any(|&(material, _)| {
            let value = high.extensions.factors(group, material, folds);
            match group {
                Group::Specular => {
                    value != Vec4::ONE || group.is_textured(&high.extensions.materials()[material].extensions)
                }
                _ => group.strength(value) > 0.0,
            }
        })
    }

    /// The one value of a group in all of the layer.
    pub fn one_value(&self, group: Group, high: &HighPoly, folds_ior: bool) -> Option<Vec4> {
        if group == Group::Anisotropy || self.materials(high).any(|(m, _)| group.is_textured(&m.extensions)) {
            return None;
        }
        let mut values = self.0.iter().map(|&(m, _)| high.extensions.factors(group, m, folds_ior));
        let first = values.next()?;
        values.all(|value| value == first).then_some(first)
    }

    /// Whether parts have several indices of refraction.
    pub fn iors_differ(&self, high: &HighPoly) -> bool {
        let mut iors = self.materials(high).map(|(m, _)| m.extensions.ior.unwrap_or(1.5));
        let first = iors.next();
        iors.any(|ior| Some(ior) != first)
    }

    /// Whether most of the layer shows its back.
    pub fn double_sided(&self, high: &HighPoly) -> bool {
        self.most(self.materials(high).map(|(m, area)| (m.double_sided, area))).unwrap_or(true)
    }

    /// Whether all clearcoats have the normals of the surface below them.
    pub fn coats_normals(&self, high: &HighPoly) -> bool {
        let coat = |m: usize| high.extensions.materials()[m].extensions.clearcoat;
        let mut coated = self.0.iter().filter(|(m, _)| coat(*m).is_some_and(|coat| coat.factor > 0.0));
        coated.all(|&(m, _)| high.extensions.coats_normals(m))
    }

    /// The value that has most of the area.
    fn most<T: PartialEq>(&self, values: impl Iterator<Item = (T, f32)>) -> Option<T> {
        let mut sums: Vec<(T, f32)> = Vec::new();
        for (value, area) in values {
            match sums.iter_mut().find(|(own, _)| *own == value) {
                Some((_, sum)) => *sum += area,
                None => sums.push((value, area)),
            }
        }
        sums.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(value, _)| value)
    }

    /// Sets what extensions have no texture for: of values that differ, the one that has most of the area.
    pub fn set_numbers(
        &self,
        high: &HighPoly,
        kind: LayerKind,
        out: &mut MaterialExtensions,
        lost: &mut Vec<String>,
    ) {
        let mut choose = |name: &str, what: &str, values: Vec<([f32; 4], f32)>| {
            if values.iter().any(|(value, _)| *value != values[0].0) {
                lost.push(format!(
                    "{name}: parts differ in {what}, for which glTF has no texture; all got the value that covers the largest area"
                ));
            }
            self.most(values.into_iter())
        };
        let one = |x: f32| [x, 0.0, 0.0, 0.0];
        let transmits = kind.transmits;
        let passing = move || self.materials(high).filter(move |_| transmits);
        if kind.transmits || !self.iors_differ(high) {
            let iors = self.materials(high).map(|(m, area)| (one(m.extensions.ior.unwrap_or(1.5)), area));
            let ior = choose("KHR_materials_ior", "index of refraction", iors.collect());
            out.ior = ior.map(|ior| ior[0]).filter(|&ior| ior != 1.5);
        }
        let dispersions = passing().map(|(m, area)| (one(m.extensions.dispersion.unwrap_or(0.0)), area));
        let dispersion = choose("KHR_materials_dispersion", "dispersion", dispersions.collect());
        out.dispersion = dispersion.map(|d| d[0]).filter(|&d| d > 0.0);
        let volumes = passing().filter_map(|(m, area)| m.extensions.volume.map(|v| (v, area)));
        let volumes = volumes.filter(|(v, _)| v.thickness > 0.0).map(|(v, area)| {
            let [r, g, b] = v.attenuation_color;
            ([r, g, b, v.attenuation_distance], area)
        });
        let inside = choose("KHR_materials_volume", "attenuation colour or distance", volumes.collect());
        out.volume = inside.map(|[r, g, b, attenuation_distance]| Volume {
            attenuation_distance,
            attenuation_color: [r, g, b],
            ..Volume::default()
        });
        let films = self.materials(high).filter_map(|(m, area)| m.extensions.iridescence.map(|i| (i, area)));
        let films = films.filter(|(i, _)| i.factor > 0.0).map(|(i, area)| (one(i.ior), area));
        let film =
            choose("KHR_materials_iridescence", "the index of refraction of iridescence", films.collect());
        out.iridescence = film.map(|ior| Iridescence { ior: ior[0], ..Iridescence::default() });
    }
}
