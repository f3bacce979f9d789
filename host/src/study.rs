//! The application studies of the thesis (chapter 8) and its published comparisons (7.3), run on the model.
//!
//! A [`Study`] names rigs with settings, what the thesis says of them, and for each such statement a
//! predicate over the runs. What the model shows and whether it agrees is computed from the runs, never
//! written. The rigs of the thesis are not here: where it compares with one, the model without the change
//! stands in for it.

mod catalogue;
mod outcome;
mod page;
mod runs;

pub use catalogue::STUDIES;
pub use outcome::Outcome;
pub use page::{index, page, statements, summary};
pub use runs::run;

/// A study.
#[derive(Debug)]
pub struct Study {
    /// What a user types.
    pub name: &'static str,
    /// Its section in the thesis.
    pub section: &'static str,
    /// What it asks.
    pub about: &'static str,
    /// The drives that are run.
    pub variants: &'static [Variant],
    /// What the thesis found.
    pub statements: &'static [Statement],
}

/// A drive of a study: a built-in rig with settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// What it is called in the study.
    pub name: &'static str,
    /// The built-in rig.
    pub rig: &'static str,
    /// `key=value` each.
    pub settings: &'static [&'static str],
}

/// Something the thesis says, and how the runs are asked for it.
#[derive(Debug)]
pub struct Statement {
    /// What the thesis says.
    pub thesis: &'static str,
    /// Asks the runs, which come in the order of the variants.
    pub judge: fn(&[Outcome]) -> Finding,
}

/// What the model shows of a statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// In figures of the runs.
    pub shows: String,
    /// Whether that is what the thesis says.
    pub verdict: Verdict,
}

/// Whether the model shows what the thesis says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It does.
    Agrees,
    /// It does not.
    Differs,
    /// What to compare with is not to be had, or the runs do not show it.
    Open,
}

impl Finding {
    fn new(agrees: bool, shows: String) -> Finding {
        Finding { shows, verdict: if agrees { Verdict::Agrees } else { Verdict::Differs } }
    }

    /// The same where the runs may be too short to show it: `agrees` is None then.
    fn decided(agrees: Option<bool>, shows: String) -> Finding {
        match agrees {
            Some(agrees) => Finding::new(agrees, shows),
            None => Finding { shows: shows + "; the runs do not decide it", verdict: Verdict::Open },
        }
    }

    /// The thesis compares with a graph that the scan has lost.
    fn open(shows: String) -> Finding {
        Finding { shows: shows + "; the graph to compare with is lost", verdict: Verdict::Open }
    }
}

impl Verdict {
    /// As it stands in the tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Open => "open",
        }
    }
}

impl Study {
    /// What the model shows of each statement.
    #[must_use]
    pub fn findings(&self, outcomes: &[Outcome]) -> Vec<Finding> {
        self.statements.iter().map(|statement| (statement.judge)(outcomes)).collect()
    }
}
