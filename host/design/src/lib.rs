//! From data sheets to a rig file, and the origins of a rig's values.
//!
//! | module | holds |
//! |---|---|
//! | [`breakaway`] | how long the air needs until a load breaks away |
//! | [`conductance`] | the flow figures of data sheets |
//! | `flow_answer` | a flow with the pressures that it holds for |
//! | [`flow_map`] | a measured map of a valve, from a table |
//! | [`question`], [`own_drive`] | the questions, and the rig file from their answers |
//! | [`rig_file`] | rig files that say where values come from |
//! | [`suggestion`] | answers that make a rig, near to some that make none |
//! | [`parts`] | the catalogue: cylinders, valves, tubes, sensors |
//! | [`values`] | every value of a rig, with where it comes from |
//! | [`difference`] | two rigs, key by key |
//! | [`six_drives`] | drives of the catalogue on which control laws are compared |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod breakaway;
pub mod conductance;
pub mod difference;
mod flow_answer;
pub mod flow_map;
pub mod own_drive;
pub mod parts;
pub mod question;
pub mod rig_file;
pub mod six_drives;
pub mod suggestion;
pub mod values;
