//! Material libraries (.mtl) out.
//!
//! Colours are written as programs show them, sRGB-encoded; metal, roughness and emission as `Pm`,
//! `Pr` and `Ke` of the PBR extension, where they differ from 0, 1 and 0. What MTL cannot say is
//! refused rather than dropped: turned, mirrored or second-set texture coordinates, factors on
//! textures, occlusion, materials without lighting, and parallax maps. Alpha mode, cutoff and
//! sides are left out: what `d` says is all that readers agree upon. The strength of emission is
//! multiplied into `Ke`.

use super::{NamedImage, srgb};
use crate::{FileError, Place};
use parbake_model::{Material, Model, TextureSlot, UvTransform, Wrap};
use std::fmt::Write;
use std::path::Path;

/// For each image a file name, if a material uses it.
pub(super) fn name_pictures<'a>(stem: &str, model: &'a Model) -> Vec<Option<NamedImage<'a>>> {
    let mut names: Vec<Option<NamedImage>> = vec![None; model.images.len()];
    let mut counts = [0; 4];
    for material in &model.materials {
        for ((slot, what), count) in textures(material).into_iter().zip(WHAT).zip(&mut counts) {
            let Some(image) = slot.map(|s| s.image).filter(|&i| names[i].is_none()) else { continue };
            *count += 1;
            let number = if *count == 1 { String::new() } else { format!("_{count}") };
            names[image] = Some((format!("{stem}_{what}{number}.png"), &model.images[image]));
        }
    }
    names
}

/// Whether a picture of a model with this stem may have this file name.
pub(super) fn is_picture_of(stem: &str, name: &str) -> bool {
    let middle = name.strip_prefix(stem).and_then(|rest| rest.strip_prefix('_')?.strip_suffix(".png"));
    let is_number = |end: &str| {
        let number = end.strip_prefix('_').unwrap_or("");
        end.is_empty() || number.parse::<usize>().is_ok_and(|n| n > 1 && n.to_string() == number)
    };
    middle.is_some_and(|middle| WHAT.iter().any(|what| middle.strip_prefix(what).is_some_and(is_number)))
}

/// What files of pictures are called after.
const WHAT: [&str; 4] = ["base_color", "normal", "metallic_roughness", "emissive"];

/// The textures that are written, in the order of [`WHAT`].
fn textures(material: &Material) -> [Option<TextureSlot>; 4] {
    [
        material.base_color_texture,
        material.normal_texture,
        material.metallic_roughness_texture,
        material.emissive_texture.filter(|_| emission(material) != [0.0; 3]),
    ]
}

/// What multiplies the emissive texture: linear, and above 1 where the strength says so.
fn emission(material: &Material) -> [f64; 3] {
    let strength = f64::from(material.emissive_strength.max(0.0));
    material.emissive.map(|x| f64::from(x).clamp(0.0, 1.0) * strength)
}

/// Names that are told apart by the reader: no blanks at the ends, none twice.
pub(super) fn material_names(model: &Model) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let mut taken = std::collections::HashSet::new();
    for (i, material) in model.materials.iter().enumerate() {
        let plain = |c: char| if c.is_control() || c == '\\' { '_' } else { c };
        let name: String = material.name.trim().chars().map(plain).collect();
        let mut name = if name.is_empty() { format!("material_{i}") } else { name };
        while !taken.insert(name.clone()) {
            name = format!("{name}_{i}");
        }
        names.push(name);
    }
    names
}

// Writing into a String cannot fail; `let _` says so where the trait returns a Result.

