//! The pictures of `$PARBAKE_DATA/bad` that are whole are read right.

use crate::common::data_folder;
use parbake_files::{Limits, read_image};
use parbake_model::Image;
use std::path::Path;

fn read(data: &Path, name: &str) -> Image {
    read_image(&data.join("bad").join(name), &Limits::default()).expect(name)
}

/// The mean difference of colour channels, in steps of 8 bits.
fn difference(a: &Image, b: &Image) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let channels = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
    let sum: u64 = channels.map(|(x, y)| u64::from(x.abs_diff(*y))).sum();
    sum as f64 / (4 * a.pixels.len()) as f64
}

/// Protects interlaced pictures: PngSuite has the same ones plain.
#[test]
fn interlaced_pngs_are_as_plain_ones() {
    let Some(data) = data_folder() else { return };
    for kind in ["3p02", "3p04", "4a08", "6a16"] {
        let [plain, interlaced] =
            ["basn", "basi"].map(|way| read(&data, &format!("png/pngsuite_valid/{way}{kind}.png")));
        assert_eq!(interlaced.pixels, plain.pixels, "{kind}");
    }
}

/// Protects transparency by a palette and by one colour.
#[test]
fn transparent_pngs() {
    let Some(data) = data_folder() else { return };
    for name in ["tbbn0g04", "tbwn0g16", "tbrn2c08", "tbbn3p08", "tp1n3p08"] {
        let image = read(&data, &format!("png/pngsuite_valid/{name}.png"));
        let clear = image.pixels.iter().filter(|p| p[3] == 0).count();
        assert!(clear > 100 && clear < 900, "{name}: {clear} of 1024 texels");
    }
}

/// Protects JPEGs of every sampling, progressive ones too: all show the same picture.
#[test]
fn jpegs_of_every_sampling_look_alike() {
    let Some(data) = data_folder() else { return };
    let reference = read(&data, "jpeg/go-fuzz/video-001.q50.444.jpeg");
    for kind in [
        "q50.410",
        "q50.410.progressive",
        "q50.411.progressive",
        "q50.420.progressive",
        "q50.422",
        "q50.440.progressive",
        "separate.dc.progression.progressive",
    ] {
        let image = read(&data, &format!("jpeg/go-fuzz/video-001.{kind}.jpeg"));
        let difference = difference(&image, &reference);
        assert!(difference < 6.0, "{kind}: {difference}");
    }
}
