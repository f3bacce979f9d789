//! `pneudrive identify`.

use std::path::Path;

use anyhow::{Context, Result};
use pneudrive_sim::{Accuracy, Rig};

use super::{accuracy, load_choice, rig_text};
use crate::cli::Identify;
use crate::identification::parameter::{Parameter, usual};
use crate::identification::recording::Recording;
use crate::identification::{Identification, identify, report};
use crate::page::{GENERATOR, Page};
use crate::run_folder::{make_writable, put, refuse_foreign};
use crate::target::TargetFile;

/// Names of the files in the folder.
const FITTED: &str = "fitted.toml";
const NUMBERS: &str = "identification.json";
const PAGE: &str = "identification.html";

pub(super) fn execute(arguments: &Identify) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    let parameters = if arguments.fit.is_empty() {
        usual(&rig)?
    } else {
        arguments.fit.iter().map(|key| Parameter::of(&rig, key)).collect::<Result<_>>()?
    };
    let recordings =
        arguments.targets.iter().map(|path| recording(path, &rig)).collect::<Result<Vec<_>>>()?;
    make_writable(&arguments.out)?;
    let accuracy = accuracy(&arguments.integration);
    let found = identify(&rig, &recordings, parameters, accuracy, &mut |line| eprintln!("{line}"))?;
    for table in report::tables(&found) {
        say!("{}\n{}", table.heading, table.to_text());
    }
    for note in report::notes(&found) {
        say!("{note}");
    }
    write(arguments, &rig, &recordings, accuracy, &found)
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
) -> Result<()> {
    let [fitted, numbers, page] = [FITTED, NUMBERS, PAGE].map(|name| arguments.out.join(name));
    refuse_foreign(&fitted, report::FITTED_MARK)?;
    refuse_foreign(&numbers, report::FORMAT)?;
    refuse_foreign(&page, GENERATOR)?;
    let (_, text) = rig_text(&arguments.rig.rig)?;
    put(&fitted, &report::fitted(&text, &arguments.rig.settings, found)?)?;
    put(&numbers, &format!("{:#}\n", report::to_json(found, recordings)))?;
    let mut figures = Vec::new();
    for (recording, start) in recordings.iter().zip(&found.starts) {
        let follow = |rig: &Rig| recording.follow(rig, accuracy, *start, recording.commands.len());
        let readings = [follow(rig), follow(&found.rig)];
        let [Some(before), Some(after)] = readings else { continue };
        figures.push(report::figure(recording, &before, &after));
    }
    let title = format!("{}, identified", rig.name());
    let page_of = Page { title, notes: report::notes(found), tables: report::tables(found), figures };
    page_of.write(&page).context("the page")?;
    for path in [fitted, numbers, page] {
        say!("{}", path.display());
    }
    Ok(())
}
