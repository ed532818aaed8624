//! A test of the comparison as a whole, on the wall at a small size.

use super::html::variants_html;
use super::*;
use parbake::{wall_pair, with_threads};

/// Somebody who has long stopped.
struct Impatient;
impl Watcher for Impatient {
    fn stopped(&self) -> bool {
        true
    }
}

fn small() -> VariantsOptions {
    VariantsOptions {
        texture_size: 64,
        parallax_size: 8,
        height_size: 16,
        steps: 4,
        views: 8,
        view_size: 32,
        resolution: 32,
        ..VariantsOptions::default()
    }
}

/// Protects the order of the variants, their costs, the page, and that nothing depends on the
/// number of threads.
#[test]
fn variants_are_compared_alike() {
    let (high, low) = wall_pair();
    let run =
        |threads| with_threads(threads, || compare_variants(&high, &low, &small(), &())).unwrap().unwrap();
    let (one, three) = (run(1), run(3));
    let figures = |c: &ComparedVariants| -> Vec<(String, f64, usize, usize)> {
        c.report.variants.iter().map(|v| (v.name.clone(), v.psnr, v.bytes, v.places)).collect()
    };
    assert_eq!(figures(&one), figures(&three));
    assert!(one.pictures == three.pictures && one.high == three.high);
    let places: Vec<usize> = one.report.variants.iter().map(|v| v.places).collect();
    assert_eq!(places, [0, 1, 1, 17, 17, 1, 1, 0]);
    assert!(one.report.variants.iter().all(|v| v.psnr > 10.0 && v.psnr < 60.0));
    let page = variants_html(&high, &one).unwrap();
    assert_eq!(page.matches("data:image/png;base64,").count(), 2 * 9);
    // Pictures may spell anything.
    let text: String = page.split('"').filter(|part| !part.starts_with("data:")).collect();
    for broken in ["<script", "http:", "https:", "NaN", ">inf"] {
        assert!(!text.contains(broken), "{broken}");
    }
}

/// Protects a stopped run: it has textures without parallax to show, and says so.
#[test]
fn a_stopped_comparison_ends_after_the_first() {
    let (high, low) = wall_pair();
    let compared = compare_variants(&high, &low, &small(), &Impatient).unwrap();
    assert!(compared.report.stopped_early && compared.report.variants.len() == 1);
    assert!(variants_html(&high, &compared).unwrap().contains("stopped early"));
}
