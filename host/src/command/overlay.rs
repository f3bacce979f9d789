//! `pneudrive overlay`.

use anyhow::{Result, bail};
use pneudrive_evaluate::alignment::Align;
use pneudrive_evaluate::deviation::{deviations, table};
use pneudrive_evaluate::report;
use pneudrive_evaluate::transient::Transient;
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_report::Table;
use serde_json::json;

use super::eval::{fits_on_a_page, interval, missing};
use super::figures;
use crate::cli::{self, Overlay};
use crate::json;

pub(super) fn execute(arguments: &Overlay) -> Result<()> {
    refuse_to_replace(&arguments.out, GENERATOR)?;
    let read = |path| match arguments.ports {
        true => Transient::read(path)?.at_ports(),
        false => Transient::read(path),
    };
    let mut transients = vec![interval(read(&arguments.reference)?, &arguments.interval)?];
    let mut notes = Vec::new();
    if arguments.ports {
        notes.push("Pressures of runs are those at the ports of the valve, P_1v and P_2v.".to_owned());
    }
    for path in &arguments.others {
        let mut other = read(path)?;
        let shift = align(arguments.align).shift(&transients[0], &other)?;
        if shift != 0.0 {
            other.shift(shift);
            notes.push(format!("{} is shifted by {:.3} ms.", other.name, 1e3 * shift));
        }
        other.error_in_counts_of(transients[0].mm_per_count);
        fits_on_a_page(&other)?;
        is_whole_during(&other, &transients[0])?;
        transients.push(other);
    }
    for note in &notes {
        say!("{note}");
    }
    json::figures(|| json!({ "notes": notes }));
    let tables = overlay(&transients)?;
    let title = format!("{} and {}", transients[0].name, names(&transients[1..]));
    report::page(&title, notes, &transients, tables).write(&arguments.out, arguments.pages.library())?;
    say!("{}", arguments.out.display());
    Ok(())
}

/// Refuses a gap in `other` during the reference: there would be nothing to compare.
fn is_whole_during(other: &Transient, reference: &Transient) -> Result<()> {
    let [from, to] = [reference.time.first(), reference.time.last()].map(|time| time.copied().unwrap_or(0.0));
    match other.gaps.iter().find(|[before, after]| *after > from && *before < to) {
        Some(gap) => Err(missing(other, gap)),
        None => Ok(()),
    }
}

fn align(wanted: cli::Align) -> Align {
    match wanted {
        cli::Align::Start => Align::Start,
        cli::Align::Move => Align::Move,
        cli::Align::Correlation => Align::Correlation,
    }
}

fn names(transients: &[Transient]) -> String {
    transients.iter().map(|transient| transient.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Prints the deviations of all others from the first, and returns their tables.
pub(super) fn overlay(transients: &[Transient]) -> Result<Vec<Table>> {
    let Some((reference, others)) = transients.split_first() else { bail!("there is nothing to compare") };
    let (mut all, mut told) = (Vec::new(), Vec::new());
    for other in others {
        let found = deviations(reference, other);
        if found.is_empty() {
            bail!("{} and {} have no time in common", reference.name, other.name);
        }
        let table = table(&format!("deviation of {} from {}", other.name, reference.name), &found);
        say!("{}\n{}", table.heading, table.to_text());
        all.push(table);
        told.push(json!({ "name": other.name, "deviations": figures::deviations(&found) }));
    }
    json::figures(|| json!({ "reference": reference.name, "others": told }));
    Ok(all)
}
