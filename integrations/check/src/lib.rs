//! Tests of `integrations/`: each shader is compiled, and its functions are compared with those of the CPU renderer,
//! without a GPU.
//!
//! ```text
//! Bevy   WGSL ─────────────────────────┐
//! Godot  its language ── as GLSL ──────┼── naga's IR ── interpreter ── numbers ── compared with parbake-render
//! Unity, Unreal  HLSL ── glslang ── SPIR-V ┘
//! ```
//!
//! `shaders.rs` compiles, `interpreter.rs` executes, `operators.rs` is its arithmetic, `numbers.rs` compares, and
//! `whole.rs` compiles the shaders that need an engine, with stand-ins for what the engine declares. `extract.rs` runs
//! the tests of the script for importers. There is nothing here but tests, so that naga is built for these alone.

#[cfg(test)]
mod extract;
#[cfg(test)]
mod interpreter;
#[cfg(test)]
mod numbers;
#[cfg(test)]
mod operators;
#[cfg(test)]
mod shaders;
#[cfg(test)]
mod whole;
