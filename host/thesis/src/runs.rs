//! Runs exhibits: their own experiments on all processors, one each, then the studies, which use all processors themselves.

use std::time::Duration;

use anyhow::{Context, Result};

use super::shown::in_order;
use super::study_exhibit::{self, study_of};
use super::{Entry, Exhibit, Experiment, Measured, Printed, Shown};
use crate::study::{self, Study};
use pneudrive_evaluate::parallel;

/// The time of exhibits on all processors, roughly.
#[must_use]
pub fn lasts(exhibits: &[&Exhibit], starts: usize) -> Duration {
    let of_one = |exhibit: &&Exhibit| match exhibit.experiment {
        Experiment::Own(_) => exhibit.takes_s,
        Experiment::Study(_) => exhibit.takes_s * starts as f64 / study::STARTS as f64,
    };
    let all: f64 = exhibits.iter().map(of_one).sum();
    Duration::from_secs_f64(all / parallel::threads().get() as f64)
}

/// Runs exhibits, studies from this many starts. `progress` is given the work done and all work.
///
/// # Errors
/// When a drive cannot be integrated, or an experiment has no reading for an entry.
pub fn run(
    exhibits: &[&'static Exhibit],
    starts: usize,
    mut progress: impl FnMut(usize, usize) + Send,
) -> Result<Vec<Shown>> {
    let studies: Vec<&Study> = exhibits.iter().filter_map(|exhibit| study_of(exhibit)).collect();
    let own: Vec<&'static Exhibit> =
        exhibits.iter().copied().filter(|exhibit| matches!(exhibit.experiment, Experiment::Own(_))).collect();
    let all = own.len() + studies.len() * starts;
    let measured = parallel::map(&own, |one| measured(one), |done| progress(done, all));
    let mut measured = measured.into_iter();
    let studied = study::run(&studies, starts, |done, _| progress(own.len() + done, all))?;
    let mut studied = studied.into_iter();
    let shown = |exhibit: &&'static Exhibit| match study_of(exhibit) {
        None => measured.next().expect("it has been measured"),
        Some(study) => study_exhibit::shown(exhibit, study, &studied.next().expect("it has been studied")),
    };
    exhibits.iter().map(shown).collect()
}

fn measured(exhibit: &'static Exhibit) -> Result<Shown> {
    let Experiment::Own(experiment) = exhibit.experiment else { unreachable!("studies are run together") };
    let Measured { readings, charts } =
        experiment().with_context(|| format!("{}, {}", exhibit.section, exhibit.place))?;
    Ok(Shown { exhibit, readings: in_order(exhibit, readings)?, statements: &[], charts })
}

/// Whether an entry is a number.
pub(super) fn is_number(entry: &Entry) -> bool {
    matches!(entry.printed, Printed::Number { .. })
}
