//! Whole bakes through the API: one program for all of them, since each
//! would be linked with everything anew.

mod emission;
mod material;
mod paper_picture;
mod paper_uv;
mod parallax;
mod prepared;
mod ray_cast;
mod vertices;
mod warnings;
