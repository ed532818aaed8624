//! The page of a made-up chain.

use super::lod_report;
use parbake::AtSize;
use parbake::lod::document::LodDocument;
use parbake::{
    Candidate, LayerReport, LevelReport, LodOptions, Start, StartReport, TargetReport, Trial, TrialMap,
    Verdict, Way, demo_pair,
};

fn level(level: usize, target: Option<TargetReport>) -> LevelReport {
    let at = AtSize { pixels: 60.0, psnr: 31.5, ms_ssim: None, flip: Some(0.05) };
    let start = |start, error| StartReport { start, triangles: 90, error };
    LevelReport {
        level,
        screen_size: 60.0,
        triangles: 90,
        texture_size: 64,
        texels: 4096,
        gutter: Some(4.0),
        smallest_gutter: Some(2.0),
        draw_calls: 1,
        way: Way::New,
        candidates: [(Way::New, 31.5), (Way::Scaled, 29.0)]
            .map(|(way, psnr)| Candidate {
                way,
                triangles: 90,
                texture_size: 64,
                psnr,
                close_up: Some(psnr - 3.0),
            })
            .to_vec(),
        parts: Vec::new(),
        low_poly: vec![LayerReport {
            triangles: 90,
            starts: vec![start(Start::Level, 1e-3), start(Start::Quadrics, 2e-3)],
            error: [1e-3, 5e-4],
        }],
        at_screen_size: at,
        switch_pixels: (level > 0).then_some(60.0),
        switch_coverage: (level > 0).then_some(0.1),
        against_before: (level > 0).then_some(at),
        target,
        stopped_early: level > 0,
        seconds: [1.0, 2.0, f64::NAN],
    }
}

/// Protects who reads the page: it says what a level is made for, which start won, what a search tried and that it did
/// not get there; names are escaped, nothing is loaded from elsewhere, and pictures have words for who does not see them.
#[test]
fn a_chain_has_a_page() {
    let (high, low) = demo_pair();
    let trial = |psnr, chosen| Trial {
        bake: 0,
        triangles: 90,
        maps: vec![TrialMap { name: "<b>".into(), size: 64 }, TrialMap { name: "normal".into(), size: 0 }],
        texture_quality: Some(65),
        bytes: 12_345,
        psnr,
        reached: false,
        chosen,
    };
    let target = TargetReport {
        psnr: 40.0,
        verdict: Verdict::Missed,
        bakes: 1,
        most_triangles: 320,
        trials: vec![trial(31.0, false), trial(31.5, true)],
    };
    let options =
        LodOptions { screen_size: vec![60.0, 30.0, 20.0], target_psnr: Some(40.0), ..LodOptions::default() };
    let files = vec![
        ("a_lod0.glb".into(), 12_345, level(0, Some(target))),
        ("<i>".into(), 2_000_000, level(1, None)),
    ];
    let mut original = high.clone();
    original.name = "<script>".into();
    let document = LodDocument::new(&original, &options, "a_lods.glb".into(), 200.0, files);
    let html = lod_report(&original, &document, &[low.clone(), low], &options, &()).unwrap();
    for word in [
        "1 of its levels are missing",
        "before all steps of level 1",
        "40.0 dB cannot be reached: the best file has 31.50 dB",
        "&lt;b&gt; 64², no normal, quality 65",
        "the level before",
        "new layout, taken",
        "layout and maps</th>",
        "At its size: 60 pixels",
        "<td>31.5\u{202f}dB</td><td>28.5\u{202f}dB</td>",
        "2.00\u{202f}MB",
    ] {
        assert!(html.contains(word), "{word}");
    }
    for bad in ["NaN", "<script>", "<i>", "<b> 64", "http:", "https:"] {
        assert!(!html.replace("http://www.w3.org", "").contains(bad), "{bad}");
    }
    assert_eq!(html.matches("<img").count(), html.matches(" alt=\"").count());
    assert_eq!(
        html.matches("<svg").count(),
        html.matches("aria-label=").count() + html.matches("aria-hidden").count()
    );
}
