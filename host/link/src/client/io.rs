//! The digital inputs and outputs.

use anyhow::Result;
use pneudrive_protocol::{ReplyBody, RequestBody};

use super::Client;
use super::answer::unexpected;

/// The digital inputs and outputs of a drive, and the inputs' last order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Io {
    /// Inputs as they are read; [`input`](pneudrive_protocol::io::input) has their bits.
    pub inputs: u8,
    /// Inputs as they count: once they have been the same for a few samples.
    pub settled: u8,
    /// Outputs; [`output`](pneudrive_protocol::io::output) has their bits.
    pub outputs: u8,
    /// The number that was started last.
    pub number: u8,
    /// Why the last start was not carried out; 0: it was, or there was none.
    pub refused: u8,
}

impl Client {
    /// The inputs and outputs as they are.
    ///
    /// # Errors
    /// When the firmware has none, or does not answer.
    pub fn io(&mut self) -> Result<Io> {
        self.ask(RequestBody::Io, |reply| match *reply {
            ReplyBody::Io { inputs, settled, outputs, number, refused } => {
                Ok(Io { inputs, settled, outputs, number, refused })
            }
            ref other => Err(unexpected(other)),
        })
    }

    /// Sets the inputs of a rig that emulates them.
    ///
    /// # Errors
    /// When they are pins, or the firmware has none.
    pub fn set_inputs(&mut self, inputs: u8) -> Result<()> {
        self.ask_done(RequestBody::IoSet { inputs })
    }
}
