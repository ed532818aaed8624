//! OBJ out: the mesh, an MTL file and the pictures beside it.
//!
//! Numbers are printed so that reading gives the same bits back (colours: nearly). What OBJ cannot
//! say is refused rather than dropped (for materials see `write_mtl.rs`). Tangents and the alpha of
//! vertex colours are left out; readers can compute the former.

use super::srgb;
use super::write_mtl::{is_picture_of, library, material_names, name_pictures};
use crate::FileError;
use crate::atomic::write_together;
use crate::image_out::pack_png;
use crate::unit::unit;
use parbake_model::glam::Vec3;
use parbake_model::{Mesh, Model};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Writes `model` to `path`, with `<stem>.mtl` and `<stem>_<use>.png` beside it.
/// All are written before any takes its place, the OBJ file last, so that it never
/// names what is not there yet. Returns how many bytes that is together.
///
/// # Errors
/// When the model breaks its contract or says what OBJ cannot, and when a file
/// cannot be written.
pub fn write_obj(path: &Path, model: &Model) -> Result<u64, FileError> {
    crate::model_out::check(path, model)?;
    let stem = plain_stem(path);
    let pictures = name_pictures(&stem, model);
    let library = library(path, model, &pictures)?;
    let text = text(&stem, model);
    let pictures: Vec<_> = pictures.iter().flatten().collect();
    let encoded = pictures.par_iter().map(|(name, image)| Ok((name, pack_png(image)?)));
    let encoded: Vec<_> = encoded.collect::<Result<_, FileError>>()?;
    let mut files: Vec<_> =
        encoded.iter().map(|(name, bytes)| (path.with_file_name(name), bytes.as_slice())).collect();
    files.push((path.with_file_name(format!("{stem}.mtl")), library.as_bytes()));
    files.push((path.to_path_buf(), text.as_bytes()));
    write_together(&files)?;
    Ok(files.iter().map(|(_, bytes)| bytes.len() as u64).sum())
}

/// The paths that [`write_obj`] may replace, of those that exist: its own, its material file's and its pictures'.
pub(crate) fn replaced(path: &Path) -> Vec<PathBuf> {
    let stem = plain_stem(path);
    // On some disks names that differ in their case alone are one.
    let stem = stem.to_lowercase();
    let is_ours = |name: &str| {
        let name = name.to_lowercase();
        name == format!("{stem}.mtl") || is_picture_of(&stem, &name)
    };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = folder.read_dir().into_iter().flatten().flatten();
    let beside = entries.map(|entry| entry.file_name()).filter(|name| name.to_str().is_some_and(is_ours));
    let own = path.exists().then(|| path.to_path_buf());
    own.into_iter().chain(beside.map(|name| path.with_file_name(name))).collect()
}

/// The stem without what other programs stumble over in OBJ and MTL files: blanks,
/// and characters that begin a comment or an option.
fn plain_stem(path: &Path) -> String {
    let plain = |c: char| if c.is_whitespace() || c.is_control() || "#\\\"".contains(c) { '_' } else { c };
    let stem: String = super::path_stem(path).chars().map(plain).collect();
    if stem.starts_with('-') { format!("_{stem}") } else { stem }
}

fn text(stem: &str, model: &Model) -> String {
    let mesh = &model.mesh;
    let mut out = String::with_capacity(100 * mesh.positions.len() + 30 * mesh.triangles.len());
    let _ = writeln!(out, "# Parbake {}\nmtllib {stem}.mtl", env!("CARGO_PKG_VERSION"));
    vertices(&mut out, mesh);
    let names = material_names(model);
    let mut current = None;
    for (triangle, &material) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
        if current != Some(material) {
            current = Some(material);
            let _ = writeln!(out, "usemtl {}", names[material as usize]);
        }
        out.push('f');
        for &i in triangle {
            let n = u64::from(i) + 1;
            let _ = match (mesh.uvs.is_empty(), mesh.normals.is_empty()) {
                (true, true) => write!(out, " {n}"),
                (false, true) => write!(out, " {n}/{n}"),
                (true, false) => write!(out, " {n}//{n}"),
                (false, false) => write!(out, " {n}/{n}/{n}"),
            };
        }
        out.push('\n');
    }
    out
}

