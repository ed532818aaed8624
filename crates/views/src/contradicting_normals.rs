//! Vertex normals that contradict the winding order of their triangles, as exports of mirrored parts often have them.
//! Renderers take the front from the winding order and flip normals on back faces, so such surfaces are dark from outside.
//!
//! Contract: the model is not changed, since a bake shows what its high-poly shows; the user is warned.

use parbake_mesh::area_facing_back;
use parbake_model::Mesh;

/// Share of the area above which the user is warned: single slivers with smooth normals are no fault.
const WORTH_A_WORD: f64 = 0.01;

/// A warning about a mesh whose vertex normals point to the back of its triangles; none where the mesh has no normals,
/// or hardly any such area.
pub(crate) fn contradicting_normals(mesh: &Mesh) -> Option<String> {
    let has_own = !mesh.normals.is_empty() && mesh.normals.len() == mesh.positions.len();
    let share = if has_own { area_facing_back(mesh) } else { 0.0 };
    (share > WORTH_A_WORD).then(|| {
        format!(
            "on {:.0} % of the surface, vertex normals point to the back of their triangles, so it renders dark there, \
             and so does the bake; recalculate normals in your modelling tool, or export the model without normals",
            100.0 * share
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec3;

    /// Protects users of careless exports, who would look for the fault in the bake, and all others from a false alarm.
    #[test]
    fn normals_of_the_wrong_side_are_told() {
        let mut mesh = Mesh {
            positions: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
                .map(|[x, y]| Vec3::new(x, y, 0.0))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        assert_eq!(contradicting_normals(&mesh), None);
        mesh.normals = vec![Vec3::Z; 4];
        assert_eq!(contradicting_normals(&mesh), None);
        mesh.triangles[1] = [0, 3, 2];
        let told = contradicting_normals(&mesh).expect("half of it looks to the back");
        assert!(told.starts_with("on 50 % of the surface"), "{told}");
    }
}
