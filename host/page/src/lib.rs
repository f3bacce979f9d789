//! The page of the studio, and the answers to what it asks.
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
//! | [`answer`](mod@answer) | which request is answered by what |
//! | [`asked`], [`refusal`] | what a request brings, and how it is refused |
//! | [`keys`], [`check`] | the table of keys, and a rig held against it: those of `rig explain` and `rig check` |
//! | [`rigs`] | the rigs that come with the program, and the text of one that is saved |
//! | [`simulation`], [`columns`] | a run, its perturbed runs, and their numbers as bytes: those of `simulate` |
//! | [`compare`] | a record laid over the run of the page: `overlay` |
//! | [`spectrum`] | which frequencies a channel of the run or of the record holds: `spectrum` |
//! | [`difference`] | the rig of the page and another, key by key: `rig diff` |
//! | [`study`] | long work on the rig of the page: `sweep`, `tune`, `identify` |

#![forbid(unsafe_code)]

pub mod answer;
pub mod asked;
pub mod assets;
pub mod check;
pub mod columns;
pub mod compare;
pub mod difference;
pub mod keys;
pub mod refusal;
pub mod rigs;
pub mod simulation;
pub mod spectrum;
pub mod study;

pub use answer::{Answer, answer};
