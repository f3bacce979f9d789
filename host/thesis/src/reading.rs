//! The result of an experiment for an entry, and whether it agrees with the thesis.
//!
//! ```text
//! agrees             the whole range of the figure lies within the tolerance of the printed number
//! in part            a part of it does
//! differs            none of it does
//! cannot be decided  the thesis compares with what is lost, or the model has nothing to show
//! ```

use super::number::value_of;
use super::{Entry, Printed};
use crate::study::{self, Verdict};

/// The result of an experiment for the entry of the same key.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The key of the entry.
    pub key: String,
    /// The result.
    pub found: Found,
    /// Its basis: how it was read, over how many starts or draws.
    pub rests_on: String,
}

/// A result.
#[derive(Clone, Debug, PartialEq)]
pub enum Found {
    /// A figure with its range.
    Figure {
        /// The figure of the rig as it is.
        value: f64,
        /// Smallest and largest figure.
        range: [f64; 2],
        /// Known digits after the point.
        decimals: usize,
    },
    /// The same, where the thesis compared with data that are lost: it only shows the size of the figure.
    SizeOnly {
        /// The figure of the rig as it is.
        value: f64,
        /// Smallest and largest figure.
        range: [f64; 2],
        /// Known digits after the point.
        decimals: usize,
    },
    /// The rig file has the number from the thesis, and the model gives it back.
    TakenOver {
        /// The model's value.
        value: f64,
        /// Digits after the point.
        decimals: usize,
    },
    /// The finding of the runs on a sentence.
    Shows {
        /// In words, with figures.
        text: String,
        /// Whether it agrees with the sentence.
        agreement: Agreement,
    },
    /// The model has nothing to compare with the entry, and why.
    Nothing(&'static str),
}

/// Whether the result agrees with the printed value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// It agrees.
    Agrees,
    /// A part of the range agrees, or some of the starts do.
    InPart,
    /// It does not agree.
    Differs,
    /// Nothing decides it.
    Open,
    /// The rig has it from the thesis, so it cannot differ.
    TakenOver,
}

/// All of them, in the order of the page's summary.
pub const AGREEMENTS: [Agreement; 5] =
    [Agreement::Agrees, Agreement::InPart, Agreement::Differs, Agreement::Open, Agreement::TakenOver];

impl Agreement {
    /// Its text on the page and in the golden file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Agreement::Agrees => "agrees",
            Agreement::InPart => "in part",
            Agreement::Differs => "differs",
            Agreement::Open => "cannot be decided",
            Agreement::TakenOver => "taken over",
        }
    }

    /// The verdict on several: they agree, they differ.
    #[must_use]
    pub fn of_many(self) -> &'static str {
        match self {
            Agreement::Agrees => "agree",
            Agreement::InPart => "agree in part",
            Agreement::Differs => "differ",
            Agreement::Open | Agreement::TakenOver => self.word(),
        }
    }

    /// The verdict on a sentence that holds or does not.
    pub(super) fn of(holds: bool) -> Agreement {
        if holds { Agreement::Agrees } else { Agreement::Differs }
    }
}

impl Reading {
    /// A figure that is the same in every run.
    pub(super) fn exact(key: &str, value: f64, decimals: usize, rests_on: impl Into<String>) -> Reading {
        let found = Found::Figure { value, range: [value; 2], decimals };
        Reading { key: key.to_owned(), found, rests_on: rests_on.into() }
    }

    /// A figure with this uncertainty.
    pub(super) fn read(
        key: &str,
        value: f64,
        within: f64,
        decimals: usize,
        rests_on: impl Into<String>,
    ) -> Reading {
        let found = Found::Figure { value, range: [value - within, value + within], decimals };
        Reading { key: key.to_owned(), found, rests_on: rests_on.into() }
    }

    /// A figure over several runs, the rig as it is first; nothing if no run shows it.
    pub(super) fn over(key: &str, values: &[f64], decimals: usize, rests_on: impl Into<String>) -> Reading {
        let found = match values.first() {
            Some(value) => Found::Figure { value: *value, range: ends(values), decimals },
            None => Found::Nothing("no run shows it"),
        };
        Reading { key: key.to_owned(), found, rests_on: rests_on.into() }
    }

    /// The finding of the runs on a sentence.
    pub(super) fn shows(key: &str, holds: bool, text: String, rests_on: impl Into<String>) -> Reading {
        let found = Found::Shows { text, agreement: Agreement::of(holds) };
        Reading { key: key.to_owned(), found, rests_on: rests_on.into() }
    }

    /// Nothing to compare with the entry.
    pub(super) fn nothing(key: &str, why: &'static str) -> Reading {
        Reading { key: key.to_owned(), found: Found::Nothing(why), rests_on: String::new() }
    }

