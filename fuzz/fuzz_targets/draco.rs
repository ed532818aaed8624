//! Draco streams inside a glTF document: the input is the stream.

#![no_main]

use libfuzzer_sys::fuzz_target;
use parbake_fuzz::compressed::{draco, read};

fuzz_target!(|data: &[u8]| {
    read(&draco(data.len()), data);
});
