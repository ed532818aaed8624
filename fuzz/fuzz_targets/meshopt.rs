//! Meshopt streams inside a glTF document: the first four bytes choose the mode, the filter, the
//! stride and the count; the rest is the stream.

#![no_main]

use libfuzzer_sys::fuzz_target;
use parbake_fuzz::compressed::{meshopt, read};

fuzz_target!(|data: &[u8]| {
    if let Some((choice, stream)) = data.split_first_chunk() {
        read(&meshopt(*choice, stream.len()), stream);
    }
});
