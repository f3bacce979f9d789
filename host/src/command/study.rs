//! `pneudrive study`.

use anyhow::Result;

use super::Progress;
use super::long_work::Pace;
use crate::cli::{ALL, LIST, Study as Arguments};
use crate::page::GENERATOR;
use crate::run_folder::{make_writable, refuse_foreign};
use crate::study::{Finding, STUDIES, Study, index, page, run, statements, summary};

pub(super) fn execute(arguments: &Arguments) -> Result<()> {
    if arguments.name == LIST {
        list();
        return Ok(());
    }
    let out = arguments.out.as_ref().expect("the command line asks for it");
    make_writable(out)?;
    let all = arguments.name == ALL;
    let studies: Vec<&Study> =
        STUDIES.into_iter().filter(|study| all || study.name == arguments.name).collect();
    let place = |name: &str| out.join(format!("{name}.html"));
    for name in studies.iter().map(|study| study.name).chain(all.then_some(INDEX)) {
        refuse_foreign(&place(name), GENERATOR)?;
    }
    let mut progress = Progress::of("studying", "drives");
    let mut pace = Pace::begin("the study", arguments.yes);
    let outcomes = run(&studies, arguments.neighbours.spacing(), |done, all| {
        progress.at(done as u64, all as u64);
        progress.aside(|| pace.at(done, all))
    });
    progress.done();
    let outcomes = outcomes?;
    let mut findings: Vec<Vec<Finding>> = Vec::new();
    for (study, outcomes) in studies.iter().zip(&outcomes) {
        let found = study.findings(outcomes);
        page(study, outcomes).write(&place(study.name))?;
        tell(study, &found);
        findings.push(found);
    }
    if all {
        index(&studies, &findings).write(&place(INDEX))?;
        let every: Vec<Finding> = findings.into_iter().flatten().collect();
        say!("{}\n{}", summary(&every), place(INDEX).display());
    } else {
        studies.iter().for_each(|study| say!("{}", place(study.name).display()));
    }
    Ok(())
}

/// The page of the whole table.
const INDEX: &str = "index";

fn list() {
    for study in STUDIES {
        say!("{:<20}{:<7}{}", study.name, study.section, study.about);
    }
}

fn tell(study: &Study, findings: &[Finding]) {
    say!("{} ({}): {}", study.name, study.section, study.about);
    for row in statements(study, findings).rows {
        say!("  thesis   {}\n  model    {}\n  verdict  {}\n", row[0], row[1], row[2]);
    }
}
