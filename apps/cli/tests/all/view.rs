//! `parbake view` as scripts and people meet it, and its page in a real browser beside the CPU renderer.

use crate::common::{demo_files, parbake, run, text};
use parbake::{EvaluateOptions, Limits, Renderer, Shading, read_model, write_glb};
use parbake_model::glam::Vec3;
use parbake_model::{Clearcoat, Sheen, Specular, TextureSlot, Transmission, Volume};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The folder of the page's sources, and of its tests in the browser.
fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../viewer")
}

/// A viewer that ends with the test.
struct Viewer {
    process: Child,
    url: String,
}

impl Viewer {
    fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut command = parbake(folder);
        command.args(["view", "--no-open", "-q"]).args(arguments).stdout(Stdio::piped());
        let mut process = command.spawn().unwrap();
        let mut url = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut url).unwrap();
        Self { process, url: url.trim().into() }
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// What the address answers, and the status.
fn get(url: &str) -> (u16, Vec<u8>) {
    let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET /{path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut all = Vec::new();
    stream.read_to_end(&mut all).unwrap();
    let head = all.windows(4).position(|four| four == b"\r\n\r\n").unwrap() + 4;
    (text(&all[9..12]).parse().unwrap(), all.split_off(head))
}

/// Protects a bake that is watched: its page has the model before the bake ends, the file has the same bytes as unwatched,
/// the last thing shown is that file, and the command ends as soon as the page has it.
#[test]
fn a_watched_bake_shows_itself_and_writes_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_files(folder, &["demo_high.glb", "demo_low.glb"]);
    let mut files = vec!["bake", "demo_high.glb", "demo_low.glb", "--preset", "fast", "-q"];
    files.extend(["--texture-size", "64", "--views", "60", "--view-size", "96"]);
    run(folder, &[&files[..], &["-o", "alone.glb"]].concat());
    let mut command = parbake(folder);
    command.args(&files).args(["-o", "watched.glb", "--watch", "--no-open"]).stderr(Stdio::piped());
    let mut process = command.spawn().unwrap();
    let mut line = String::new();
    BufReader::new(process.stderr.take().unwrap()).read_line(&mut line).unwrap();
    let url = line.trim().split(' ').next_back().unwrap();
    let ask = |version: u64| -> Value {
        serde_json::from_slice(&get(&format!("{url}run/look/{version}")).1).unwrap()
    };
    let (mut state, mut shown, mut models) = (ask(0), 0, Vec::new());
    while state["isFinished"] == false && state["failure"].is_null() {
        let snapshot = state["snapshot"].as_u64().unwrap();
        if snapshot > shown {
            shown = snapshot;
            models.push(get(&format!("{url}run/snapshot")).1);
        }
        state = ask(state["version"].as_u64().unwrap());
    }
    assert!(state["failure"].is_null(), "{state}");
    let last = get(&format!("{url}run/snapshot")).1;
    assert!(!models.is_empty(), "{state}");
    for (k, model) in models.iter().enumerate() {
        let name = folder.join(format!("snapshot{k}.glb"));
        std::fs::write(&name, model).unwrap();
        assert!(!read_model(&name, &Limits::default()).unwrap().model.mesh.triangles.is_empty());
    }
    assert!(state["curves"].as_array().unwrap().len() > 1, "{state}");
    assert_eq!(get(&format!("{url}run/shown")).0, 200);
    let told = Instant::now();
    assert!(process.wait().unwrap().success());
    assert!(told.elapsed() < Duration::from_secs(6), "a page that has what it needs is waited for");
    let written = std::fs::read(folder.join("watched.glb")).unwrap();
    assert_eq!(last, written);
    assert!(written == std::fs::read(folder.join("alone.glb")).unwrap(), "watched, it wrote something else");
}

