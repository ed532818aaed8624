//! Vertices, through public functions: one program for all of them, since each
//! would be linked with everything anew.

mod points;
mod stage;
mod triangle_quality;
