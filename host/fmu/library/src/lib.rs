//! The shared library that lies in each FMU: the functions of the standard, exported by their names in C.

pub use pneudrive_fmu::c_api;
