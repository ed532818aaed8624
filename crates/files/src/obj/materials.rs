//! From an OBJ file's libraries to materials and pictures.
//!
//! * `Kd` is what programs show on the screen, hence sRGB; the model's base colour
//!   is linear. Where there is a `map_Kd`, `Kd` is ignored: exporters leave
//!   anything there, 0 0 0 and 0.8 0.8 0.8 above all.
//! * `norm` is a tangent-space normal map, +Y up. `map_Bump` should be a height
//!   map, but many exporters write normal maps there: a picture whose mean colour
//!   is that of a normal map (blue) is taken as one, any other is left out.
//! * Metal, roughness and emission: `pbr.rs`.
//! * What is missing (a library, a section, a picture) is a warning.

use super::find_file::{read_absolute, read_beside};
use super::lex::text;
use super::mtl::{self, Found};
use super::pictures::Pictures;
use crate::context::Context;
use crate::image_in::Origin;
use crate::search::is_absolute;
use crate::{FileError, WarningKind};
use parbake_model::{AlphaMode, Image, Material};
use std::collections::HashMap;

/// More are not looked for: each may cost a search on the disk.
const MOST_LIBRARIES: usize = 1000;

/// Materials for these names, in this order, and the pictures they use.
pub(super) fn build(
    names: &[String],
    libraries: &[Vec<u8>],
    context: &Context<'_>,
) -> Result<(Vec<Material>, Vec<Image>), FileError> {
    let sections = read_libraries(libraries, context)?;
    let mut pictures = Pictures::new(context);
    let mut materials = Vec::with_capacity(names.len());
    let mut doubtful = Vec::new();
    for name in names {
        let mut material = Material { name: name.clone(), ..Material::default() };
        match sections.get(name.as_str()) {
            Some(found) => {
                if let Some(bump) = fill(&mut material, found, &mut pictures)? {
                    doubtful.push((materials.len(), bump));
                }
            }
            None if name.is_empty() => material.name = "default".into(),
            // Said once and not for each material, where there is no library at all.
            None if sections.is_empty() => {}
            None => context.warn_of(
                WarningKind::MissingMaterial,
                format!("material {name:?} is in no material library; it becomes white"),
            ),
        }
        materials.push(material);
    }
    let images = context.decode_images(&pictures.found, Origin::Other)?;
    for (material, file) in doubtful {
        let slot = &mut materials[material].normal_texture;
        if slot.is_some_and(|slot| !looks_like_normals(&images[slot.image])) {
            *slot = None;
            materials[material].normal_scale = 1.0;
            context.warn(format!(
                "bump map {file:?} does not look like a tangent-space normal map and was left out; write it as `norm` if it is one"
            ));
        }
    }
    Ok((materials, images))
}

fn read_libraries(libraries: &[Vec<u8>], context: &Context<'_>) -> Result<HashMap<String, Found>, FileError> {
    let mut sections = HashMap::new();
    let mut add = |file: &str, bytes: &[u8]| {
        let folder = file.rfind('/').map_or("", |at| &file[..=at]);
        for section in mtl::read(bytes) {
            // Of sections of one name the first counts, as libraries are searched in order.
            let key = text(&section.name);
            sections.entry(key).or_insert_with(|| (section, folder.to_string()));
        }
    };
    let mut seen: Vec<&[u8]> = Vec::new();
    for words in libraries {
        // Exporters that write one `mtllib` for each object write the same each time.
        if seen.contains(&words.as_slice()) || seen.len() > MOST_LIBRARIES {
            continue;
        }
        seen.push(words);
        let whole = text(words).replace("\\ ", " ").replace('\\', "/");
        let several = split_names(&text(words), MOST_LIBRARIES);
        if is_absolute(&whole) {
            // Blanks are in folders' names, above all in those of Windows.
            match read_absolute(&whole, "", context)? {
                Some((file, bytes)) => add(&file, &bytes),
                None => context.warn(format!(
                    "material library {whole:?} was not found, nor a file of its name beside the model; put it there"
                )),
            }
            continue;
        }
        // One name with blanks is likelier than several names; but both occur.
        if let Some(bytes) = read_beside(&whole, context)? {
            add(&whole, &bytes);
        } else {
            for name in &several {
                match read_beside(name, context)? {
                    Some(bytes) => add(name, &bytes),
                    None => context.warn_of(
                        WarningKind::MissingMaterial,
                        format!("material library {name:?} was not found; put it beside the model"),
                    ),
                }
            }
        }
    }
    Ok(sections)
}

