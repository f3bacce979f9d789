//! The page of a study, and the index of all.

use super::steadiness::SEEN_MM;
use super::{Finding, Studied, Study, Variant, Verdict};
use pneudrive_evaluate::evaluation;
use pneudrive_evaluate::report;
use pneudrive_evaluate::transient::Transient;
use pneudrive_report::{Figure, Page, Table};

/// The page of a study: its statements, the drives' moves, and their transients on the same graphs.
#[must_use]
pub fn page(study: &Study, studied: &Studied) -> Page {
    let moves = study.variants.iter().zip(&studied.moves).map(|(variant, moves)| {
        let table = evaluation::table(moves, evaluation::tolerance_mm(None));
        Table { heading: format!("{}: {}", variant.name, table.heading), ..table }
    });
    let transients: Vec<Transient> = studied.own.iter().map(|outcome| outcome.transient.clone()).collect();
    let tables = [statements(study, &studied.findings), drives(study.variants)];
    Page {
        title: format!("{} (thesis {})", study.about, study.section),
        notes: vec![summary(&studied.findings), over(studied.moves.first().map_or(0, Vec::len))],
        tables: tables.into_iter().chain(moves).collect(),
        figures: graphs(&transients),
        ..Page::default()
    }
}

/// Transients on the same graphs; if they are too many to be distinguished, in pairs, as studies have them.
fn graphs(transients: &[Transient]) -> Vec<Figure> {
    let together = if transients.len() > 3 { 2 } else { 3 };
    transients.chunks(together).map(|some| Figure::over_time(report::panels(some))).collect()
}

/// On how many starts a verdict rests, in a sentence.
fn over(starts: usize) -> String {
    format!(
        "Each drive was run from {starts} starts, with its test at another position on the stroke and its dither at another phase. Figures are those of the unchanged rig, with their range over the starts; a verdict holds if the 95 % interval of its share of starts lies above two thirds. The graphs show the unchanged rig. A drive vibrates if it swings by more than {SEEN_MM} mm in each of the last three intervals of 0.4 s of a move of 2 s or more, and is steady if it does so in none."
    )
}

/// How many statements the model shows, in a sentence.
#[must_use]
pub fn summary(findings: &[Finding]) -> String {
    let count = |verdict| findings.iter().filter(|finding| finding.verdict == verdict).count();
    let differs = match count(Verdict::Differs) {
        0 => "It differs in none.".to_owned(),
        differs => format!("It differs in {differs}: there the model does not show what the thesis says."),
    };
    let depends = match count(Verdict::Depends) {
        0 => String::new(),
        depends => format!(" The verdict on {depends} depends on the start."),
    };
    let open = match count(Verdict::Open) {
        0 => String::new(),
        open => format!(" {open} cannot be decided."),
    };
    format!(
        "The model shows what the thesis says in {} of {} statements. {differs}{depends}{open}",
        count(Verdict::Agrees),
        findings.len()
    )
}

/// The statements of the thesis, and the model's answers.
#[must_use]
pub fn statements(study: &Study, findings: &[Finding]) -> Table {
    let rows = study.statements.iter().zip(findings);
    let rows = rows.map(|(statement, finding)| {
        vec![statement.thesis.to_owned(), finding.shows.clone(), finding.verdict.word().to_owned()]
    });
    Table::new("statements", ["the thesis says", "the model shows", "verdict"], rows)
}

fn drives(variants: &[Variant]) -> Table {
    let row = |variant: &Variant| {
        vec![variant.name.to_owned(), variant.rig.to_owned(), variant.settings.join("; ")]
    };
    Table::new("drives", ["drive", "rig", "settings"], variants.iter().map(row))
}

/// The statements of all studies, with the pages beside it.
#[must_use]
pub fn index(studies: &[&Study], findings: &[Vec<Finding>]) -> Page {
    let all: Vec<Finding> = findings.iter().flatten().cloned().collect();
    let rows = studies.iter().zip(findings).flat_map(|(study, findings)| {
        statements(study, findings).rows.into_iter().map(|row| {
            let own = [format!("{}.html", study.name), study.section.to_owned()];
            own.into_iter().chain(row).collect()
        })
    });
    Page {
        title: "Application studies: the thesis and the model".to_owned(),
        notes: vec![
            summary(&all),
            "The rigs of the thesis are not available: a statement that compares with one cannot be decided."
                .to_owned(),
        ],
        tables: vec![Table::new(
            "all statements",
            ["study", "section", "the thesis says", "the model shows", "verdict"],
            rows,
        )],
        ..Page::default()
    }
}
