//! The components of a drive, one file each: its equations with their numbers in the thesis, its keys in a rig file with
//! their constraints, and its construction from them.

pub mod actuator;
pub mod air;
pub mod controller;
pub mod dither;
pub mod encoder;
pub mod exhaust;
pub mod faults;
pub mod friction;
pub mod gas;
pub mod load;
pub mod operator;
pub mod play;
pub mod safety;
pub mod sensors;
pub mod stop;
pub mod supply;
pub mod tubing;
pub mod valve;
