//! Buffers and buffer views (glTF 2.0, 3.6.1), compressed ones too (`meshopt.rs`), and Draco
//! streams in views (`draco.rs`). A buffer is fetched, and a view or a stream decoded, when
//! something first reads from it; the bytes are counted against the limits.

use super::draco::{self, Decoded};
use super::json::{Document, Meshopt};
use super::meshopt::Compression;
use super::uri::{Uri, parse};
use crate::context::Context;
use crate::search::is_refusal;
use crate::words::shown;
use crate::{FileError, Place};
use std::borrow::Cow;
use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashSet;

/// The bytes that a document refers to.
pub(super) struct Buffers<'a> {
    pub context: &'a Context<'a>,
    pub document: &'a Document,
    binary: Option<&'a [u8]>,
    fetched: Vec<OnceCell<Cow<'a, [u8]>>>,
    /// The bytes of compressed views.
    decompressed: Vec<OnceCell<Vec<u8>>>,
    /// The Draco streams in views.
    streams: Vec<OnceCell<Decoded>>,
    /// Points of all these streams.
    points: Cell<u64>,
    total: Cell<u64>,
    /// Accessors whose sparse indices are known to be in order: looking through them
    /// again for every instance could take for ever.
    pub ordered: RefCell<HashSet<usize>>,
}

pub(super) fn pointer(text: String) -> Place {
    Place::Pointer(text)
}

impl<'a> Buffers<'a> {
    pub fn new(document: &'a Document, binary: Option<&'a [u8]>, context: &'a Context<'a>) -> Self {
        let fetched = document.buffers.iter().map(|_| OnceCell::new()).collect();
        let decompressed = document.buffer_views.iter().map(|_| OnceCell::new()).collect();
        let streams = document.buffer_views.iter().map(|_| OnceCell::new()).collect();
        let (points, total, ordered) = Default::default();
        Self { context, document, binary, fetched, decompressed, streams, points, total, ordered }
    }

    /// The bytes of a buffer, `byteLength` of them.
    fn buffer(&self, index: usize, from: &str) -> Result<&[u8], FileError> {
        let Some(cell) = self.fetched.get(index) else {
            return Err(self.missing(from, "buffer", index, self.fetched.len()));
        };
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let bytes = self.fetch(index)?;
        Ok(cell.get_or_init(|| bytes))
    }

    fn fetch(&self, index: usize) -> Result<Cow<'a, [u8]>, FileError> {
        let place = || pointer(format!("/buffers/{index}"));
        let buffer = &self.document.buffers[index];
        let bytes = match (&buffer.uri, self.binary) {
            (Some(uri), _) => {
                let uri_place = || pointer(format!("/buffers/{index}/uri"));
                match parse(uri).map_err(|reason| self.context.invalid(uri_place(), reason))? {
                    Uri::Data(bytes) => Cow::Owned(bytes),
                    Uri::Relative(path) => Cow::Owned(self.external(&path, uri_place())??),
                }
            }
            (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
            (None, _) => {
                return Err(self
                    .context
                    .invalid(place(), "the buffer has no data: neither a URI nor a GLB chunk"));
            }
        };
        if bytes.len() < buffer.byte_length {
            let reason =
                format!("the buffer has {} of the {} bytes it declares", bytes.len(), buffer.byte_length);
            return Err(self.context.invalid(place(), reason));
        }
        Ok(bytes)
    }

    /// The bytes of another file, all such together within the limit. The inner error is that of a
    /// file that is not there or cannot be read, without which a model may do; the outer one is not.
    pub fn external(&self, path: &str, place: Place) -> Result<Result<Vec<u8>, FileError>, FileError> {
        let left = self.context.limits.max_file_bytes.saturating_sub(self.total.get());
        let read = match self.context.read(path, left) {
            Ok(read) => read,
            Err(error) => {
                let refused = is_refusal(&error);
                // The file's own name helps more than the pointer to where it is named.
                let source = std::io::Error::new(error.kind(), format!("{:?}: {error}", shown(path)));
                let error = FileError::Read { path: self.context.path.into(), place, source };
                return if refused { Err(error) } else { Ok(Err(error)) };
            }
        };
        self.total.set(self.total.get() + read.len() as u64);
        Ok(Ok(read))
    }

    /// Counts bytes that are about to be made from compressed ones.
    pub fn add_bytes(&self, bytes: u64, place: Place) -> Result<(), FileError> {
        let total = self.total.get().saturating_add(bytes);
        self.context.within(place, "bytes of all buffers", total, self.context.limits.max_file_bytes)?;
        self.total.set(total);
        Ok(())
    }

    /// So many bytes of a buffer; `here` is the pointer to what asks for them.
    pub fn part(&self, buffer: usize, offset: usize, length: usize, here: &str) -> Result<&[u8], FileError> {
        let bytes = self.buffer(buffer, &format!("{here}/buffer"))?;
        offset.checked_add(length).and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
            let reason =
                format!("bytes from {offset}, {length} of them, reach beyond the buffer's {}", bytes.len());
            self.context.invalid(pointer(here.into()), reason)
        })
    }

    /// The Draco stream in a buffer view; `here` is the pointer to the extension that names it.
    pub fn stream(&self, view: usize, here: &str) -> Result<&Decoded, FileError> {
        let (bytes, _) = self.view(view, &format!("{here}/bufferView"))?;
        let cell = &self.streams[view];
        if let Some(decoded) = cell.get() {
            return Ok(decoded);
        }
        let decoded = draco::decode(self.context, bytes, here, self.points.get())?;
        self.points.set(self.points.get() + decoded.points as u64);
        Ok(cell.get_or_init(|| decoded))
    }

    /// The bytes of a buffer view, and its stride.
    pub fn view(&self, index: usize, from: &str) -> Result<(&[u8], Option<usize>), FileError> {
        let Some(view) = self.document.buffer_views.get(index) else {
            return Err(self.missing(from, "buffer view", index, self.document.buffer_views.len()));
        };
        let here = format!("/bufferViews/{index}");
        let extensions = view.extensions.as_deref();
        let khr = extensions.and_then(|e| e.khr_meshopt.as_ref());
        let compressed = khr.or(extensions.and_then(|e| e.ext_meshopt.as_ref()));
        let bytes = match compressed {
            Some(json) => {
                let name = if khr.is_some() { "KHR" } else { "EXT" };
                self.decompressed(index, json, &format!("{here}/extensions/{name}_meshopt_compression"))?
            }
            None => self.part(view.buffer, view.byte_offset, view.byte_length, &here)?,
        };
        Ok((bytes, view.byte_stride))
    }

    fn decompressed(&self, view: usize, json: &Meshopt, here: &str) -> Result<&[u8], FileError> {
        let cell = &self.decompressed[view];
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let compression = Compression::new(self.context, json, here)?;
        let stream = self.part(json.buffer, json.byte_offset, json.byte_length, here)?;
        self.add_bytes(compression.bytes(stream)?, pointer(here.into()))?;
        let bytes = compression.decode(stream)?;
        Ok(cell.get_or_init(|| bytes))
    }

    /// The error for an index that names nothing.
    pub fn missing(&self, from: &str, what: &str, index: usize, count: usize) -> FileError {
        self.context.invalid(
            pointer(from.into()),
            format!("{what} {index} is asked for, but the document has {count} (they count from 0)"),
        )
    }
}
