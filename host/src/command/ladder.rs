//! `pneudrive ladder`.

use std::time::Instant;

use anyhow::Result;
use pneudrive_optimise::ladder::{compare, page, table};
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};

use super::figures;
use super::long_work::Pace;
use super::progress::Progress;
use super::rig_source::rig_text;
use crate::cli::Ladder;
use crate::json;

pub(super) fn execute(arguments: &Ladder) -> Result<()> {
    let place = arguments.out.join("ladder.html");
    make_writable(&arguments.out)?;
    refuse_to_replace(&place, GENERATOR)?;
    let source = rig_text(&arguments.rig.rig)?;
    let mut progress = Progress::of("comparing", "models");
    let spacing = arguments.members.spacing();
    let mut pace = Pace::begin("the comparison of models", arguments.yes);
    let begun = Instant::now();
    let variants = compare(
        &source,
        &arguments.rig.settings,
        spacing,
        || begun.elapsed(),
        |done, all| {
            progress.at(done as u64, all as u64);
            progress.aside(|| pace.at(done, all))
        },
    )?;
    progress.done();
    page(&source.0, &variants).write(&place, arguments.pages.library())?;
    json::figures(|| figures::ladder(&variants));
    let table = table(&variants);
    say!("{}\n{}\n{}", table.heading, table.to_text(), place.display());
    Ok(())
}
