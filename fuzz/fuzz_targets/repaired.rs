//! Repair of any layout, and the check of what came of it. The input is what a small
//! mesh is built from.

#![no_main]

use libfuzzer_sys::arbitrary::Unstructured;
use libfuzzer_sys::fuzz_target;
use parbake_fuzz::repaired;

fuzz_target!(|data: &[u8]| {
    // Bytes that end early are no fault.
    let _ = repaired::any_mesh_is_repaired(&mut Unstructured::new(data));
});
