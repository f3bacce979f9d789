//! An exhibit with its results.

use anyhow::{Context, Result, ensure};

use super::{Agreement, Chart, Entry, Exhibit, Reading};
use crate::study::Statement;

/// An exhibit, the readings of its entries, and its graphs.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The printed values of the thesis.
    pub exhibit: &'static Exhibit,
    /// The readings of its entries, followed by those of its study.
    pub readings: Vec<Reading>,
    /// The statements of its study, as entries.
    pub statements: &'static [Statement],
    /// Its graphs.
    pub charts: Vec<Chart>,
}

impl Shown {
    /// Each entry with its reading: meaning, printed value, result.
    pub fn rows(&self) -> impl Iterator<Item = (Entry, &Reading)> {
        let of_study = self.statements.iter().map(|statement| Entry::sentence("", statement.thesis));
        let own = self.exhibit.entries.iter().map(|entry| Entry { ..*entry });
        own.chain(of_study).zip(&self.readings)
    }

    /// How many of its entries agree, differ and so on; other readings of the text do not count.
    #[must_use]
    pub fn count(&self, agreement: Agreement) -> usize {
        self.rows()
            .filter(|(entry, reading)| !entry.alternative && reading.agreement(entry) == agreement)
            .count()
    }
}

/// The readings in the order of the entries.
pub(super) fn in_order(exhibit: &Exhibit, mut readings: Vec<Reading>) -> Result<Vec<Reading>> {
    let mut ordered = Vec::new();
    for entry in exhibit.entries {
        let place = readings.iter().position(|reading| reading.key == entry.key);
        let place =
            place.with_context(|| format!("{}: nothing was read of {:?}", exhibit.place, entry.key))?;
        ordered.push(readings.swap_remove(place));
    }
    ensure!(readings.is_empty(), "{}: no entry for {:?}", exhibit.place, readings[0].key);
    Ok(ordered)
}
