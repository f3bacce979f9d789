//! Evaluation of transients, as a library: no command line and no port; nothing is printed.
//!
//! | module | holds |
//! |---|---|
//! | [`transient`], [`deviation`] | channels in engineering units, and how far two of them are apart |
//! | [`channel`] | a channel by its name, with its unit and its samples |
//! | [`alignment`] | two transients on one time |
//! | [`evaluation`], [`range`] | the figures of a transient's moves; a figure as a range over several runs |
//! | [`recorded_test`] | the test that a record was made with, for a simulation of it |
//! | [`recorded_run`] | a simulated run as the TARGET file that a rig would record of it |
//! | [`replay`] | a TARGET file's inputs through the controller on the PC, compared with its outputs |
//! | [`known`] | what the law of a record knew, by its replay |
//! | [`spectrum`] | amplitudes of a channel over frequency |
//! | [`report`] | the page of transients |
//! | [`parallel`] | the same for each of many, on several threads |
//! | [`cancel`] | the token by which a caller ends long work early |
//!
//! The result of a run, in one sentence and in figures:
//!
//! ```
//! use pneudrive_evaluate::evaluation::{moves_of_run, tolerance_mm, verdict};
//! use pneudrive_sim::{Accuracy, Rig, run};
//!
//! let rig = Rig::builtin("press").expect("a built-in rig");
//! let moves = moves_of_run(&rig, &run(&rig, Accuracy::of(&rig))?);
//! let stroke = moves.last().expect("a move");
//! assert_eq!(stroke.to_mm, Some(187.5));
//! assert!(stroke.settling_s.is_some_and(|settling| settling < 0.4));
//! assert!(verdict(&[moves], tolerance_mm(Some(&rig))).starts_with("settles within 0.05 mm"));
//! # Ok::<(), pneudrive_sim::IntegrationError>(())
//! ```
//!
//! `examples/simulate.rs` prints this for any rig file.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod alignment;
pub mod cancel;
pub mod channel;
pub mod deviation;
pub mod evaluation;
pub mod known;
pub mod parallel;
pub mod range;
pub mod recorded_run;
pub mod recorded_test;
pub mod replay;
pub mod report;
pub mod spectrum;
pub mod transient;
