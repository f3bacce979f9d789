//! All integration tests of this crate, as one program.

mod echo;
mod faulty_link;
mod record_head;
mod repeats;
mod simulated_link;
mod stream_in_pieces;
mod versions;
mod watchdog;
