//! Readers and writers through public functions: one program for all of them, since each
//! would be linked with everything anew.

#[path = "../common/mod.rs"]
mod common;
mod feature_files;
mod material_files;
mod part_files;
mod picture_files;
mod real_files;
mod robustness;
mod written_files;
