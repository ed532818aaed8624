//! The UV optimiser through its public functions: one program for all of them, since each
//! would be linked with everything anew.

mod common;
mod contact;
mod contact_property;
mod gradients;
mod optimise;
mod optimise_random;
mod paper;
mod stages;