/// At most so many names separated by blanks; a blank after a backslash is part of the name.
fn split_names(words: &str, most: usize) -> Vec<String> {
    let blank = '\u{0}';
    let kept = words.replace("\\ ", &blank.to_string()).replace('\\', "/");
    kept.split_ascii_whitespace().take(most).map(|name| name.replace(blank, " ")).collect()
}

/// Fills the material in. A bump map is put down as a normal map, and its file is
/// returned: only its pixels will tell whether it is one.
fn fill<'f>(
    material: &mut Material,
    found: &'f Found,
    pictures: &mut Pictures<'_, '_>,
) -> Result<Option<&'f str>, FileError> {
    let (section, folder) = found;
    if let Some(diffuse) = section.diffuse {
        let [r, g, b] = diffuse.map(|x| super::srgb::decode(x) as f32);
        material.base_color = [r, g, b, 1.0];
    }
    if let Some(map) = &section.diffuse_map {
        material.base_color = [1.0; 4];
        material.base_color_texture = pictures.slot(map, folder, &material.name)?;
    }
    material.base_color[3] = section.opacity.filter(|o| o.is_finite()).unwrap_or(1.0).clamp(0.0, 1.0);
    if section.has_opacity_map {
        material.alpha_mode = AlphaMode::Mask;
    } else if material.base_color[3] < 1.0 {
        material.alpha_mode = AlphaMode::Blend;
    }
    super::pbr::fill(material, found, pictures)?;
    let normals = section.normal_map.as_ref();
    if let Some(map) = normals.or(section.bump_map.as_ref()) {
        material.normal_texture = pictures.slot(map, folder, &material.name)?;
        if material.normal_texture.is_some() {
            material.normal_scale = map.strength;
            return Ok(normals.is_none().then_some(&map.file));
        }
    }
    Ok(None)
}

