//! The application studies of the thesis (chapter 8) and its published comparisons (7.3), run on the model.
//!
//! A [`Study`] names rigs with settings, what the thesis says of them, and for each such statement a predicate over
//! the runs. What the model shows and whether it agrees is always computed from the runs: each drive is run from many
//! starts, and a verdict holds if it significantly holds in most of them. Each drive with a change is compared with one
//! without it from the same start: what both show is not due to the change. The rigs of the thesis are not available: a
//! statement that compares with one is undecided.

mod catalogue;
mod finding;
mod outcome;
mod page;
mod runs;
mod starts;
mod steadiness;

pub use catalogue::STUDIES;
pub use finding::{Finding, Verdict};
pub use outcome::Outcome;
pub use page::{index, page, statements, summary};
pub use runs::{Studied, run};
pub use starts::{STARTS, at_start};
pub use steadiness::{Steadiness, Swing};

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

/// A statement of the thesis, and how it is tested on the runs.
#[derive(Debug)]
pub struct Statement {
    /// What the thesis says.
    pub thesis: &'static str,
    /// Asks the runs of one start, which come in the order of the variants.
    pub judge: fn(&[Outcome]) -> Finding,
}
