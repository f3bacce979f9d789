//! `pneudrive identify`.

mod bench;
mod simple;

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use pneudrive_analysis::identification::figures::Figures;
use pneudrive_analysis::identification::parameter::{Parameter, usual};
use pneudrive_analysis::identification::plan::Recorded;
use pneudrive_analysis::identification::recording::Recording;
use pneudrive_analysis::identification::{Identification, identify, report};
use pneudrive_analysis::page::{Page, Table};
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_records::target::TargetFile;
use pneudrive_records::whole_file::put;
use pneudrive_sim::{Accuracy, Rig};

use super::rig_source::{load_choice, rig_text};
use crate::cli::Identify;
use crate::exit::Exit;

/// Names of the files in the folder.
const FITTED: &str = "fitted.toml";
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
    let (recordings, figures) = records(arguments, &rig)?;
    say!("{}\n{}", figures.heading, figures.to_text());
    make_writable(&arguments.out)?;
    let accuracy = arguments.integration.accuracy(&rig);
    let found = identify(&rig, &recordings, parameters, accuracy, &mut |line| tell!("{line}"))?;
    let mut tables = report::tables(&found);
    for table in &tables {
        say!("{}\n{}", table.heading, table.to_text());
    }
    for note in report::notes(&found) {
        say!("{note}");
    }
    tables.push(figures);
    write(arguments, &rig, &recordings, accuracy, &found, tables)?;
    if found.fits {
        return Ok(());
    }
    Err(Exit::NotBorneOut.error(format!(
        "{}; {} shows the residuals, and --despite-misfit writes {FITTED} nevertheless",
        refusal(&rig, found.spectrum.is_testable()),
        arguments.out.join(PAGE).display()
    )))
}

/// Why a fit is refused.
fn refusal(rig: &Rig, is_judged: bool) -> String {
    match is_judged {
        true => format!("the model of {} does not explain the transients", rig.name()),
        false => format!("the transients have too few samples to judge the model of {}", rig.name()),
    }
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

/// The recordings to fit, and the figures that all records give without a model of the air.
fn records(arguments: &Identify, rig: &Rig) -> Result<(Vec<Recording>, Table)> {
    let recorded = if let Some(port) = &arguments.plan {
        make_writable(&arguments.out)?;
        bench::execute(&arguments.rig, port, &arguments.out)?
    } else {
        let all = arguments.targets.iter().map(|path| recording(path, rig)).collect::<Result<Vec<_>>>()?;
        Recorded { fitted: all.clone(), all }
    };
    let figures = Figures::of(rig, &recorded.all).table(rig);
    Ok((recorded.fitted, figures))
}

fn recording(path: &Path, rig: &Rig) -> Result<Recording> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    Recording::of(&name, &TargetFile::read(path)?, rig)
}

fn write(
    arguments: &Identify,
    rig: &Rig,
    recordings: &[Recording],
    accuracy: Accuracy,
    found: &Identification,
    tables: Vec<Table>,
) -> Result<()> {
    let [numbers, page] = [NUMBERS, PAGE].map(|name| arguments.out.join(name));
    refuse_to_replace(&numbers, report::FORMAT)?;
    refuse_to_replace(&page, GENERATOR)?;
    let fitted = write_fitted(arguments, found)?;
    put(&numbers, &format!("{:#}\n", report::to_json(found, recordings)))?;
    let mut figures = Vec::new();
    for (recording, start) in recordings.iter().zip(&found.starts) {
        let follow = |rig: &Rig| -> Result<_> {
            let started = rig.with_numbers(&recording.start(*start))?;
            recording.follow(&started, accuracy, recording.commands.len())
        };
        let readings = [follow(rig), follow(&found.rig)];
        let [Ok(before), Ok(after)] = readings else { continue };
        figures.push(report::figure(recording, &before, &after));
    }
    let title = format!("{}, identified", rig.name());
    let page_of = Page { title, notes: report::notes(found), tables, figures };
    page_of.write(&page).context("the page")?;
    for path in fitted.into_iter().chain([numbers, page]) {
        say!("{}", path.display());
    }
    Ok(())
}