/// Whether the mean colour is that of tangent-space normals: much blue, and red
/// and green about half.
fn looks_like_normals(image: &Image) -> bool {
    let mut sums = [0u64; 3];
    for pixel in &image.pixels {
        for (sum, &channel) in sums.iter_mut().zip(pixel) {
            *sum += u64::from(channel);
        }
    }
    let [r, g, b] = sums.map(|sum| sum as f64 / image.pixels.len() as f64);
    b > 178.0 && (r - 127.5).abs() < 40.0 && (g - 127.5).abs() < 40.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Textures;
    use crate::{Limits, NoResources, Resources, encode_png};
    use parbake_model::Wrap;
    use parbake_model::glam::Vec2;
    use std::io::{self, ErrorKind};
    use std::path::Path;

    struct Shelf(Vec<(&'static str, Vec<u8>)>);

    impl Resources for Shelf {
        fn read(&self, relative: &str, _max_bytes: u64) -> io::Result<Vec<u8>> {
            let found = self.0.iter().find(|(name, _)| *name == relative);
            found.map(|(_, bytes)| bytes.clone()).ok_or(io::Error::from(ErrorKind::NotFound))
        }
    }

    type Built = Result<(Vec<Material>, Vec<Image>, Vec<crate::Warning>), FileError>;

    fn run(resources: &dyn Resources, names: &[&str], libraries: &[&str]) -> Built {
        let limits = Limits::default();
        let context = Context::new(Path::new("a.obj"), resources, &limits, Textures::Decode);
        let names: Vec<_> = names.iter().map(|s| s.to_string()).collect();
        let libraries: Vec<_> = libraries.iter().map(|s| s.as_bytes().to_vec()).collect();
        let (materials, images) = build(&names, &libraries, &context)?;
        Ok((materials, images, context.into_warnings()))
    }

    fn png(rgba: [u8; 4]) -> Vec<u8> {
        encode_png(&Image::solid("x", 2, 2, rgba)).unwrap()
    }

    /// Protects the meaning of Kd with and without a map, and one image for two uses.
    #[test]
    fn colours_and_shared_pictures() {
        let mtl = "newmtl a\nKd 0 0 0\nmap_Kd t/x y.png\nnewmtl b\nKd 0.5 1 0\nd 0.5\nnewmtl c\nmap_Kd -s 2 2 -o 0.25 0.5 -clamp on t/x y.png\n";
        let shelf = Shelf(vec![("m/l.mtl", mtl.into()), ("m/t/x y.png", png([1, 2, 3, 255]))]);
        let (materials, images, warnings) = run(&shelf, &["a", "b", "c"], &["m\\l.mtl"]).unwrap();
        assert_eq!((images.len(), warnings.len()), (1, 0));
        assert_eq!(images[0].name, "m/t/x y.png");
        assert_eq!(materials[0].base_color, [1.0; 4]);
        assert!((materials[1].base_color[0] - 0.214_041).abs() < 1e-6);
        assert_eq!(materials[1].base_color[3], 0.5);
        assert_eq!(materials[1].alpha_mode, AlphaMode::Blend);
        let slot = materials[2].base_color_texture.unwrap();
        assert_eq!(slot.wrap, [Wrap::Clamp; 2]);
        // OBJ's (0.5, 0.25) goes to (1.25, 1.0); turned over: (0.5, 0.75) to (1.25, 0.0).
        assert_eq!(slot.transform.apply(Vec2::new(0.5, 0.75)), Vec2::new(1.25, 0.0));
    }

    /// Protects the choice between normal and height maps.
    #[test]
    fn bump_maps_are_looked_at() {
        let mtl = "newmtl a\nmap_Bump -bm 0.5 n.png\nnewmtl b\nbump h.png\nnewmtl c\nnorm h.png\n";
        let files =
            vec![("l", mtl.into()), ("n.png", png([128, 120, 250, 255])), ("h.png", png([99, 99, 99, 255]))];
        let (materials, _, warnings) = run(&Shelf(files), &["a", "b", "c"], &["l"]).unwrap();
        assert_eq!(materials[0].normal_texture.map(|t| t.image), Some(0));
        assert_eq!(materials[0].normal_scale, 0.5);
        assert_eq!(materials[1].normal_texture, None);
        assert_eq!(materials[2].normal_texture.map(|t| t.image), Some(1));
        assert!(warnings.len() == 1 && warnings[0].text.contains("h.png"), "{warnings:?}");
    }

    /// Protects models with missing parts: warnings that name them, and no error.
    #[test]
    fn missing_parts_are_warnings() {
        let (materials, _, warnings) = run(&NoResources, &["a", ""], &["b c.mtl"]).unwrap();
        assert_eq!(materials[1].name, "default");
        assert_eq!(warnings.len(), 2);
        let shelf = Shelf(vec![("c.mtl", "newmtl d\nmap_Kd C:\\x\\y.png".into())]);
        let (_, _, warnings) = run(&shelf, &["d", "e"], &["b.mtl c.mtl", "b.mtl c.mtl"]).unwrap();
        assert_eq!(warnings.len(), 3, "{warnings:?}");
        let shelf = Shelf(vec![("c.mtl", "newmtl d\nmap_Kd C:\\x\\y.png".into()), ("y.png", b"junk".into())]);
        let error = run(&shelf, &["d"], &["c.mtl"]).unwrap_err().to_string();
        assert!(error.contains("a.obj") && error.contains("y.png"), "{error}");
    }
}
