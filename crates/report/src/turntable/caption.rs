//! Names below the pictures, in a small typeface of our own: no file, no library, and the same
//! pixels everywhere. It has the letters of ASCII; others are shown as question marks.

use super::sheet::Sheet;

/// Dots of a letter, and of the space to the next one.
const WIDTH: usize = 5;
const HEIGHT: usize = 7;
const SPACE: usize = 1;
/// Dots above and below a line.
const MARGIN: usize = 3;

/// The letters from ' ' to '~': seven rows of five dots, the top left one in the highest of 35 bits.
#[rustfmt::skip]
const LETTERS: [u64; 95] = [
    0x000000000, 0x108421004, 0x294000000, 0x295f57d4a, 0x11f4717c4, 0x672222273, 0x32544564d, 0x108000000,
    0x088842082, 0x208210888, 0x009575480, 0x0084f9080, 0x000003088, 0x0000f8000, 0x00000018c, 0x002222200,
    0x3a33ae62e, 0x11842108e, 0x3a211111f, 0x3a213062e, 0x08ca97c42, 0x7e1e0862e, 0x1910f462e, 0x7c2221108,
    0x3a317462e, 0x3a317844c, 0x018c03180, 0x018c03088, 0x088882082, 0x001f07c00, 0x208208888, 0x3a2111004,
    0x3a216d6ae, 0x11518fe31, 0x7a31f463e, 0x3a308422e, 0x7a318c63e, 0x7e10f421f, 0x7e10f4210, 0x3a30bc62f,
    0x4631fc631, 0x38842108e, 0x1c4210a4c, 0x4654c5251, 0x42108421f, 0x4775ac631, 0x4739ace71, 0x3a318c62e,
    0x7a31f4210, 0x3a318d64d, 0x7a31f5251, 0x3e107043e, 0x7c8421084, 0x46318c62e, 0x46318c544, 0x4631ad771,
    0x462a22a31, 0x462a21084, 0x7c222221f, 0x39084210e, 0x020820820, 0x38421084e, 0x115100000, 0x00000001f,
    0x208000000, 0x000e0be2f, 0x4216cc63e, 0x000e8422e, 0x042d9c62f, 0x000e8fe0e, 0x1928e2108, 0x000f8bc2e,
    0x4216cc631, 0x100c2108e, 0x080610a4c, 0x4212a6292, 0x30842108e, 0x001aad631, 0x0016cc631, 0x000e8c62e,
    0x001e8fa10, 0x000d9bc21, 0x0016cc210, 0x000f8383e, 0x211c42126, 0x00118c66d, 0x00118c544, 0x00118d6aa,
    0x001151151, 0x00118bc2e, 0x001f1111f, 0x088441082, 0x108421084, 0x208411088, 0x0009b0000,
];

/// Pixels along a side of each dot, below a picture of this side.
fn dot(side: usize) -> usize {
    (side / 192).max(1)
}

/// Rows that a caption takes below a picture of this side.
pub(super) fn height(side: usize) -> usize {
    (HEIGHT + 2 * MARGIN) * dot(side)
}

/// Writes `text` in the middle of a strip, `side` wide, whose left upper corner is `place`; what is too
/// long ends in two points.
pub(super) fn write(sheet: &mut Sheet, place: [usize; 2], side: usize, text: &str, color: [u8; 3]) {
    let dot = dot(side);
    let room = side / ((WIDTH + SPACE) * dot);
    let mut letters: Vec<char> = text.chars().collect();
    if letters.len() > room {
        letters.truncate(room.saturating_sub(2));
        letters.extend("..".chars().take(room));
    }
    let width = (letters.len() * (WIDTH + SPACE)).saturating_sub(SPACE) * dot;
    let (left, top) = (place[0] + (side.saturating_sub(width)) / 2, place[1] + MARGIN * dot);
    for (index, letter) in letters.into_iter().enumerate() {
        let left = left + index * (WIDTH + SPACE) * dot;
        for y in 0..HEIGHT * dot {
            for x in (0..WIDTH * dot).filter(|x| is_set(letter, x / dot, y / dot)) {
                sheet.pixels[(top + y) * sheet.width + left + x] = color;
            }
        }
    }
}

fn is_set(letter: char, x: usize, y: usize) -> bool {
    let shown = if (' '..='~').contains(&letter) { letter } else { '?' };
    let rows = LETTERS[shown as usize - ' ' as usize];
    rows >> (WIDTH * HEIGHT - 1 - (y * WIDTH + x)) & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the typeface's table: a letter that can be recognised by hand, and every letter its own.
    #[test]
    fn letters_are_what_they_are_called() {
        let drawn = |letter: char| -> Vec<String> {
            let row = |y| (0..WIDTH).map(|x| if is_set(letter, x, y) { '#' } else { '.' }).collect();
            (0..HEIGHT).map(row).collect()
        };
        assert_eq!(drawn('L'), ["#....", "#....", "#....", "#....", "#....", "#....", "#####"]);
        assert_eq!(drawn('é'), drawn('?'));
        let mut all: Vec<u64> = LETTERS.to_vec();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), LETTERS.len());
    }

    /// Protects neighbours: a name of any length stays below its own picture.
    #[test]
    fn long_names_stay_within_their_strip() {
        for (side, text) in [(32, "a name that is far too long"), (400, &"W".repeat(500)), (33, "")] {
            let strip = height(side);
            let mut sheet = Sheet { width: 3 * side, height: strip, pixels: vec![[0; 3]; 3 * side * strip] };
            write(&mut sheet, [side, 0], side, text, [255; 3]);
            let columns = |from: usize| {
                sheet.pixels.chunks_exact(3 * side).any(|row| row[from..from + side].iter().any(|p| p[0] > 0))
            };
            assert_eq!([0, side, 2 * side].map(columns), [false, !text.is_empty(), false]);
        }
    }
}
