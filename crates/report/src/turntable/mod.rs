//! A film of models that turn beside each other, all alike in pose, size and light: what
//! the coarse ones lack shows when they move.
//!
//! ```text
//! models ─ set ─ frame 0 … n−1, batch by batch in parallel ─ reel ─ writer
//!                                                            ├ APNG: what changed, lossless
//!                          some frames ─ palette ────────────┴ GIF: what changed, 256 colours
//! ```
//!
//! While a batch is rendered, the one before is encoded, so no more than two are in memory.
//!
//! Contract: the bytes depend on the arguments only, not on the number of threads. The turn is
//! closed: the last frame is as far from the first as from the one before it.

mod apng;
mod caption;
mod film;
mod gif;
mod layout;
mod options;
mod palette;
mod reel;
mod sheet;

pub use options::TurntableOptions;

use self::gif::Gif;
use apng::Apng;
use film::Set;
use parbake::BakeError;
use parbake::{Message, Stage, Watcher};
use parbake_files::{FileError, write_streamed};
use parbake_model::Model;
use rayon::prelude::*;
use reel::Reel;
use serde::{Deserialize, Serialize};
use sheet::Sheet;
use std::io::{self, Write};
use std::path::Path;

/// What a film is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FilmFormat {
    /// An animated PNG: true colour, lossless.
    Apng,
    /// A GIF: 256 colours, a smaller file.
    Gif,
}

impl FilmFormat {
    /// By the file's ending: .png or .apng, .gif; none for others.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" | "apng" => Some(Self::Apng),
            "gif" => Some(Self::Gif),
            _ => None,
        }
    }
}

/// Samples of pictures that are rendered at once: keeps the largest ones within some gigabytes.
const LIVE_SAMPLES: usize = 1 << 26;

/// Films `high` and beside it each of `lows`, which stand in its frame, and writes the film as it
/// comes. It plays again and again.
///
/// Runs on rayon's current thread pool.
///
/// # Errors
/// An option out of range; a high-poly without extent; [`BakeError::Film`] if `file` cannot take
/// it all; [`BakeError::Stopped`] if the watcher stops the run, for part of a turn is no use.
pub fn turntable(
    high: &Model,
    lows: &[&Model],
    options: &TurntableOptions,
    format: FilmFormat,
    file: &mut (dyn Write + Send),
    watcher: &dyn Watcher,
) -> Result<(), BakeError> {
    options.check()?;
    options.check_size(1 + lows.len(), format)?;
    if options.shown_seconds() > options.seconds {
        watcher.message(Message::Warning(format!(
            "{} frames take {:.1} s, since viewers show no more than 50 a second",
            options.frames,
            options.shown_seconds()
        )));
    }
    watcher.message(Message::Progress { stage: Stage::Prepare, done: 0, total: 1 });
    let set = Set::new(high, lows, options)?;
    watcher.message(Message::Progress { stage: Stage::Film, done: 0, total: options.frames });
    let failed = |source| BakeError::Film { source };
    let reel: Box<dyn Reel + '_> = match format {
        FilmFormat::Apng => Box::new(Apng::new(file, options, &set.layout).map_err(failed)?),
        FilmFormat::Gif => Box::new(Gif::new(file, options, &set.layout, set.palette()).map_err(failed)?),
    };
    wind(&set, options, reel, watcher)
}

/// [`turntable`] into a file, whole or not at all: until the film is finished, it lies in a
/// temporary file beside `path`.
///
/// # Errors
/// As of [`turntable`]; a file that cannot be written is named.
pub fn write_turntable(
    path: &Path,
    high: &Model,
    lows: &[&Model],
    options: &TurntableOptions,
    format: FilmFormat,
    watcher: &dyn Watcher,
) -> Result<(), BakeError> {
    write_streamed(path, |file| match turntable(high, lows, options, format, file, watcher) {
        Err(BakeError::Film { source }) => Err(FileError::Write { path: path.into(), source }.into()),
        other => other,
    })
}

/// Renders all frames and winds them on.
fn wind(
    set: &Set,
    options: &TurntableOptions,
    mut reel: Box<dyn Reel + '_>,
    watcher: &dyn Watcher,
) -> Result<(), BakeError> {
    let samples = (options.resolution * options.supersample).pow(2);
    let batch = (LIVE_SAMPLES / samples).clamp(1, rayon::current_num_threads());
    let mut waiting: Vec<Sheet> = Vec::new();
    let mut next = 0;
    while next < options.frames || !waiting.is_empty() {
        let now = next..(next + batch).min(options.frames);
        next = now.end;
        let done = next - now.len();
        let ready = std::mem::take(&mut waiting);
        let (wound, rendered) = rayon::join(
            || -> io::Result<()> { ready.into_iter().try_for_each(|sheet| reel.add(sheet)) },
            || now.into_par_iter().map(|index| (!watcher.stopped()).then(|| set.frame(index))).collect(),
        );
        wound.map_err(|source| BakeError::Film { source })?;
        let rendered: Option<Vec<Sheet>> = rendered;
        waiting = rendered.ok_or(BakeError::Stopped)?;
        watcher.message(Message::Progress { stage: Stage::Film, done, total: options.frames });
    }
    reel.finish().map_err(|source| BakeError::Film { source })
}

#[cfg(test)]
mod tests;
