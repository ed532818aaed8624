//! What every reader carries along: whose file it is, what it may use, and the
//! warnings so far.

use crate::contents::{PictureFormat, StoredPicture};
use crate::image_in::{Origin, decode, texels};
use crate::picture_files::PictureFiles;
use crate::search;
use crate::words::shown;
use crate::{Contents, FileError, Limits, Place, Resources, Warning, WarningKind};
use parbake_model::Image;
use rayon::prelude::*;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
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

/// A picture that is yet to be decoded, and its name.
pub(crate) type NamedBytes<'a> = (String, Cow<'a, [u8]>);

/// Carried through one reading of one file.
pub(crate) struct Context<'a> {
    pub path: &'a Path,
    resources: &'a dyn Resources,
    pub limits: &'a Limits,
    pub textures: Textures,
    /// The vertex attribute that importances are painted in, where they are asked for.
    pub attribute: Option<&'a str>,
    /// Whether the files of pictures are kept.
    pub keeps_pictures: bool,
    warnings: RefCell<Vec<Warning>>,
    seen: RefCell<BTreeSet<String>>,
    /// Bytes of each file that was read, the model's own under the empty name.
    read: RefCell<BTreeMap<String, u64>>,
    contents: RefCell<Contents>,
    picture_files: RefCell<PictureFiles>,
}

impl<'a> Context<'a> {
    pub fn new(path: &'a Path, resources: &'a dyn Resources, limits: &'a Limits, textures: Textures) -> Self {
        let (warnings, seen, read, contents, picture_files) = Default::default();
        let (attribute, keeps_pictures) = (None, false);
        Self {
            path,
            resources,
            limits,
            textures,
            attribute,
            keeps_pictures,
            warnings,
            seen,
            read,
            contents,
            picture_files,
        }
    }

    /// Counts the model's own file.
    pub fn count_own(&self, bytes: &[u8]) {
        self.count("", bytes);
    }

    /// Reads a file that the model names; where nothing is at an absolute path, the file of that name
    /// beside the model, with a warning.
    pub fn read(&self, named: &str, max_bytes: u64) -> io::Result<Vec<u8>> {
        let error = match self.read_there(named, max_bytes) {
            Ok(bytes) => return Ok(bytes),
            Err(error) if search::is_absolute(named) && error.kind() != io::ErrorKind::FileTooLarge => error,
            Err(error) => return Err(error),
        };
        match self.read_by_name(named, "", max_bytes)? {
            Some((_, bytes)) => Ok(bytes),
            None if search::is_refusal(&error) => Err(error),
            None => {
                let reason = "nothing is at this absolute path, and no file of its name is beside the model";
                Err(io::Error::new(error.kind(), reason))
            }
        }
    }

    /// Reads a file exactly where the model says.
    pub fn read_there(&self, named: &str, max_bytes: u64) -> io::Result<Vec<u8>> {
        // The resources are a caller's own and need not know about confinement.
        if self.limits.confine && (search::is_absolute(named) || search::leaves(named)) {
            return Err(search::outside());
        }
        if !search::may_be_here(named) {
            return Err(io::Error::from(io::ErrorKind::NotFound));
        }
        let bytes = self.resources.read(named, max_bytes)?;
        self.count(named, &bytes);
        Ok(bytes)
    }

    /// Looks for a file by its name alone, in `folder` and beside the model; a warning says where it
    /// was found.
    pub fn read_by_name(
        &self,
        named: &str,
        folder: &str,
        max_bytes: u64,
    ) -> io::Result<Option<(String, Vec<u8>)>> {
        for place in search::by_name(named, folder) {
            // These are our own guesses: one that a confined reading may not make is not an error.
            if place == named || (self.limits.confine && search::leaves(&place)) {
                continue;
            }
            match self.read_there(&place, max_bytes) {
                Ok(bytes) => {
                    let (named, found) = (shown(named), shown(&place));
                    self.warn(format!("nothing is at {named:?}; {found:?} beside the model was taken"));
                    return Ok(Some((place, bytes)));
                }
                Err(error) if search::is_refusal(&error) => return Err(error),
                Err(_) => {}
            }
        }
        Ok(None)
    }

    fn count(&self, name: &str, bytes: &[u8]) {
        self.read.borrow_mut().insert(name.into(), bytes.len() as u64);
    }

    /// Bytes of all files that were read, each once.
    pub fn bytes(&self) -> u64 {
        self.read.borrow().values().sum()
    }

    /// Counts further draw calls.
    pub fn count_draw_calls(&self, more: usize) {
        self.contents.borrow_mut().draw_calls += more;
    }

    /// What the files hold, as far as they were read.
    pub fn contents(&self) -> Contents {
        self.contents.borrow().clone()
    }

    /// Takes out the files of pictures, where they are kept.
    pub fn take_picture_files(&self) -> PictureFiles {
        self.picture_files.take()
    }

    /// Adds a warning of no kind of its own, once.
    pub fn warn(&self, text: impl Into<String>) {
        self.warn_of(WarningKind::Other, text);
    }

