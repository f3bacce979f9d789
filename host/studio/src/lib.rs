//! `pneudrive studio`: a drive designed, tried out and commissioned in the browser.
//!
//! ```text
//! page (web/*.js)  ->  guard  ->  rig file + settings  ->  simulation  ->  columns of numbers  ->  page
//! ```
//!
//! The server keeps no rig: every request brings the text of the rig file and the settings made on the page, so undo is the
//! page's own affair and a killed server loses nothing. Keys, units, checks and figures are those of `rig explain`,
//! `rig check` and `simulate`.
//!
//! | module | holds |
//! |---|---|
//! | [`token`], [`guard`] | who may ask, and what every answer says to the browser |
//! | [`assets`] | the page, embedded in the program |
//! | [`asked`], [`refusal`] | what a request brings, and how it is refused |
//! | [`keys`], [`check`] | the table of keys, and a rig held against it |
//! | [`simulation`], [`columns`] | a run, its neighbours, and their numbers as bytes |
//! | [`files`] | rig files that are opened and saved |
//! | [`compare`] | a record laid over the run of the page |
//! | [`commission`] | a rig at a port, moved from the page |
//! | [`server`] | the routes, and the address |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod asked;
pub mod assets;
pub mod check;
pub mod columns;
pub mod commission;
pub mod compare;
pub mod files;
pub mod guard;
pub mod keys;
pub mod refusal;
pub mod server;
pub mod simulation;
pub mod token;

pub use server::{Options, Studio};
