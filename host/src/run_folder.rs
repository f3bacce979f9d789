//! The folder of a simulated run: trace.csv and run.json, band.csv where the run has neighbours, and its page.
//!
//! They are one thing: they are replaced together (`replacement.rs`), run.json has the checksums of trace.csv and band.csv,
//! and the page has the identity of its run, [`IDENTITY`].

mod numbering;
mod replacement;
mod stored;

pub use crate::own_file::{make_writable, refuse_foreign};
pub use crate::whole_file::{put, put_pieces};
pub use numbering::{Existing, Numbered, refuse_other_rig};
pub use stored::{StoredRun, is_trace, rig_of};

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use crc::{CRC_64_XZ, Crc};
use pneudrive_controller::parameters::TABLE;
use pneudrive_sim::key::Typed;
use pneudrive_sim::keys;
use pneudrive_sim::rig::{Fields, Value};
use pneudrive_sim::trace::{COLUMNS, to_csv_with};
use pneudrive_sim::{Decision, Rig};
use serde_json::{Map, json};

use crate::band::{self, Band};
use crate::ensemble::Judged;
use crate::page::{GENERATOR, Page};
use crate::whole_file::is_device;
use crate::words;
use replacement::Replacement;

/// The page's mark that tells of which run it is; run.json has the same under `identity`.
pub const IDENTITY: &str = "pneudrive-run";

const TRACE: &str = "trace.csv";
const BAND: &str = "band.csv";
const RUN: &str = "run.json";
const PAGE: &str = "report.html";

/// Where run.json has the checksums of the other files.
const CHECKSUMS: &str = "checksums";

/// `format` of run.json.
const FORMAT: &str = "pneudrive-run 1";

/// `controller.loop` of a run whose moves are commands.
const OPEN: &str = "open";

/// Keys of the windows over which the controller forms velocity and acceleration.
static WINDOWS: [&Typed<i64>; 2] =
    [&keys::controller::VELOCITY_WINDOW_SAMPLES, &keys::controller::ACCELERATION_WINDOW_SAMPLES];

/// Writes trace.csv, run.json and, if there is a band, band.csv of a run into a folder, and its page if it has one; all of
/// them or none, and none of another run stays. `moves` are those of the run and its neighbours as run.json has
/// them: [`to_json`](crate::evaluation::to_json) makes them. Tells the number of the run.
///
/// # Errors
/// When the folder cannot be written to, holds a file of such a name that is not ours, or the run of another rig that is
/// to be kept.
pub fn write(
    folder: &Path,
    rig: &Rig,
    judged: &Judged,
    moves: serde_json::Value,
    page: Option<&Page>,
    existing: Existing,
) -> Result<u64> {
    refuse_others(folder)?;
    let numbered = Numbered::next(folder, rig, existing)?;
    let trace = to_csv_with(&judged.run.rows, &judged.columns);
    let band = judged.band.as_ref().map(Band::to_csv);
    let mut description = describe(rig, judged, moves, &numbered);
    let identity = checksum(&format!("{trace}{}{}", band.as_deref().unwrap_or(""), description["keys"]));
    description[CHECKSUMS] = json!({ TRACE: checksum(&trace), BAND: band.as_deref().map(checksum) });
    description["identity"] = json!(identity);
    let mut set = Replacement::begin(folder)?;
    set.add(TRACE, &[trace.as_bytes()])?;
    if let Some(band) = band {
        set.add(BAND, &[band.as_bytes()])?;
    }
    if let Some(page) = page {
        let mark = format!("<meta name=\"{IDENTITY}\" content=\"{identity}\">");
        let pieces = page.pieces(&mark, None)?;
        set.add(PAGE, &pieces.each_ref().map(|piece| piece.as_bytes()))?;
    }
    set.add(RUN, &[(serde_json::to_string_pretty(&description)? + "\n").as_bytes()])?;
    set.commit()?;
    Ok(numbered.run)
}

/// Refuses to replace files that are somebody's own.
fn refuse_others(folder: &Path) -> Result<()> {
    // The files of a run are replaced, whatever they are.
    if let Some(device) =
        [TRACE, BAND, RUN, PAGE].map(|name| folder.join(name)).iter().find(|path| is_device(path))
    {
        bail!("{} is no file; choose another folder", device.display());
    }
    let json_path = folder.join(RUN);
    if json_path.exists() && read_json(&json_path).is_err() {
        bail!("{} is not of this program; choose another folder", json_path.display());
    }
    refuse_foreign(&folder.join(TRACE), &COLUMNS.join(","))?;
    refuse_foreign(&folder.join(BAND), &band::header())?;
    refuse_foreign(&folder.join(PAGE), GENERATOR)
}

/// A checksum as run.json has it: CRC-64 (XZ), in hexadecimal digits.
fn checksum(text: &str) -> String {
    const CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);
    format!("{:016x}", CRC.checksum(text.as_bytes()))
}

