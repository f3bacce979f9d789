//! The page of the studio, and the answers to its requests.
//!
//! ```text
//! page (web/*.js)  ->  request  ->  rig file + settings  ->  simulation  ->  columns of numbers  ->  page
//! ```
//!
//! There is no server here, no file and no thread: the same answers come from `pneudrive studio` (`host/studio`) and from
//! the page itself where it has the designer with it as WebAssembly (`host/page/browser`). Nothing is kept between requests:
//! each brings the text of the rig file and the settings made on the page, so undo is the page's own affair.
//!
//! | module | holds |
//! |---|---|
//! | [`assets`] | the files of the page |
//! | [`answer`](mod@answer) | dispatches requests to their answers |
//! | [`page_rig`], [`refusal`] | the content of a request, and refusals |
//! | [`keys`], [`check`] | the table of keys, and the check of a rig: `rig explain` and `rig check` |
//! | [`rigs`] | the built-in rigs, and the text of a saved one |
//! | [`simulation`], [`columns`] | a run, its perturbed runs, and their numbers as bytes: `simulate` |
//! | [`compare`] | overlays a record on the page's run: `overlay` |
//! | [`spectrum`] | the spectrum of a channel of the run or the record: `spectrum` |
//! | [`difference`] | compares the page's rig with another, key by key: `rig diff` |
//! | [`study`] | long work on the page's rig: `sweep`, `tune`, `identify` |

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod answer;
pub mod assets;
pub mod check;
pub mod columns;
pub mod compare;
pub mod difference;
mod first_keys;
pub mod keys;
pub mod page_rig;
#[cfg(test)]
mod press;
pub mod refusal;
pub mod rigs;
pub mod simulation;
pub mod spectrum;
pub mod study;

pub use answer::{Answer, answer};
