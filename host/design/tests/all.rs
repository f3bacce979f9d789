//! All integration tests of this crate, as one program.

mod drawn;
mod drawn_drives;
mod equations;
mod independent;
mod outcome;
