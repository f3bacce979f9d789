//! All integration tests of this crate, as one program.

mod chip_bus;
mod digital_pins;
mod failing_bus;
mod ls7366r;
mod mcp3208;
mod mcp4922;
mod ssi;
mod stages;
mod step_pins;
mod wiper;
