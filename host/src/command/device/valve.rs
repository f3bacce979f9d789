//! `pneudrive device valve`.

use anyhow::Result;
use pneudrive_link::client::Client;

use crate::cli::ValveAction;

pub(super) fn execute(client: &mut Client, action: ValveAction) -> Result<()> {
    match action {
        ValveAction::SeekNull => {
            client.seek_null()?;
            say!("the spool walks back to its null; then the drive can be armed");
        }
        ValveAction::AtNull => {
            client.at_null()?;
            say!("the spool is taken to be at its null from here on");
        }
    }
    Ok(())
}
