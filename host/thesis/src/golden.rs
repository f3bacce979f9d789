//! The readings as TOML, and the differences from an older file, which show changes of the model.
//!
//! ```toml
//! # pneudrive: the thesis in numbers; written by `pneudrive thesis`
//! # 40 printed numbers: 18 agree, ...
//!
//! [["7.1.2.1 Fig. 7.6".number]]
//! key = "2 N"
//! verdict = "agrees"
//! value = 0.2031
//! low = 0.2029
//! high = 0.2034
//! tolerance = 0.0005
//! ```
//!
//! A figure has changed if its value or an end of its range is off by more than the tolerance, a sentence if its verdict
//! is another one.

use std::fmt::Write;

use anyhow::{Context, Result};
use toml_edit::{DocumentMut, Item, Table};

use super::{Found, Reading, Shown, summary_line};

/// First line of a file.
pub const MARK: &str = "# pneudrive: the thesis in numbers";

/// Readings of one exhibit, under `section place`.
fn heading(one: &Shown) -> String {
    format!("{} {}", one.exhibit.section, one.exhibit.place).trim_end().to_owned()
}

/// The readings as a file.
#[must_use]
pub fn to_toml(shown: &[Shown]) -> String {
    let mut text = format!("{MARK}; written by `pneudrive thesis`\n# {}\n", summary_line(shown));
    for one in shown {
        for (entry, reading) in one.rows() {
            let verdict = reading.agreement(&entry).word();
            let _ = write!(
                text,
                "\n[[{:?}.number]]\nkey = {:?}\nverdict = {verdict:?}\n",
                heading(one),
                reading.key
            );
            if let Some(figures) = Figures::of(reading) {
                let Figures { value, low, high, tolerance } = figures;
                let _ = writeln!(
                    text,
                    "value = {value:?}\nlow = {low:?}\nhigh = {high:?}\ntolerance = {tolerance:?}"
                );
            }
        }
    }
    text
}

/// The figures of a reading.
struct Figures {
    value: f64,
    low: f64,
    high: f64,
    tolerance: f64,
}

impl Figures {
    /// Off by half of its last digit that is shown, a figure has changed.
    fn of(reading: &Reading) -> Option<Figures> {
        let (value, [low, high], decimals) = match reading.found {
            Found::Figure { value, range, decimals } | Found::SizeOnly { value, range, decimals } => {
                (value, range, decimals)
            }
            Found::TakenOver { value, decimals } => (value, [value; 2], decimals),
            Found::Shows { .. } | Found::Nothing(_) => return None,
        };
        Some(Figures { value, low, high, tolerance: 0.5 * 10_f64.powi(-(decimals as i32)) })
    }
}

/// The changes against an older file, a line each, for the exhibits that were run. Empty if nothing has changed.
///
/// # Errors
/// When the file is not one of [`to_toml`].
pub fn changes(older: &str, shown: &[Shown]) -> Result<Vec<String>> {
    let document: DocumentMut = older.parse().context("the golden file is not TOML")?;
    let mut changed = Vec::new();
    for one in shown {
        let heading = heading(one);
        let known =
            document.get(&heading).and_then(|item| item.get("number")).and_then(Item::as_array_of_tables);
        let known: Vec<&Table> = known.into_iter().flatten().collect();
        if known.len() != one.rows().count() {
            changed.push(format!(
                "{heading}: {} numbers, and the golden file has {}",
                one.rows().count(),
                known.len()
            ));
        }
        for ((entry, reading), table) in one.rows().zip(known) {
            let verdict = reading.agreement(&entry).word();
            changed.extend(change(&heading, reading, verdict, table));
        }
    }
    Ok(changed)
}

fn change(heading: &str, reading: &Reading, verdict: &str, table: &Table) -> Option<String> {
    let word = |key: &str| table.get(key).and_then(Item::as_str).unwrap_or_default();
    let number = |key: &str| table.get(key).and_then(Item::as_float);
    let name = format!("{heading}, {}", reading.key);
    if word("key") != reading.key {
        return Some(format!("{name}: the golden file has {:?} in its place", word("key")));
    }
    if word("verdict") != verdict {
        return Some(format!("{name}: {verdict}, and it was {:?}", word("verdict")));
    }
    let Some(Figures { value, low, high, .. }) = Figures::of(reading) else {
        return number("value").map(|was| format!("{name}: no figure any more, and it was {was}"));
    };
    let tolerance = number("tolerance").unwrap_or(0.0);
    let off = [("value", value), ("low", low), ("high", high)].into_iter().find(|(key, now)| {
        // NaN counts as changed.
        !number(key).is_some_and(|was| (was - now).abs() <= tolerance)
    });
    let was = |key: &str| number(key).map_or_else(|| "no figure".to_owned(), |was| format!("{was:?}"));
    off.map(|(key, now)| format!("{name}: {key} is {now:?}, was {}, within {tolerance:?}", was(key)))
}

#[cfg(test)]
mod tests {
    use super::super::{runs, within};
    use super::*;

    fn shown() -> Vec<Shown> {
        runs::run(&within("7.1.3.3"), 1, |_, _| {}).expect("volumes")
    }

    #[test]
    fn a_file_holds_what_was_found_and_tells_what_has_changed() {
        let text = to_toml(&shown());
        assert!(text.starts_with(MARK));
        assert_eq!(changes(&text, &shown()).expect("a file"), Vec::<String>::new());
        let other = text.replacen("value = 1.96", "value = 2.96", 1);
        let told = changes(&other, &shown()).expect("a file");
        assert_eq!(told.len(), 1);
        assert!(
            told[0].starts_with("7.1.3.3 Tab. 7.3, asymmetric: value is 1.9634954084936214e-5, was 2.96"),
            "{told:?}"
        );
        let other = text.replacen("\"agrees\"", "\"differs\"", 1);
        assert!(changes(&other, &shown()).expect("a file")[0].ends_with("agrees, and it was \"differs\""));
    }

    #[test]
    fn a_number_that_is_new_or_gone_is_told() {
        assert_eq!(changes(MARK, &shown()).expect("a file").len(), 1);
        assert!(changes("[", &shown()).is_err());
    }
}
