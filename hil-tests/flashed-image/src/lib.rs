//! The image that is flashed on the Nucleo board, executed on the PC with its plant at its pins.

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
