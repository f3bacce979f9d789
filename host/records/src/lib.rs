//! The data of rigs, records and simulated runs, as files and as text: no port, no thread.
//!
//! | module | holds |
//! |---|---|
//! | [`rig_info`], [`record`] | the identity and parameters of a rig, and the transient that it has recorded |
//! | [`target`] | TARGETxx.DAT: read, write, number |
//! | [`stream_file`] | a run that is streamed to disk |
//! | [`run_folder`] | trace.csv and run.json of a simulated run: read, write |
//! | [`judged`], [`band`] | a run and how far it can be trusted, and the range of the run and its perturbed runs |
//! | [`rig_source`], [`rig_text`] | rig files by name, and as text: new values, the same comments |
//! | [`words`] | the meaning of the controller's codes |
//! | [`parameter_names`] | names and values of parameters as in rig files |
//! | [`move_points`] | a path through points, as a table of times and positions |
//! | [`move_records`] | move records of a drive as text |
//! | [`units`] | figures of a device in mm, kPa and s |
//! | [`window`] | windows of the controller's estimator |
//! | [`untrusted`] | texts of a device, made safe for a terminal and a file |
//! | [`whole_file`], [`own_file`] | files that are written whole or not at all, and which ones may be replaced |
//!
//! Nothing is printed: notes go to the log.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod band;
pub mod judged;
pub mod move_points;
pub mod move_records;
pub mod own_file;
pub mod parameter_names;
pub mod record;
mod record_text;
pub mod rig_info;
pub mod rig_source;
pub mod rig_text;
pub mod run_folder;
pub mod stream_file;
pub mod target;
pub mod test_lines;
pub mod text_file;
pub mod units;
pub mod untrusted;
pub mod whole_file;
pub mod window;
pub mod words;
