//! `parbake turntable` as scripts and people meet it: files, exit codes, words.

use crate::common::{demo_pair, parbake, run, text};
use std::fs;

/// Options with which a film takes a fraction of a second.
const SMALL: [&str; 6] = ["--frames", "3", "--resolution", "32", "--supersample", "1"];

/// Protects the first look at a bake: several models, both formats, one line with what came of it,
/// and the same bytes for any number of threads.
#[test]
fn a_film_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let film = |name: &str, more: &[&str]| {
        let models = ["turntable", "demo_high.glb", "demo_low.glb", "demo_low.glb", "-o", name];
        let output = run(folder, &[&models[..], &SMALL, more].concat());
        (fs::read(folder.join(name)).unwrap(), text(&output.stderr))
    };
    let (png, said) = film("a.png", &["--threads", "1"]);
    assert_eq!(png[..4], *b"\x89PNG");
    assert!(png.windows(4).any(|w| w == b"acTL"), "animated");
    assert!(said.contains("a.png: 3 frames, "), "{said}");
    assert!(png == film("b.APNG", &["--threads", "3"]).0);
    let (gif, said) = film("a.gif", &["-q"]);
    assert_eq!(gif[..6], *b"GIF89a");
    assert!(gif.windows(11).any(|w| w == b"NETSCAPE2.0"), "plays again and again");
    assert_eq!(said, "");
}

/// Protects scripts: one sentence that names the culprit, the right exit code, nothing left behind.
#[test]
fn mistakes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let with = |more: &[&'static str]| [&["turntable", "demo_high.glb", "demo_low.glb"], more].concat();
    let cases = [
        (with(&["-o", "never.mp4"]), 2, ".gif"),
        (with(&["-o", "never"]), 2, ".apng"),
        (with(&["-o", "nowhere/never.png"]), 2, "nowhere"),
        (with(&["-o", "never.png", "--frames", "1"]), 2, "2 to 720"),
        (with(&["-o", "never.png", "--height", "-90"]), 2, "-87 to 87"),
        (with(&["-o", "never.png", "--background", "pink"]), 2, "R,G,B"),
        (with(&["never.glb", "-o", "never.png"]), 1, "never.glb"),
        (vec!["turntable", "demo_high.glb"], 2, "turntable needs LOW"),
    ];
    for (arguments, code, words) in cases {
        let output = parbake(folder).args(&arguments).output().unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(words) && said.contains("error: "), "{arguments:?}: {said}");
    }
    assert_eq!(fs::read_dir(folder).unwrap().count(), 2, "nothing but the inputs");
}

/// Protects the folder, and an older film, from half of a new one.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_what_there_was() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    fs::write(folder.join("old.png"), "old").unwrap();
    let mut child = parbake(folder)
        .args(["turntable", "demo_high.glb", "demo_low.glb", "-o", "old.png", "-q"])
        .args(["--frames", "720", "--resolution", "256", "--supersample", "8"])
        .spawn()
        .unwrap();
    // Until it films: there is a third file then.
    for _ in 0..600 {
        std::thread::sleep(std::time::Duration::from_millis(50));
        if fs::read_dir(folder).unwrap().count() > 3 {
            break;
        }
    }
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(fs::read(folder.join("old.png")).unwrap(), b"old");
    assert_eq!(fs::read_dir(folder).unwrap().count(), 3);
}
