//! The jar's form: a profile turned about +Y and two handles, and the relief that
//! the detailed model has on it. `paint.rs` follows the same patterns.
//!
//! Coordinates on a part: `u` goes once round it in 0 … 1 (to the right as seen
//! from outside), `v` along it: for the body the profile's knots from the bottom's
//! centre over the lip to the inside's, for a handle 0 … 1 from shoulder to neck.

use parbake_model::glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Which surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// The jar itself.
    Body,
    /// The handle at +X or −X.
    Handle { side: f32 },
}

/// (radius, height) along the profile; joined by a Catmull–Rom spline.
const PROFILE: [(f32, f32); 20] = [
    (0.0, -0.97),
    (0.30, -0.99),
    (0.34, -0.93),
    (0.27, -0.84),
    (0.215, -0.75),
    (0.36, -0.60),
    (0.545, -0.32),
    (0.625, 0.0),
    (0.585, 0.24),
    (0.44, 0.43),
    (0.275, 0.54),
    (0.21, 0.66),
    (0.215, 0.78),
    (0.29, 0.92),
    (0.36, 0.975),
    (0.345, 0.995),
    (0.29, 0.95),
    (0.145, 0.78),
    (0.135, 0.60),
    (0.0, 0.55),
];

/// Panels of the frieze round the jar.
pub(super) const PANELS: f32 = 16.0;
/// Knots between which the frieze of letters runs.
pub(super) const FRIEZE: (f32, f32) = (6.78, 8.0);
/// Knots between which the spiral lobes run.
pub(super) const LOBES: (f32, f32) = (5.0, 6.68);
/// Knots between which the bosses sit.
pub(super) const BOSSES: (f32, f32) = (8.12, 9.85);
/// Knots of the raised rings.
pub(super) const RINGS: [f32; 5] = [4.0, 6.73, 8.06, 10.0, 12.7];

/// (radius, height) of the plain profile.
pub(super) fn profile(v: f32) -> Vec2 {
    let last = PROFILE.len() - 1;
    let knot = (v.max(0.0) as usize).min(last - 1);
    let at = |i: usize| Vec2::from(PROFILE[i]);
    let (a, b, c, d) = (at(knot.saturating_sub(1)), at(knot), at(knot + 1), at((knot + 2).min(last)));
    let t = v - knot as f32;
    let cubic = b * 2.0
        + (c - a) * t
        + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t)
        + (b * 3.0 - a - c * 3.0 + d) * (t * t * t);
    // Rounding must not open the profile's ends.
    let p = cubic * 0.5;
    Vec2::new(if p.x < 1e-5 { 0.0 } else { p.x }, p.y)
}

/// A point of the jar, with or without its relief.
pub(super) fn surface(part: Part, u: f32, v: f32, detailed: bool) -> Vec3 {
    match part {
        Part::Body => {
            let along = profile(v + 0.01) - profile(v - 0.01);
            let outwards = Vec2::new(along.y, -along.x).normalize_or_zero();
            // The plain form runs half-way between the relief's heights and depths.
            let height = if detailed { relief(u, v) } else { 0.008 * window(v, 1.2, 15.0, 0.2) };
            let p = profile(v) + outwards * height;
            let (sin, cos) = (u * TAU).sin_cos();
            Vec3::new(p.x * sin, p.y, p.x * cos)
        }
        Part::Handle { side } => {
            let (centre, along) = handle_curve(v);
            let across = Vec2::new(along.y, -along.x).normalize_or_zero();
            let (sin, cos) = (u * TAU).sin_cos();
            let thickness = 0.05 + 0.018 * (2.0 * v - 1.0).powi(2);
            let ridges = if detailed { 0.012 * handle_twist(u, v) } else { 0.007 };
            let radius = thickness + ridges;
            let p = centre + across * (cos * radius);
            // Turned by the side about +Y, so that both are wound alike.
            Vec3::new(p.x * side, p.y, -sin * radius * 1.25 * side)
        }
    }
}

/// A handle's middle line in its plane, and its derivative.
fn handle_curve(v: f32) -> (Vec2, Vec2) {
    let [a, b, c, d] = [(0.47, 0.30), (0.98, 0.34), (0.80, 1.10), (0.195, 0.79)].map(Vec2::from);
    let w = 1.0 - v;
    let point = a * (w * w * w) + b * (3.0 * w * w * v) + c * (3.0 * w * v * v) + d * (v * v * v);
    let along = (b - a) * (w * w) + (c - b) * (2.0 * w * v) + (d - c) * (v * v);
    (point, along)
}

/// The handle's rope, 0 in its grooves … 1.
pub(super) fn handle_twist(u: f32, v: f32) -> f32 {
    (PI * (3.0 * u + 11.0 * v)).sin().abs().powf(0.7)
}

