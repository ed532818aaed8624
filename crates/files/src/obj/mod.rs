//! OBJ and MTL, in and out.

mod assemble;
mod lex;
mod materials;
mod mtl;
mod srgb;
mod statements;
mod write;

pub use write::write_obj;

use crate::context::{Context, Textures};
use crate::finish::finish;
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
    let mut statements = statements::read(bytes, &context)?;
    if statements.short_faces > 0 {
        let count = statements.short_faces;
        context.warn(format!("{count} faces have fewer than three corners and were left out"));
    }
    if statements.free_form {
        context.warn("free-form curves and surfaces were left out; export them as polygons");
    }
    let empty = match statements.positions.len() {
        0 => " and no vertices; it may not be an OBJ file".to_string(),
        n => format!("; it has {n} vertices, but nothing joins them to faces"),
    };
    let names = std::mem::take(&mut statements.material_names);
    let libraries = std::mem::take(&mut statements.libraries);
    let mesh = assemble::assemble(statements, &context)?;
    let (mesh, names) = used_materials(mesh, names);
    let (materials, images) = materials::build(&names, &libraries, &context)?;
    check_coordinates(&mesh, &materials, &context);
    let name = path_stem(context.path);
    finish(Model { name, mesh, materials, images }, context, &empty)
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
    let textured = |m: &Material| m.base_color_texture.is_some() || m.normal_texture.is_some();
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
    use crate::NoResources;

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

    /// Protects the words about files without triangles.
    #[test]
    fn emptiness_is_explained() {
        let error = run(b"v 0 0 0\np 1").unwrap_err().to_string();
        assert!(error.ends_with("has 1 vertices, but nothing joins them to faces"), "{error}");
        let error = run(b"solid cube\nfacet normal").unwrap_err().to_string();
        assert!(error.contains("may not be an OBJ file"), "{error}");
    }
}