/// Protects scripts: the address alone on standard output, on this machine alone; and one sentence for mistakes.
#[test]
fn the_address_is_printed_and_mistakes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let viewer = Viewer::start(folder, &["a.obj"]);
    let rest = viewer.url.strip_prefix("http://127.0.0.1:").unwrap();
    let (port, token) = rest.trim_end_matches('/').split_once('/').unwrap();
    assert!(port.parse::<u16>().is_ok() && token.len() == 32, "{}", viewer.url);

    for (arguments, code, words) in [
        (vec!["gone.glb"], 1, "gone.glb"),
        (vec!["a.obj", "--compare", "gone.glb"], 1, "gone.glb"),
        (vec!["."], 1, "folder"),
        (vec!["-"], 2, "standard input"),
        (vec![], 2, "view needs MODELS"),
        (vec!["a.obj", "--port", port], 1, "--port"),
        (vec!["a.obj", "--port", "65536"], 2, "65536"),
    ] {
        let output = parbake(folder).args(["view", "--no-open"]).args(&arguments).output().unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
}

/// The command that runs a script of the page's tests; none, with a word about it, where the browser, Node or the
/// packages are missing.
fn script(name: &str) -> Option<Command> {
    let places = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
    let set = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let has_browser = set.into_iter().chain(places.map(PathBuf::from)).any(|place| place.is_file());
    let has_node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
    if !has_browser || !has_node || !page().join("node_modules/puppeteer-core").is_dir() {
        eprintln!(
            "skipped: this test needs Chromium (set CHROMIUM if it lies elsewhere), Node, and \"npm ci\" in apps/viewer"
        );
        return None;
    }
    let mut command = Command::new("node");
    command.arg(page().join("test").join(name));
    Some(command)
}

const SIZE: usize = 192;

