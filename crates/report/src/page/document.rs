//! The page around its content: head, style, sections, foot.

use std::fmt::Write;

const STYLE: &str = include_str!("style.css");

/// A whole page. `title` is escaped already and may hold no elements; `body` stands inside of `<main>`.
pub fn document(title: &str, body: &str) -> String {
    format!(
        concat!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">",
            r#"<meta name="viewport" content="width=device-width,initial-scale=1">"#,
            r#"<meta name="color-scheme" content="light dark">"#,
            // The browser itself keeps the page from fetching or running anything.
            r#"<meta http-equiv="Content-Security-Policy" content="default-src 'none';img-src data:;style-src 'unsafe-inline'">"#,
            "<title>{title} – Parbake</title><style>{style}</style></head>\n",
            "<body><main>{body}</main><footer>Parbake {version}</footer></body></html>\n"
        ),
        title = title,
        style = STYLE,
        body = body,
        version = env!("CARGO_PKG_VERSION")
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
