//! The page of a comparison of two small models.

use super::evaluation_report;
use super::views::chosen;
use parbake::{EvaluateOptions, Shading, ViewFigures, demo_pair, evaluate};

/// Protects who reads the page: it has the figures that were measured, what is worst comes first, channels stand on it where whole
/// materials are compared, names are escaped, nothing is loaded from elsewhere, and the command gives the same figures.
#[test]
fn a_comparison_has_a_page() {
    let (high, mut low) = demo_pair();
    low.name = "<low> & \"co\"".into();
    let options = EvaluateOptions {
        views: 9,
        resolution: 48,
        shading: Shading::Pbr,
        background: "grey".into(),
        ..EvaluateOptions::default()
    };
    let evaluation = evaluate(&high, &low, &options, &()).unwrap();
    let page = evaluation_report(&high, &low, &evaluation, &()).unwrap();
    assert!(page.contains("&lt;low&gt; &amp; &quot;co&quot;") && !page.contains("<low>"));
    let least = evaluation.views.iter().map(|view| view.psnr).fold(f64::INFINITY, f64::min);
    for figure in [evaluation.mean.psnr, least] {
        assert!(page.contains(&format!("{figure:.2}")), "{figure}");
    }
    let place = |why: &str| page.find(&format!(", {why} <")).unwrap();
    assert!(place("worst") < place("second worst") && place("sixth worst") < place("best"));
    for of in &evaluation.channels {
        let row = format!("<th scope=\"row\">{}</th><td>{:.2}</td>", of.channel.label(), of.mean.psnr);
        assert!(page.contains(&row), "{row}");
    }
    assert!(
        page.contains("parbake eval HIGH LOW --background grey --resolution 48 --shading pbr --views 9<")
    );
    let text: String =
        page.split("base64,").map(|part| part.split_once('"').map_or(part, |(_, rest)| rest)).collect();
    assert!(!text.contains("NaN") && !text.contains("http://") && !text.contains("https://"));
    assert_eq!(page.matches("<img").count(), page.matches(" alt=\"").count());
    // No channels, no pictures of any.
    let matte = EvaluateOptions { shading: Shading::Lambert, no_flip: true, views: 2, ..options };
    let evaluation = evaluate(&high, &low, &matte, &()).unwrap();
    let page = evaluation_report(&high, &low, &evaluation, &()).unwrap();
    assert!(!page.contains("Channel by channel") && !page.contains("FLIP, 0 to 1"));
}

/// Protects the choice of views: the worst first, none twice, and as many as there are where these are few.
#[test]
fn the_worst_views_come_first() {
    let of = |psnr: &[f64]| {
        let views: Vec<ViewFigures> =
            psnr.iter().map(|&psnr| ViewFigures { psnr, ms_ssim: None, flip: None }).collect();
        chosen(&views).iter().map(|view| view.index).collect::<Vec<_>>()
    };
    let many: Vec<f64> = (0..20).map(|i| 60.0 - f64::from(i)).collect();
    assert_eq!(of(&many), [19, 18, 17, 16, 15, 14, 9, 0]);
    assert_eq!(of(&[30.0, 20.0]), [1, 0]);
    assert_eq!(of(&[f64::NAN, 20.0, 25.0]), [1, 2, 0]);
    assert_eq!(of(&[100.0; 9]), [0]);
    assert!(of(&[]).is_empty());
}
