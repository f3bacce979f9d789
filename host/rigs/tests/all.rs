//! All integration tests of this crate, as one program.

mod following;
mod holding;
mod throughput;
