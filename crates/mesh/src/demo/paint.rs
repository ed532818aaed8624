//! The jar's colours: fired clay, glazes, gilding and a painted frieze, each
//! following the relief of `shape.rs`. Noise is over space, so that no seam shows.

use super::layout::Layout;
use super::shape::*;
use parbake_model::Image;
use parbake_model::glam::{IVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// sRGB colours.
const CLAY: Vec3 = Vec3::new(0.70, 0.38, 0.24);
const GOLD: Vec3 = Vec3::new(0.87, 0.68, 0.30);
const TEAL: Vec3 = Vec3::new(0.07, 0.48, 0.50);
const COBALT: Vec3 = Vec3::new(0.10, 0.18, 0.47);
const CREAM: Vec3 = Vec3::new(0.93, 0.88, 0.76);
const CORAL: Vec3 = Vec3::new(0.82, 0.29, 0.22);
const SOOT: Vec3 = Vec3::new(0.16, 0.11, 0.09);

/// The texture of this layout, `size`² texels, painted into the gutters too.
pub(super) fn texture(layout: &Layout, size: usize) -> Image {
    let background = CLAY.lerp(SOOT, 0.5);
    let mut pixels = vec![bytes(background); size * size];
    let margin = 2.0 / size as f32;
    pixels.par_chunks_mut(size).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size as f32;
            for chart in &layout.charts {
                let (low, high) = layout.bounds(chart, margin);
                if place.cmpge(low).all() && place.cmple(high).all() {
                    let (u, v) = layout.find(chart, place);
                    *pixel = bytes(color(chart.part, u, v));
                }
            }
        }
    });
    Image { name: "jar".into(), width: size, height: size, pixels }
}

pub(super) fn bytes(color: Vec3) -> [u8; 4] {
    let [r, g, b] = (color.clamp(Vec3::ZERO, Vec3::ONE) * 255.0).round().to_array().map(|x| x as u8);
    [r, g, b, 255]
}

fn color(part: Part, u: f32, v: f32) -> Vec3 {
    let point = surface(part, u, v, false);
    // Uneven firing.
    let mottle = 0.86 + 0.28 * turbulence(point * 9.0);
    let grain = 0.95 + 0.10 * noise(point * 150.0);
    let base = match part {
        Part::Body => body(u, v, point),
        Part::Handle { .. } => {
            let twist = handle_twist(u, v);
            let strand = (3.0 * u + 11.0 * v).floor().rem_euclid(3.0);
            let glaze = if strand == 0.0 { GOLD } else { COBALT.lerp(TEAL, 0.35 * twist) };
            glaze.lerp(SOOT, 0.55 * smoothstep(0.6, 0.0, twist))
        }
    };
    base * mottle * grain
}

fn body(u: f32, v: f32, point: Vec3) -> Vec3 {
    let mut color = match v {
        v if v < 4.0 => foot(u, v, point),
        v if v < LOBES.1 => lobes(u, v, point),
        v if v < FRIEZE.1 + 0.06 => frieze(u, v, point),
        v if v < RINGS[3] => shoulder(u, v, point),
        v if v < RINGS[4] => neck(u, v),
        v if v < 15.5 => {
            let scallop = (PI * PANELS * u).cos().abs();
            GOLD.lerp(CORAL, smoothstep(0.45, 0.55, scallop) * window(v, 13.1, 14.8, 0.15))
        }
        v => CLAY.lerp(SOOT, smoothstep(15.5, 17.5, v)),
    };
    for ring in RINGS {
        let hammered = 0.85 + 0.3 * noise(point * 60.0);
        let edge = ((v - ring) / 0.085).abs();
        color = color.lerp(SOOT, 0.6 * smoothstep(1.7, 1.0, edge));
        color = color.lerp(GOLD * hammered, smoothstep(1.1, 0.95, edge));
    }
    color
}

fn foot(u: f32, v: f32, point: Vec3) -> Vec3 {
    let roped = window(v, 1.35, 2.75, 0.25);
    let clay = CLAY * (0.8 + 0.4 * turbulence(point * Vec3::new(6.0, 40.0, 6.0)));
    let strand = GOLD.lerp(SOOT, 0.7 * smoothstep(0.5, 0.0, rope(u, v)));
    let painted = clay.lerp(strand, smoothstep(0.3, 0.7, roped));
    // A collar of painted triangles above the rope.
    let tooth = ((u * 32.0).fract() - 0.5).abs() * 2.0;
    let collar = window(v, 2.95, 3.75, 0.02) * smoothstep(0.06, -0.06, tooth - (3.75 - v) / 0.8);
    painted.lerp(CREAM, collar)
}

