//! The colours of the animation: for each of a few hues a ramp from the ground to a dark
//! tone, on which a chart's fill, its lines and their soft rims all lie.

/// Outside of the texture's square.
pub const MARGIN: u8 = 0;
/// Inside, where nothing is.
pub const GROUND: u8 = 1;
/// What did not change.
pub const TRANSPARENT: u8 = 2;
/// The part of the bar that is done.
pub const DONE: u8 = 3;
const FIRST_RAMP: u8 = 4;

/// Steps from the ground (0) to the darkest tone.
pub const LEVELS: u8 = 11;
/// Hues of charts.
pub const HUES: u8 = 10;
/// The hue after them, of flipped triangles.
pub const FAULT: u8 = HUES;

const GROUND_COLOR: [u8; 3] = [253, 253, 252];

/// Muted tones that stay apart next to each other, none of them red; the last one is.
const TONES: [[u8; 3]; HUES as usize + 1] = [
    [43, 92, 146],
    [176, 106, 24],
    [28, 121, 104],
    [117, 76, 148],
    [110, 118, 28],
    [20, 117, 143],
    [133, 88, 58],
    [62, 84, 168],
    [58, 122, 56],
    [158, 66, 128],
    [214, 24, 24],
];

/// A colour's index: a hue and a level from 1 to [`LEVELS`].
pub fn index(hue: u8, level: u8) -> u8 {
    FIRST_RAMP + hue * LEVELS + level.clamp(1, LEVELS) - 1
}

/// All colours, three bytes each; at most 128, so that codes of seven bits do.
pub fn bytes() -> Vec<u8> {
    let mut bytes = Vec::new();
    for color in [[238, 240, 242], GROUND_COLOR, [255, 0, 255], [120, 128, 140]] {
        bytes.extend(color);
    }
    for tone in TONES {
        for level in 1..=u32::from(LEVELS) {
            bytes.extend((0..3).map(|k| {
                let (from, to) = (u32::from(GROUND_COLOR[k]), u32::from(tone[k]));
                let most = u32::from(LEVELS);
                ((from * (most - level) + to * level + most / 2) / most) as u8
            }));
        }
    }
    bytes
}
