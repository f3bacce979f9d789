//! Tables in the documentation that programs write and tests check.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use crate::cargo::root;

/// How far a figure may be off its table, per cent.
const TOLERANCE: u64 = 3;

/// Which figures are off their table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffTable {
    /// Larger ones and smaller ones.
    EitherWay,
    /// Larger ones: a smaller one is welcome.
    Above,
}

/// A document with tables.
#[derive(Clone, Copy, Debug)]
pub struct Document {
    /// Where it is in the repository.
    path: &'static str,
    /// The command that writes its tables.
    command: &'static str,
}

/// The needs of the firmware's images.
pub const FIRMWARE: Document =
    Document { path: "docs/reference/firmware-figures.md", command: "cargo xtask figures" };

/// The cost of the simulator's runs.
pub const SPEED: Document =
    Document { path: "sim/tests/counts/instructions.md", command: "cargo xtask cost" };

/// The document's text before the lines of a table, these lines, and the text behind them. A table stands between
/// `<!-- NAME -->` and `<!-- end -->`.
fn parts<'a>(text: &'a str, name: &str) -> Result<(&'a str, &'a str, &'a str)> {
    let begin = format!("<!-- {name} -->\n");
    let begin = text.find(&begin).map(|at| at + begin.len());
    let (before, rest) = text.split_at(begin.with_context(|| format!("there is no table {name}"))?);
    let end = rest.find("<!-- end -->").with_context(|| format!("table {name} has no end"))?;
    Ok((before, &rest[..end], &rest[end..]))
}

impl Document {
    fn file(&self) -> PathBuf {
        root().join(self.path)
    }
}

/// The lines of a table of a document.
///
/// # Errors
/// When there is no document, or no such table in it.
pub fn lines(document: Document, name: &str) -> Result<String> {
    let text = fs::read_to_string(document.file())?;
    parts(&text, name).map(|(_, lines, _)| lines.to_owned())
}

/// Writes a table of a document again.
///
/// # Errors
/// When there is no document, or no such table in it.
pub fn write(document: Document, name: &str, table: &str) -> Result<()> {
    let text = fs::read_to_string(document.file())?;
    let (before, _, behind) = parts(&text, name)?;
    Ok(fs::write(document.file(), format!("{before}{table}{behind}"))?)
}

/// Compares the figures of a table with those of a document.
///
/// # Errors
/// When one is off by more than 3 %, or the tables differ in form; with the remedy.
pub fn hold(document: Document, name: &str, table: &str, off: OffTable) -> Result<()> {
    let advice = format!("if that is meant, write the tables anew: {}", document.command);
    compare(&lines(document, name)?, table, off)
        .with_context(|| format!("table {name} of {}; {advice}", document.path))
}

fn compare(written: &str, measured: &str, off: OffTable) -> Result<()> {
    ensure!(numbers(written).len() == numbers(measured).len(), "the tables have not the same figures");
    for (old, new) in written.lines().zip(measured.lines()) {
        for (written, measured) in numbers(old).into_iter().zip(numbers(new)) {
            let by = match off {
                OffTable::EitherWay => written.abs_diff(measured),
                OffTable::Above => measured.saturating_sub(written),
            };
            ensure!(by * 100 <= TOLERANCE * written, "it says {written}, and it is {measured}, in {new}");
        }
    }
    Ok(())
}

fn numbers(table: &str) -> Vec<u64> {
    table.split([' ', '|', '\n']).filter_map(|word| word.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "before\n<!-- one -->\n| a | 100 |\n<!-- end -->\n<!-- two -->\n| b | 7 / 8 |\n<!-- end -->\n";

    #[test]
    fn a_table_stands_between_its_marks() {
        let (before, table, behind) = parts(TEXT, "two").expect("a table");
        assert_eq!(table, "| b | 7 / 8 |\n");
        assert_eq!(format!("{before}{table}{behind}"), TEXT);
        assert!(parts(TEXT, "three").is_err());
        assert!(parts("<!-- one -->\n", "one").is_err());
    }

    #[test]
    fn figures_may_be_off_by_three_per_cent() {
        let compared = |measured, off| compare("| a | 100 |", measured, off);
        assert!(compared("| a | 103 |", OffTable::EitherWay).is_ok());
        for measured in ["| a | 104 |", "| a | 96 |", "| a | 100 / 100 |"] {
            assert!(compared(measured, OffTable::EitherWay).is_err(), "{measured}");
        }
    }

    #[test]
    fn where_less_is_welcome_only_more_is_off() {
        let compared = |measured| compare("| a | 100 |", measured, OffTable::Above);
        assert!(compared("| a | 50 |").is_ok() && compared("| a | 103 |").is_ok());
        assert!(compared("| a | 104 |").is_err() && compared("| a | 50 / 50 |").is_err());
    }

    #[test]
    fn a_figure_that_is_off_says_where_and_what_to_do() {
        let error =
            hold(SPEED, "instructions", "| servo-a | 1 |\n", OffTable::Above).expect_err("other figures");
        let said = format!("{error:#}");
        assert!(
            said.contains("instructions of sim/tests/counts/instructions.md")
                && said.contains("cargo xtask cost"),
            "{said}"
        );
    }
}