/// Height of the body's relief over its plain form.
pub(super) fn relief(u: f32, v: f32) -> f32 {
    let mut height = 0.0;
    for ring in RINGS {
        height += 0.02 * bump((v - ring) / 0.085);
    }
    height += 0.016 * rope(u, v) * window(v, 1.35, 2.75, 0.25);
    height += 0.045 * lobe(u, v) * window(v, LOBES.0, LOBES.1, 0.5);
    height += 0.016 * glyph(u, v);
    height += 0.028 * boss(u, v).0;
    height += 0.009 * (1.0 + (TAU * PANELS * u).cos()) * window(v, 10.1, 12.55, 0.4);
    height += 0.014 * (PI * PANELS * u).cos().abs() * window(v, 13.0, 15.3, 0.6);
    height
}

/// The foot's rope, 0 … 1.
pub(super) fn rope(u: f32, v: f32) -> f32 {
    (PI * (26.0 * u + 1.2 * v)).sin().abs()
}

/// The belly's spiral lobes, 0 in their grooves … 1.
pub(super) fn lobe(u: f32, v: f32) -> f32 {
    (PI * lobe_position(u, v)).sin().abs().powf(0.75)
}

/// Lobes counted round the jar: the integer part is which, the fraction where.
pub(super) fn lobe_position(u: f32, v: f32) -> f32 {
    PANELS * (u + 0.07 * (v - LOBES.0)) + PANELS
}

/// The shoulder's bosses: height 0 … 1, distance from the nearest one's centre
/// (1 at its rim), and which row it is in.
pub(super) fn boss(u: f32, v: f32) -> (f32, f32, usize) {
    const ROWS: f32 = 4.0;
    let along = (v - BOSSES.0) / (BOSSES.1 - BOSSES.0) * ROWS;
    let row = along.floor().clamp(0.0, ROWS - 1.0);
    let around = PANELS * u + 0.5 * row;
    let offset = Vec2::new(around - around.round(), along - row - 0.5) / Vec2::new(0.36, 0.42);
    let distance = offset.length();
    ((1.0 - distance * distance).max(0.0).sqrt(), distance, row as usize)
}

/// How much of a letter of the frieze is here, 0 … 1: 5 × 7 cells, smoothed.
pub(super) fn glyph(u: f32, v: f32) -> f32 {
    // The middle letter faces +Z.
    let around = PANELS * u + 3.5 + PANELS;
    let letter = GLYPHS[around as usize % GLYPHS.len()];
    let height = (FRIEZE.1 - FRIEZE.0) * 0.72;
    let x = (around.fract() - 0.5) / 0.72 * 5.0 + 2.5;
    let y = 3.5 - (v - 0.5 * (FRIEZE.0 + FRIEZE.1)) / height * 7.0;
    let cell = |i: i32, j: i32| {
        let inside = (0..5).contains(&i) && (0..7).contains(&j);
        if inside && letter[j as usize] >> (4 - i) & 1 == 1 { 1.0 } else { 0.0 }
    };
    let (fx, fy) = ((x - 0.5).floor(), (y - 0.5).floor());
    let (i, j, s, t) = (fx as i32, fy as i32, x - 0.5 - fx, y - 0.5 - fy);
    let top = cell(i, j) * (1.0 - s) + cell(i + 1, j) * s;
    let bottom = cell(i, j + 1) * (1.0 - s) + cell(i + 1, j + 1) * s;
    smoothstep(0.2, 0.5, top * (1.0 - t) + bottom * t)
}

/// P A R B A K E and a star, a row of five cells a number.
const GLYPHS: [[u8; 7]; 8] = [
    [0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000, 0b10000],
    [0b01110, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001],
    [0b11110, 0b10001, 0b10001, 0b11110, 0b10100, 0b10010, 0b10001],
    [0b11110, 0b10001, 0b10001, 0b11110, 0b10001, 0b10001, 0b11110],
    [0b01110, 0b10001, 0b10001, 0b11111, 0b10001, 0b10001, 0b10001],
    [0b10001, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010, 0b10001],
    [0b11111, 0b10000, 0b10000, 0b11110, 0b10000, 0b10000, 0b11111],
    [0b00000, 0b00100, 0b10101, 0b01110, 0b10101, 0b00100, 0b00000],
];

/// 0 below `from`, 1 above `to`, smooth between.
pub(super) fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// 1 between `from` and `to`, fading to 0 over `fade` inside either end.
pub(super) fn window(x: f32, from: f32, to: f32, fade: f32) -> f32 {
    smoothstep(from, from + fade, x) * smoothstep(to, to - fade, x)
}

/// A round hump over −1 … 1.
pub(super) fn bump(x: f32) -> f32 {
    (1.0 - x * x).max(0.0).sqrt()
}
