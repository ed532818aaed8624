//! The built page: `apps/viewer/dist`, which `npm run build` there makes. Nothing is loaded from anywhere else.

/// A file of the page.
#[derive(Debug, PartialEq)]
pub(crate) struct File {
    /// The name below the token.
    pub name: &'static str,
    pub media_type: &'static str,
    pub bytes: &'static [u8],
}

impl File {
    /// Whether it makes functions from text, as the compiled transcoder of textures does.
    pub fn evaluates_text(&self) -> bool {
        self.name == "basis/worker.js"
    }
}

macro_rules! file {
    ($name:literal, $media_type:literal) => {
        File {
            name: $name,
            media_type: $media_type,
            bytes: include_bytes!(concat!("../../../apps/viewer/dist/", $name)),
        }
    };
}

/// All of them.
pub(crate) static FILES: [File; 9] = [
    file!("index.html", "text/html; charset=utf-8"),
    file!("style.css", "text/css; charset=utf-8"),
    file!("app.js", "text/javascript; charset=utf-8"),
    file!("three.js", "text/javascript; charset=utf-8"),
    file!("draco/draco_wasm_wrapper.js", "text/javascript; charset=utf-8"),
    file!("draco/draco_decoder.wasm", "application/wasm"),
    file!("basis/worker.js", "text/javascript; charset=utf-8"),
    file!("basis/basis_transcoder.wasm", "application/wasm"),
    file!("THIRD_PARTY_LICENSES.txt", "text/plain; charset=utf-8"),
];
