//! Tests of whole films at a small size.

use super::*;
use ::gif::{ColorOutput, DecodeOptions, Repeat};
use parbake::{wall_pair, with_threads};
use parbake_model::Model;
use parbake_model::glam::Vec3;
use std::io::Cursor;

fn small() -> TurntableOptions {
    TurntableOptions { frames: 5, seconds: 1.0, resolution: 40, ..TurntableOptions::default() }
}

fn film(
    lows: &[&Model],
    high: &Model,
    options: &TurntableOptions,
    format: FilmFormat,
    threads: usize,
) -> Vec<u8> {
    let mut bytes = Vec::new();
    with_threads(threads, || turntable(high, lows, options, format, &mut bytes, &())).unwrap().unwrap();
    bytes
}

/// Shows the frames of an animated PNG, each as milliseconds and all its pixels.
fn play_png(bytes: &[u8]) -> Vec<(u16, Sheet)> {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let animation = *reader.info().animation_control().unwrap();
    assert_eq!(animation.num_plays, 0, "plays again and again");
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let mut sheet = Sheet { width, height, pixels: vec![[0; 3]; width * height] };
    let mut buffer = vec![0; width * height * 3];
    (0..animation.num_frames)
        .map(|_| {
            let info = reader.next_frame(&mut buffer).unwrap();
            let control = *reader.info().frame_control().unwrap();
            assert_eq!(control.delay_den, 1000);
            for y in 0..info.height as usize {
                let from = (y + control.y_offset as usize) * width + control.x_offset as usize;
                let row = &buffer[y * info.line_size..][..3 * info.width as usize];
                sheet.pixels[from..from + info.width as usize].copy_from_slice(row.as_chunks().0);
            }
            (control.delay_num, sheet.clone())
        })
        .collect()
}

/// Shows the frames of a GIF, each as hundredths of a second and all its pixels.
fn play_gif(bytes: &[u8]) -> Vec<(u16, Sheet)> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::RGBA);
    let mut decoder = options.read_info(Cursor::new(bytes)).unwrap();
    let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
    let mut sheet = Sheet { width, height, pixels: vec![[0; 3]; width * height] };
    let mut shown = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (i, pixel) in frame.buffer.as_chunks::<4>().0.iter().enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            let at = (y + usize::from(frame.top)) * width + x + usize::from(frame.left);
            if pixel[3] > 0 {
                sheet.pixels[at] = [pixel[0], pixel[1], pixel[2]];
            }
        }
        shown.push((frame.delay, sheet.clone()));
    }
    assert_eq!(decoder.repeat(), Repeat::Infinite);
    shown
}

/// Protects losslessness: what a viewer puts together from the changes is what was rendered, for
/// as long as it should be seen.
#[test]
fn an_apng_shows_what_was_rendered() {
    let (high, low) = wall_pair();
    let options = small();
    let shown = play_png(&film(&[&low, &low], &high, &options, FilmFormat::Apng, 2));
    assert_eq!(shown.len(), 5);
    let set = Set::new(&high, &[&low, &low], &options).unwrap();
    for (index, (milliseconds, sheet)) in shown.iter().enumerate() {
        assert_eq!((sheet.width, sheet.height), (3 * 40 + 2, 40 + 13));
        assert_eq!(*milliseconds, 200);
        assert!(*sheet == set.frame(index), "frame {index}");
    }
}

/// Protects the GIF's colours and what stays transparent in it: close to the lossless film, and
/// the background exactly.
#[test]
fn a_gif_is_close_to_what_was_rendered() {
    let (high, low) = wall_pair();
    let options = TurntableOptions { background: "0.9,0.1,0.2".into(), ..small() };
    let exact = play_png(&film(&[&low], &high, &options, FilmFormat::Apng, 1));
    let shown = play_gif(&film(&[&low], &high, &options, FilmFormat::Gif, 1));
    assert_eq!(shown.len(), exact.len());
    for ((hundredths, shown), (_, exact)) in shown.iter().zip(&exact) {
        assert_eq!((*hundredths, shown.width, shown.height), (20, exact.width, exact.height));
        assert_eq!(shown.pixels[0], exact.pixels[0]);
        let pairs = shown.pixels.as_flattened().iter().zip(exact.pixels.as_flattened());
        let error: f64 = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
        let error = error / (3 * shown.pixels.len()) as f64;
        assert!(error < 40.0, "mean squared error {error}");
    }
}

