//! The analysis of transients as a library: no command line and no port; nothing is printed.
//!
//! | module | holds |
//! |---|---|
//! | [`transient`], [`deviation`] | channels in engineering units, and how far two of them are apart |
//! | [`channel`] | a channel by its name, with its unit and its samples |
//! | [`alignment`] | two transients on one time |
//! | [`evaluation`] | the figures of a transient's moves |
//! | [`ensemble`], [`range`] | a run with its perturbed runs, and figures as ranges over them |
//! | [`recorded_test`] | the test that a record was made with, for a simulation of it |
//! | [`replay`] | a TARGET file's inputs through the controller on the PC, compared with its outputs |
//! | [`spectrum`] | which frequencies a channel holds |
//! | [`identification`] | parameters of a rig from its transients, with their uncertainties |
//! | [`sweep`] | many runs of one rig: what varies, what is collected, on all cores |
//! | [`tuning`] | gains for a step, on rigs within a spread |
//! | [`sensitivity`] | which value that nobody has measured moves the transient most |
//! | [`measured_points`] | measured points beside a computed curve |
//! | [`ladder`] | what each model of a component costs, and what it changes |
//! | [`study`] | the thesis's application studies: what it says, and what the model shows |
//! | [`thesis`] | the numbers of the thesis that the model can be held against, on one page |
//! | [`parallel`], [`runners`] | the same for each of many, on several threads; runs in the memory of those before |
//! | [`wanted`] | whether somebody still waits for long work |
//! | [`page`], [`report`] | notes, tables and graphs in one file; the page of transients |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod alignment;
pub mod channel;
pub mod deviation;
pub mod ensemble;
pub mod evaluation;
pub mod identification;
pub mod ladder;
pub mod measured_points;
pub mod page;
pub mod parallel;
pub mod range;
pub mod recorded_test;
pub mod replay;
pub mod report;
pub mod runnable;
pub mod runners;
pub mod sensitivity;
pub mod spectrum;
pub mod study;
pub mod sweep;
pub mod thesis;
pub mod transient;
pub mod tuning;
pub mod wanted;