    /// The finding of a study on a statement.
    pub(super) fn of_study(key: String, finding: &study::Finding, starts: usize) -> Reading {
        let agreement = match finding.verdict {
            Verdict::Agrees => Agreement::Agrees,
            Verdict::Differs => Agreement::Differs,
            Verdict::Open => Agreement::Open,
            Verdict::Depends => Agreement::InPart,
        };
        let (text, shares) = finding.shows.split_once(". Starts that agree").unwrap_or((&finding.shows, ""));
        let rests_on = match shares {
            "" => format!("{starts} starts"),
            shares => format!("starts that agree{shares}"),
        };
        Reading { key, found: Found::Shows { text: text.to_owned(), agreement }, rests_on }
    }

    /// Whether it equals the printed value of the entry.
    #[must_use]
    pub fn agreement(&self, entry: &Entry) -> Agreement {
        match (&self.found, entry.printed) {
            (Found::Shows { agreement, .. }, _) => *agreement,
            (Found::TakenOver { .. }, _) => Agreement::TakenOver,
            (Found::Figure { range, .. }, Printed::Number { text, within, .. }) => {
                of_range(*range, value_of(text), within)
            }
            (Found::SizeOnly { .. } | Found::Nothing(_) | Found::Figure { .. }, _) => Agreement::Open,
        }
    }
}

fn of_range([low, high]: [f64; 2], printed: f64, within: f64) -> Agreement {
    // The tolerance is a decimal fraction: a value on its edge is within it.
    let [least, most] = [printed - within * (1.0 + 1e-9), printed + within * (1.0 + 1e-9)];
    match () {
        () if low >= least && high <= most => Agreement::Agrees,
        () if high < least || low > most => Agreement::Differs,
        () => Agreement::InPart,
    }
}

/// Smallest and largest.
pub(super) fn ends(values: &[f64]) -> [f64; 2] {
    let each = |of: fn(f64, f64) -> f64| values.iter().copied().reduce(of).unwrap_or(f64::NAN);
    [each(f64::min), each(f64::max)]
}

impl Found {
    /// In words: a figure with its range if that is more than its digits show.
    #[must_use]
    pub fn formatted(&self, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match self {
            Found::Figure { value, range: [low, high], decimals }
            | Found::SizeOnly { value, range: [low, high], decimals } => {
                let [value, low, high] = [value, low, high].map(|value| rounded(*value, *decimals));
                if low == high {
                    format!("{value}{unit}")
                } else {
                    format!("{value} ({low} to {high}){unit}")
                }
            }
            Found::TakenOver { value, decimals } => format!("{}{unit}", rounded(*value, *decimals)),
            Found::Shows { text, .. } => text.clone(),
            Found::Nothing(why) => (*why).to_owned(),
        }
    }
}

/// This many digits after the point; a value that rounds to zero has no sign.
pub(super) fn rounded(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRY: Entry = Entry::number("loop", "loop", ["0.21", "A"], 0.009, "two digits");

    #[test]
    fn a_range_agrees_as_a_whole_in_part_or_not_at_all() {
        let of = |low: f64, high: f64| {
            let found = Found::Figure { value: low, range: [low, high], decimals: 3 };
            Reading { key: "loop".to_owned(), found, rests_on: String::new() }.agreement(&ENTRY)
        };
        assert_eq!(of(0.203, 0.219), Agreement::Agrees, "its edge is within it");
        assert_eq!(of(0.19, 0.203), Agreement::InPart);
        assert_eq!(of(0.16, 0.18), Agreement::Differs);
        assert_eq!(of(0.1, 0.3), Agreement::InPart, "wider than the tolerance");
    }

    #[test]
    fn a_number_that_the_rig_was_given_neither_agrees_nor_differs() {
        let given = Reading {
            key: "loop".to_owned(),
            found: Found::TakenOver { value: 0.3, decimals: 2 },
            rests_on: String::new(),
        };
        assert_eq!(given.agreement(&ENTRY), Agreement::TakenOver);
        assert_eq!(Reading::nothing("loop", "lost").agreement(&ENTRY), Agreement::Open);
        assert_eq!(Reading::over("loop", &[], 1, "").agreement(&ENTRY), Agreement::Open);
    }

    #[test]
    fn a_figure_is_said_with_its_range_where_its_digits_show_one() {
        assert_eq!(Reading::read("a", 8.04, 0.5, 1, "").found.formatted("Hz"), "8.0 (7.5 to 8.5) Hz");
        assert_eq!(Reading::read("a", 8.04, 0.001, 1, "").found.formatted("Hz"), "8.0 Hz");
        assert_eq!(rounded(-0.0004, 3), "0.000");
    }

    #[test]
    fn a_verdict_of_a_study_keeps_its_share_of_starts() {
        let shows = "it swings by 2 mm. Starts that agree: 3 of 4, 75 % (30 to 95 %)".to_owned();
        let found =
            Reading::of_study("1".to_owned(), &study::Finding { shows, verdict: Verdict::Depends }, 4);
        assert_eq!(found.rests_on, "starts that agree: 3 of 4, 75 % (30 to 95 %)");
        assert!(matches!(found.found, Found::Shows { agreement: Agreement::InPart, .. }));
    }
}
