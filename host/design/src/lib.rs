//! A drive of one's own: from data sheets to a rig file, and what its values rest on.
//!
//! | module | holds |
//! |---|---|
//! | [`values`] | every value of a rig, with where it comes from |
//! | [`difference`] | two rigs, key by key |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod difference;
pub mod values;