/// Protects what the page shows, and so what people judge a bake by: its pictures are those of the CPU renderer, from
/// the same cameras under the same light. The headlight and the studio are `eval`'s; unlit is the base colour alone.
/// Maps of the model: colour and normals; then metallic, roughness, occlusion and emission besides; then what extensions add.
#[test]
fn the_page_shows_what_the_cpu_renders() {
    let Some(mut stills) = script("stills.mjs") else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_files(folder, &["demo_high.glb", "demo.glb"]);
    let model = |name: &str| read_model(&folder.join(name), &Limits::default()).unwrap().model;
    let mut whole = model("demo.glb");
    // Any pictures will do: the baked colours as light, and the same numbers as data.
    let colors = whole.materials[0].base_color_texture.unwrap();
    whole.images.push(whole.images[colors.image].clone());
    let data = Some(TextureSlot { image: whole.images.len() - 1, ..colors });
    let material = &mut whole.materials[0];
    assert!(material.normal_texture.is_some());
    (material.metallic, material.roughness, material.metallic_roughness_texture) = (0.8, 0.7, data);
    (material.occlusion_texture, material.occlusion_strength) = (data, 0.5);
    (material.emissive_texture, material.emissive) = (Some(colors), [0.1, 0.2, 0.3]);
    write_glb(&folder.join("whole.glb"), &whole).unwrap();
    // Varnished cloth, with textures, and a coloured glass that is thicker in some places.
    let mut layered = whole.clone();
    let extensions = &mut layered.materials[0].extensions;
    extensions.clearcoat = Some(Clearcoat {
        factor: 0.8,
        texture: data,
        roughness: 0.4,
        roughness_texture: data,
        normal_texture: whole.materials[0].normal_texture,
        normal_scale: 0.5,
    });
    let (color, color_texture) = ([0.9, 0.5, 0.3], Some(colors));
    extensions.sheen = Some(Sheen { color, color_texture, roughness: 0.6, roughness_texture: data });
    extensions.specular = Some(Specular { factor: 0.7, color: [1.0, 0.6, 0.4], ..Specular::default() });
    extensions.ior = Some(1.8);
    write_glb(&folder.join("layered.glb"), &layered).unwrap();
    // A belt of the vase, through which its inside shows.
    let mut glass = model("demo.glb");
    let positions = &glass.mesh.positions;
    let low = positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
    let high = positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
    let is_in_belt =
        |&corner: &u32| (0.3..0.65).contains(&((positions[corner as usize].y - low) / (high - low)));
    let belt: Vec<bool> = glass.mesh.triangles.iter().map(|corners| corners.iter().all(is_in_belt)).collect();
    let mut around = glass.materials[0].clone();
    (around.double_sided, around.emissive, around.emissive_texture) = (true, [1.0; 3], Some(colors));
    glass.materials.push(around);
    glass.mesh.triangle_materials = belt.iter().map(|&is_glass| u32::from(!is_glass)).collect();
    let material = &mut glass.materials[0];
    (material.metallic, material.roughness, material.double_sided) = (0.0, 0.3, false);
    material.base_color = [0.8; 4];
    material.extensions.transmission = Some(Transmission { factor: 0.9, texture: data });
    let attenuation_color = [0.0, 0.5, 0.6];
    material.extensions.volume =
        Some(Volume { thickness: 0.5, texture: data, attenuation_distance: 1.5, attenuation_color });
    (material.base_color_texture, material.extensions.ior) = (None, Some(1.4));
    glass.images.push(whole.images[colors.image].clone());
    write_glb(&folder.join("glass.glb"), &glass).unwrap();
    let mut unlit = model("demo.glb");
    unlit.materials[0].unlit = true;
    write_glb(&folder.join("unlit.glb"), &unlit).unwrap();

    let cases = [
        ("demo_high.glb", "headlight", Shading::Lambert),
        ("demo.glb", "headlight", Shading::Lambert),
        ("demo.glb", "studio", Shading::Pbr),
        ("whole.glb", "studio", Shading::Pbr),
        ("layered.glb", "studio", Shading::Pbr),
        ("glass.glb", "studio", Shading::Pbr),
        ("unlit.glb", "studio", Shading::Pbr),
    ];
    let directions = [[0.3f32, 0.2, 1.0], [-1.0, 0.6, -0.4], [0.2, -0.5, 0.8]];
    let file = |case: usize, view: usize| folder.join(format!("{case}_{view}.rgba"));
    let (mut viewers, mut spec) = (Vec::new(), Vec::new());
    for (case, (name, light, _)) in cases.iter().enumerate() {
        viewers.push(Viewer::start(folder, &[name]));
        let stills: Vec<_> = directions
            .iter()
            .enumerate()
            .map(|(view, direction)| {
                json!({ "file": file(case, view), "direction": direction, "size": SIZE, "supersample": 2, "light": light })
            })
            .collect();
        spec.push(json!({ "url": viewers[case].url, "stills": stills }));
    }
    std::fs::write(folder.join("spec.json"), serde_json::to_vec(&spec).unwrap()).unwrap();
    let output = stills.arg(folder.join("spec.json")).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));

    for (case, (name, light, shading)) in cases.into_iter().enumerate() {
        let model = model(name);
        let options =
            EvaluateOptions { shading, resolution: SIZE, supersample: 2, ..EvaluateOptions::default() };
        let renderer = Renderer::new(&model, &options).unwrap();
        let placed = renderer.place(&model);
        for (view, direction) in directions.into_iter().enumerate() {
            let rendered = renderer.render(&placed, Vec3::from(direction).normalize());
            let ours = renderer.tonemap(&rendered, [0.0; 3]).pixels;
            let page = std::fs::read(file(case, view)).unwrap();
            let error = |(ours, page): (&[f32; 3], &[u8])| -> f64 {
                (0..3).map(|k| f64::from(ours[k] - f32::from(page[k]) / 255.0).powi(2)).sum()
            };
            let sum: f64 = ours.iter().zip(page.chunks_exact(4)).map(error).sum();
            let psnr = -10.0 * (sum / (3 * SIZE * SIZE) as f64).log10();
            // A black picture would agree with another one.
            let lit = ours.iter().filter(|pixel| pixel[0] + pixel[1] + pixel[2] > 0.1).count();
            eprintln!("{name}, {light}, view {view}: {psnr:.1} dB, {lit} pixels lit");
            assert!(lit > SIZE * SIZE / 20, "{name}, {light}, view {view}: {lit} pixels are not black");
            assert!(psnr > 40.0, "{name}, {light}, view {view}: {psnr:.1} dB");
        }
    }
}
