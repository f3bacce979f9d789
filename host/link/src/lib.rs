//! What talks to a rig: a port, the requests over it, and what comes back in many pieces.
//!
//! | module | holds |
//! |---|---|
//! | [`port`] | a byte link to a rig: a serial port, or TCP |
//! | [`client`] | requests, each asked again until it is answered |
//! | [`download`], [`part_file`] | which chunks of a record are there, and what an interrupted download has left |
//! | [`stream`] | which rows of a stream are there |
//! | [`failure`] | why a request came to nothing |
//!
//! Nothing is printed: notes go to the log.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod client;
pub mod download;
pub mod failure;
pub mod part_file;
pub mod port;
pub mod stream;
