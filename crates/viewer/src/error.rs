//! Why a viewer could not be served.

use std::io;

/// Why a viewer could not be served, or not be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The port cannot be listened on.
    #[error(
        "port {port} of this machine cannot be listened on ({source}); choose another --port, or 0 for any"
    )]
    Port {
        /// The port that was asked for.
        port: u16,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The operating system has no random numbers for the address's token.
    #[error("no random numbers for the page's address: {0}")]
    Random(String),
    /// The operating system gives no event loop or no thread.
    #[error("the viewer could not be started: {0}")]
    Start(io::Error),
    /// No browser could be opened.
    #[error("no browser could be opened ({0}); open the address by hand")]
    Browser(io::Error),
}
