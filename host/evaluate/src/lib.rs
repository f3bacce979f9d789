//! What a transient tells, as a library: no command line and no port; nothing is printed.
//!
//! | module | holds |
//! |---|---|
//! | [`transient`], [`deviation`] | channels in engineering units, and how far two of them are apart |
//! | [`channel`] | a channel by its name, with its unit and its samples |
//! | [`alignment`] | two transients on one time |
//! | [`evaluation`], [`range`] | the figures of a transient's moves; a figure as a range over several runs |
//! | [`recorded_test`] | the test that a record was made with, for a simulation of it |
//! | [`replay`] | a TARGET file's inputs through the controller on the PC, compared with its outputs |
//! | [`known`] | what the law of a record knew, by its replay |
//! | [`spectrum`] | which frequencies a channel holds |
//! | [`report`] | the page of transients |
//! | [`parallel`] | the same for each of many, on several threads |
//! | [`cancel`] | the token by which a caller ends long work early |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod alignment;
pub mod cancel;
pub mod channel;
pub mod deviation;
pub mod evaluation;
pub mod known;
pub mod parallel;
pub mod range;
pub mod recorded_test;
pub mod replay;
pub mod report;
pub mod spectrum;
pub mod transient;
