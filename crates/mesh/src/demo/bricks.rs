//! The brick wall's pattern: how deep and of what colour it is at each point of its cube.
//!
//! The four sides are one wall of eight courses in running bond that goes round the corners;
//! top and bottom are paved in the same bond with a smooth rim.
//!
//! Coordinates on a face: `a` to the right and `b` upwards as seen from outside, −1 … 1.
//! Contract: where two faces meet they are equally deep, to the bit, so that the relief is
//! closed; depths are 0 to about an eighth of half a side.

use super::paint::{hash, noise, turbulence};
use super::shape::smoothstep;
use parbake_model::glam::{IVec3, Vec2, Vec3};

/// Height of a course, and half the length of a brick.
pub(super) const COURSE: f32 = 0.25;

/// Half the width of a joint's ground, and of the whole joint.
const JOINT: (f32, f32) = (0.018, 0.034);
const JOINT_DEPTH: f32 = 0.11;
/// Bricks lie up to so deep below the face, a few of them set back further.
const UNEVEN: f32 = 0.025;
const SET_BACK: f32 = 0.05;
/// Roughness of all surfaces.
const ROUGH: f32 = 0.012;

/// sRGB colours.
const CLAY: [Vec3; 4] = [
    Vec3::new(0.62, 0.27, 0.19),
    Vec3::new(0.74, 0.40, 0.25),
    Vec3::new(0.47, 0.20, 0.17),
    Vec3::new(0.80, 0.55, 0.36),
];
const MORTAR: Vec3 = Vec3::new(0.74, 0.71, 0.65);
const SOOT: Vec3 = Vec3::new(0.17, 0.15, 0.14);

/// One of the cube's faces: 0 to 3 are the sides, each to the right of the one before as seen
/// from outside, 4 is the top and 5 the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Face(pub usize);

impl Face {
    /// Unit vectors outwards, to the right and upwards as seen from outside.
    pub(super) fn axes(self) -> [Vec3; 3] {
        match self.0 {
            0 => [Vec3::Z, Vec3::X, Vec3::Y],
            1 => [Vec3::X, Vec3::NEG_Z, Vec3::Y],
            2 => [Vec3::NEG_Z, Vec3::NEG_X, Vec3::Y],
            3 => [Vec3::NEG_X, Vec3::Z, Vec3::Y],
            4 => [Vec3::Y, Vec3::X, Vec3::NEG_Z],
            _ => [Vec3::NEG_Y, Vec3::X, Vec3::Z],
        }
    }

    /// A point of the plain cube with corners at ±1.
    pub(super) fn point(self, at: Vec2) -> Vec3 {
        let [out, right, up] = self.axes();
        out + right * at.x + up * at.y
    }
}

/// A point of the pattern.
struct Spot {
    brick: IVec3,
    /// Place on the brick, about −1 … 1.
    on_brick: Vec2,
    /// 0 on a brick … 1 on the ground of a joint.
    joint: f32,
    /// 0 where the face ends or its rim is smooth … 1 within.
    within: f32,
}

/// 1 within a face, 0 at |x| = 1.
fn fading(x: f32) -> f32 {
    smoothstep(1.0, 0.93, x.abs())
}

fn spot(face: Face, at: Vec2) -> Spot {
    let row = ((at.y + 1.0) / COURSE).floor().clamp(0.0, 7.0);
    let shift = if row as i32 % 2 == 0 { 0.0 } else { COURSE };
    // Sides are counted round the cube, so that bricks of odd courses go round its edges.
    let start = if face.0 < 4 { 2.0 * face.0 as f32 } else { 0.0 };
    let along = (at.x + 1.0 + start - shift) / (2.0 * COURSE);
    let column = along.floor().rem_euclid(16.0);
    let level = if face.0 < 4 { 0 } else { face.0 as i32 };

    // The nearest joint that is not an edge of the cube.
    let inner = |x: f32, period: f32, from: f32| {
        let nearest = ((x - from) / period).round() * period + from;
        if nearest.abs() > 0.99 { 1.0 } else { (x - nearest).abs() }
    };
    let groove = |distance: f32| smoothstep(JOINT.1, JOINT.0, distance);
    let upright = groove(inner(at.x, 2.0 * COURSE, shift - 1.0));
    let level_joint = groove(inner(at.y, COURSE, -1.0));
    // Sides only end above and below; round their edges courses go on.
    let rim = if face.0 < 4 { fading(at.y) } else { fading(at.x) * fading(at.y) };
    Spot {
        brick: IVec3::new(column as i32, row as i32, level),
        on_brick: Vec2::new(along - along.floor(), (at.y + 1.0) / COURSE - row) * 2.0 - 1.0,
        joint: upright.max(level_joint) * rim,
        within: fading(at.x) * fading(at.y),
    }
}

/// How far below the cube's face the wall is.
pub(super) fn depth(face: Face, at: Vec2) -> f32 {
    let Spot { brick, on_brick, joint, within } = spot(face, at);
    let number = |k: i32| hash(brick + IVec3::new(0, 0, 100 * k));
    let tilt = Vec2::new(number(1) - 0.5, number(2) - 0.5).dot(on_brick) * 0.5;
    let set_back = if number(3) > 0.86 { SET_BACK } else { 0.0 };
    let laid = (UNEVEN * (number(0) + tilt).clamp(0.0, 1.0) + set_back) * within;
    let rough = ROUGH * turbulence(face.point(at) * 9.0);
    laid + (JOINT_DEPTH - laid) * joint + rough
}

/// sRGB colour.
pub(super) fn color(face: Face, at: Vec2) -> Vec3 {
    let Spot { brick, on_brick, joint, .. } = spot(face, at);
    let point = face.point(at);
    let number = |k: i32| hash(brick + IVec3::new(50, 0, 100 * k));
    let pick = |k: i32| CLAY[((number(k) * 4.0) as usize).min(3)];
    let fired = pick(0).lerp(pick(1), 0.5 * number(2)) * (0.8 + 0.35 * number(3));
    let speckle = smoothstep(0.72, 0.8, noise(point * 46.0));
    let worn = smoothstep(0.75, 1.0, on_brick.abs().max_element());
    let clay = (fired * (0.72 + 0.5 * turbulence(point * 14.0)))
        .lerp(SOOT, 0.45 * speckle)
        .lerp(fired * 1.25, 0.35 * worn);
    let sand = MORTAR * (0.75 + 0.4 * turbulence(point * 33.0));
    clay.lerp(sand, smoothstep(0.35, 0.7, joint))
}
