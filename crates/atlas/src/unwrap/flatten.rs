//! Charts cut and laid flat by the crate `uvunwrap`: region growing, least-squares
//! conformal maps (Lévy et al. 2002), as-rigid-as-possible steps (Liu et al. 2008).

use super::corners::{Corners, MESH_CORNER, Surface};
use glam::{DVec2, dvec2};
use parbake_model::glam::Vec3;
use uvunwrap::{Density, MeshInput, Options, Packing, generate};

/// Gives some triangles new places in new charts, all of the same scale. Those that the
/// library leaves out, as too thin or because it refuses the mesh, get one each.
///
/// The charts of different pages may overlap; they are to be packed.
pub(crate) fn flatten(surface: &Surface, corners: &mut Corners, triangles: &[u32], max_chart_angle: f32) {
    let mesh = surface.mesh;
    let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| mesh.triangles[t as usize]).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let local = |v: u32| vertices.partition_point(|&w| w < v) as u32;
    let indices: Vec<u32> = triangles.iter().flat_map(|&t| mesh.triangles[t as usize].map(local)).collect();
    // Into the unit cube, so that no length overflows.
    let corner = |f: fn(Vec3, Vec3) -> Vec3| {
        vertices.iter().map(|&v| mesh.positions[v as usize]).reduce(f).unwrap_or_default().as_dvec3()
    };
    let (low, high) = (corner(Vec3::min), corner(Vec3::max));
    let size = (high - low).max_element().max(f64::MIN_POSITIVE);
    let positions: Vec<[f32; 3]> = vertices
        .iter()
        .map(|&v| ((mesh.positions[v as usize].as_dvec3() - low) / size).as_vec3().to_array())
        .collect();
    let options = Options {
        max_chart_angle,
        // All is packed again, by shape.
        packing: Packing::Fast,
        padding: 1,
        density: Density::Auto { page_size: 4096 },
        ..Options::default()
    };
    let atlas = generate(&[MeshInput::new(&positions, &indices)], &options).ok();
    let output = atlas.as_ref().and_then(|atlas| Some((atlas, atlas.meshes.first()?)));
    let first_label = corners.next;
    for (i, &t) in triangles.iter().enumerate() {
        let t = t as usize;
        let found = output.and_then(|(atlas, output)| {
            let ids: Vec<u32> = output.indices.get(3 * i..3 * i + 3)?.to_vec();
            let vertex = |k: usize| output.vertices.get(ids[MESH_CORNER[k]] as usize);
            let chart = vertex(0)?.chart?;
            // Its pages need not be square; v is turned over, which unmirrors its charts.
            let page = dvec2(f64::from(atlas.width), f64::from(atlas.height)) * size
                / f64::from(atlas.texels_per_unit);
            let mut uv = [DVec2::ZERO; 3];
            for (k, uv) in uv.iter_mut().enumerate() {
                let vertex = vertex(k)?;
                if vertex.chart != Some(chart) {
                    return None;
                }
                *uv = dvec2(f64::from(vertex.uv[0]), 1.0 - f64::from(vertex.uv[1])) * page;
            }
            uv.iter().all(|p| p.is_finite()).then_some((uv, chart))
        });
        let label = match found {
            Some((uv, chart)) => {
                corners.uv[t] = uv;
                first_label + chart
            }
            None => {
                corners.uv[t] = surface.alone(t, 1.0);
                first_label + atlas.as_ref().map_or(0, |a| a.chart_count) + i as u32
            }
        };
        corners.chart[t] = label;
        corners.next = corners.next.max(label + 1);
    }
}
