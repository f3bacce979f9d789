//! What the boards compute for their hardware, without the hardware: the PC tests it, the images write the results into
//! registers.
#![no_std]
#![forbid(unsafe_code)]

pub mod nucleo;
pub mod pico2;
pub mod range;
