//! What rigs say, what they have recorded and what was simulated, as files and as text: no port, no thread.
//!
//! | module | holds |
//! |---|---|
//! | [`rig_info`], [`record`] | what a rig says of itself, and the transient that it has recorded |
//! | [`target`] | TARGETxx.DAT: read, write, number |
//! | [`stream_file`] | a run as it is streamed to disk |
//! | [`run_folder`] | trace.csv and run.json of a simulated run: read, write |
//! | [`judged`], [`band`] | a run and how far it can be trusted, and what it and its neighbours cover |
//! | [`rig_text`] | rig files as text: other values, the same comments |
//! | [`words`] | what the codes of the controller mean |
//! | [`parameter_names`] | names and values of parameters as a person writes them |
//! | [`units`] | figures of a device in mm, kPa and s |
//! | [`window`] | windows of the controller's estimator |
//! | [`untrusted`] | texts of a device, made fit for a terminal and a file |
//! | [`whole_file`], [`own_file`] | files that are there whole or not at all, and which may be replaced |
//!
//! Nothing is printed: notes go to the log.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod band;
pub mod judged;
pub mod own_file;
pub mod parameter_names;
pub mod record;
mod record_text;
pub mod rig_info;
pub mod rig_text;
pub mod run_folder;
pub mod stream_file;
pub mod target;
pub mod units;
pub mod untrusted;
pub mod whole_file;
pub mod window;
pub mod words;
