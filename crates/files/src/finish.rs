//! The last step of every reader: makes the mesh keep its contract, and says what
//! had to be done for it.
//!
//! * triangles without area go (two corners at one place, or all on one line), and with them what is said of them;
//! * normals become unit vectors; one without a direction is replaced by the
//!   area-weighted mean of its triangles' normals;
//! * texture coordinates and colours that are no numbers become 0 and white.
//!
//! Positions are finite already: only the readers know where a bad one stands.

use crate::context::Context;
use crate::unit::{unit, unit_tangent};
use crate::words::count;
use crate::{Contents, FileError, Loaded, Place};
use parbake_model::glam::{DVec3, Vec2, Vec3, Vec4};
use parbake_model::{Mesh, Model};

/// Ends a reading. `empty_detail` explains an empty mesh, in words that follow
/// "the model has no triangles".
pub(crate) fn finish(
    mut model: Model,
    context: Context<'_>,
    empty_detail: &str,
) -> Result<Loaded, FileError> {
    let degenerate = drop_degenerate(&mut model);
    let mesh = &mut model.mesh;
    if mesh.triangles.is_empty() {
        let detail = match degenerate {
            0 => empty_detail.into(),
            n => format!(" with an area ({n} without)"),
        };
        return Err(FileError::Empty { path: context.path.into(), detail });
    }
    if degenerate > 0 {
        context.warn(format!("left out {} without area", count(degenerate, "triangle")));
    }
    repair_numbers(mesh, &context);
    let replaced = repair_normals(mesh);
    if replaced > 0 {
        let normals = count(replaced, "normal");
        context.warn(format!("computed {normals} without a direction from the triangles around"));
    }
    let (uvs, offsets) = ([mesh.uvs.len(), mesh.uvs1.len()], mesh.parallax_offsets.len());
    let sizes = [mesh.normals.len(), mesh.tangents.len(), uvs[0], uvs[1], offsets];
    if sizes.iter().any(|&n| n != 0 && n != mesh.positions.len()) {
        return Err(context.invalid(Place::File, "the attributes of its vertices differ in number"));
    }
    let bytes = context.bytes();
    let contents = Contents { degenerate_triangles: degenerate, ..context.contents() };
    let pictures = context.take_picture_files();
    Ok(Loaded { model, warnings: context.into_warnings(), bytes, contents, pictures })
}

/// Twice the area vector, in doubles: products of small floats would vanish.
fn area_normal(mesh: &Mesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
    (b - a).cross(c - a)
}

fn drop_degenerate(model: &mut Model) -> usize {
    let Model { mesh, nodes, painted, .. } = model;
    let before = mesh.triangles.len();
    let is_kept: Vec<bool> = (0..before)
        .map(|i| {
            let [a, b, c] = mesh.triangles[i];
            a != b && b != c && c != a && area_normal(mesh, i) != DVec3::ZERO
        })
        .collect();
    if is_kept.iter().all(|&kept| kept) {
        return 0;
    }
    keep(&mut mesh.triangles, &is_kept);
    keep(&mut mesh.triangle_materials, &is_kept);
    keep(painted, &is_kept);
    if let Some(nodes) = nodes {
        keep(&mut nodes.of_triangles, &is_kept);
    }
    before - mesh.triangles.len()
}

fn keep<T>(values: &mut Vec<T>, is_kept: &[bool]) {
    let mut kept = is_kept.iter();
    values.retain(|_| kept.next().is_some_and(|&kept| kept));
}

fn repair_numbers(mesh: &mut Mesh, context: &Context<'_>) {
    let mut bad = 0;
    for uv in mesh.uvs.iter_mut().chain(&mut mesh.uvs1).filter(|uv| !uv.is_finite()) {
        *uv = Vec2::ZERO;
        bad += 1;
    }
    if bad > 0 {
        let bad = count(bad, "texture coordinate");
        context.warn(format!("replaced {bad} without a finite value by 0"));
    }
    let mut bad = 0;
    for color in mesh.colors.iter_mut().filter(|c| !c.is_finite()) {
        *color = Vec4::ONE;
        bad += 1;
    }
    if bad > 0 {
        let bad = count(bad, "vertex colour");
        context.warn(format!("replaced {bad} without a finite value by white"));
    }
}

/// How many normals were replaced.
fn repair_normals(mesh: &mut Mesh) -> usize {
    let mut sums: Option<Vec<DVec3>> = None;
    let mut replaced = 0;
    for i in 0..mesh.normals.len() {
        mesh.normals[i] = unit(mesh.normals[i]).unwrap_or_else(|| {
            replaced += 1;
            let sum = sums.get_or_insert_with(|| vertex_area_normals(mesh))[i];
            sum.normalize_or(DVec3::Y).as_vec3()
        });
    }
    for (tangent, &normal) in mesh.tangents.iter_mut().zip(&mesh.normals) {
        *tangent = unit_tangent(*tangent, normal);
    }
    replaced
}

/// For every vertex the sum of its triangles' area vectors.
fn vertex_area_normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        let normal = area_normal(mesh, i);
        for &corner in triangle {
            sums[corner as usize] += normal;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Textures;
    use crate::{Limits, NoResources};
    use std::path::Path;

    fn model() -> Model {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X * 2.0],
            triangles: vec![[0, 1, 2], [0, 1, 3], [0, 0, 2]],
            triangle_materials: vec![0, 1, 2],
            ..Mesh::default()
        };
        Model { mesh, materials: vec![Default::default(); 3], ..Model::default() }
    }

    fn run(model: Model) -> Result<Loaded, FileError> {
        let limits = Limits::default();
        let context = Context::new(Path::new("a.obj"), &NoResources, &limits, Textures::Decode);
        finish(model, context, "")
    }

    /// Protects later rooms from triangles without area, and their materials' order.
    #[test]
    fn degenerate_triangles_go() {
        let loaded = run(model()).unwrap();
        assert_eq!(loaded.model.mesh.triangles, [[0, 1, 2]]);
        assert_eq!(loaded.model.mesh.triangle_materials, [0]);
        assert_eq!(loaded.warnings, ["left out 2 triangles without area"]);
        assert_eq!(loaded.contents.degenerate_triangles, 2);
    }

    /// Protects tiny models: areas of 1e-50 are areas.
    #[test]
    fn tiny_triangles_stay() {
        let mut model = model();
        model.mesh.positions.iter_mut().for_each(|p| *p *= 1e-25);
        assert_eq!(run(model).unwrap().model.mesh.triangles.len(), 1);
    }

    /// Protects the unit-length contract of normals and the message on emptiness.
    #[test]
    fn normals_are_repaired_and_empty_is_an_error() {
        let mut broken = model();
        broken.mesh.normals = vec![Vec3::ZERO, Vec3::Z * 3.0, Vec3::NAN, Vec3::X];
        let loaded = run(broken).unwrap();
        assert_eq!(loaded.model.mesh.normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::X]);
        let mut empty = model();
        empty.mesh.triangles[0] = [0, 0, 0];
        let error = run(empty).unwrap_err().to_string();
        assert_eq!(error, "a.obj: the model has no triangles with an area (3 without)");
    }
}
