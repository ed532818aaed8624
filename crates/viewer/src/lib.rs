//! A viewer for models, as a page in the browser: nothing is installed, nothing leaves this machine.
//!
//! ```text
//! files ─ models ─┐
//! run ─── live ───┤
//! page ───────────┴ routes ─ server ─ browser
//! ```
//!
//! `page.rs` is the built page, whose sources are in `apps/viewer`; `models.rs` makes one GLB file of each model; `live.rs` follows a running bake;
//! `routes.rs` says what may be asked for, `answer.rs` what comes back, and `server.rs` listens.
//!
//! Contract: the server listens on 127.0.0.1 alone. Every address begins with a token that is drawn anew for each
//! server, so that no other page can guess it. Models are asked for by number, never by path, and what the page may
//! do is bounded by its Content-Security-Policy: it cannot reach any other server.

mod answer;
mod error;
mod live;
mod models;
mod page;
mod routes;
mod server;

pub use error::ViewError;
pub use live::Live;
pub use server::{Server, View, open_browser};