pub(super) fn library(
    path: &Path,
    model: &Model,
    pictures: &[Option<NamedImage>],
) -> Result<String, FileError> {
    let mut out = format!("# Parbake {}\n", env!("CARGO_PKG_VERSION"));
    for (material, name) in model.materials.iter().zip(material_names(model)) {
        let not_in_mtl = [
            (material.parallax.is_some(), "a parallax map"),
            (material.occlusion_texture.is_some(), "an occlusion map"),
            (material.unlit, "a material without lighting"),
        ];
        if let Some((_, feature)) = not_in_mtl.iter().find(|(is_there, _)| *is_there) {
            return Err(cannot(path, material, feature));
        }
        let [r, g, b, a] = material.base_color.map(f64::from);
        let [r, g, b] = [r, g, b].map(|x| srgb::encode(x.clamp(0.0, 1.0)));
        let _ = write!(out, "\nnewmtl {name}\nKd {r} {g} {b}\nKs 0 0 0\n");
        if a < 1.0 {
            let _ = writeln!(out, "d {a}");
        }
        if let Some(slot) = &material.base_color_texture {
            if material.base_color[..3] != [1.0; 3] {
                return Err(cannot(path, material, "a colour factor on a texture"));
            }
            let _ = writeln!(out, "map_Kd {}", map(path, material, slot, pictures)?);
        }
        if let Some(slot) = &material.normal_texture {
            let map = map(path, material, slot, pictures)?;
            let strength = material.normal_scale;
            let strength = if strength == 1.0 { String::new() } else { format!("-bm {strength} ") };
            // `norm` is what new programs read, `map_Bump` what old ones do.
            let _ = write!(out, "norm {strength}{map}\nmap_Bump {strength}{map}\n");
        }
        metal_and_roughness(&mut out, path, material, pictures)?;
        emitted(&mut out, path, material, pictures)?;
    }
    Ok(out)
}

/// What differs from 0 for metal and 1 for roughness. The channels of the texture are glTF's.
fn metal_and_roughness(
    out: &mut String,
    path: &Path,
    material: &Material,
    pictures: &[Option<NamedImage>],
) -> Result<(), FileError> {
    let (metallic, roughness) = (material.metallic.clamp(0.0, 1.0), material.roughness.clamp(0.0, 1.0));
    if roughness != 1.0 {
        let _ = writeln!(out, "Pr {roughness}");
    }
    if metallic != 0.0 {
        let _ = writeln!(out, "Pm {metallic}");
    }
    let Some(slot) = &material.metallic_roughness_texture else { return Ok(()) };
    if roughness != 1.0 || !(metallic == 0.0 || metallic == 1.0) {
        return Err(cannot(path, material, "a factor of metal or roughness on a texture"));
    }
    let map = map(path, material, slot, pictures)?;
    let _ = writeln!(out, "map_Pr -imfchan g {map}");
    if metallic == 1.0 {
        let _ = writeln!(out, "map_Pm -imfchan b {map}");
    }
    Ok(())
}

fn emitted(
    out: &mut String,
    path: &Path,
    material: &Material,
    pictures: &[Option<NamedImage>],
) -> Result<(), FileError> {
    let emission = emission(material);
    if emission == [0.0; 3] {
        return Ok(());
    }
    let [r, g, b] = emission.map(srgb::encode);
    let _ = writeln!(out, "Ke {r} {g} {b}");
    if let Some(slot) = &material.emissive_texture {
        if emission != [1.0; 3] {
            return Err(cannot(path, material, "a factor of emission on a texture"));
        }
        let _ = writeln!(out, "map_Ke {}", map(path, material, slot, pictures)?);
    }
    Ok(())
}

/// Options and file name of one use.
fn map(
    path: &Path,
    material: &Material,
    slot: &TextureSlot,
    pictures: &[Option<NamedImage>],
) -> Result<String, FileError> {
    let mut out = String::new();
    match slot.wrap {
        [Wrap::Repeat, Wrap::Repeat] => {}
        [Wrap::Clamp, Wrap::Clamp] => out += "-clamp on ",
        _ => return Err(cannot(path, material, "mirrored textures, or other edges along u than along v")),
    }
    let UvTransform { offset, rotation, scale } = slot.transform;
    if rotation != 0.0 {
        return Err(cannot(path, material, "turned textures"));
    }
    if slot.uv_set != 0 {
        return Err(cannot(path, material, "a second set of texture coordinates"));
    }
    if slot.transform != UvTransform::default() {
        let up = 1.0 - f64::from(scale.y) - f64::from(offset.y);
        let _ = write!(out, "-s {} {} 1 -o {} {up} 0 ", scale.x, scale.y, offset.x);
    }
    out += pictures[slot.image].as_ref().map_or("", |(name, _)| name);
    Ok(out)
}

fn cannot(path: &Path, material: &Material, feature: &str) -> FileError {
    FileError::Unsupported {
        path: path.into(),
        place: Place::File,
        feature: format!("{feature} (material {:?}) in OBJ", material.name),
        advice: "write a .glb file instead".into(),
    }
}
