//! The tables of docs/firmware-figures.md, which programs write and tests hold.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use crate::cargo::root;

/// How far a figure may be off its table, per cent.
const TOLERANCE: u64 = 3;

/// What writes the tables anew.
const ADVICE: &str = "if that is meant, write the tables anew: cargo xtask figures";

/// The document's text before the lines of a table, these lines, and the text behind them. A table stands between
/// `<!-- NAME -->` and `<!-- end -->`.
fn parts<'a>(text: &'a str, name: &str) -> Result<(&'a str, &'a str, &'a str)> {
    let begin = format!("<!-- {name} -->\n");
    let begin = text.find(&begin).map(|at| at + begin.len());
    let (before, rest) = text.split_at(begin.with_context(|| format!("there is no table {name}"))?);
    let end = rest.find("<!-- end -->").with_context(|| format!("table {name} has no end"))?;
    Ok((before, &rest[..end], &rest[end..]))
}

fn document() -> PathBuf {
    root().join("docs/firmware-figures.md")
}

/// Writes a table of the document anew.
///
/// # Errors
/// When there is no document, or no such table in it.
pub fn write(name: &str, table: &str) -> Result<()> {
    let text = fs::read_to_string(document())?;
    let (before, _, behind) = parts(&text, name)?;
    Ok(fs::write(document(), format!("{before}{table}{behind}"))?)
}

/// Compares the figures of a table with those of the document.
///
/// # Errors
/// When one is off by more than 3 %, or the tables are not of one form; with what to do.
pub fn hold(name: &str, table: &str) -> Result<()> {
    let text = fs::read_to_string(document())?;
    compare(parts(&text, name)?.1, table).with_context(|| format!("table {name} of docs/firmware-figures.md"))
}

fn compare(written: &str, measured: &str) -> Result<()> {
    let (written, measured) = (numbers(written), numbers(measured));
    ensure!(written.len() == measured.len(), "the tables have not the same figures; {ADVICE}");
    for (written, measured) in written.into_iter().zip(measured) {
        let off = written.abs_diff(measured) * 100;
        ensure!(off <= TOLERANCE * written, "it says {written}, and it is {measured}; {ADVICE}");
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
    fn figures_may_be_off_by_three_per_cent_and_say_what_to_do_beyond() {
        assert!(compare("| a | 100 |", "| a | 103 |").is_ok());
        for measured in ["| a | 104 |", "| a | 96 |", "| a | 100 / 100 |"] {
            let error = format!("{:#}", compare("| a | 100 |", measured).expect_err(measured));
            assert!(error.contains("cargo xtask figures"), "{error}");
        }
    }
}
