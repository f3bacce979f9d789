//! `pneudrive overlay`.

use anyhow::{Context, Result, bail};
use pneudrive_analysis::alignment::{best_shift, first_move};
use pneudrive_analysis::deviation::{deviations, table};
use pneudrive_analysis::page::Table;
use pneudrive_analysis::report;
use pneudrive_analysis::transient::Transient;
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};

use super::eval::{fits_on_a_page, interval, missing};
use crate::cli::{Align, Overlay};

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
        let shift = shift(arguments.align, &transients[0], &other)?;
        if shift != 0.0 {
            other.shift(shift);
            notes.push(format!("{} is shifted by {:.3} ms.", other.name, 1e3 * shift));
        }
        fits_on_a_page(&other)?;
        is_whole_during(&other, &transients[0])?;
        transients.push(other);
    }
    for note in &notes {
        say!("{note}");
    }
    let tables = overlay(&transients)?;
    let title = format!("{} and {}", transients[0].name, names(&transients[1..]));
    report::page(&title, notes, &transients, tables).write(&arguments.out)?;
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

/// How far `other` has to be shifted, s.
fn shift(align: Align, reference: &Transient, other: &Transient) -> Result<f64> {
    let move_of =
        |of: &Transient| first_move(of).with_context(|| format!("{} has no move to align by", of.name));
    match align {
        Align::Start => Ok(0.0),
        Align::Move => Ok(move_of(reference)? - move_of(other)?),
        Align::Correlation => best_shift(reference, other).with_context(|| {
            format!("{} and {} have too little time in common to align", reference.name, other.name)
        }),
    }
}

fn names(transients: &[Transient]) -> String {
    transients.iter().map(|transient| transient.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Prints the deviations of all others from the first, and returns their tables.
pub(super) fn overlay(transients: &[Transient]) -> Result<Vec<Table>> {
    let Some((reference, others)) = transients.split_first() else { bail!("there is nothing to compare") };
    let mut all = Vec::new();
    for other in others {
        let found = deviations(reference, other);
        if found.is_empty() {
            bail!("{} and {} have no time in common", reference.name, other.name);
        }
        let table = table(&format!("deviation of {} from {}", other.name, reference.name), &found);
        say!("{}\n{}", table.heading, table.to_text());
        all.push(table);
    }
    Ok(all)
}