fn lobes(u: f32, v: f32, point: Vec3) -> Vec3 {
    if v < LOBES.0 {
        // Combed slip on the stem.
        let comb = smoothstep(-0.2, 0.2, (v * 38.0 + 1.5 * (TAU * PANELS * u).sin()).sin());
        return CLAY.lerp(CREAM, 0.7 * comb);
    }
    let height = lobe(u, v);
    let odd = lobe_position(u, v).floor().rem_euclid(2.0) == 1.0;
    let glaze = if odd { TEAL } else { COBALT };
    // Glaze runs thin on the heights and pools in the grooves.
    let thin = glaze.lerp(CREAM, 0.28 * smoothstep(0.8, 1.0, height));
    let pooled = thin.lerp(SOOT, 0.75 * smoothstep(0.55, 0.0, height));
    let speckle = smoothstep(0.79, 0.85, noise(point * 50.0));
    let spots = if odd { CREAM } else { GOLD };
    let across = lobe_position(u, v).fract() - 0.5;
    let dot_row = ((v - LOBES.0) * 9.0).fract() - 0.5;
    let dot = smoothstep(0.30, 0.22, (across * 3.2).hypot(dot_row)) * window(v, 5.35, 6.45, 0.05);
    pooled.lerp(spots, 0.5 * speckle * height).lerp(spots, dot)
}

fn frieze(u: f32, v: f32, point: Vec3) -> Vec3 {
    let mut color = CREAM.lerp(Vec3::new(0.55, 0.42, 0.28), 0.7 * crackle(point * 17.0));
    let (low, high) = FRIEZE;
    for (line, width) in [(low + 0.085, 0.02), (high - 0.085, 0.02)] {
        color = color.lerp(CORAL, smoothstep(width * 1.3, width, (v - line).abs()));
    }
    // A meander of small squares along both edges.
    let step = (u * PANELS * 6.0).fract();
    for edge in [low + 0.035, high - 0.035] {
        let inside = window(step, 0.25, 0.75, 0.1) * smoothstep(0.022, 0.016, (v - edge).abs());
        color = color.lerp(COBALT, inside);
    }
    let letter = glyph(u, v);
    let star = ((PANELS * u + 3.5 + PANELS) as usize) % 8 == 7;
    let ink = if star { CORAL } else { COBALT };
    let outline = smoothstep(0.0, 0.25, letter) * (1.0 - smoothstep(0.4, 0.6, letter));
    color.lerp(ink, smoothstep(0.4, 0.6, letter)).lerp(GOLD, 0.8 * outline)
}

fn shoulder(u: f32, v: f32, point: Vec3) -> Vec3 {
    let (height, distance, row) = boss(u, v);
    let stars = smoothstep(0.76, 0.82, noise(point * 70.0));
    let night = COBALT.lerp(TEAL, 0.5 * turbulence(point * 5.0)).lerp(CREAM, 0.5 * stars);
    let ring = smoothstep(1.42, 1.34, distance) * smoothstep(1.14, 1.22, distance);
    let stone = [CORAL, CREAM, GOLD, CORAL][row % 4];
    let ground = night.lerp(SOOT, 0.6 * smoothstep(1.25, 1.0, distance)).lerp(GOLD, ring);
    ground.lerp(stone.lerp(SOOT, 0.35 * (1.0 - height)), smoothstep(1.02, 0.96, distance))
}

fn neck(u: f32, v: f32) -> Vec3 {
    // Zigzags, one to a flute.
    let zigzag = ((PANELS * u + 0.5).fract() - 0.5).abs() * 0.9;
    let stripe = ((v + zigzag) * 2.6).rem_euclid(1.0);
    let band = window(stripe, 0.0, 0.5, 0.06);
    let thread = window(stripe, 0.62, 0.78, 0.05);
    CREAM.lerp(TEAL, band).lerp(CORAL, thread)
}

/// A value of its own for each lattice point, 0 … 1.
pub(super) fn hash(p: IVec3) -> f32 {
    let mut h = (p.x as u32).wrapping_mul(0x9E37_79B1)
        ^ (p.y as u32).wrapping_mul(0x85EB_CA77)
        ^ (p.z as u32).wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    (h ^ (h >> 15)) as f32 / u32::MAX as f32
}

/// Value noise, 0 … 1.
pub(super) fn noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let f = f * f * (3.0 - 2.0 * f);
    let cell = cell.as_ivec3();
    let at = |x: i32, y: i32, z: i32| hash(cell + IVec3::new(x, y, z));
    let row = |y: i32, z: i32| at(0, y, z) + (at(1, y, z) - at(0, y, z)) * f.x;
    let plane = |z: i32| row(0, z) + (row(1, z) - row(0, z)) * f.y;
    plane(0) + (plane(1) - plane(0)) * f.z
}

/// Four octaves of noise, 0 … 1.
pub(super) fn turbulence(p: Vec3) -> f32 {
    let octave = |k: i32| noise(p * 2f32.powi(k) + 17.0 * k as f32) * 0.5f32.powi(k + 1);
    (0..4).map(octave).sum::<f32>() / 0.9375
}

/// Crazed glaze: 1 on the borders between the cells of scattered points (Worley
/// 1996), 0 inside them.
fn crackle(p: Vec3) -> f32 {
    let cell = p.floor().as_ivec3();
    let (mut first, mut second) = (f32::INFINITY, f32::INFINITY);
    for i in 0..27 {
        let c = cell + IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        let jitter = Vec3::new(hash(c), hash(c + 71), hash(c + 173));
        let distance = p.distance(c.as_vec3() + jitter);
        second = second.min(distance.max(first));
        first = first.min(distance);
    }
    smoothstep(0.05, 0.01, second - first)
}
