//! Where to look for a file that a model names, and which places a confined reading never looks at.
//!
//! Artists' files carry absolute paths of the machine they were made on, Windows paths too. Where
//! nothing is at such a path, the file of the same name beside the model, or in its folder of
//! textures, is very likely the one that is meant.

/// Folders in which a file is looked for by its name, from the model's own on.
const FOLDERS: [&str; 5] = ["", "textures/", "tex/", "../textures/", "../tex/"];

/// Why a confined reading refuses a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outside;

impl std::fmt::Display for Outside {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("it lies outside the model's folder, to which reading is confined")
    }
}

impl std::error::Error for Outside {}

/// The error for a file outside the folder to which a reading is confined.
pub(crate) fn outside() -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::PermissionDenied, Outside)
}

/// Whether a file is not merely missing: it is too large, or outside where reading is confined.
pub(crate) fn is_refusal(error: &std::io::Error) -> bool {
    error.kind() == std::io::ErrorKind::FileTooLarge
        || error.get_ref().is_some_and(|inner| inner.is::<Outside>())
}

/// Whether a path begins at a root: of this system, of a Windows drive or of a Windows server.
pub(crate) fn is_absolute(path: &str) -> bool {
    let drive = matches!(path.as_bytes(), [letter, b':', ..] if letter.is_ascii_alphabetic());
    drive || path.starts_with(['/', '\\'])
}

/// Whether a path may be looked at without searching: relative ones, and absolute ones of this
/// system. A server's is not: a model could make this machine call another.
pub(crate) fn may_be_here(path: &str) -> bool {
    !is_absolute(path) || (std::path::Path::new(path).is_absolute() && !path.starts_with("//"))
}

/// Whether a relative path leads out of the folder that it starts in, at any of its steps.
pub(crate) fn leaves(path: &str) -> bool {
    let mut depth = 0i64;
    for part in path.split(['/', '\\']) {
        depth += match part {
            "" | "." => 0,
            ".." => -1,
            _ => 1,
        };
        if depth < 0 {
            return true;
        }
    }
    false
}

/// Where a file of the same name as `path` may lie; `folder` (empty, or with a `/` at its end) is
/// looked at before the model's own.
pub(crate) fn by_name(path: &str, folder: &str) -> Vec<String> {
    let name = path.rsplit(['/', '\\']).next().unwrap_or_default();
    if matches!(name, "" | "." | "..") || name.contains(':') {
        return Vec::new();
    }
    let mut places: Vec<String> = Vec::new();
    for start in [folder, ""] {
        for below in FOLDERS {
            let place = format!("{start}{below}{name}");
            if !places.contains(&place) {
                places.push(place);
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the search from names that are none, and finds folders of textures.
    #[test]
    fn places_of_a_name() {
        let places = by_name("C:\\Users\\x\\oak.png", "");
        assert_eq!(
            places,
            ["oak.png", "textures/oak.png", "tex/oak.png", "../textures/oak.png", "../tex/oak.png"]
        );
        assert_eq!(by_name("/a/oak.png", "m/")[..2], ["m/oak.png", "m/textures/oak.png"]);
        for none in ["/a/..", "C:", "/", ""] {
            assert!(by_name(none, "").is_empty(), "{none}");
        }
    }

    /// Protects files outside: what is absolute, and what leads out, is seen in any notation.
    #[test]
    fn absolute_and_leaving_paths_are_seen() {
        for path in ["/etc/passwd", "C:/x.png", "c:x.png", "\\\\server\\x.png", "//server/x.png"] {
            assert!(is_absolute(path), "{path}");
        }
        for path in ["a/b.png", "./b.png", "a/../b.png", "..a/b.png"] {
            assert!(!is_absolute(path) && !leaves(path), "{path}");
        }
        for path in ["../b.png", "a/../../b.png", "a\\..\\..\\b.png", "./../a"] {
            assert!(leaves(path), "{path}");
        }
        assert!(!may_be_here("C:/x.png") || cfg!(windows));
        assert!(!may_be_here("//server/x.png"));
    }
}
