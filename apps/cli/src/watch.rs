//! `--watch`: the running bake in the browser.

use crate::arguments::Watch;
use crate::failure::Failure;
use crate::progress::Console;
use parbake_viewer::{Live, Server, View, open_browser};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Bytes of a high-poly's file beyond which it is not shown beside the bake: to read it once more would take the time of
/// the bake.
const LARGEST: u64 = 64 << 20;
/// How long the end of a run waits for the page to show it.
const PATIENCE: Duration = Duration::from_secs(20);

/// Opens the page of a run that will write `output`, beside the high-poly's file; nothing where nobody asked for it.
pub fn open(
    watch: &Watch,
    output: &Path,
    high: &Path,
    console: &Console,
) -> Result<Option<Arc<Live>>, Failure> {
    if !watch.watch {
        return Ok(None);
    }
    let name = output.file_name().unwrap_or(output.as_os_str()).to_string_lossy();
    let live = Arc::new(Live::new(&name));
    // What cannot be read is said by the bake itself.
    let is_large = std::fs::metadata(high).is_ok_and(|found| found.len() > LARGEST);
    if is_large {
        live.warn(&format!(
            "{high}: not shown beside the bake, since it is larger than {} MB; afterwards \
             parbake view {output} --compare {high} shows both",
            LARGEST >> 20,
            high = high.display(),
            output = output.display()
        ));
    }
    let view = View {
        live: Some(live.clone()),
        compare: (!is_large).then(|| high.to_path_buf()),
        port: watch.port,
        limits: *console.limits(),
        ..View::default()
    };
    let server = Server::bind(&view)?;
    let url = server.url();
    // Not for people alone: a script has no other way to learn of it.
    console.announce(&format!("watch this bake at {url}"));
    std::thread::spawn(move || server.run());
    if !watch.no_open
        && let Err(error) = open_browser(&url)
    {
        console.say(&format!("warning: {error}"));
    }
    Ok(Some(live))
}

/// Tells the page how the run ended, and waits until it has shown that. The page then needs nobody any more.
pub fn close<T>(live: Option<&Live>, outcome: &Result<T, Failure>) {
    let Some(live) = live else { return };
    if let Err(failure) = outcome {
        live.fail(&failure.to_string());
    }
    live.hand_over(PATIENCE);
}
