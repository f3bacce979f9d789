//! `pneudrive overlay`.

use anyhow::{Result, bail};

use crate::cli::Overlay;
use crate::deviation::{Deviation, deviations, table};
use crate::report::{GENERATOR, Report};
use crate::run_folder::refuse_foreign;
use crate::transient::Transient;

pub(super) fn execute(arguments: &Overlay) -> Result<()> {
    refuse_foreign(&arguments.out, GENERATOR)?;
    let reference = Transient::read(&arguments.reference)?;
    let mut transients = vec![reference];
    for path in &arguments.others {
        transients.push(Transient::read(path)?);
    }
    let deviations = overlay(&transients)?;
    let title = format!("{} and {}", transients[0].name, names(&transients[1..]));
    Report { title: &title, notes: &[], transients: &transients, deviations: &deviations }
        .write(&arguments.out)?;
    say!("{}", arguments.out.display());
    Ok(())
}

fn names(transients: &[Transient]) -> String {
    transients.iter().map(|transient| transient.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Prints the deviations of all others from the first, and gives them with their headings.
pub(super) fn overlay(transients: &[Transient]) -> Result<Vec<(String, Vec<Deviation>)>> {
    let Some((reference, others)) = transients.split_first() else { bail!("there is nothing to compare") };
    let mut all = Vec::new();
    for other in others {
        let found = deviations(reference, other);
        if found.is_empty() {
            bail!("{} and {} have no time in common", reference.name, other.name);
        }
        let heading = format!("deviation of {} from {}", other.name, reference.name);
        say!("{heading}\n{}", table(&found));
        all.push((heading, found));
    }
    Ok(all)
}
