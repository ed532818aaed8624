//! Ways to shift texture coordinates with the direction they are seen from, behind one
//! interface (Knodt et al. 2023, Table 1 and Fig. 19).
//!
//! ```text
//! shift_map ─┬ ../parallax   spherical harmonics: what files hold
//!            ├ height        parallax, with offset limiting, steep, occlusion
//!            │  └ march      the last two's way through their layers
//!            └ neural        a small network, for comparison
//! ```

pub mod height;
pub mod heights;
pub mod march;
pub mod neural;
pub mod shift_map;
