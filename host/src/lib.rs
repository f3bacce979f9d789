//! What the `pneudrive` command does, as functions that others can call.
//!
//! | module | holds |
//! |---|---|
//! | [`cli`], [`command`] | arguments, and one thin file a subcommand |
//! | [`mod@output`], [`exit`] | what the program says, and how it ends |
//! | [`port`], [`client`] | a byte link to a rig, and the requests over it |
//! | [`download`], [`stream`] | which chunks of a record, and which rows of a stream, are there |
//! | [`rig_info`], [`record`] | what a rig says of itself, and the transient that it has recorded |
//! | [`part_file`] | what an interrupted download has left |
//! | [`virtual_rig`] | the firmware's application on the simulated plant |
//! | [`emulated_board`] | the image of the firmware in QEMU, on the simulated plant |
//! | [`board_plant`] | the simulated plant of a real board, over its second serial port |
//! | [`kept_flash`] | their flash, which outlives them |
//! | [`punctuality`] | how they keep time |
//! | [`target`] | TARGETxx.DAT: read, write, number |
//! | [`stream_file`] | a run as it is streamed to disk |
//! | [`whole_file`] | files that are there whole or not at all |
//! | [`run_folder`] | trace.csv and run.json: read, write |
//! | [`ensemble`], [`band`], [`range`] | a run with its neighbours, what they cover, and figures as ranges over them |
//! | [`transient`], [`deviation`] | channels in engineering units, and how far two of them are apart |
//! | [`replay`] | a TARGET file's inputs through the controller on the PC, compared with its outputs |
//! | [`alignment`] | two transients on one time |
//! | [`spectrum`] | which frequencies a channel holds |
//! | [`identification`] | parameters of a rig from its transients, with their uncertainties |
//! | [`evaluation`] | what a transient tells about its moves |
//! | [`study`] | the thesis's application studies: what it says, and what the model shows |
//! | [`thesis`] | the numbers of the thesis that the model can be held against, on one page |
//! | [`sweep`] | many runs of one rig: what varies, what is collected, on all cores |
//! | [`ladder`] | what each model of a component costs, and what it changes |
//! | [`parallel`] | the same for each of many, on several threads |
//! | [`tuning`] | gains for a step, at the worst of all rigs within a spread |
//! | [`rig_text`] | rig files as text: other values, the same comments |
//! | [`page`] | notes, tables and graphs in one file |
//! | [`report`] | the page of transients |

// Whoever prints by these panics when nobody reads it: `say!` and `tell!` do not.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[macro_use]
pub mod output;

pub mod alignment;
pub mod band;
#[cfg(unix)]
pub mod board_plant;
pub mod cli;
pub mod client;
pub mod command;
pub mod deviation;
pub mod download;
#[cfg(unix)]
pub mod emulated_board;
pub mod ensemble;
pub mod evaluation;
pub mod exit;
pub mod identification;
pub mod kept_flash;
pub mod ladder;
mod noise;
pub mod page;
pub mod parallel;
pub mod part_file;
#[cfg(unix)]
mod plant_server;
pub mod port;
pub mod punctuality;
pub mod range;
pub mod recorded_test;
pub mod replay;
pub mod report;
pub mod rig_text;
pub mod run_folder;
#[cfg(unix)]
mod sample_cost;
pub mod spectrum;
pub mod stream;
pub mod study;
pub mod sweep;
pub mod thesis;
pub mod transient;
pub mod tuning;
pub mod virtual_rig;
mod words;

use pneudrive_records::{foreign, own_file, parameter_names, units, window};
pub use pneudrive_records::{record, rig_info, stream_file, target, whole_file};
