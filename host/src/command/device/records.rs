//! `pneudrive device records`.

use std::path::Path;

use anyhow::Result;
use pneudrive_controller::Move;
use pneudrive_link::client::Client;
use pneudrive_records::move_records::{MoveRecord, in_words, record_by_settings, records_of};
use pneudrive_records::text_file;
use pneudrive_records::units::Units;
use serde_json::{Value, json};

use super::units;
use crate::cli::RecordsAction;
use crate::json;

pub(super) fn execute(client: &mut Client, action: &RecordsAction, counts: bool) -> Result<()> {
    match action {
        RecordsAction::Show => show(client, counts),
        RecordsAction::Set { number, settings } => {
            let record = record_by_settings(*number, settings, &client.parameters()?)?;
            client.put_move_records(&[record])?;
            let units = units::of(client, counts);
            json::figures(|| json!({ "records": [figures(&record, &units)] }));
            say!("{}", in_words(&record, &units).trim_start());
            Ok(())
        }
        RecordsAction::Remove { number } => {
            client.remove_move_record(*number)?;
            say!("there is no record {number} any more");
            Ok(())
        }
        RecordsAction::Load { file } => load(client, file),
        RecordsAction::Save => {
            client.move_records()?;
            client.save_parameters()?;
            say!("stored with the parameters; they survive a reset");
            Ok(())
        }
    }
}

fn show(client: &mut Client, counts: bool) -> Result<()> {
    let records = client.move_records()?;
    let units = units::of(client, counts);
    if records.is_empty() {
        say!("no records; `pneudrive device records set 1 to_mm=120` makes one");
    }
    for record in &records {
        say!("{}", in_words(record, &units));
    }
    let saved = client.config_state()?.saved;
    let all = || records.iter().map(|record| figures(record, &units)).collect::<Vec<_>>();
    json::figures(|| json!({ "records": all(), "saved": saved }));
    if !saved {
        say!(
            "not stored since the last change; `pneudrive device records save` stores records and parameters"
        );
    }
    Ok(())
}

fn figures(record: &MoveRecord, units: &Units) -> Value {
    let Move { target, profile, .. } = record.next;
    json!({
        "number": record.number,
        "target_counts": target,
        "target_mm": units.millimetres(target),
        "profile_samples": profile.samples(),
        "dwell_samples": record.dwell,
        "words": in_words(record, units).trim_start(),
    })
}

fn load(client: &mut Client, file: &Path) -> Result<()> {
    let source = file.display().to_string();
    let text = text_file::read(file)?;
    let records = records_of(&source, &text, &client.parameters()?)?;
    client.replace_move_records(&records)?;
    say!(
        "{source}: {} records are the table now; `pneudrive device records save` stores them",
        records.len()
    );
    Ok(())
}