    /// Adds a warning, once. The first of each kind is always kept, however many there are: programs decide by
    /// kinds.
    pub fn warn_of(&self, kind: WarningKind, text: impl Into<String>) {
        let text = shown(&text.into());
        let mut warnings = self.warnings.borrow_mut();
        let mut seen = self.seen.borrow_mut();
        // The set is bounded too: a hostile file could warn about a million names.
        let is_first = kind != WarningKind::Other && warnings.iter().all(|warning| warning.kind != kind);
        let is_new = (is_first || seen.len() < 10 * MOST_WARNINGS) && seen.insert(text.clone());
        if is_new && (is_first || seen.len() <= MOST_WARNINGS) {
            warnings.push(Warning { kind, text });
        }
    }

    /// All warnings, in order.
    pub fn into_warnings(self) -> Vec<Warning> {
        let mut warnings = self.warnings.into_inner();
        let seen = self.seen.borrow().len();
        if seen > warnings.len() {
            let text = format!("and {} or more further warnings", seen - warnings.len());
            warnings.push(Warning { kind: WarningKind::Other, text });
        }
        warnings
    }

    pub fn invalid(&self, place: Place, reason: impl Into<String>) -> FileError {
        FileError::Invalid { path: self.path.into(), place, reason: shown(&reason.into()) }
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
            feature: shown(&feature.into()),
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

    /// Decodes all of the model's pictures, side by side. Each has a name, by which
    /// errors call it. To be called once, as the texels of all are counted together.
    pub fn decode_images(
        &self,
        pictures: &[NamedBytes<'_>],
        origin: Origin,
    ) -> Result<Vec<Image>, FileError> {
        let place = |name: &str| Place::Image(shown(name));
        // All sizes are known to be within the limits before memory is reserved for any.
        let mut total = 0u64;
        for (name, bytes) in pictures {
            let texels = texels(name, bytes, origin, self.limits)
                .map_err(|trouble| trouble.into_error(self.path, place(name), self.limits))?;
            total = total.saturating_add(texels);
            self.within(place(name), "texels of all images together", total, self.limits.max_total_pixels)?;
        }
        let images: Vec<_> =
            pictures.par_iter().map(|(name, bytes)| decode(name, bytes, origin, self.limits)).collect();
        let named = images.into_iter().zip(pictures);
        let images: Vec<Image> = named
            .map(|(image, (name, _))| {
                image.map_err(|trouble| trouble.into_error(self.path, place(name), self.limits))
            })
            .collect::<Result<_, _>>()?;
        let stored = images.iter().zip(pictures).filter_map(|(image, (name, bytes))| {
            Some(StoredPicture {
                name: shown(name),
                format: PictureFormat::of(name, bytes)?,
                width: image.width,
                height: image.height,
                bytes: bytes.len() as u64,
            })
        });
        self.contents.borrow_mut().pictures.extend(stored);
        if self.keeps_pictures {
            let mut files = self.picture_files.borrow_mut();
            images.iter().zip(pictures).for_each(|(image, (_, bytes))| files.keep(image, bytes));
        }
        Ok(images)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoResources;

    /// Protects memory: many pictures are counted together before any is decoded.
    #[test]
    fn pictures_are_counted_together() {
        let png = crate::encode_png(&Image::solid("a", 10, 10, [1, 2, 3, 4])).unwrap();
        let pictures: Vec<NamedBytes> = (0..3).map(|i| (format!("p{i}"), png.as_slice().into())).collect();
        let run = |max_total_pixels| {
            let limits = Limits { max_total_pixels, ..Limits::default() };
            let context = Context::new(Path::new("a"), &NoResources, &limits, Textures::Decode);
            context.decode_images(&pictures, Origin::Other).map_err(|e| e.to_string())
        };
        let names: Vec<_> = run(300).unwrap().into_iter().map(|image| image.name).collect();
        assert_eq!(names, ["p0", "p1", "p2"]);
        let error = run(299).unwrap_err();
        assert!(error.contains("\"p2\": texels of all images together: 300"), "{error}");
    }

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
        assert!(warnings[MOST_WARNINGS].text.starts_with("and 360 or more"));
    }

    /// Protects `--strict` from a missing texture that is lost among warnings about other things.
    #[test]
    fn the_first_warning_of_a_kind_is_kept() {
        let limits = Limits::default();
        let context = Context::new(Path::new("a"), &NoResources, &limits, Textures::Decode);
        (0..100_000).for_each(|i| context.warn(format!("number {i}")));
        (0..9).for_each(|i| context.warn_of(WarningKind::MissingTexture, format!("picture {i}")));
        let kinds: Vec<_> = context.into_warnings().iter().map(|warning| warning.kind).collect();
        assert_eq!(kinds.iter().filter(|kind| **kind == WarningKind::MissingTexture).count(), 1);
        assert!(kinds.len() <= MOST_WARNINGS + 2);
    }
}
