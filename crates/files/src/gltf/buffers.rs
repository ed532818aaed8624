//! Buffers and buffer views (glTF 2.0, 3.6.1). A buffer is fetched when something
//! first reads from it, and its bytes are counted against the limits.

use super::json::Document;
use super::uri::{Uri, parse};
use crate::context::Context;
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
        Self { context, document, binary, fetched, total: Cell::new(0), ordered: RefCell::default() }
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
                    Uri::Relative(path) => Cow::Owned(self.external(&path, uri_place())?),
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

    /// The bytes of another file, all such together within the limit.
    pub fn external(&self, path: &str, place: Place) -> Result<Vec<u8>, FileError> {
        let left = self.context.limits.max_file_bytes.saturating_sub(self.total.get());
        let read = self.context.read(path, left).map_err(|e| {
            // The file's own name helps more than the pointer to where it is named.
            let source = std::io::Error::new(e.kind(), format!("{:?}: {e}", shown(path)));
            FileError::Read { path: self.context.path.into(), place, source }
        })?;
        self.total.set(self.total.get() + read.len() as u64);
        Ok(read)
    }

    /// The bytes of a buffer view, and its stride.
    pub fn view(&self, index: usize, from: &str) -> Result<(&[u8], Option<usize>), FileError> {
        let Some(view) = self.document.buffer_views.get(index) else {
            return Err(self.missing(from, "buffer view", index, self.document.buffer_views.len()));
        };
        let here = format!("/bufferViews/{index}");
        let buffer = self.buffer(view.buffer, &format!("{here}/buffer"))?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end)).ok_or_else(|| {
            let (offset, length, there) = (view.byte_offset, view.byte_length, buffer.len());
            self.context.invalid(
                pointer(here),
                format!("bytes from {offset}, {length} of them, reach beyond the buffer's {there}"),
            )
        })?;
        Ok((bytes, view.byte_stride))
    }

    /// The error for an index that names nothing.
    pub fn missing(&self, from: &str, what: &str, index: usize, count: usize) -> FileError {
        self.context.invalid(
            pointer(from.into()),
            format!("{what} {index} is asked for, but the document has {count} (they count from 0)"),
        )
    }
}
