//! The application studies: every one runs, and what the model shows of the thesis stays as it is.

mod program;

use std::fs;

use pneudrive::ensemble::Spacing;
use pneudrive::study::Verdict::{Agrees, Depends, Differs, Open};
use pneudrive::study::{Outcome, STUDIES, Verdict, index, page, run};
use program::{exists, folder, ok, transcript};

/// What the model shows today. A change of the model that changes a verdict is told here: find out why
/// before a line is changed.
const VERDICTS: [(&str, &[Verdict]); 12] = [
    ("lut-stepper", &[Agrees, Open]),
    ("lut-solenoid", &[Agrees, Depends, Open]),
    ("burrows", &[Agrees, Open]),
    ("soft-spring", &[Differs, Agrees]),
    ("impulse", &[Agrees, Differs]),
    ("reduced-gain", &[Depends, Differs, Depends]),
    ("null-learning", &[Agrees]),
    ("step-time", &[Agrees, Depends]),
    ("positive-gain", &[Agrees, Differs]),
    ("continuous", &[Differs, Agrees, Differs]),
    ("empirical-operator", &[Agrees, Differs, Agrees]),
    ("leakage", &[Differs, Differs, Depends]),
];

#[test]
fn every_study_runs_and_each_statement_has_the_verdict_that_it_had() {
    let outcomes = run(&STUDIES, Spacing::default(), |_, _| Ok(())).expect("every drive can be simulated");
    let mut all = Vec::new();
    for ((study, outcomes), (name, verdicts)) in STUDIES.iter().zip(&outcomes).zip(VERDICTS) {
        assert_eq!(study.name, name);
        let findings = study.findings(outcomes);
        let found: Vec<Verdict> = findings.iter().map(|finding| finding.verdict).collect();
        assert_eq!(found, verdicts, "{name}: {findings:#?}");
        page_tells_all(study.name, outcomes);
        all.push(findings);
    }
    let index = index(&STUDIES, &all);
    let verdicts = || VERDICTS.iter().flat_map(|(_, verdicts)| *verdicts);
    let count = |wanted: Verdict| verdicts().filter(|verdict| **verdict == wanted).count();
    assert_eq!(index.tables[0].rows.len(), verdicts().count());
    let differs = count(Differs);
    assert!(index.notes[0].contains(&format!("It differs in {differs}: ")), "{}", index.notes[0]);
    let readme = include_str!("../../README.md").replace('\n', " ");
    let said = format!(
        "{} statements of the thesis about its drives: it shows {} of them, differs in {differs}, {} depend on less than anyone knows of a drive, and {} cannot",
        verdicts().count(),
        count(Agrees),
        count(Depends),
        count(Open)
    );
    assert!(readme.contains(&said), "README has other counts than: {said}");
}

/// A row for each statement, a table of moves for each drive, and all transients on the graphs.
fn page_tells_all(name: &str, runs: &[Vec<Outcome>]) {
    let study = STUDIES.iter().find(|study| study.name == name).expect("a study");
    let page = page(study, runs);
    assert_eq!(page.tables[0].rows.len(), study.statements.len(), "{name}");
    assert!(
        page.tables[0].rows.iter().all(|row| !row[1].contains("NaN")),
        "{name}: {:?}",
        page.tables[0].rows
    );
    assert_eq!(page.tables.len(), 2 + study.variants.len(), "{name}");
    let positions: usize = page.figures.iter().map(|figure| figure.panels[0].curves.len() - 1).sum();
    assert_eq!(positions, study.variants.len(), "{name}: beside the setpoint a position each");
    assert!(runs.iter().flatten().all(|outcome| outcome.moves.len() > 1), "{name}");
}

#[test]
fn a_study_leaves_its_page_and_tells_what_it_found() {
    let folder = folder();
    let said = ok(folder.path(), "study impulse --out st");
    exists(folder.path(), &["st/impulse.html"]);
    assert!(!folder.path().join("st/index.html").exists());
    assert!(said.contains("  thesis   After the impulse the system is unstable.\n  model    "), "{said}");
    assert_eq!(said.matches("  verdict  ").count(), 2, "{said}");
    let page = fs::read_to_string(folder.path().join("st/impulse.html")).expect("written");
    assert!(page.contains("The model shows what the thesis says in 1 of 2 statements. It differs in 1"));
}

#[test]
fn the_list_names_every_study_and_wrong_use_and_files_of_the_users_are_refused() {
    let folder = folder();
    let said = ok(folder.path(), "study list");
    assert!(STUDIES.iter().all(|study| said.contains(study.name) && said.contains(study.section)), "{said}");
    for wrong in ["study nothing --out .", "study impulse", "study all"] {
        assert!(transcript(folder.path(), wrong).ends_with("= 2"), "{wrong}");
    }
    for mine in ["impulse.html", "index.html"] {
        fs::write(folder.path().join(mine), "mine").expect("written");
        let said = transcript(folder.path(), "study all --out .");
        assert!(said.contains(&format!("{mine} is not of this program")) && said.ends_with("= 1"), "{said}");
        assert_eq!(fs::read_to_string(folder.path().join(mine)).expect("there"), "mine");
        fs::remove_file(folder.path().join(mine)).expect("there");
    }
}
