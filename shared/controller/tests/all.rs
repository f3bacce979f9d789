//! All integration tests of this crate, as one program.

mod axis;
mod bench;
mod cascade;
mod homing;
mod oracle;
mod pid;
mod profiles;
mod properties;
mod spool;
mod supervisor;
