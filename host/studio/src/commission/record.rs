//! The record of the last test, as a TARGET file for the page.

use anyhow::{Error, Result};
use pneudrive_link::client::{Client, Pieces};
use pneudrive_records::target::TargetFile;
use serde_json::{Value, json};

use super::order::Orders;
use super::seen::Teller;

/// What a page is told that wants to move the drive meanwhile.
const BUSY: &str = "not now: the record is being read";

/// Downloads the record; its name in the answer is that of its CRC, so the same record has the same name.
///
/// # Errors
/// When there is none, the rig does not answer, or the page ends it ([`Ended`](super::ended::Ended)).
pub fn record(client: &mut Client, orders: &mut Orders<'_>, teller: &Teller<'_>) -> Result<Value> {
    let info = client.info()?;
    let parameters = client.parameters()?;
    let mut hear = || {
        let heard = orders.goes_on();
        if orders.has_refused() {
            teller.tell(BUSY);
        }
        heard.map_err(Error::from)
    };
    let head = client.record_head_while(&mut hear)?;
    let test = client.test()?;
    let none = Pieces::none(head.samples);
    let record = client.download(&head, none, |_, _| hear())?;
    let file = TargetFile::new(&record, &info, &parameters)?.with_test(test.as_ref());
    let name = format!("TARGET-{:08x}.DAT", head.crc32);
    Ok(json!({ "name": name, "text": file.to_text(), "samples": file.samples.len() }))
}
