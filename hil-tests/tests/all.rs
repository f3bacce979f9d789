//! All integration tests of this crate, as one program.

mod board_runner;
mod emulated_board;
mod golden;
mod instructions;
mod levels;
mod linked;
mod program;
mod requests;
mod wired;
