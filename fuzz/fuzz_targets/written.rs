//! What writers write and readers read back. The input is what a small model is built
//! from.

#![no_main]

use libfuzzer_sys::arbitrary::Unstructured;
use libfuzzer_sys::fuzz_target;
use parbake_fuzz::{built, written};
use std::sync::LazyLock;

static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| tempfile::tempdir().unwrap());

fuzz_target!(|data: &[u8]| {
    if let Ok(model) = built::model(&mut Unstructured::new(data)) {
        written::glb_comes_back(&model);
        written::obj_comes_back(&model, FOLDER.path());
    }
});
