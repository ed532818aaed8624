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

use parbake::{Model, demo_pair, simplified};
use std::sync::OnceLock;

/// The built-in pair with a tenth of the high-poly's triangles: coarse enough for tests, and still far finer than the
/// low-poly.
pub fn small_pair() -> (Model, Model) {
    static PAIR: OnceLock<(Model, Model)> = OnceLock::new();
    let make = || {
        let (high, low) = demo_pair();
        (simplified(&high, 6000), low)
    };
    PAIR.get_or_init(make).clone()
}
