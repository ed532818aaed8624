//! Runs the tests of `hlsl/extract.py`, which prepares files for importers that do not know the extension.

use std::path::Path;
use std::process::Command;

/// Protects models of Unity and Unreal: vertices that stand elsewhere than the maps have them, or textures that are not
/// the maps'.
#[test]
fn files_for_other_importers_are_what_the_maps_need() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../hlsl/test_extract.py");
    // -B: it leaves nothing in the repository.
    let ran = match Command::new("python3").arg("-B").arg(&script).output() {
        Ok(ran) => ran,
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "python3 cannot be started: {error}");
            eprintln!("skipped: extract.py needs python3, and {error}");
            return;
        }
    };
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success() && !said.contains("Ran 0 tests"), "{said}");
}
