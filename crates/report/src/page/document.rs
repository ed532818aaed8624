//! The page around its content: head, style, sections, foot.

use super::base64::encode as base64;
use sha2::{Digest, Sha256};
use std::fmt::Write;

const STYLE: &str = include_str!("style.css");

/// A whole page. `title` is escaped already and may hold no elements; `body` stands inside of `<main>`.
pub fn document(title: &str, body: &str) -> String {
    page(title, body, "default-src 'none';img-src data:;style-src 'unsafe-inline'", "")
}

/// The same with a script, a module, which alone may run, and may make pictures of what is on the page.
pub fn document_with_script(title: &str, body: &str, script: &str) -> String {
    let mut hash = String::new();
    base64(&Sha256::digest(script), &mut hash);
    let policy = format!(
        "default-src 'none';img-src data: blob:;connect-src blob:;style-src 'unsafe-inline';script-src 'sha256-{hash}'"
    );
    page(title, body, &policy, &format!(r#"<script type="module">{script}</script>"#))
}

fn page(title: &str, body: &str, policy: &str, script: &str) -> String {
    format!(
        concat!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">",
            r#"<meta name="viewport" content="width=device-width,initial-scale=1">"#,
            r#"<meta name="color-scheme" content="light dark">"#,
            // The browser itself keeps the page from fetching or running anything else.
            r#"<meta http-equiv="Content-Security-Policy" content="{policy}">"#,
            "<title>{title} – Parbake</title><style>{style}</style></head>\n",
            "<body><main>{body}</main><footer>Parbake {version}</footer>{script}</body></html>\n"
        ),
        policy = policy,
        title = title,
        style = STYLE,
        body = body,
        version = env!("CARGO_PKG_VERSION"),
        script = script
    )
}

/// Appends a section with its heading; `lead` is a sentence below it, or nothing.
pub fn section(out: &mut String, id: &str, title: &str, lead: &str, content: &str) {
    let _ = write!(out, r#"<section id="{id}"><h2>{title}</h2>"#);
    if !lead.is_empty() {
        let _ = write!(out, r#"<p class="lead">{lead}</p>"#);
    }
    let _ = writeln!(out, "{content}</section>");
}
