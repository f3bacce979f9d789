//! The record of the last test, as a TARGET file for the page.

use anyhow::{Error, Result};
use pneudrive_link::client::Client;
use pneudrive_session::record::to_memory;
use serde_json::{Value, json};

use super::drive_view::Reporter;
use super::order::Orders;

/// The answer to a page that wants to move the drive meanwhile.
const BUSY: &str = "not now: the record is being read";

/// Downloads the record. Its name contains its CRC, so the same record has the same name.
///
/// # Errors
/// When there is no record, the rig does not answer, or the page ends the download ([`Ended`](super::ended::Ended)).
pub fn record(client: &mut Client, orders: &mut Orders<'_>, reporter: &Reporter<'_>) -> Result<Value> {
    let (crc32, file) = to_memory(client, &mut |_, _| {
        let heard = orders.goes_on();
        if orders.has_refused() {
            reporter.tell(BUSY);
        }
        heard.map_err(Error::from)
    })?;
    let name = format!("TARGET-{crc32:08x}.DAT");
    Ok(json!({ "name": name, "text": file.to_text(), "samples": file.samples.len() }))
}
