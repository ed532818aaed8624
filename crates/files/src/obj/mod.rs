//! OBJ and MTL, in and out.

mod assemble;
mod corner;
mod find_file;
mod lex;
mod materials;
mod mtl;
mod names;
mod pbr;
mod pictures;
mod polygon;
mod srgb;
mod statements;
mod write;
mod write_mtl;

pub(crate) use names::{named_libraries, named_pictures};
pub(crate) use write::replaced;
pub use write::write_obj;

use crate::context::{Context, Textures};
use crate::finish::finish;
use crate::words::count;
use crate::{FileError, Limits, Loaded, Resources};
use parbake_model::{Image, Material, Mesh, Model};
use std::path::Path;

/// Reads an OBJ file from memory; what it refers to comes from `resources`.
/// `path` is only for messages and the model's name.
///
/// # Errors
/// As [`read_model`](crate::read_model); those about the OBJ file itself give the line.
pub fn read_obj_bytes(
    path: &Path,
    bytes: &[u8],
    resources: &dyn Resources,
    limits: &Limits,
) -> Result<Loaded, FileError> {
    read(Context::new(path, resources, limits, Textures::Decode), bytes)
}

pub(crate) fn read(context: Context<'_>, bytes: &[u8]) -> Result<Loaded, FileError> {
    context.count_own(bytes);
    let mut statements = statements::read(bytes, &context)?;
    if statements.short_faces > 0 {
        let faces = count(statements.short_faces, "face");
        context.warn(format!("left out {faces} of fewer than three corners"));
    }
    if statements.free_form {
        context.warn("free-form curves and surfaces were left out; export them as polygons");
    }
    let empty = match statements.positions.len() {
        0 => " and no vertices; it may not be an OBJ file".to_string(),
        n => format!("; it has {}, but nothing joins them to faces", count(n, "position")),
    };
    let names = std::mem::take(&mut statements.material_names);
    let libraries = std::mem::take(&mut statements.libraries);
    let mesh = assemble::assemble(statements, &context)?;
    let (mesh, names) = used_materials(mesh, names);
    context.count_draw_calls(names.len());
    let (materials, images) = materials::build(&names, &libraries, &context)?;
    check_coordinates(&mesh, &materials, &context);
    let name = path_stem(context.path);
    finish(Model { name, mesh, materials, images, ..Model::default() }, context, &empty)
}

/// Forgets the materials that no triangle has, so that their pictures stay closed.
fn used_materials(mut mesh: Mesh, names: Vec<String>) -> (Mesh, Vec<String>) {
    let mut used = vec![false; names.len()];
    for &material in &mesh.triangle_materials {
        used[material as usize] = true;
    }
    let mut places = vec![0; names.len()];
    let mut next = 0;
    for (place, &used) in places.iter_mut().zip(&used) {
        *place = next;
        next += u32::from(used);
    }
    for material in &mut mesh.triangle_materials {
        *material = places[*material as usize];
    }
    (mesh, names.into_iter().zip(used).filter(|(_, u)| *u).map(|(n, _)| n).collect())
}

fn check_coordinates(mesh: &Mesh, materials: &[Material], context: &Context<'_>) {
    let textured = |m: &Material| m.all_texture_slots().next().is_some();
    if mesh.uvs.is_empty() && materials.iter().any(textured) {
        context.warn("materials have pictures, but no face has texture coordinates");
    }
}

