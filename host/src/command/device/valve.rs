//! `pneudrive device valve`.

use anyhow::Result;
use pneudrive_link::client::Client;

use crate::cli::ValveAction;

pub(super) fn execute(client: &mut Client, action: ValveAction) -> Result<()> {
    match action {
        ValveAction::SeekNull => {
            client.seek_null()?;
            say!("the spool is stepping back to its null; once it is there, the drive can be armed");
        }
        ValveAction::AtNull => {
            client.at_null()?;
            say!("the current position of the spool is now its null");
        }
    }
    Ok(())
}
