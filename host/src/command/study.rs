//! `pneudrive study`.

use anyhow::Result;
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_thesis::study::{Finding, STUDIES, Studied, Study, index, page, run, statements, summary};
use serde_json::json;

use super::figures;
use super::progress::Progress;
use crate::cli::{ALL, LIST, Study as Arguments};
use crate::json;

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
        refuse_to_replace(&place(name), GENERATOR)?;
    }
    let mut progress = Progress::of("studying", "starts");
    let starts = usize::from(arguments.starts);
    let studied = run(&studies, starts, |done, all| progress.at(done as u64, all as u64));
    progress.done();
    let studied = studied?;
    for (study, studied) in studies.iter().zip(&studied) {
        page(study, studied).write(&place(study.name), arguments.pages.library())?;
        tell(study, studied);
    }
    json::figures(|| {
        let all = studies.iter().zip(&studied).map(|(study, studied)| figures::study(study, studied));
        json!({ "studies": all.collect::<Vec<_>>() })
    });
    let findings: Vec<Vec<Finding>> = studied.into_iter().map(|studied| studied.findings).collect();
    if all {
        index(&studies, &findings).write(&place(INDEX), arguments.pages.library())?;
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
    let one = |study: &Study| json!({ "name": study.name, "section": study.section, "about": study.about });
    json::figures(|| json!({ "studies": STUDIES.into_iter().map(one).collect::<Vec<_>>() }));
}

fn tell(study: &Study, studied: &Studied) {
    say!("{} ({}): {}", study.name, study.section, study.about);
    for row in statements(study, &studied.findings).rows {
        say!("  thesis   {}\n  model    {}\n  verdict  {}\n", row[0], row[1], row[2]);
    }
}
