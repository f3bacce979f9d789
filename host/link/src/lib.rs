//! Communication with a rig: ports, requests, downloads and streams.
//!
//! | module | holds |
//! |---|---|
//! | [`port`] | a byte link to a rig: a serial port, or TCP |
//! | [`client`] | requests, each repeated until it is answered |
//! | [`download`] | which chunks of a record are there |
//! | [`stream`] | which rows of a stream are there |
//! | [`failure`] | why a request failed |
//!
//! Nothing is printed.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod client;
pub mod download;
pub mod failure;
pub mod port;
pub mod stream;
