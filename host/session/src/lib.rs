//! What is done with a rig at a port: the command and the Python package do it in the same way. The studio shares the record, the
//! bring-up, the slow moves and the wait for a stepper; it arms and runs in steps of its own, as its page may withdraw an
//! order in between.
//!
//! | module | holds |
//! |---|---|
//! | [`test_run`], [`streaming`] | a test checked, made ready, started and followed, and the file that it is streamed to |
//! | [`slow_move`] | a drive moved by hand: slowly to a place, or by a stretch |
//! | [`record`], `part_file` | the record of the last run as a TARGET file, and what an interrupted download has left |
//! | [`drive`] | a drive armed, and told where its axis stands |
//! | [`bring_up`] | the checks of a new board, one after the other |
//! | [`borrowed`] | parameters that are changed for a while, and given back even if the program is killed |
//! | [`state`] | where programs of this user keep what must outlast them |
//! | [`firmware_notes`] | notes on firmware that lacks something |
//!
//! A test is made ready, run to its end and recorded; the rig is a virtual one here:
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//!
//! use pneudrive_link::client::Client;
//! use pneudrive_protocol::Mode;
//! use pneudrive_rigs::virtual_rig::Background;
//! use pneudrive_session::{record, test_run::TestRun};
//!
//! let rig = pneudrive_sim::Rig::builtin("servo-b-tuned").expect("a built-in rig");
//! let served = Background::of(rig.clone())?;
//! let mut client = Client::connect(served.port())?;
//! let test = TestRun::of(&rig).prepare(&mut client, None)?;
//! let ran = test.run(&mut client, &AtomicBool::new(false), &mut || Ok(()), |_| {});
//! assert_eq!(ran.ended?, Mode::Done);
//! let folder = tempfile::tempdir()?;
//! let (path, file) = record::to_folder(&mut client, folder.path(), &mut |_, _| Ok(()))?;
//! assert!(path.ends_with("TARGET01.DAT"));
//! assert_eq!(file.samples.len(), 1 + rig.last_sample() as usize);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/drive_a_rig.rs` compares such a record with the simulation.
//!
//! Requests, downloads and streams are `pneudrive_link`'s. Nothing is printed: notes go to the log.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod borrowed;
pub mod bring_up;
pub mod drive;
pub mod firmware_notes;
mod part_file;
pub mod record;
pub mod slow_move;
pub mod state;
pub mod streaming;
pub mod test_run;