fn describe(rig: &Rig, judged: &Judged, moves: serde_json::Value, numbered: &Numbered) -> serde_json::Value {
    let (run, accuracy) = (&judged.run, judged.accuracy);
    let keys: Map<String, serde_json::Value> =
        rig.entries().map(|(key, value)| (key.path.to_owned(), json_of(value))).collect();
    let parameters = rig.parameters();
    let controller: Map<String, serde_json::Value> = TABLE
        .iter()
        .filter(|parameter| parameter.len == 1)
        .filter_map(|parameter| Some((parameter.name.to_owned(), json!(parameters.get(parameter.id)?))))
        .collect();
    let work = run.work;
    json!({
        "format": FORMAT,
        "program": format!("pneudrive {}", env!("CARGO_PKG_VERSION")),
        "rig": rig.name(),
        "method": format!("{:?}", accuracy.method),
        "tolerance": accuracy.tolerance,
        "samples": run.observations.len(),
        "rows": run.rows.len(),
        "decided": judged.decision.is_decided(),
        "undecided_from_s": judged.decision.undecided_from_s,
        "closest_edge": closest_edge(&judged.decision),
        "position_error_m": judged.decision.error_m,
        "ensemble": judged.band.as_ref().map(|_| json!({
            "runs": judged.spacing.runs,
            "relative_change": judged.spacing.relative,
            "tripped": judged.lost.tripped.iter().map(|fault| words::fault_name(*fault)).collect::<Vec<_>>(),
            "not_simulated": judged.lost.failed,
        })),
        "moves": moves,
        "fault": run.fault.map(|(fault, k)| json!({ "name": words::fault_name(fault), "sample": k })),
        "work": {
            "steps": work.integrator.n_steps,
            "rejected": work.integrator.n_rejected_steps,
            "evaluations": work.integrator.n_rhs_evaluations,
            "restarts": work.integrator.n_restarts,
            "events": work.integrator.n_events,
            "flow_solutions": work.network.solutions,
            "flow_iterations": work.network.iterations,
        },
        "controller": controller,
        "keys": keys,
        "run": numbered.run,
        "date": numbered.date,
    })
}

fn closest_edge(decision: &Decision) -> Option<serde_json::Value> {
    decision.closest_edge.map(|edge| json!({ "distance_m": edge.distance_m, "at_s": edge.at_s }))
}

fn json_of(value: &Value) -> serde_json::Value {
    match value {
        Value::Number(value) => json!(value),
        Value::Integer(value) => json!(value),
        Value::Switch(on) => json!(on),
        Value::Word(word) => json!(word),
        Value::Integers(values) => json!(values),
        Value::Numbers(values) => json!(values),
        Value::Moves(moves) => json!(moves),
        Value::Events(events) => events.iter().map(json_of_event).collect(),
    }
}

fn json_of_event(fields: &Fields) -> serde_json::Value {
    fields.iter().map(|(name, value)| ((*name).to_owned(), json_of(value))).collect()
}

fn read_json(path: &Path) -> Result<serde_json::Value> {
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let value: serde_json::Value =
        serde_json::from_str(&text).with_context(|| format!("{} is not JSON", path.display()))?;
    if value["format"] != FORMAT {
        bail!("{} is not a run of this program: its format is not {FORMAT:?}", path.display());
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ensemble::{Spacing, run_ensemble};
    use pneudrive_sim::Accuracy;
    use pneudrive_sim::rig::BUILTIN;

    #[test]
    fn the_rig_of_a_run_folder_is_the_rig_that_was_run() {
        let folder = tempfile::tempdir().expect("a folder");
        let fault = "\n[[faults.event]]\nkind = \"supply-dip\"\nat_s = 0.01\npressure_pa = 4e5\n";
        let with_fault = Rig::read("dips", fault).unwrap_or_else(|problems| panic!("{problems}"));
        let built_in = BUILTIN.iter().map(|(name, _)| Rig::builtin(name).expect("a built-in rig"));
        for rig in built_in.chain([with_fault]) {
            let rig = rig.with_numbers(&[("test.duration_s", 0.03)]).unwrap_or(rig);
            let spacing = Spacing { runs: 2, ..Spacing::default() };
            let ensemble = run_ensemble(&rig, Accuracy::of(&rig), spacing, |_, _| (), |_, _| {});
            write(
                folder.path(),
                &rig,
                &ensemble.expect("runs").nominal,
                json!([]),
                None,
                Existing::Overwrite,
            )
            .expect("written");
            let read = rig_of(folder.path()).unwrap_or_else(|error| panic!("{}: {error:#}", rig.name()));
            for (key, value) in rig.entries() {
                assert_eq!(read.value(key.path), Some(value), "{}: {}", rig.name(), key.path);
            }
            let stored = StoredRun::read(folder.path()).expect("a run folder");
            assert_eq!((stored.spacing, stored.accuracy), (Some(spacing), Some(Accuracy::of(&rig))));
        }
    }
}
