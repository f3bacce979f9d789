//! The spool of a stepper valve after a reset.

use anyhow::Result;
use pneudrive_protocol::RequestBody;

use super::Client;

impl Client {
    /// Steps the spool back to its null from its position before the reset.
    ///
    /// # Errors
    /// When it is refused or not answered.
    pub fn seek_null(&mut self) -> Result<()> {
        self.ask_done(RequestBody::SeekNull)
    }

    /// Declares that the spool is at its null.
    ///
    /// # Errors
    /// When it is refused or not answered.
    pub fn at_null(&mut self) -> Result<()> {
        self.ask_done(RequestBody::AtNull)
    }
}
