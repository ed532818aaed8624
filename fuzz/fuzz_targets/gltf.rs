//! glTF, as JSON and as GLB. External buffers and pictures are the input itself.

#![no_main]

use libfuzzer_sys::fuzz_target;
use parbake_files::read_gltf_bytes;
use parbake_fuzz::{Everywhere, LIMITS, check};
use std::path::Path;

fuzz_target!(|data: &[u8]| {
    check(read_gltf_bytes(Path::new("fuzz"), data, &Everywhere(data), &LIMITS));
});