/// Protects reproducible films: threads change how frames are batched and nothing else.
#[test]
fn bytes_do_not_depend_on_threads() {
    let (high, low) = wall_pair();
    for format in [FilmFormat::Apng, FilmFormat::Gif] {
        let made = |threads| film(&[&low], &high, &small(), format, threads);
        assert!(made(1) == made(3), "{format:?}");
    }
}

/// Protects the turn: no frame comes twice, and what follows the last one is the first.
#[test]
fn the_turn_closes() {
    let (high, low) = wall_pair();
    let options = TurntableOptions { frames: 7, ..small() };
    let shown = play_png(&film(&[&low], &high, &options, FilmFormat::Apng, 1));
    for (i, (_, a)) in shown.iter().enumerate() {
        assert!(shown[..i].iter().all(|(_, b)| a != b), "frame {i} is another's copy");
    }
    let distance = |a: Vec3, b: Vec3| f64::from(a.distance(b));
    let set = Set::new(&high, &[], &options).unwrap();
    let step = distance(set.direction(0), set.direction(1));
    assert!(step > 0.1 && (distance(set.direction(6), set.direction(0)) - step).abs() < 1e-6);
}

/// Protects users from guessing: a bad option is refused by its name.
#[test]
fn bad_options_are_named() {
    let named = |change: fn(&mut TurntableOptions)| {
        let mut options = small();
        change(&mut options);
        match options.check() {
            Err(BakeError::Option { option, .. }) => option,
            other => panic!("{other:?}"),
        }
    };
    assert!(TurntableOptions::default().check().is_ok());
    assert_eq!(named(|o| o.frames = 1), "frames");
    assert_eq!(named(|o| o.seconds = f64::NAN), "seconds");
    assert_eq!(named(|o| o.resolution = 31), "resolution");
    assert_eq!(named(|o| o.supersample = 9), "supersample");
    assert_eq!(named(|o| o.height = -88.0), "height");
    assert_eq!(named(|o| o.radius = 1.0), "radius");
    assert_eq!(named(|o| o.fov = 180.0), "fov");
    assert_eq!(named(|o| o.background = "pink".into()), "background");
    assert_eq!(named(|o| o.threads = 1000), "threads");
    let wide = TurntableOptions { resolution: 2048, ..small() };
    assert!(wide.check_size(40, FilmFormat::Gif).is_err() && wide.check_size(40, FilmFormat::Apng).is_ok());
}

/// Protects the speed of a turn: times add up to it, and none is so short that viewers slow it down.
#[test]
fn times_add_up_to_the_turn() {
    for (frames, seconds, whole) in [(60, 6.0, 6.0), (7, 1.0, 1.0), (720, 6.0, 14.4), (2, 100.0, 100.0)] {
        let options = TurntableOptions { frames, seconds, ..small() };
        for a_second in [100.0, 1000.0] {
            let ticks: Vec<u16> = (0..frames).map(|index| options.ticks(index, a_second)).collect();
            let sum: f64 = ticks.iter().map(|&t| f64::from(t)).sum();
            assert!((sum / a_second - whole).abs() < 1e-9, "{frames} frames: {sum}");
            assert!(ticks.iter().all(|&t| f64::from(t) >= 0.02 * a_second), "{ticks:?}");
        }
    }
}

/// Protects folders and disks: a film that is stopped or does not fit is an error, and no file.
#[test]
fn half_a_film_is_none() {
    struct Impatient;
    impl Watcher for Impatient {
        fn stopped(&self) -> bool {
            true
        }
    }
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let (high, low) = wall_pair();
    for format in [FilmFormat::Apng, FilmFormat::Gif] {
        let stopped = turntable(&high, &[&low], &small(), format, &mut Vec::new(), &Impatient);
        assert!(matches!(stopped, Err(BakeError::Stopped)), "{stopped:?}");
        let full = turntable(&high, &[&low], &small(), format, &mut Full, &());
        assert!(matches!(full, Err(BakeError::Film { .. })), "{full:?}");
    }
}

/// Protects the changes that frames hold: all of them, nothing more, and never nothing.
#[test]
fn changes_are_found() {
    use sheet::Rectangle;
    let before = [0; 20];
    let mut now = before;
    assert_eq!(Rectangle::changed(5, &before, &now), Rectangle::whole(1, 1));
    (now[6], now[13]) = (1, 1);
    let both = Rectangle { left: 1, top: 1, width: 3, height: 2 };
    assert_eq!(Rectangle::changed(5, &before, &now), both);
    assert_eq!(both.rows(5).collect::<Vec<_>>(), [6..9, 11..14]);
}
