//! A repaired layout is sound, as the check sees it, or repair says why there is none.

use crate::built;
use libfuzzer_sys::arbitrary::{Result, Unstructured};
use parbake_atlas::{AtlasError, Layout, PackOptions, RepairOptions, check, repair};
use parbake_model::Mesh;

/// Repairs a mesh built from bytes and checks what came of it: sound, with the gutter
/// asked for, every triangle where it was in space.
///
/// # Errors
/// Where bytes cannot be read as what is wanted; that is no fault.
pub fn any_mesh_is_repaired(bytes: &mut Unstructured) -> Result<()> {
    let size = bytes.int_in_range(16..=256)?;
    let gutter = f64::from(bytes.int_in_range(0..=8u8)?) / 4.0;
    let pack = PackOptions { texture_size: size, gutter_texels: gutter, effort: 0, ..PackOptions::default() };
    let mesh = built::mesh(bytes)?;
    let (repaired, sentences) = match repair(&mesh, &RepairOptions { pack, ..RepairOptions::default() }) {
        Ok(repaired) => repaired,
        Err(AtlasError::NoRoom { .. } | AtlasError::TooThin { .. }) => return Ok(()),
        Err(error) => panic!("{error}"),
    };
    let report = check(&Layout::new(&repaired), size);
    assert!(report.is_bijective(), "{sentences:?} {:?}", report.problems());
    assert_eq!(sentences.is_empty(), repaired == mesh, "{sentences:?}");
    assert_eq!(repaired.triangles.len(), mesh.triangles.len());
    for t in 0..mesh.triangles.len() {
        assert_eq!(repaired.corners(t), mesh.corners(t));
    }
    // Triangles without an area in space have no distance to keep.
    let layout = Layout::new(&repaired);
    let seen = (0..mesh.triangles.len()).filter(|&t| layout.rest_area(t) > 0.0);
    let seen = Mesh { triangles: seen.map(|t| repaired.triangles[t]).collect(), ..repaired.clone() };
    let apart = check(&Layout::new(&seen), size).gutter;
    assert!(apart.as_ref().is_none_or(|g| g.texels >= gutter), "{sentences:?} {apart:?} {gutter}");
    Ok(())
}
