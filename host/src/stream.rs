//! The rows of a stream in their order: what has come, what is to be asked for again. No input or output.

use std::collections::BTreeMap;

use pneudrive_protocol::{MAX_ROWS, StreamedSample};

/// Rows on their way from the link to the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arrivals {
    /// Number of the next row to be taken.
    next: u32,
    /// Rows from there on that have come, and those that are gone.
    held: BTreeMap<u32, Option<StreamedSample>>,
    lost: u64,
}

impl Arrivals {
    /// Rows have come, numbered from `first` on: unasked or asked for again, once or twice.
    pub fn came(&mut self, first: u32, rows: impl IntoIterator<Item = StreamedSample>) {
        let numbered = (first..).zip(rows).filter(|(number, _)| *number >= self.next);
        self.held.extend(numbered.map(|(number, row)| (number, Some(row))));
    }

    /// Number and count of rows to be asked for again: later ones have come.
    #[must_use]
    pub fn missing(&self) -> Option<(u32, u8)> {
        let mut due = self.next;
        for &number in self.held.keys() {
            if number > due {
                return Some((due, (number - due).min(MAX_ROWS as u32) as u8));
            }
            due = number + 1;
        }
        None
    }

    /// Rows before this one that have not come will not come any more.
    pub fn gone(&mut self, until: u32) {
        for number in self.next..until {
            self.held.entry(number).or_insert(None);
        }
    }

    /// The next row, if it has come.
    pub fn take(&mut self) -> Option<StreamedSample> {
        while let Some(held) = self.held.remove(&self.next) {
            self.next += 1;
            match held {
                Some(row) => return Some(row),
                None => self.lost += 1,
            }
        }
        None
    }

    /// Number of the row behind the last one that has come.
    #[must_use]
    pub fn end(&self) -> u32 {
        self.held.last_key_value().map_or(self.next, |(&last, _)| last + 1)
    }

    /// Number of the next row to be taken.
    #[must_use]
    pub fn next(&self) -> u32 {
        self.next
    }

    /// Rows that the link has lost for good, of those that were passed over.
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
        std::iter::from_fn(|| arrivals.take()).map(|row| row.index).collect()
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
}
