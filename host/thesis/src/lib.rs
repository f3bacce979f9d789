//! The thesis, reproduced: the numbers in the text of its chapters 7 and 8 with which the model can be compared.
//!
//! An [`Exhibit`] is one table, figure or section of the thesis: its printed values ([`Entry`], a line each), the
//! experiment that repeats it, and the command that repeats the experiment. The experiment gives a [`Reading`] for
//! each entry, with its basis. [`Agreement`] is always computed from the two. The application studies
//! ([`crate::study`]) are exhibits, too: their statements are entries without a number.
//!
//! | module | holds |
//! |---|---|
//! | [`characteristics`] | the component tests, on a bench made of the simulator's very parts, a curve each |
//! | [`measured_points`] | measured points beside such a curve |
//! | [`study`] | the application studies: what the thesis says, and what the model shows |
//! | `chapter_7`, `chapter_8` | the exhibits, and their experiments |
//! | `reading` | the result of an experiment, and whether it agrees |
//! | `number` | numbers as the thesis prints them |
//! | `study_exhibit` | the exhibits that are application studies |
//! | `runs`, `shown` | runs the exhibits on all processors; an exhibit with its results |
//! | `page`, `table`, `chart`, `bar` | the page, its tables and graphs, and the bars that hold printed and found beside each other |
//! | `golden` | the readings as TOML, and the changes against an older file |
//!
//! To add a number: a line in the entries of its exhibit, and a reading of the same key in the experiment.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod bar;
mod chapter_7;
mod chapter_8;
pub mod characteristics;
mod chart;
mod drives;
pub mod golden;
pub mod measured_points;
mod number;
mod page;
mod reading;
mod runs;
mod shown;
pub mod study;
mod study_exhibit;
mod table;

use anyhow::Result;

pub use chart::{Chart, Line};
pub use number::value_of;
pub use page::{html, summary_line, title};
pub use reading::{Agreement, Found, Reading};
pub use runs::{lasts, run};
pub use shown::Shown;

/// One table, figure or section of the thesis.
#[derive(Debug)]
pub struct Exhibit {
    /// Its section, such as `7.1.2.1`.
    pub section: &'static str,
    /// Its figure or table, such as `Fig. 7.6`.
    pub place: &'static str,
    /// Its topic.
    pub about: &'static str,
    /// The part of it that the scan has lost; "" if nothing.
    pub lost: &'static str,
    /// Commands that repeat it, a line each.
    pub commands: &'static [&'static str],
    /// Its printed values.
    pub entries: &'static [Entry],
    /// The most likely reason for differences, as tried out; "" if nothing differs.
    pub why: &'static str,
    /// The command that repeats it.
    pub experiment: Experiment,
    /// Its time on one core, s, roughly.
    pub takes_s: f64,
}

/// The experiment of an exhibit.
#[derive(Clone, Copy, Debug)]
pub enum Experiment {
    /// An experiment of its own.
    Own(fn() -> Result<Measured>),
    /// The application study of this name, whose statements are further entries.
    Study(&'static str),
}

/// Something that the thesis prints.
#[derive(Debug)]
pub struct Entry {
    /// Its name within the exhibit, the same as that of its reading.
    pub key: &'static str,
    /// Its meaning.
    pub what: &'static str,
    /// The printed value.
    pub printed: Printed,
    /// Whether it repeats a number under another reading of the text, and is not counted.
    pub alternative: bool,
}

/// The printed form of an entry.
#[derive(Clone, Copy, Debug)]
pub enum Printed {
    /// A number.
    Number {
        /// As printed.
        text: &'static str,
        /// Its unit, or "".
        unit: &'static str,
        /// A difference up to this agrees.
        within: f64,
        /// Where that tolerance comes from.
        source: &'static str,
    },
    /// A sentence; the experiment judges it.
    Sentence(&'static str),
}

/// The result of an experiment.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// A reading for each entry.
    pub readings: Vec<Reading>,
    /// Its graphs.
    pub charts: Vec<Chart>,
}

impl Entry {
    /// A number of the text.
    const fn number(
        key: &'static str,
        what: &'static str,
        [text, unit]: [&'static str; 2],
        within: f64,
        source: &'static str,
    ) -> Entry {
        let printed = Printed::Number { text, unit, within, source };
        Entry { key, what, printed, alternative: false }
    }

    /// A sentence of the text.
    const fn sentence(key: &'static str, sentence: &'static str) -> Entry {
        Entry { key, what: "", printed: Printed::Sentence(sentence), alternative: false }
    }

    /// The same under another reading of the text.
    const fn alternative(self) -> Entry {
        Entry { alternative: true, ..self }
    }
}

/// All exhibits, in the order of the thesis.
#[must_use]
pub fn exhibits() -> Vec<&'static Exhibit> {
    chapter_7::EXHIBITS.iter().copied().chain(chapter_8::EXHIBITS).flatten().collect()
}

/// The exhibits of a section and of those within it: `7.1` holds 7.1.2.1 and not 7.10.
#[must_use]
pub fn within(section: &str) -> Vec<&'static Exhibit> {
    let of_section = |exhibit: &&Exhibit| {
        exhibit.section.strip_prefix(section).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    exhibits().into_iter().filter(of_section).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_can_be_read_and_every_key_stands_once_in_its_exhibit() {
        for exhibit in exhibits() {
            let mut keys: Vec<&str> = exhibit.entries.iter().map(|entry| entry.key).collect();
            keys.sort_unstable();
            assert!(keys.windows(2).all(|pair| pair[0] != pair[1]), "{}: {keys:?}", exhibit.place);
            for entry in exhibit.entries {
                if let Printed::Number { text, within, source, .. } = entry.printed {
                    assert!(
                        value_of(text).is_finite() && within > 0.0 && !source.is_empty(),
                        "{}",
                        entry.key
                    );
                }
            }
        }
    }

    #[test]
    fn every_statement_of_every_study_is_on_the_page_once() {
        for study in crate::study::STUDIES {
            let shown = exhibits().into_iter().filter(
                |exhibit| matches!(exhibit.experiment, Experiment::Study(name) if name == study.name),
            );
            assert_eq!(shown.count(), 1, "{}", study.name);
        }
    }

    #[test]
    fn a_section_holds_those_within_it_and_no_others() {
        let sections = |of: &str| within(of).iter().map(|exhibit| exhibit.section).collect::<Vec<_>>();
        assert!(sections("7.1").contains(&"7.1.2.1") && !sections("7.1").contains(&"7.2.1"));
        assert!(sections("7.1.2.1").iter().all(|section| *section == "7.1.2.1"));
        assert!(sections("7.").is_empty() && sections("9").is_empty() && sections("").is_empty());
    }
}
