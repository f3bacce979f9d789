//! All integration tests of this crate, as one program.

mod all_states;
mod hosts;
mod mutants;
