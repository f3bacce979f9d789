//! The rows of a stream in their order: which have arrived, which to request again. No input or output.

use std::collections::BTreeMap;

use anyhow::{Result, bail};
use pneudrive_protocol::{MAX_ROWS, StreamedSample};

/// Rows on their way from the link to the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arrivals {
    /// Number of the next row to be taken.
    next: u32,
    /// Rows from there on that have arrived.
    held: BTreeMap<u32, StreamedSample>,
    /// Rows before this one that are not held will not arrive any more.
    settled: u32,
    lost: u64,
    /// Index of the sample that was taken last.
    taken: Option<u32>,
}

impl Arrivals {
    /// Adds rows numbered from `first` on, whether streamed or requested again, once or twice.
    pub fn came(&mut self, first: u32, rows: impl IntoIterator<Item = StreamedSample>) {
        // The largest number is left out, as the row after it would have none.
        let numbered = (first..u32::MAX).zip(rows).filter(|(number, _)| *number >= self.next);
        self.held.extend(numbered);
    }

    /// Number and count of rows to request again: later ones have arrived.
    #[must_use]
    pub fn missing(&self) -> Option<(u32, u8)> {
        let mut due = self.next.max(self.settled);
        for &number in self.held.range(due..).map(|(number, _)| number) {
            if number > due {
                return Some((due, (number - due).min(MAX_ROWS as u32) as u8));
            }
            due = number + 1;
        }
        None
    }

    /// Marks the rows before this one that have not arrived as lost.
    pub fn gone(&mut self, until: u32) {
        self.settled = self.settled.max(until);
    }

    /// The next row, if it has arrived and the run has reached its sample.
    ///
    /// # Errors
    /// When its sample is not later than that of the row before.
    pub fn take(&mut self, reached: u32) -> Result<Option<StreamedSample>> {
        let first = self.held.first_key_value().map(|(&number, &row)| (number, row));
        let due = first.map_or(self.settled, |(number, _)| number.min(self.settled)).max(self.next);
        self.lost += u64::from(due - self.next);
        self.next = due;
        let Some((number, row)) = first.filter(|(number, row)| *number == due && row.index <= reached) else {
            return Ok(None);
        };
        if let Some(taken) = self.taken.filter(|&taken| row.index <= taken) {
            bail!("its stream goes back, from sample {taken} to sample {}", row.index);
        }
        self.held.remove(&number);
        (self.next, self.taken) = (number + 1, Some(row.index));
        Ok(Some(row))
    }

    /// The sample of a row that has arrived and was not taken.
    #[must_use]
    pub fn waiting(&self) -> Option<u32> {
        self.held.first_key_value().map(|(_, row)| row.index)
    }

    /// Number of the row after the last one that has arrived.
    #[must_use]
    pub fn end(&self) -> u32 {
        self.held.last_key_value().map_or(self.next.max(self.settled), |(&last, _)| last + 1)
    }

    /// Number of the next row to be taken.
    #[must_use]
    pub fn next(&self) -> u32 {
        self.next
    }

    /// Rows that the link has lost for good, of those that were skipped.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(indices: std::ops::Range<u32>) -> impl Iterator<Item = StreamedSample> {
        indices.map(|index| StreamedSample { index, ..StreamedSample::default() })
    }

    fn taken(arrivals: &mut Arrivals) -> Vec<u32> {
        std::iter::from_fn(|| arrivals.take(u32::MAX).expect("in order")).map(|row| row.index).collect()
    }

    #[test]
    fn rows_come_out_in_order_and_once_however_they_come_in() {
        let mut arrivals = Arrivals::default();
        arrivals.came(4, rows(4..6));
        assert!(taken(&mut arrivals).is_empty());
        assert_eq!(arrivals.missing(), Some((0, 4)));
        arrivals.came(0, rows(0..4));
        arrivals.came(2, rows(2..5));
        assert_eq!(taken(&mut arrivals), [0, 1, 2, 3, 4, 5]);
        arrivals.came(0, rows(0..6));
        assert_eq!((taken(&mut arrivals), arrivals.missing(), arrivals.lost()), (vec![], None, 0));
    }

    #[test]
    fn a_gap_behind_rows_that_were_not_taken_yet_is_seen() {
        let mut arrivals = Arrivals::default();
        arrivals.came(0, rows(0..3));
        arrivals.came(5, rows(5..6));
        assert_eq!(arrivals.missing(), Some((3, 2)));
        arrivals.gone(5);
        assert_eq!(arrivals.missing(), None);
        assert_eq!((taken(&mut arrivals), arrivals.lost()), (vec![0, 1, 2, 5], 2));
    }

    #[test]
    fn rows_that_are_gone_are_counted_and_passed_over() {
        let mut arrivals = Arrivals::default();
        arrivals.came(40, rows(40..42));
        assert_eq!(arrivals.missing(), Some((0, MAX_ROWS as u8)), "as many as one answer holds");
        arrivals.came(20, rows(20..24));
        arrivals.gone(24);
        assert_eq!((taken(&mut arrivals), arrivals.lost()), ((20..24).collect(), 20));
        assert_eq!(arrivals.missing(), Some((24, 16)));
        arrivals.gone(40);
        assert_eq!((taken(&mut arrivals), arrivals.lost()), (vec![40, 41], 36));
        arrivals.gone(10);
        assert_eq!((arrivals.next(), arrivals.lost()), (42, 36), "what is past stays");
    }

    #[test]
    fn a_row_waits_until_the_run_has_reached_its_sample() {
        let mut arrivals = Arrivals::default();
        arrivals.came(0, rows(10..12));
        assert_eq!(arrivals.take(9).expect("in order"), None);
        assert_eq!(arrivals.take(10).expect("in order").map(|row| row.index), Some(10));
        assert_eq!((arrivals.take(10).expect("in order"), arrivals.waiting()), (None, Some(11)));
        assert_eq!((taken(&mut arrivals), arrivals.waiting()), (vec![11], None));
    }

    #[test]
    fn rows_whose_samples_go_back_are_refused() {
        for second in [5, 4] {
            let mut arrivals = Arrivals::default();
            arrivals.came(0, rows(5..6).chain(rows(second..second + 1)));
            assert!(arrivals.take(9).expect("the first").is_some());
            let error = arrivals.take(9).expect_err("not behind it").to_string();
            assert!(error.contains(&format!("from sample 5 to sample {second}")), "{error}");
        }
    }

    /// Once each of them took its place in memory.
    #[test]
    fn four_thousand_million_rows_that_are_gone_cost_nothing() {
        let mut arrivals = Arrivals::default();
        arrivals.came(u32::MAX, rows(0..3));
        assert_eq!((arrivals.end(), arrivals.missing()), (0, None), "there is no number behind it");
        arrivals.came(u32::MAX - 1, rows(7..12));
        assert_eq!(arrivals.missing(), Some((0, MAX_ROWS as u8)));
        arrivals.gone(u32::MAX - 1);
        assert_eq!(taken(&mut arrivals), [7]);
        assert_eq!((arrivals.next(), arrivals.lost()), (u32::MAX, u64::from(u32::MAX) - 1));
        arrivals.gone(u32::MAX);
        assert_eq!((taken(&mut arrivals), arrivals.missing()), (vec![], None));
    }
}
