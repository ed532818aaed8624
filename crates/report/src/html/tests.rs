//! A test of the page as a whole, on two small tents.

use super::html_report;
use parbake::{
    BakeOptions, EvaluateOptions, MeshCompression, TextureFormat, Watcher, Written, WrittenMesh,
    WrittenTexture, bake, evaluate,
};
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Material, Mesh, Model};

/// A tent of four triangles, `height` high, with texture coordinates.
fn tent(name: &str, height: f32) -> Model {
    let corners =
        [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, height]];
    let mesh = Mesh {
        positions: corners.map(Vec3::from).to_vec(),
        uvs: corners.map(|c| Vec2::new(c[0] + 1.0, 1.0 - c[1]) * 0.5).to_vec(),
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        triangle_materials: vec![0; 4],
        ..Mesh::default()
    };
    Model { name: name.into(), mesh, materials: vec![Material::default()], ..Model::default() }
}

fn options() -> BakeOptions {
    BakeOptions {
        texture_size: 32,
        views: Some(6),
        view_size: Some(32),
        rounds: Some(1),
        ..BakeOptions::default()
    }
}

/// A file with a texture that lost something, and one that stayed what it was.
fn written() -> Written {
    let texture = |name: &str, format, bytes, psnr, reason: Option<&str>| WrittenTexture {
        name: name.into(),
        format,
        bytes,
        psnr,
        reason: reason.map(Into::into),
    };
    Written {
        bytes: 5_000_000,
        mesh: WrittenMesh { compression: MeshCompression::Quantized, bytes: 99, position_error: 2e-5 },
        textures: vec![
            texture("base color", TextureFormat::Ktx2, 123_456, Some(41.28), None),
            texture("<b>", TextureFormat::Png, 77, None, Some("sides")),
        ],
    }
}

/// Somebody who has long stopped.
struct Impatient;
impl Watcher for Impatient {
    fn stopped(&self) -> bool {
        true
    }
}

/// The page without the script of the view and the model that it shows.
fn without_view(page: &str) -> String {
    let (before, rest) = page.split_once(r#"<script type="text/plain" id="view-model">"#).expect("a model");
    let (_, rest) = rest.split_once("</script>").expect("its end");
    let (between, rest) = rest.split_once(r#"<script type="module">"#).expect("a script");
    let (script, after) = rest.split_once("</script>").expect("its end");
    assert_eq!(script, super::model_view::SCRIPT);
    [before, between, after].concat()
}

/// Where elements are left open, every browser guesses something else.
fn assert_elements_are_closed(page: &str) {
    let mut open = Vec::new();
    for tag in page.split('<').skip(1) {
        let name: String = tag.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '/').collect();
        match name.as_str() {
            "" | "meta" | "img" | "input" => {}
            closing if closing.starts_with('/') => assert_eq!(open.pop(), Some(closing[1..].to_string())),
            _ if tag.split('>').next().is_some_and(|t| t.ends_with('/')) => {}
            _ => open.push(name),
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

/// Protects what the page promises: nothing is fetched or run, names cannot break
/// out, the figures are those of `evaluate`, and a stopped run is reported too.
#[test]
fn the_page_is_whole() {
    let (high, low) = (tent("high <b>", 0.5), tent("low & <script>", 0.4));
    let mut baked = bake(&high, &low, &options(), &Impatient).unwrap();
    baked.report.written = Some(written());
    let page = without_view(&html_report(&high, &baked, &Impatient).unwrap());
    for row in [
        "<td class=\"words\">KTX2 (UASTC)</td><td>123\u{202f}456</td><td>PSNR 41.3 dB</td>",
        "<th scope=\"row\">&lt;b&gt;</th><td class=\"words\">PNG: sides</td><td>77</td><td>none</td>",
        "<td class=\"words\">quantized</td><td>99</td><td>positions within 2.00e-5 units</td>",
    ] {
        assert!(page.contains(row), "{row}");
    }
    for broken in ["<script", "<b>\"", "http:", "https:", "url(", "NaN", ">inf", "src=\"\""] {
        assert!(!page.contains(broken), "{broken}");
    }
    assert!(page.contains("<h1>low &amp; &lt;script&gt;</h1>") && page.contains("(high &lt;b&gt;)"));
    assert!(page.contains("stopped early"));
    // Four sides of five pictures, and the colours; the normals of flat sides need no texture.
    assert_eq!(page.matches("data:image/png;base64,").count(), 4 * 5 + 1);

    assert_elements_are_closed(&page);

    for (model, background) in [(&baked.model, "black"), (&baked.ray_cast, "grey")] {
        let options = EvaluateOptions {
            views: parbake::compared_as(&options()).views,
            background: background.into(),
            no_flip: true,
            ..EvaluateOptions::default()
        };
        let mean = evaluate(&high, model, &options, &()).unwrap().mean;
        for figure in [format!("{:.2}", mean.psnr), format!("{:.4}", mean.ms_ssim.unwrap())] {
            assert!(page.contains(&format!("<td>{figure}</td>")), "{background} {figure}");
        }
    }
}

/// Protects whole materials on the page: each channel has its figures and its pictures, and textures are named by
/// what they hold.
#[test]
fn a_metal_page_shows_channels() {
    let (mut high, low) = (tent("high", 0.5), tent("low", 0.4));
    for material in &mut high.materials {
        (material.metallic, material.emissive) = (1.0, [0.0, 0.5, 0.0]);
    }
    let baked = bake(&high, &low, &options(), &Impatient).unwrap();
    let page = without_view(&html_report(&high, &baked, &Impatient).unwrap());
    for name in ["base color", "normal", "roughness", "metallic", "emission", "opacity"] {
        assert!(page.contains(&format!("<h3>{name}</h3>")), "{name}");
        assert!(page.contains(&format!(r#"<th scope="row">{name}</th>"#)), "{name}");
    }
    assert!(!page.contains(r#"id="file""#), "nothing was written");
    // None of the models has it.
    assert!(!page.contains("<h3>occlusion</h3>") && !page.contains("NaN"));
    let textures = page.matches("× 32</figcaption>").count();
    let pictures = page.matches("data:image/png;base64,").count();
    assert_eq!(pictures, 4 * 5 + 6 * 3 + textures);
    assert_elements_are_closed(&page);
}
