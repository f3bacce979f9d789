//! The folder of a simulated run: trace.csv and run.json, band.csv where the run has perturbed runs, and its page.
//!
//! The files form a unit: they are replaced together (`replacement.rs`), run.json has the checksums of trace.csv and
//! band.csv, and the page has the identity of its run, [`IDENTITY`].

mod checksum;
mod description;
mod holding;
mod json_file;
mod numbering;
mod replacement;
mod stored;

pub use holding::Holding;
pub use numbering::{Existing, Numbered, refuse_other_rig};
pub use stored::{StoredRun, is_trace, rig_of};

use std::path::Path;

use anyhow::{Result, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::key::Typed;
use pneudrive_sim::keys;
use pneudrive_sim::trace::{COLUMNS, to_csv_with};
use serde_json::json;

use crate::judged::Judged;
use crate::own_file::{GENERATOR, refuse_to_replace};

use crate::band::{self, Band};
use crate::whole_file::is_device;
use checksum::checksum;
use description::describe;
use json_file::read_json;
use replacement::Replacement;

/// Makes a run's page with the given mark in its head, for a run of this number and date.
pub type PageOf<'a> = &'a dyn Fn(&str, &Numbered) -> Result<String>;

/// The mark of a page that identifies its run; run.json has the same under `identity`.
pub const IDENTITY: &str = "pneudrive-run";

const TRACE: &str = "trace.csv";
const BAND: &str = "band.csv";
const RUN: &str = "run.json";
const PAGE: &str = "report.html";

/// The field of run.json with the checksums of the other files.
const CHECKSUMS: &str = "checksums";

/// `format` of run.json.
pub const FORMAT: &str = "pneudrive-run 1";

/// `controller.loop` of a run whose moves are commands.
const OPEN: &str = "open";

/// Keys of the windows over which the controller estimates velocity and acceleration.
static WINDOWS: [&Typed<i64>; 2] =
    [&keys::controller::VELOCITY_WINDOW_SAMPLES, &keys::controller::ACCELERATION_WINDOW_SAMPLES];

/// Writes trace.csv, run.json and, if there is a band, band.csv of a run to a folder, and its page if it has one; all of
/// them or none, and no file of another run stays. `moves` are those of the run and its perturbed runs in the form of
/// run.json. Returns the number of the run.
///
/// # Errors
/// When the folder cannot be written to, or holds a file of such a name that is not ours, or a run of another rig that
/// is to be kept.
pub fn write(
    folder: &Path,
    rig: &Rig,
    judged: &Judged,
    moves: serde_json::Value,
    page: Option<PageOf<'_>>,
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
        set.add(PAGE, &[page(&mark, &numbered)?.as_bytes()])?;
    }
    set.add(RUN, &[(serde_json::to_string_pretty(&description)? + "\n").as_bytes()])?;
    set.commit()?;
    Ok(numbered.run)
}

/// Refuses to replace files that this program has not written.
fn refuse_others(folder: &Path) -> Result<()> {
    // The files of a run are replaced by renaming, which would remove a device.
    if let Some(device) =
        [TRACE, BAND, RUN, PAGE].map(|name| folder.join(name)).iter().find(|path| is_device(path))
    {
        bail!("{} is not a file; choose another folder", device.display());
    }
    let json_path = folder.join(RUN);
    if json_path.exists() && read_json(&json_path).is_err() {
        bail!("{} was not written by this program; choose another folder", json_path.display());
    }
    refuse_to_replace(&folder.join(TRACE), &COLUMNS.join(","))?;
    refuse_to_replace(&folder.join(BAND), &band::header())?;
    refuse_to_replace(&folder.join(PAGE), GENERATOR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judged::{FailedMembers, Spacing};
    use pneudrive_sim::rigfile::BUILTIN;
    use pneudrive_sim::{Accuracy, Convergence, run};

    #[test]
    fn the_rig_of_a_run_folder_is_the_rig_that_was_run() {
        let folder = tempfile::tempdir().expect("a folder");
        let fault = "\n[[faults.event]]\nkind = \"supply-dip\"\nat_s = 0.01\npressure_pa = 4e5\n";
        let with_fault = Rig::read("dips", fault).unwrap_or_else(|problems| panic!("{problems}"));
        let built_in = BUILTIN.iter().map(|(name, _)| Rig::builtin(name).expect("a built-in rig"));
        for rig in built_in.chain([with_fault]) {
            let rig = rig.with_numbers(&[("test.duration_s", 0.03)]).unwrap_or(rig);
            let (accuracy, spacing) = (Accuracy::of(&rig), Spacing { runs: 2, ..Spacing::default() });
            let run = run(&rig, accuracy).expect("a run");
            let (convergence, band) = (Convergence::UNKNOWN, Some(Band::of(&run)));
            let (lost, columns) = (FailedMembers::default(), Vec::new());
            let judged = Judged { run, accuracy, convergence, band, spacing, lost, columns };
            write(folder.path(), &rig, &judged, json!([]), None, Existing::Overwrite).expect("written");
            let read = rig_of(folder.path()).unwrap_or_else(|error| panic!("{}: {error:#}", rig.name()));
            for (key, value) in rig.entries() {
                assert_eq!(read.value(key.path), Some(value), "{}: {}", rig.name(), key.path);
            }
            let stored = StoredRun::read(folder.path()).expect("a run folder");
            assert_eq!((stored.spacing, stored.accuracy), (Some(spacing), Some(accuracy)));
            let texts =
                [RUN, TRACE].map(|name| std::fs::read_to_string(folder.path().join(name)).expect("there"));
            let sent = StoredRun::of_files("sim", &texts[0], &texts[1]).expect("the files of a run");
            assert_eq!((&sent.rig, sent.windows, sent.band.is_none()), (&stored.rig, stored.windows, true));
            assert!(sent.into_columns().eq(stored.into_columns()), "{}", rig.name());
            let changed = format!("{}1\n", texts[1].trim_end());
            let error = StoredRun::of_files("sim", &texts[0], &changed).expect_err("changed").to_string();
            assert!(error.starts_with("sim/trace.csv does not belong to run.json"), "{error}");
        }
    }
}
