//! The animation read again by the GIF decoder, on layouts of which one knows what to see.

use super::*;
use parbake_model::glam::{Vec2, vec2};

/// A grid of `cells`² squares, of which the upper and the lower half are charts, and
/// `count` layouts in which it turns and shrinks.
fn turning(cells: u32, count: usize) -> UvMoves {
    let row = cells + 1;
    let index = |x: u32, y: u32| y * row + x;
    let mut moves = UvMoves::default();
    for y in 0..cells {
        for x in 0..cells {
            let [a, b, c, d] = [index(x, y), index(x + 1, y), index(x + 1, y + 1), index(x, y + 1)];
            moves.triangles.extend([[a, b, c], [a, c, d]]);
            moves.charts.extend([u32::from(2 * y >= cells); 2]);
        }
    }
    for frame in 0..count {
        let turn = Vec2::from_angle(frame as f32 * 0.02) * (0.9 - 0.005 * frame as f32);
        let points = (0..row * row).map(|i| {
            let p = vec2((i % row) as f32, (i / row) as f32) / cells as f32 - 0.5;
            turn.rotate(p) + 0.5
        });
        moves.frames.push(points.collect());
    }
    moves
}

fn small() -> UvAnimationOptions {
    UvAnimationOptions { side: 100, ..UvAnimationOptions::default() }
}

/// All pictures as a viewer shows them, as palette indices, and their delays.
fn played(gif: &[u8]) -> Vec<(Vec<u8>, u16)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let mut decoder = options.read_info(gif).unwrap();
    let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
    let mut canvas = vec![palette::TRANSPARENT; width * height];
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (i, &pixel) in frame.buffer.iter().enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            if frame.transparent != Some(pixel) {
                canvas[(usize::from(frame.top) + y) * width + usize::from(frame.left) + x] = pixel;
            }
        }
        pictures.push((canvas.clone(), frame.delay));
    }
    assert_eq!(decoder.repeat(), Repeat::Infinite);
    pictures
}

/// Protects what a viewer sees: the pictures that were drawn, the first and the last
/// layout among them, the last one longest.
#[test]
fn it_plays_what_was_drawn() {
    let moves = turning(4, 100);
    let pictures = played(&uv_animation(&moves, &small()).unwrap());
    assert_eq!(pictures.len(), 60);
    let drawing = Drawing::new(&moves, 100);
    for (picture, index) in pictures.iter().zip(chosen(100, 60)) {
        assert!(picture.0 == drawing.frame(&moves.frames[index], index as f64 / 99.0).pixels, "{index}");
    }
    assert!(pictures[..59].iter().all(|p| p.1 < LAST) && pictures[59].1 == LAST);
    assert_eq!(played(&uv_animation(&turning(4, 7), &small()).unwrap()).len(), 7);
}

/// Protects the choice of frames.
#[test]
fn frames_are_chosen_evenly() {
    assert_eq!(chosen(5, 5), [0, 1, 2, 3, 4]);
    assert_eq!(chosen(101, 3), [0, 50, 100]);
    assert_eq!(chosen(9, 1), [8]);
    assert!(chosen(0, 0).is_empty());
    let steps = chosen(1000, 60);
    assert_eq!((steps[0], steps[59]), (0, 999));
    assert!(steps.windows(2).all(|w| (16..=17).contains(&(w[1] - w[0]))));
}

/// Protects the same bytes for any number of threads.
#[test]
fn threads_change_nothing() {
    let moves = turning(10, 12);
    let gif = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| uv_animation(&moves, &small()).unwrap())
    };
    assert!(gif(1) == gif(2) && gif(1) == gif(5));
}

/// Protects the report's size.
#[test]
fn a_small_size_is_kept_with_fewer_frames() {
    let moves = turning(20, 60);
    let size = |most_bytes| {
        let gif = uv_animation(&moves, &UvAnimationOptions { most_bytes, ..small() }).unwrap();
        (gif.len(), played(&gif).len())
    };
    let (bytes, frames) = size(usize::MAX);
    assert_eq!(frames, 60);
    let (fewer_bytes, fewer) = size(bytes / 2);
    assert!(fewer_bytes <= bytes / 2 && (10..40).contains(&fewer), "{fewer_bytes} {fewer}");
    assert_eq!(size(0).1, FEWEST_FRAMES);
}

/// Protects the colours' meaning: a flipped triangle is red, another one is not.
#[test]
fn flipped_triangles_are_red() {
    let mut moves = UvMoves {
        frames: vec![vec![vec2(0.1, 0.1), vec2(0.9, 0.1), vec2(0.1, 0.9)]],
        triangles: vec![[0, 1, 2]],
        charts: vec![0],
    };
    let red = |moves: &UvMoves| {
        let pixels = Drawing::new(moves, 100).frame(&moves.frames[0], 1.0).pixels;
        pixels.iter().filter(|&&p| p >= palette::index(palette::FAULT, 1)).count()
    };
    assert_eq!(red(&moves), 0);
    moves.frames[0].swap(0, 1);
    assert!(red(&moves) > 2_500);
}

/// Protects against panics on what no layout should be, and on still pictures.
#[test]
fn odd_input_is_drawn_without_panic() {
    let odd = [f32::NAN, f32::INFINITY, 1e30, -3e4, 0.5, 0.5, 1.5, -0.5];
    let points: Vec<Vec2> = odd.iter().flat_map(|&u| odd.map(|v| vec2(u, v))).collect();
    let count = points.len() as u32;
    let moves = UvMoves {
        triangles: (0..count * count).map(|i| [i % count, i / count, (i * 7) % (count + 3)]).collect(),
        charts: vec![u32::MAX, 3],
        frames: vec![points.clone(), Vec::new(), points.clone(), points],
    };
    assert_eq!(played(&uv_animation(&moves, &small()).unwrap()).len(), 4);
    for moves in [UvMoves::default(), UvMoves { frames: vec![Vec::new(); 2], ..UvMoves::default() }] {
        for side in [0, 100, usize::MAX] {
            let options = UvAnimationOptions { side, most_frames: 0, most_bytes: 0 };
            assert_eq!(played(&uv_animation(&moves, &options).unwrap()).len(), 1);
        }
    }
}
