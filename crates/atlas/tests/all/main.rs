//! Layouts through public functions, most of them random: one program for all of them, since each
//! would be linked with everything anew.

mod check_random;
mod pack_random;
mod repair_random;
mod tutte;
