//! The application studies: what is found is told on the page and at the terminal, and the list of the documentation is
//! that of the last whole run.

use std::fs;

use pneudrive_thesis::study::Verdict::{self, Agrees, Depends, Differs, Open};
use pneudrive_thesis::study::{STARTS, STUDIES, Studied, index, page, run};

use crate::program::{exists, folder, ok, transcript};

/// What the model shows, as docs/explanation/thesis.md and README have it. A change of the model that changes a
/// verdict is told by the test below that runs all of them: find out why before a line is changed.
const VERDICTS: [(&str, &[Verdict]); 12] = [
    ("lut-stepper", &[Agrees, Open]),
    ("lut-solenoid", &[Agrees, Open, Open]),
    ("burrows", &[Agrees, Open]),
    ("soft-spring", &[Open, Open, Agrees]),
    ("impulse", &[Open, Differs]),
    ("reduced-gain", &[Open, Depends, Open]),
    ("null-learning", &[Agrees]),
    ("step-time", &[Agrees, Open]),
    ("positive-gain", &[Agrees, Differs]),
    ("continuous", &[Agrees, Open, Differs, Differs]),
    ("empirical-operator", &[Open, Open, Depends]),
    ("leakage", &[Open, Depends, Agrees]),
];

fn verdicts(studied: &Studied) -> Vec<Verdict> {
    studied.findings.iter().map(|finding| finding.verdict).collect()
}

#[test]
fn two_studies_have_the_verdicts_that_they_had_and_their_pages_tell_all() {
    let some = STUDIES.into_iter().filter(|study| ["lut-stepper", "burrows"].contains(&study.name));
    let studies: Vec<_> = some.collect();
    let mut told = Vec::new();
    let studied =
        run(&studies, STARTS, |done, all| told.push((done, all))).expect("every drive can be simulated");
    assert_eq!(told.last(), Some(&(2 * STARTS, 2 * STARTS)));
    for (study, studied) in studies.iter().zip(&studied) {
        let known = VERDICTS.iter().find(|(name, _)| *name == study.name).expect("known").1;
        assert_eq!(verdicts(studied), known, "{}: {:#?}", study.name, studied.findings);
        let page = page(study, studied);
        assert_eq!(page.tables[0].rows.len(), study.statements.len());
        assert!(page.tables[0].rows.iter().all(|row| !row[1].contains("NaN")), "{:?}", page.tables[0].rows);
        assert_eq!(page.tables.len(), 2 + study.variants.len());
        let positions: usize = page.figures.iter().map(|figure| figure.panels[0].curves.len() - 1).sum();
        assert_eq!(positions, study.variants.len(), "beside the setpoint a position each");
        assert!(studied.moves.iter().all(|starts| starts.len() == STARTS), "{}", study.name);
    }
    let findings: Vec<_> = studied.into_iter().map(|studied| studied.findings).collect();
    assert_eq!(index(&studies, &findings).tables[0].rows.len(), 4);
}

/// Every drive of every study from 64 starts.
#[test]
#[ignore = "long: cargo xtask test long"]
fn every_study_runs_and_each_statement_has_the_verdict_that_it_had() {
    let studied = run(&STUDIES, STARTS, |_, _| {}).expect("every drive can be simulated");
    for ((study, studied), (name, known)) in STUDIES.iter().zip(&studied).zip(VERDICTS) {
        assert_eq!((study.name, verdicts(studied).as_slice()), (name, known), "{:#?}", studied.findings);
    }
}

#[test]
fn the_documentation_has_the_counts_and_the_verdicts_of_the_last_whole_run() {
    let all: Vec<Verdict> = VERDICTS.iter().flat_map(|(_, verdicts)| verdicts.iter().copied()).collect();
    let count = |wanted: Verdict| all.iter().filter(|verdict| **verdict == wanted).count();
    let printed = format!(
        "{} statements of the thesis about its drives: it shows {} of them, differs in {}, {} depend on where the drive starts, and {} cannot be decided",
        all.len(),
        count(Agrees),
        count(Differs),
        count(Depends),
        count(Open)
    );
    let page = include_str!("../../docs/explanation/trust.md").replace('\n', " ");
    assert!(page.contains(&printed), "docs/explanation/trust.md has other counts than: {printed}");
    let table = include_str!("verdicts.md");
    for (study, (name, verdicts)) in STUDIES.iter().zip(VERDICTS) {
        assert_eq!((study.name, study.statements.len()), (name, verdicts.len()));
        for (statement, verdict) in study.statements.iter().zip(verdicts) {
            let begins = format!("| {name} | {} | {} |", statement.thesis, verdict.word());
            assert!(table.contains(&begins), "host/tests/verdicts.md lacks: {begins}");
        }
    }
}

#[test]
fn a_study_leaves_its_page_and_tells_what_it_found() {
    let folder = folder();
    let printed = ok(folder.path(), "study burrows --starts 2 --out st");
    exists(folder.path(), &["st/burrows.html"]);
    assert!(!folder.path().join("st/index.html").exists());
    assert!(printed.contains("  thesis   The valve works in three states"), "{printed}");
    assert!(printed.contains("Starts that agree: 2 of 2, 100 % (34 to 100 %);"), "{printed}");
    assert_eq!(printed.matches("  verdict  ").count(), 2, "{printed}");
    let page = fs::read_to_string(folder.path().join("st/burrows.html")).expect("written");
    assert!(page.contains("Each drive was run from 2 starts"));
}

#[test]
fn the_list_names_every_study_and_wrong_use_and_files_of_the_users_are_refused() {
    let folder = folder();
    let printed = ok(folder.path(), "study list");
    assert!(
        STUDIES.iter().all(|study| printed.contains(study.name) && printed.contains(study.section)),
        "{printed}"
    );
    for wrong in ["study nothing --out .", "study impulse", "study all", "study impulse --starts 0 --out ."] {
        assert!(transcript(folder.path(), wrong).ends_with("= 2"), "{wrong}");
    }
    for mine in ["impulse.html", "index.html"] {
        fs::write(folder.path().join(mine), "mine").expect("written");
        let printed = transcript(folder.path(), "study all --out .");
        assert!(
            printed.contains(&format!("{mine} was not written by this program")) && printed.ends_with("= 1"),
            "{printed}"
        );
        assert_eq!(fs::read_to_string(folder.path().join(mine)).expect("there"), "mine");
        fs::remove_file(folder.path().join(mine)).expect("there");
    }
}
