//! All integration tests of this crate, as one program.

mod link;
mod wire_v1;
