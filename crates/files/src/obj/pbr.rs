//! Metal, roughness and emission from MTL's PBR extension: `Pm`, `Pr`, `Ke` and their maps.
//!
//! * As with `Kd`, a factor is ignored where there is a map: exporters leave anything there.
//! * `Ke` is sRGB as `Kd` is, but may exceed 1: what exceeds it becomes the emission's strength.
//! * The model has one image for metal and roughness, in glTF's channels (G roughness, B metal). MTL
//!   has two maps. They serve where both name the same picture with the same options, or where there
//!   is a map of roughness alone and no metal; if `-imfchan` names a channel, it must be glTF's.
//!   Other maps are left out with a warning, and `Pr` and `Pm` count.

use super::mtl::{Found, Map, Section};
use super::pictures::Pictures;
use crate::FileError;
use crate::context::Textures;
use parbake_model::Material;

pub(super) fn fill(
    material: &mut Material,
    (section, folder): &Found,
    pictures: &mut Pictures<'_, '_>,
) -> Result<(), FileError> {
    let factor =
        |x: Option<f32>, default: f32| x.filter(|x| x.is_finite()).unwrap_or(default).clamp(0.0, 1.0);
    material.roughness = factor(section.roughness, material.roughness);
    material.metallic = factor(section.metallic, material.metallic);
    if section.roughness_map.is_some() || section.metallic_map.is_some() {
        if let Some(map) = joint_map(section, material.metallic) {
            material.metallic_roughness_texture = pictures.slot(map, folder, &material.name)?;
            if material.metallic_roughness_texture.is_some() {
                material.roughness = 1.0;
                material.metallic = if section.metallic_map.is_some() { 1.0 } else { 0.0 };
            }
        } else if pictures.context.textures == Textures::Decode {
            pictures.context.warn(format!(
                "the maps of metal and roughness of material {:?} were left out: they are not the green and blue of one picture; Pm and Pr count instead",
                material.name
            ));
        }
    }
    if let Some(map) = &section.emission_map {
        material.emissive_texture = pictures.slot(map, folder, &material.name)?;
    }
    if material.emissive_texture.is_some() {
        material.emissive = [1.0; 3];
    } else if let Some(emission) = section.emission {
        let linear = emission.map(|x| super::srgb::decode(x).min(f64::from(f32::MAX)));
        let strength = linear.into_iter().fold(1.0, f64::max);
        material.emissive = linear.map(|x| (x / strength) as f32);
        material.emissive_strength = strength as f32;
    }
    Ok(())
}

/// The one map that says what both maps say.
fn joint_map(section: &Section, metallic: f32) -> Option<&Map> {
    let is_from = |map: &Map, channel: u8| map.channel.is_none_or(|c| c == channel);
    let roughness = section.roughness_map.as_ref().filter(|map| is_from(map, b'g'))?;
    let joint = match &section.metallic_map {
        None => metallic == 0.0,
        Some(metal) => {
            is_from(metal, b'b') && Map { channel: roughness.channel, ..metal.clone() } == *roughness
        }
    };
    joint.then_some(roughness)
}

#[cfg(test)]
mod tests {
    use super::super::read_obj_bytes;
    use super::*;
    use crate::{Limits, Resources, encode_png};
    use parbake_model::{AlphaMode, Image};
    use std::io;
    use std::path::Path;

    /// This library, and pictures of any name but `gone.png`.
    struct Shelf(String);

    impl Resources for Shelf {
        fn read(&self, relative: &str, _max_bytes: u64) -> io::Result<Vec<u8>> {
            match relative {
                "l.mtl" => Ok(self.0.clone().into_bytes()),
                gone if gone.ends_with("gone.png") => Err(io::ErrorKind::NotFound.into()),
                _ => Ok(encode_png(&Image::solid("", 1, 1, [9; 4])).unwrap()),
            }
        }
    }

    fn run(section: &str) -> (Material, usize, Vec<crate::Warning>) {
        let text = b"mtllib l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1";
        let shelf = Shelf(format!("newmtl a\n{section}"));
        let mut loaded = read_obj_bytes(Path::new("a.obj"), text, &shelf, &Limits::default()).unwrap();
        (loaded.model.materials.remove(0), loaded.model.images.len(), loaded.warnings)
    }

    /// Protects factors: their defaults, ranges, and emission beyond 1.
    #[test]
    fn factors() {
        let (plain, ..) = run("illum 2");
        assert_eq!(plain, Material { name: "a".into(), ..Material::default() });
        let (read, _, warnings) = run("Pr 0.25\nPm 3\nKe 0 1 0.5\nmap_Ke gone.png");
        assert_eq!((read.roughness, read.metallic, read.emissive_strength), (0.25, 1.0, 1.0));
        assert!((read.emissive[2] - 0.214_041).abs() < 1e-6 && read.emissive[..2] == [0.0, 1.0], "{read:?}");
        assert!(warnings.len() == 1 && warnings[0].text.contains("gone.png"), "{warnings:?}");
        let (read, ..) = run("Pr nan\nPm -1\nKe 2 1 nan\nmap_d x.png");
        assert_eq!((read.roughness, read.metallic, read.alpha_mode), (1.0, 0.0, AlphaMode::Mask));
        assert!((read.emissive_strength - 4.953_846).abs() < 1e-5, "{read:?}");
        assert_eq!(
            (read.emissive[0], read.emissive[1] * read.emissive_strength, read.emissive[2]),
            (1.0, 1.0, 0.0)
        );
        let (read, ..) = run("Ke 1e300");
        assert_eq!((read.emissive, read.emissive_strength), ([1.0; 3], f32::MAX));
    }

    /// Protects maps: one picture serves for metal and roughness, two do not, and emission is
    /// white beneath its map.
    #[test]
    fn maps() {
        let (read, images, warnings) = run("Pr 0.5\nmap_Pr x.png\nMap_Pm x.png\nKe 0 0 0\nmap_Ke y.png");
        assert_eq!((read.metallic, read.roughness, read.emissive), (1.0, 1.0, [1.0; 3]));
        assert_eq!(read.metallic_roughness_texture.map(|s| s.image), Some(0));
        assert_eq!(read.emissive_texture.map(|s| s.image), Some(1));
        assert_eq!((images, warnings.len()), (2, 0));
        for section in ["map_Pr -imfchan g x.png", "Pr 0\nPm 0\nmap_Pr x.png"] {
            let (read, images, warnings) = run(section);
            assert_eq!((read.metallic, read.roughness, images), (0.0, 1.0, 1), "{section}");
            assert!(read.metallic_roughness_texture.is_some() && warnings.is_empty(), "{warnings:?}");
        }
        for section in [
            "map_Pr x.png\nmap_Pm y.png",
            "map_Pr x.png\nmap_Pm -clamp on x.png",
            "map_Pr -imfchan r x.png\nmap_Pm -imfchan g x.png",
            "map_Pr -imfchan r x.png",
            "map_Pr x.png",
            "map_Pm x.png",
        ] {
            let (read, images, warnings) = run(&format!("Pr 0.5\nPm 0.25\n{section}"));
            assert_eq!((read.metallic, read.roughness, images), (0.25, 0.5, 0), "{section}");
            assert!(warnings.len() == 1 && warnings[0].text.contains("Pm and Pr count"), "{warnings:?}");
        }
    }
}
