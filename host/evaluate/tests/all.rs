//! All integration tests of this crate, as one program.

mod converged;
mod evaluation;
mod own_drives;
mod pairs;
mod replay;
mod rest;
mod watched;
