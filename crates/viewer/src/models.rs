//! The models of a view: read once each, in threads of their own, while the page is loading.
//!
//! Contract: what cannot be read is one sentence, which the page shows. A GLB file is handed over as it is, so that
//! the page shows what other viewers would.

use bytes::Bytes;
use parbake_files::{Limits, read_self_contained};
use std::path::{Path, PathBuf};
use tokio::sync::OnceCell;

/// What a model is shown as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// The model, or one of its levels of detail.
    Level,
    /// What it is compared with.
    Compare,
}

impl Role {
    pub fn name(self) -> &'static str {
        match self {
            Self::Level => "level",
            Self::Compare => "compare",
        }
    }
}

/// A model that was read.
#[derive(Clone, Debug)]
pub(crate) struct Ready {
    pub glb: Bytes,
    /// Of its file and all others that were read for it.
    pub bytes: u64,
    pub warnings: Vec<String>,
}

/// A model of the view.
#[derive(Debug)]
pub(crate) struct Entry {
    path: PathBuf,
    limits: Limits,
    pub role: Role,
    ready: OnceCell<Result<Ready, String>>,
}

impl Entry {
    pub fn new(path: &Path, role: Role, limits: Limits) -> Self {
        Self { path: path.into(), limits, role, ready: OnceCell::new() }
    }

    /// The file's name without its folders.
    pub fn name(&self) -> String {
        self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }

    /// The model, as soon as it is read; or why it cannot be.
    pub async fn ready(&self) -> &Result<Ready, String> {
        self.ready
            .get_or_init(|| async {
                let (path, limits) = (self.path.clone(), self.limits);
                let reading = tokio::task::spawn_blocking(move || read(&path, &limits));
                reading.await.unwrap_or_else(|_| Err("the model could not be read".into()))
            })
            .await
    }
}

fn read(path: &Path, limits: &Limits) -> Result<Ready, String> {
    let model = read_self_contained(path, limits).map_err(|error| error.to_string())?;
    let warnings = model.warnings.into_iter().map(|warning| warning.text).collect();
    Ok(Ready { glb: model.glb.into(), bytes: model.bytes, warnings })
}