fn path_stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A picture and the file name it was given.
type NamedImage<'a> = (String, &'a Image);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NoResources, encode_png};
    use parbake_model::Wrap;
    use parbake_model::glam::{Vec2, Vec3};

    fn run(text: &[u8]) -> Result<Loaded, FileError> {
        read_obj_bytes(Path::new("x/a.obj"), text, &NoResources, &Limits::default())
    }

    /// Protects the smallest model: a default material, no attributes, no warnings.
    #[test]
    fn a_bare_triangle() {
        let loaded = run(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl unused\nusemtl b\nf 1 2 3").unwrap();
        assert_eq!(loaded.model.name, "a");
        assert_eq!(loaded.model.materials.len(), 1);
        assert_eq!(loaded.model.materials[0].name, "b");
        assert_eq!(loaded.model.mesh.triangle_materials, [0]);
        assert_eq!(loaded.warnings, [""; 0]);
    }

    /// Protects files as different systems write them: ends of lines, continued
    /// lines, counting backwards, and bytes that are no UTF-8.
    #[test]
    fn files_of_all_systems_give_one_mesh() {
        let unix = "# caf\u{e9}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nusemtl a\nf 1/1 2/1 3/1\n";
        let mesh = run(unix.as_bytes()).unwrap().model.mesh;
        assert_eq!(mesh.uvs[0], Vec2::ZERO);
        let latin: Vec<u8> = unix.chars().map(|c| c as u8).collect();
        let long = format!("{unix}#{}\n", "x".repeat(1 << 20));
        for other in [
            unix.replace('\n', "\r\n").into_bytes(),
            unix.replace('\n', "\r").into_bytes(),
            unix.replace("f 1/1 2/1", "f \\\n 1/1 \\\r\n\t2/1").into_bytes(),
            unix.replace("f 1/1 2/1 3/1", "f -3/-1 -2/-1 -1/-1").into_bytes(),
            [b"\xef\xbb\xbf", unix.as_bytes()].concat(),
            latin,
            long.into_bytes(),
            unix.replace(' ', &" ".repeat(5000)).into_bytes(),
        ] {
            assert_eq!(run(&other).unwrap().model.mesh, mesh, "{}", lex::text(&other[..40]));
        }
    }

    /// Protects concave faces from being filled beyond their outline.
    #[test]
    fn concave_faces_are_filled_right() {
        let mesh = run(b"f 1 2 3 4\nv 0 0 0\nv 4 -3 0\nv 1 0 0\nv 4 3 0").unwrap().model.mesh;
        assert_eq!(mesh.triangles.len(), 2);
        assert!((0..2).all(|i| mesh.area_normal(i).z > 0.0), "{:?}", mesh.triangles);
        let area: Vec3 = (0..2).map(|i| mesh.area_normal(i) / 2.0).sum();
        assert_eq!(area, Vec3::Z * 3.0);
    }

    /// Protects the way from an OBJ file through its library to a picture: names in
    /// Latin-1, a path of another machine, options before the name.
    #[test]
    fn libraries_and_pictures_are_found() {
        struct Shelf(Vec<u8>);
        impl Resources for Shelf {
            fn read(&self, relative: &str, _max_bytes: u64) -> std::io::Result<Vec<u8>> {
                match relative {
                    "sub dir/m.mtl" => Ok(b"newmtl \xe4\nKd 1 0 0\nnewmtl \xf6\nmap_Kd -clamp on -s 2 4 -o 0 0.5 C:\\tex\\B\xe4r.png\r\n".to_vec()),
                    "sub dir/B\u{e4}r.png" => Ok(self.0.clone()),
                    _ => Err(std::io::ErrorKind::NotFound.into()),
                }
            }
        }
        let text = b"mtllib sub dir\\m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl \xe4\nf 1 2 3\nusemtl \xf6\nf 1/1 2/1 3/1";
        let shelf = Shelf(encode_png(&Image::solid("", 1, 1, [9; 4])).unwrap());
        let loaded = read_obj_bytes(Path::new("a.obj"), text, &shelf, &Limits::default()).unwrap();
        let elsewhere =
            "nothing is at \"C:/tex/B\u{e4}r.png\"; \"sub dir/B\u{e4}r.png\" beside the model was taken";
        let expected = ["took (0, 0) for 3 face corners without a texture coordinate", elsewhere];
        assert_eq!(loaded.warnings, expected);
        let [red, textured] = &loaded.model.materials[..] else { panic!("two materials") };
        assert_eq!((red.name.as_str(), red.base_color), ("\u{e4}", [1.0, 0.0, 0.0, 1.0]));
        let slot = textured.base_color_texture.unwrap();
        assert_eq!(slot.wrap, [Wrap::Clamp; 2]);
        // v up: (0, 0) goes to (0, 0.5); v down: (0, 1) to (0, 0.5).
        assert_eq!(slot.transform.apply(Vec2::Y), Vec2::new(0.0, 0.5));
        assert_eq!(loaded.model.images[0].pixels, [[9; 4]]);
    }

    /// Protects the words about files without triangles.
    #[test]
    fn emptiness_is_explained() {
        let error = run(b"v 0 0 0\np 1").unwrap_err().to_string();
        assert!(error.ends_with("has 1 position, but nothing joins them to faces"), "{error}");
        let error = run(b"solid cube\nfacet normal").unwrap_err().to_string();
        assert!(error.contains("may not be an OBJ file"), "{error}");
    }
}
