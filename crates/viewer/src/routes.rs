//! What may be asked for: a fixed list of names below the token. A path is never a path of the disk.

use crate::page::{FILES, File};

/// Something that may be asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Route {
    /// A file of the page.
    Page(&'static File),
    /// Which models there are.
    Session,
    /// A model as a GLB file, by its number.
    Model(usize),
    /// What there is to say about it.
    Notes(usize),
    /// Something about the run.
    Run(RunRoute),
}

/// What may be asked of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RunRoute {
    /// How it goes, as soon as that is news to a page that knows this version.
    News(u64),
    /// The same; the page could show a new snapshot.
    NewsAndSnapshot(u64),
    /// Its newest snapshot.
    Snapshot,
    /// Nothing: the page tells that it has shown how the run ended.
    Shown,
}

/// What a request's path means to a server with this token and so many models, `is_live` if it follows a run; `None` for
/// everything else.
pub(crate) fn route(path: &str, token: &str, models: usize, is_live: bool) -> Option<Route> {
    let name = path.strip_prefix('/')?.strip_prefix(token)?.strip_prefix('/')?;
    let number = |text: &str| text.parse::<usize>().ok().filter(|&n| n < models && n.to_string() == text);
    match name {
        "" => find("index.html"),
        "session.json" => Some(Route::Session),
        _ if is_live && name.starts_with("run/") => match name.strip_prefix("run/")? {
            "snapshot" => Some(Route::Run(RunRoute::Snapshot)),
            "shown" => Some(Route::Run(RunRoute::Shown)),
            rest => {
                let (what, version) = rest.split_once('/')?;
                let number = version.parse().ok().filter(|n: &u64| n.to_string() == version)?;
                match what {
                    "news" => Some(Route::Run(RunRoute::News(number))),
                    "look" => Some(Route::Run(RunRoute::NewsAndSnapshot(number))),
                    _ => None,
                }
            }
        },
        _ => match name.strip_prefix("model/") {
            Some(rest) => match rest.strip_suffix("/notes.json") {
                Some(index) => number(index).map(Route::Notes),
                None => number(rest).map(Route::Model),
            },
            None => find(name),
        },
    }
}

fn find(name: &str) -> Option<Route> {
    FILES.iter().find(|file| file.name == name).map(Route::Page)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Protects files of this machine: only names on the list lead anywhere, and only below the token.
    #[test]
    fn only_known_names_lead_anywhere() {
        let at = |path: &str| route(path, "t0ken", 2, false);
        assert!(matches!(at("/t0ken/"), Some(Route::Page(file)) if file.name == "index.html"));
        assert!(matches!(at("/t0ken/app.js"), Some(Route::Page(_))));
        assert_eq!(at("/t0ken/session.json"), Some(Route::Session));
        assert_eq!(at("/t0ken/model/1"), Some(Route::Model(1)));
        assert_eq!(at("/t0ken/model/0/notes.json"), Some(Route::Notes(0)));
        for path in [
            "/",
            "",
            "/app.js",
            "/t0ken",
            "/t0kem/app.js",
            "/t0kenapp.js",
            "//t0ken/app.js",
            "/t0ken//app.js",
            "/t0ken/../t0ken/app.js",
            "/t0ken/./app.js",
            "/t0ken/%61pp.js",
            "/t0ken/app.js/",
            "/t0ken/../../etc/passwd",
            "/t0ken/..%2f..%2fetc/passwd",
            "/t0ken/model/2",
            "/t0ken/model/-1",
            "/t0ken/model/01",
            "/t0ken/model/+1",
            "/t0ken/model/../session.json",
            "/t0ken/model/0/",
            "/t0ken/model/99999999999999999999",
            "/t0ken/run/news/0",
            "/t0ken/run/snapshot",
            "/t0ken/run/shown",
        ] {
            assert_eq!(at(path), None, "{path}");
        }
        let live = |path: &str| route(path, "t0ken", 1, true);
        assert_eq!(live("/t0ken/run/news/17"), Some(Route::Run(RunRoute::News(17))));
        assert_eq!(live("/t0ken/run/look/3"), Some(Route::Run(RunRoute::NewsAndSnapshot(3))));
        assert_eq!(live("/t0ken/run/snapshot"), Some(Route::Run(RunRoute::Snapshot)));
        for path in [
            "/t0ken/run/news/",
            "/t0ken/run/news/017",
            "/t0ken/run/news/-1",
            "/t0ken/run/news/0/",
            "/t0ken/run/look",
            "/t0ken/run/x/0",
        ] {
            assert_eq!(live(path), None, "{path}");
        }
    }
}
