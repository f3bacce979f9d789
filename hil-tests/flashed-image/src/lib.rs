//! The image that is flashed on the Nucleo board, executed on the PC with its plant at its pins.
//!
//! | module | holds |
//! |---|---|
//! | [`processor`] | executes the instructions of the image; exceptions |
//! | [`board`] | the peripherals at their addresses, and the time |
//! | [`peripheral`] | a model of each, with the section of the manual on top |
//! | [`bench`] | the plant and the wires to it |
//! | [`tap`] | when a run begins, heard on the line |
//! | [`image`] | the ELF file |
//! | [`line`] | the serial port, as a TCP port |
//! | [`machine`] | all of that, going on at its pace |
//! | [`target`] | the execution level of the tests |
//! | [`register`], [`time`] | what registers and instants are |

pub mod bench;
pub mod board;
pub mod image;
pub mod line;
pub mod machine;
pub mod peripheral;
pub mod processor;
pub mod register;
pub mod tap;
pub mod target;
pub mod time;
