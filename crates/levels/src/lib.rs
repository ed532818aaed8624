//! What a level of detail needs beside triangles and bakes.
//!
//! ```text
//! collapses: a coarser copy with its own layout ─ missed: the vertices that its pictures miss most
//! merged: the materials of a model on one common set of maps ─ maps: which may lose texels, or become factors
//!                                                             └ fewer_texels: how many each may lose
//! search: with which triangles, texels and maps a file is smallest at a PSNR
//! screen: triangles, texels and mip levels that a size on screen asks for
//! face_frames: tangents that a file lacks, as viewers make them up
//! ```
//!
//! Nothing here bakes, renders or reads files: who calls it does, and hands over what judges a model.

pub mod collapses;
pub mod face_frames;
pub mod fewer_texels;
pub mod maps;
pub mod merged;
pub mod missed;
pub mod screen;
pub mod search;
