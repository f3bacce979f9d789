//! Transients in the files of other programs, and logs of other recorders as records.
//!
//! | module | holds |
//! |---|---|
//! | [`signals`] | the signals of a record, a streamed run or a simulated run, in SI units |
//! | [`export`] | the same as CSV, MAT (MATLAB, SciPy), MCAP (PlotJuggler, Foxglove) or Parquet |
//! | [`log`] | the series of a CSV or MCAP file of another recorder |
//! | [`column_map`] | the assignment of series to position, pressures and the like, with their units |
//! | [`import`] | a log as a TARGET file, for `overlay`, `eval`, `spectrum` and `identify` |
//!
//! Nothing is printed.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod column_map;
pub mod export;
pub mod import;
pub mod log;
pub mod signals;
