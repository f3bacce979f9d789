//! Communication with a rig: ports, requests, downloads and streams.
//!
//! | module | holds |
//! |---|---|
//! | [`port`] | a byte link to a rig: a serial port, or TCP |
//! | [`client`] | requests, each repeated until it is answered |
//! | [`download`], [`part_file`] | which chunks of a record are there, and the file of an interrupted download |
//! | [`stream`] | which rows of a stream are there |
//! | [`failure`] | why a request failed |
//! | [`borrowed`] | parameters that are changed for a while, and given back even if the program is killed |
//! | [`bring_up`] | the checks of a new board, one after the other |
//! | [`test_run`], [`firmware_notes`] | a test made ready and started; notes on firmware that lacks something |
//!
//! Nothing is printed: notes go to the log.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod borrowed;
pub mod bring_up;
pub mod client;
pub mod download;
pub mod failure;
pub mod firmware_notes;
pub mod part_file;
pub mod port;
pub mod stream;
pub mod test_run;
