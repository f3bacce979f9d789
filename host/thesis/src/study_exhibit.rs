//! Exhibits that are application studies: their statements are entries, and each start of a drive is a run.

use anyhow::Result;

use super::shown::in_order;
use super::{Chart, Entry, Exhibit, Experiment, Line, Reading, Shown};
use crate::study::{STUDIES, Studied, Study};
use pneudrive_evaluate::transient::{POSITION, SETPOINT};

/// An exhibit of a study; the rest is to be filled in.
pub(super) const fn of_study(
    name: &'static str,
    section: &'static str,
    place: &'static str,
    entries: &'static [Entry],
) -> Exhibit {
    Exhibit {
        section,
        place,
        about: "",
        lost: "",
        commands: &[],
        entries,
        why: "",
        experiment: Experiment::Study(name),
        takes_s: 1.0,
    }
}

/// The study of an exhibit.
pub(super) fn study_of(exhibit: &Exhibit) -> Option<&'static Study> {
    let Experiment::Study(name) = exhibit.experiment else { return None };
    STUDIES.into_iter().find(|study| study.name == name)
}

/// A study as its exhibit shows it.
pub(super) fn shown(exhibit: &'static Exhibit, study: &'static Study, studied: &Studied) -> Result<Shown> {
    let starts = studied.moves.first().map_or(0, Vec::len);
    let of_statements = studied
        .findings
        .iter()
        .enumerate()
        .map(|(number, finding)| Reading::of_study(format!("{}", number + 1), finding, starts));
    let readings = in_order(exhibit, Vec::new())?.into_iter().chain(of_statements).collect();
    Ok(Shown { exhibit, readings, statements: study.statements, charts: charts(studied) })
}

/// The positions of the drives as the rigs are, and how far each swings over all starts.
fn charts(studied: &Studied) -> Vec<Chart> {
    let positions = studied.own.iter().map(|outcome| {
        let transient = &outcome.transient;
        let line =
            |name: &str, channel: usize| Line::new(name, &transient.time, &transient.channels[channel]);
        Chart {
            title: format!("{}: position", outcome.name),
            across: "time, s",
            up: "position, mm",
            lines: vec![line("position", POSITION), line("setpoint", SETPOINT)],
            ..Chart::default()
        }
    });
    positions.chain(swings(studied)).collect()
}

/// The swings of the drives over all starts, smallest first; none of drives whose moves are too short.
fn swings(studied: &Studied) -> Option<Chart> {
    let line = |(name, swings): (&str, &Vec<Option<f64>>)| {
        let mut known: Vec<f64> = swings.iter().flatten().copied().collect();
        known.sort_by(f64::total_cmp);
        let shares: Vec<f64> =
            (1..=known.len()).map(|place| 100.0 * place as f64 / known.len() as f64).collect();
        (known.len() > 1).then(|| Line::new(name, &known, &shares))
    };
    let names = studied.own.iter().map(|outcome| outcome.name);
    let lines: Vec<Line> = names.zip(&studied.swings_mm).filter_map(line).collect();
    (!lines.is_empty()).then(|| Chart {
        title: "swing at the end of the moves, over the starts".to_owned(),
        across: "from peak to peak, mm",
        up: "starts that swing by less, %",
        lines,
        ..Chart::default()
    })
}