fn vertices(out: &mut String, mesh: &Mesh) {
    for (i, p) in mesh.positions.iter().enumerate() {
        let _ = write!(out, "v {} {} {}", p.x, p.y, p.z);
        if let Some(color) = mesh.colors.get(i) {
            let [r, g, b] =
                color.truncate().to_array().map(|x| srgb::encode(f64::from(x).clamp(0.0, 1.0)) as f32);
            let _ = write!(out, " {r} {g} {b}");
        }
        out.push('\n');
    }
    for uv in &mesh.uvs {
        // In doubles 1 − v is exact but for |v| < 2⁻²⁹, so that the reader's 1 − v gives v back,
        // these tiny ones to within 2⁻⁵³.
        let _ = writeln!(out, "vt {} {}", uv.x, 1.0 - f64::from(uv.y));
    }
    for n in &mesh.normals {
        let n = unit(*n).unwrap_or(Vec3::Y);
        let _ = writeln!(out, "vn {} {} {}", n.x, n.y, n.z);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, read_model};
    use parbake_model::glam::{Vec2, Vec4};
    use parbake_model::{Image, Material, TextureSlot, Wrap};

    fn model() -> Model {
        let mesh = Mesh {
            positions: vec![Vec3::new(0.1, -1e-9, 3e20), Vec3::X, Vec3::Y, Vec3::Z],
            normals: vec![Vec3::Z, Vec3::X, Vec3::Y, Vec3::new(0.6, 0.8, 0.0)],
            uvs: vec![Vec2::new(0.1, 0.3), Vec2::new(1.0, 1e-7), Vec2::new(-3.3, 7.1), Vec2::ONE],
            colors: vec![Vec4::new(0.1, 0.2, 0.3, 1.0), Vec4::ONE, Vec4::W, Vec4::ONE],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            triangle_materials: vec![0, 1],
            ..Mesh::default()
        };
        let slot = TextureSlot { image: 1, ..TextureSlot::default() };
        let colored = Material { name: "a".into(), base_color: [0.2, 0.4, 0.6, 1.0], ..Material::default() };
        let textured = Material {
            name: "a".into(),
            base_color_texture: Some(slot),
            normal_texture: Some(TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..slot }),
            normal_scale: 0.5,
            ..Material::default()
        };
        let images = vec![Image::solid("n", 2, 2, [1, 2, 3, 4]), Image::solid("c", 3, 1, [9, 8, 7, 255])];
        Model { name: "m".into(), mesh, materials: vec![colored, textured], images, ..Model::default() }
    }

    /// Protects every bit on the way through a file, the pictures' names, and the count of all
    /// bytes that were written, which are those that are read.
    #[test]
    fn comes_back_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my cup.obj");
        let model = model();
        let written = write_obj(&path, &model).unwrap();
        assert!(folder.path().join("my_cup_base_color.png").exists());
        let loaded = read_model(&path, &Limits::default()).unwrap();
        assert_eq!(loaded.warnings, [""; 0]);
        let lengths =
            std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().metadata().unwrap().len());
        assert_eq!([loaded.bytes, written], [lengths.sum::<u64>(); 2]);
        let mut mesh = loaded.model.mesh;
        for (a, b) in mesh.colors.iter_mut().zip(&model.mesh.colors) {
            assert!(a.distance(*b) < 1e-6, "{a} {b}");
            *a = *b;
        }
        assert_eq!(mesh, model.mesh);
        let (a, b) = (&loaded.model.materials, &model.materials);
        assert_eq!(a[0], b[0]);
        assert_eq!(a[1].name, "a_1");
        assert_eq!(a[1].normal_scale, 0.5);
        assert_eq!(a[1].normal_texture.unwrap().wrap, [Wrap::Clamp; 2]);
        let image = &loaded.model.images[a[1].normal_texture.unwrap().image];
        assert_eq!(image.pixels, model.images[0].pixels);
    }

    /// Protects users from silently losing what OBJ cannot say.
    #[test]
    fn what_obj_cannot_say_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut turned = model();
        turned.materials[1].base_color_texture.as_mut().unwrap().transform.rotation = 1.0;
        let error = write_obj(&folder.path().join("a.obj"), &turned).unwrap_err().to_string();
        assert!(error.contains("turned textures") && error.contains(".glb"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    /// Protects folders from half a model: pictures without their OBJ file.
    #[test]
    fn a_failure_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::create_dir(&path).unwrap();
        let error = write_obj(&path, &model()).unwrap_err();
        assert_eq!(error.path(), path);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
