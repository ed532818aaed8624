//! OBJ, MTL and pictures. The input is an OBJ file up to its first zero byte; what
//! follows stands beside it, as library and as picture.

#![no_main]

use libfuzzer_sys::fuzz_target;
use parbake_files::read_obj_bytes;
use parbake_fuzz::{Everywhere, LIMITS, check};
use std::path::Path;

fuzz_target!(|data: &[u8]| {
    let end = data.iter().position(|&b| b == 0).unwrap_or(data.len());
    let beside = Everywhere(data.get(end + 1..).unwrap_or_default());
    check(read_obj_bytes(Path::new("fuzz"), &data[..end], &beside, &LIMITS));
});
