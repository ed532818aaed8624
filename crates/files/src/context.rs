//! What every reader carries along: whose file it is, what it may use, and the
//! warnings so far.

use crate::image_in::{ImageTrouble, decode};
use crate::{FileError, Limits, Place, Resources};
use parbake_model::Image;
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::path::Path;

/// More warnings than this help nobody; the rest are counted.
const MOST_WARNINGS: usize = 40;

/// Whether pictures are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Textures {
    /// Those that materials use.
    Decode,
    /// None: every material comes without textures.
    Skip,
}

/// Carried through one reading of one file.
pub(crate) struct Context<'a> {
    pub path: &'a Path,
    pub resources: &'a dyn Resources,
    pub limits: &'a Limits,
    pub textures: Textures,
    warnings: RefCell<Vec<String>>,
    seen: RefCell<BTreeSet<String>>,
    pixels: Cell<u64>,
}

impl<'a> Context<'a> {
    pub fn new(path: &'a Path, resources: &'a dyn Resources, limits: &'a Limits, textures: Textures) -> Self {
        let (warnings, seen, pixels) = Default::default();
        Self { path, resources, limits, textures, warnings, seen, pixels }
    }

    /// Adds a warning, once.
    pub fn warn(&self, text: impl Into<String>) {
        let text = text.into();
        let mut seen = self.seen.borrow_mut();
        // The set is bounded too: a hostile file could warn about a million names.
        if seen.len() < 10 * MOST_WARNINGS && seen.insert(text.clone()) && seen.len() <= MOST_WARNINGS {
            self.warnings.borrow_mut().push(text);
        }
    }

    /// All warnings, in order.
    pub fn into_warnings(self) -> Vec<String> {
        let mut warnings = self.warnings.into_inner();
        let seen = self.seen.borrow().len();
        if seen > warnings.len() {
            warnings.push(format!("and {} or more further warnings", seen - warnings.len()));
        }
        warnings
    }

    pub fn invalid(&self, place: Place, reason: impl Into<String>) -> FileError {
        FileError::Invalid { path: self.path.into(), place, reason: reason.into() }
    }

    pub fn unsupported(
        &self,
        place: Place,
        feature: impl Into<String>,
        advice: impl Into<String>,
    ) -> FileError {
        FileError::Unsupported {
            path: self.path.into(),
            place,
            feature: feature.into(),
            advice: advice.into(),
        }
    }

    /// Refuses `found` where it is over `limit`.
    pub fn within(&self, place: Place, what: &'static str, found: u64, limit: u64) -> Result<(), FileError> {
        if found <= limit {
            return Ok(());
        }
        Err(FileError::OverLimit { path: self.path.into(), place, what, found, limit })
    }

    /// Decodes one of the model's pictures, and counts its texels.
    pub fn decode_image(&self, name: &str, bytes: &[u8]) -> Result<Image, FileError> {
        let place = || Place::Image(name.into());
        let left = self.limits.max_total_pixels.saturating_sub(self.pixels.get());
        let limits = Limits { max_image_pixels: self.limits.max_image_pixels.min(left), ..*self.limits };
        let image = decode(name, bytes, &limits).map_err(|trouble| match trouble {
            ImageTrouble::Pixels(found) if found <= self.limits.max_image_pixels => FileError::OverLimit {
                path: self.path.into(),
                place: place(),
                what: "texels of all images together",
                found: found.saturating_add(self.pixels.get()),
                limit: self.limits.max_total_pixels,
            },
            other => other.into_error(self.path, place(), &limits),
        })?;
        self.pixels.set(self.pixels.get() + (image.width * image.height) as u64);
        Ok(image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoResources;

    /// Protects the terminal from a flood of warnings.
    #[test]
    fn warnings_are_said_once_and_bounded() {
        let limits = Limits::default();
        let context = Context::new(Path::new("a"), &NoResources, &limits, Textures::Decode);
        for i in 0..200_000 {
            context.warn(format!("number {}", i / 2));
        }
        let warnings = context.into_warnings();
        assert_eq!(warnings.len(), MOST_WARNINGS + 1);
        assert_eq!(warnings[1], "number 1");
        assert!(warnings[MOST_WARNINGS].starts_with("and 360 or more"));
    }
}
