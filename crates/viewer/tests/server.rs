//! The viewer's server as browsers, and those who are up to something, meet it.

#![allow(clippy::unwrap_used)]

use parbake_viewer::{Server, View};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A running server with two models, of which one is broken; its address without and with the token.
fn running(folder: &Path) -> (String, String) {
    std::fs::write(folder.join("a.obj"), OBJ).unwrap();
    std::fs::write(folder.join("b.glb"), b"glTF broken").unwrap();
    std::fs::write(folder.join("secret.txt"), b"secret").unwrap();
    let view =
        View { levels: vec![folder.join("a.obj")], compare: Some(folder.join("b.glb")), ..View::default() };
    let server = Server::bind(&view).unwrap();
    assert!(server.address().unwrap().ip().is_loopback());
    let url = server.url();
    let host = server.address().unwrap().to_string();
    std::thread::spawn(move || server.run());
    let token = url.strip_prefix(&format!("http://{host}/")).unwrap().trim_end_matches('/').to_string();
    assert!(token.len() == 32 && token.bytes().all(|b| b.is_ascii_hexdigit()), "{token}");
    (host, token)
}

/// Sends a request as it is; the head in lower case, and the body.
fn ask(host: &str, request: &str) -> (String, Vec<u8>) {
    let mut stream = TcpStream::connect(host).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut all = Vec::new();
    stream.read_to_end(&mut all).unwrap();
    let end = all.windows(4).position(|w| w == b"\r\n\r\n").map_or(all.len(), |at| at + 4);
    (String::from_utf8_lossy(&all[..end]).to_lowercase(), all[end..].to_vec())
}

fn get(host: &str, path: &str) -> (String, Vec<u8>) {
    ask(host, &format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"))
}

/// Protects the page: every file it needs is there, with its type and a policy that keeps it on this machine.
#[test]
fn the_page_and_its_models_are_served() {
    let folder = tempfile::tempdir().unwrap();
    let (host, token) = running(folder.path());
    let types = [
        ("", "text/html; charset=utf-8"),
        ("app.js", "text/javascript; charset=utf-8"),
        ("three.js", "text/javascript; charset=utf-8"),
        ("style.css", "text/css; charset=utf-8"),
        ("draco/draco_decoder.wasm", "application/wasm"),
        ("session.json", "application/json"),
        ("model/0", "model/gltf-binary"),
        ("model/0/notes.json", "application/json"),
    ];
    for (name, media_type) in types {
        let (head, body) = get(&host, &format!("/{token}/{name}"));
        assert!(head.starts_with("http/1.1 200"), "{name}: {head}");
        assert!(head.contains(&format!("content-type: {media_type}\r\n")), "{name}: {head}");
        for header in [
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cache-control: no-store",
            "cross-origin-resource-policy: same-origin",
            "content-security-policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval';",
        ] {
            assert!(head.contains(header), "{name}: {head}");
        }
        assert!(!body.is_empty(), "{name}");
    }
    let worker = get(&host, &format!("/{token}/basis/worker.js")).0;
    assert!(
        worker.contains("content-security-policy: default-src 'none'; script-src 'unsafe-eval'"),
        "{worker}"
    );
    let policy = get(&host, &format!("/{token}/")).0;
    assert!(!policy.contains("'unsafe-eval'"), "{policy}");
    assert!(!policy.contains("http:") && !policy.contains("https:") && !policy.contains(" *"), "{policy}");
    assert_eq!(get(&host, &format!("/{token}/model/0")).1[..4], *b"glTF");
    let session = String::from_utf8(get(&host, &format!("/{token}/session.json")).1).unwrap();
    assert!(session.contains("\"a.obj\"") && !session.contains(folder.path().to_str().unwrap()), "{session}");
}

/// Protects users of broken files: the reader's sentence, not a cut-off answer.
#[test]
fn a_broken_model_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let (host, token) = running(folder.path());
    let (head, body) = get(&host, &format!("/{token}/model/1"));
    assert!(head.starts_with("http/1.1 422"), "{head}");
    assert!(String::from_utf8_lossy(&body).contains("b.glb"), "{}", String::from_utf8_lossy(&body));
}

/// Protects models and files of this machine from other pages and programs: a wrong token, any path that is not on
/// the list, another host's name, another site's page and other methods are refused.
#[test]
fn everything_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (host, token) = running(folder.path());
    let wrong = "0".repeat(32);
    for path in [
        "/".to_string(),
        "/session.json".into(),
        format!("/{wrong}/session.json"),
        format!("/{token}/../{token}/session.json"),
        format!("/{token}/../secret.txt"),
        format!("/{token}/model/../../secret.txt"),
        format!("/{token}/%2e%2e/secret.txt"),
        format!("/{token}/secret.txt"),
        format!("/{token}/a.obj"),
        format!("/{token}/model/2"),
        format!("/{token}//etc/passwd"),
    ] {
        let (head, body) = get(&host, &path);
        assert!(head.starts_with("http/1.1 404"), "{path}: {head}");
        assert!(
            !body.windows(6).any(|w| w == b"secret") && head.contains("content-security-policy"),
            "{path}"
        );
    }
    let page = format!("/{token}/session.json");
    let with = |first: &str, headers: &str| {
        ask(&host, &format!("{first} {page} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n")).0
    };
    let own = format!("Host: {host}\r\n");
    assert!(with("GET", "Host: example.com\r\n").starts_with("http/1.1 403"));
    assert!(with("GET", &format!("{own}Sec-Fetch-Site: cross-site\r\n")).starts_with("http/1.1 403"));
    assert!(with("GET", &format!("{own}Sec-Fetch-Site: same-origin\r\n")).starts_with("http/1.1 200"));
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "HEAD"] {
        let head = with(method, &own);
        assert!(head.starts_with("http/1.1 405") && head.contains("allow: get"), "{method}: {head}");
    }
}

/// Protects two viewers side by side: a taken port is said in one sentence.
#[test]
fn a_taken_port_is_named() {
    let first = Server::bind(&View::default()).unwrap();
    let port = first.address().unwrap().port();
    let error = Server::bind(&View { port, ..View::default() }).unwrap_err().to_string();
    assert!(error.contains(&port.to_string()) && error.contains("--port"), "{error}");
    assert_ne!(first.url(), Server::bind(&View::default()).unwrap().url());
}
