//! `pneudrive identify`.

pub(super) mod bench;
mod kept;
mod simple;

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_identify::figures::Figures;
use pneudrive_identify::independence::is_same;
use pneudrive_identify::parameter::{Parameter, usual};
use pneudrive_identify::plan::Recorded;
use pneudrive_identify::recording::Recording;
use pneudrive_identify::{Identification, identify, report};
use pneudrive_link::client::Client;
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_records::target::TargetFile;
use pneudrive_records::whole_file::put;
use pneudrive_report::{Page, Table};
use pneudrive_sim::Rig;
use serde_json::json;

use super::rig_source::{load_choice, rig_text};
use crate::cli::Identify;
use crate::exit::Exit;
use crate::json;
use kept::Kept;

/// Names of the files in the folder.
pub(super) const FITTED: &str = "fitted.toml";
const NUMBERS: &str = "identification.json";
const PAGE: &str = "identification.html";

pub(super) fn execute(arguments: &Identify) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    if let Some(path) = &arguments.tubing {
        return simple::tubing(&rig, path);
    }
    if let Some(path) = &arguments.conductance {
        return simple::conductance(&rig, path);
    }
    if arguments.timer {
        return simple::timer(&arguments.targets);
    }
    let parameters = if arguments.fit.is_empty() {
        usual(&rig)
    } else {
        arguments.fit.iter().map(|key| Parameter::of(&rig, key)).collect::<Result<_>>()?
    };
    let (recorded, kept) = match &arguments.plan {
        Some(port) => planned(arguments, &mut Client::connect(port)?).map(|(all, kept)| (all, Some(kept)))?,
        None => (named(arguments, &rig)?, None),
    };
    let figures = read_off(&rig, &recorded);
    say!("{}\n{}", figures.heading, figures.to_text());
    let found = searched(arguments, (&recorded.fitted, parameters), CancelToken::NEVER);
    if let Ok(found) = &found {
        written(arguments, &recorded.fitted, figures, found)?;
    }
    kept.map_or(Ok(()), Kept::end)?;
    let found = found?;
    for table in &report::tables(&found) {
        say!("{}\n{}", table.heading, table.to_text());
    }
    for note in report::notes(&found) {
        say!("{note}");
    }
    let Some(refusal) = report::refusal(&found) else { return Ok(()) };
    Err(Exit::NotBorneOut.error(format!(
        "{refusal}; {} shows the residuals, and --despite-misfit writes {FITTED} nevertheless",
        arguments.out.join(PAGE).display()
    )))
}

/// The records of the tests of the plan, and what keeps them for a call that follows a killed one, to be ended once the files of the fit are
/// written, or there is none.
pub(super) fn planned(arguments: &Identify, client: &mut Client) -> Result<(Recorded, Kept)> {
    make_writable(&arguments.out)?;
    bench::execute(&arguments.rig, client, &arguments.out)
}

/// The records of the files that are named.
fn named(arguments: &Identify, rig: &Rig) -> Result<Recorded> {
    let all = arguments.targets.iter().map(|path| recording(path, rig)).collect::<Result<Vec<_>>>()?;
    let all = without_copies(all);
    Ok(Recorded { fitted: all.clone(), all })
}

/// The figures that records give without a model of the air.
pub(super) fn read_off(rig: &Rig, recorded: &Recorded) -> Table {
    let read = Figures::of(rig, &recorded.all);
    json::figures(|| json!({ "read_off": report::read_off(&read) }));
    read.table(rig)
}

/// The fit, whether it explains the data or not.
pub(super) fn searched(
    arguments: &Identify,
    (recordings, parameters): (&[Recording], Vec<Parameter>),
    cancel: CancelToken<'_>,
) -> Result<Identification> {
    let rig = load_choice(&arguments.rig)?;
    make_writable(&arguments.out)?;
    let accuracy = arguments.integration.accuracy(&rig);
    identify(&rig, recordings, parameters, accuracy, &mut |line| tell!("{line}"), cancel)
}

/// Writes the files of a fit.
pub(super) fn written(
    arguments: &Identify,
    recordings: &[Recording],
    read_off: Table,
    found: &Identification,
) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    json::figures(|| report::to_json(found, recordings));
    let page = report::page(&rig, recordings, arguments.integration.accuracy(&rig), found, read_off);
    write(arguments, recordings, found, &page)
}

/// Writes the fitted rig file. If the fit is refused, removes the file of an earlier fit, which would be taken for this
/// one's.
fn write_fitted(arguments: &Identify, found: &Identification) -> Result<Option<PathBuf>> {
    let path = arguments.out.join(FITTED);
    refuse_to_replace(&path, report::FITTED_MARK)?;
    if !found.fits && !arguments.despite_misfit {
        return match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(error).with_context(|| format!("cannot remove {} of an earlier fit", path.display()))
            }
            _ => Ok(None),
        };
    }
    let (_, text) = rig_text(&arguments.rig.rig)?;
    put(&path, &report::fitted(&text, &arguments.rig.settings, found)?)?;
    Ok(Some(path))
}

/// Recordings, each once: a file may be named twice, and a record may be there as a stream, too.
fn without_copies(recordings: Vec<Recording>) -> Vec<Recording> {
    let mut kept: Vec<Recording> = Vec::new();
    for recording in recordings {
        match kept.iter().find(|other| is_same(other, &recording)) {
            Some(other) => {
                tell!("note: {} has the same samples as {}, and counts once", recording.name, other.name);
            }
            None => kept.push(recording),
        }
    }
    kept
}

fn recording(path: &Path, rig: &Rig) -> Result<Recording> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    Recording::of(&name, &TargetFile::read(path)?, rig)
}

fn write(arguments: &Identify, recordings: &[Recording], found: &Identification, page: &Page) -> Result<()> {
    let [numbers, path] = [NUMBERS, PAGE].map(|name| arguments.out.join(name));
    refuse_to_replace(&numbers, report::FORMAT)?;
    refuse_to_replace(&path, GENERATOR)?;
    let fitted = write_fitted(arguments, found)?;
    put(&numbers, &format!("{:#}\n", report::to_json(found, recordings)))?;
    page.write(&path, arguments.pages.library()).context("the page")?;
    for path in fitted.into_iter().chain([numbers, path]) {
        say!("{}", path.display());
    }
    Ok(())
}
