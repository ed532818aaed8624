//! The built command as scripts and people meet it: one program for all of them, since each
//! would be linked with everything anew.

#![allow(clippy::unwrap_used)]

mod batch;
mod check;
mod command;
mod common;
mod layouts;
mod lod;
mod parallax;
mod parts;
mod raycast;
mod real_models;
mod refusals;
mod reproduce;
mod schema;
mod skins;
mod stats;
mod turntable;
mod view;
