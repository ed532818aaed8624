//! Tests of the crate's public functions, on scenes whose answers are known.

#![allow(clippy::unwrap_used)]

mod cast;
mod scenes;
mod shape_maps;
