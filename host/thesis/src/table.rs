//! The tables of an exhibit: its numbers, and its sentences.

use super::bar::bar;
use super::number::value_of;
use super::reading::rounded;
use super::{Agreement, Entry, Found, Printed, Reading, Shown};
use pneudrive_report::escaped;

/// A row of a table: its cells, and its basis, which appears once for all rows with the same basis.
struct Row {
    cells: String,
    rests_on: String,
    alternative: bool,
}

/// Both tables, except a table that the exhibit does not have.
pub(super) fn table(one: &Shown) -> String {
    let (mut numbers, mut sentences) = (Vec::new(), Vec::new());
    for (entry, reading) in one.rows() {
        match entry.printed {
            Printed::Number { .. } => numbers.push(number(&entry, reading)),
            Printed::Sentence(says) => sentences.push(sentence(says, &entry, reading)),
        }
    }
    filled(OF_NUMBERS, &numbers) + &filled(OF_SENTENCES, &sentences)
}

const OF_NUMBERS: &str = "<th class=\"words\">number</th><th>printed</th><th></th><th>ours (range)</th><th>gap</th><th class=\"words\">verdict</th>";
const OF_SENTENCES: &str = "<th class=\"words\">the thesis says</th><th class=\"words\">the model shows</th><th class=\"words\">verdict</th>";

fn filled(heads: &str, rows: &[Row]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut text = format!("<table><tr>{heads}<th class=\"words\">rests on</th></tr>\n");
    for same in rows.chunk_by(|one, next| one.rests_on == next.rests_on) {
        for (place, row) in same.iter().enumerate() {
            let class = if row.alternative { " class=\"alternative\"" } else { "" };
            let rests_on = match place {
                0 => format!(
                    "<td class=\"words rests\" rowspan=\"{}\">{}</td>",
                    same.len(),
                    escaped(&row.rests_on)
                ),
                _ => String::new(),
            };
            text += &format!("<tr{class}>{}{rests_on}</tr>\n", row.cells);
        }
    }
    text + "</table>\n"
}

/// Meaning, printed value, bar, our value, gap, verdict.
fn number(entry: &Entry, reading: &Reading) -> Row {
    let Printed::Number { text, unit, within, source } = entry.printed else {
        unreachable!("it is a number")
    };
    let judged = matches!(reading.found, Found::Figure { .. });
    let tolerance = if judged { format!(" <small>\u{b1}{within}</small>") } else { String::new() };
    let source = match reading.found {
        Found::Figure { .. } | Found::SizeOnly { .. } => format!(" Tolerance: {source}."),
        _ => String::new(),
    };
    let cells = format!(
        "<td class=\"words\">{}</td><td class=\"figure\">{text}{tolerance} {}</td><td>{}</td><td class=\"figure\">{}</td><td class=\"figure\">{}</td><td class=\"words\">{}</td>",
        escaped(entry.what),
        escaped(unit),
        bar(entry, reading),
        escaped(&reading.found.formatted(unit)),
        gap(value_of(text), &reading.found),
        chip(reading.agreement(entry)),
    );
    let rests_on =
        if reading.rests_on.is_empty() { source } else { format!("{}.{source}", reading.rests_on) };
    Row { cells, rests_on, alternative: entry.alternative }
}

/// How far ours lies beside the printed number.
fn gap(printed: f64, found: &Found) -> String {
    match found {
        Found::Figure { value, .. } if printed != 0.0 => {
            let percent = rounded(100.0 * (value / printed - 1.0), 1);
            if percent.starts_with('-') { format!("{percent} %") } else { format!("+{percent} %") }
        }
        _ => String::new(),
    }
}

/// Statement, finding, verdict. Another reading of a sentence is named by its change.
fn sentence(says: &str, entry: &Entry, reading: &Reading) -> Row {
    let says = if entry.what.is_empty() { says } else { entry.what };
    let cells = format!(
        "<td class=\"words says\">{}</td><td class=\"words\">{}</td><td class=\"words\">{}</td>",
        escaped(says),
        escaped(&reading.found.formatted("")),
        chip(reading.agreement(entry)),
    );
    Row { cells, rests_on: reading.rests_on.clone(), alternative: entry.alternative }
}

fn chip(agreement: Agreement) -> String {
    format!("<span class=\"chip {}\">{}</span>", class(agreement), agreement.word())
}

pub(super) fn class(agreement: Agreement) -> &'static str {
    match agreement {
        Agreement::Agrees => "agrees",
        Agreement::InPart => "part",
        Agreement::Differs => "differs",
        Agreement::Open => "open",
        Agreement::TakenOver => "given",
    }
}

#[cfg(test)]
mod tests {
    use super::super::{runs, within};
    use super::*;

    #[test]
    fn every_entry_has_a_row_and_what_it_rests_on_stands_once_for_rows_that_rest_on_the_same() {
        let shown = runs::run(&within("7.1.1.3"), 1, |_, _| {}).expect("a bench");
        let html = table(&shown[0]);
        assert_eq!(html.matches("<tr>").count(), 2 + 6, "{html}");
        assert!(
            html.contains("rowspan=\"5\"") && html.contains("9.572 <small>\u{b1}0.003</small> mm"),
            "{html}"
        );
        assert_eq!(html.matches("<svg class=\"bar").count(), 5);
    }

    #[test]
    fn the_gap_is_that_of_figures_that_can_be_compared() {
        let figure = |value| Found::Figure { value, range: [value; 2], decimals: 2 };
        assert_eq!(gap(2.0, &figure(2.1)), "+5.0 %");
        assert_eq!(gap(2.0, &figure(1.9)), "-5.0 %");
        assert_eq!(gap(2.0, &Found::SizeOnly { value: 1.0, range: [1.0; 2], decimals: 0 }), "");
    }
}
