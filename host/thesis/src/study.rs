//! The application studies of the thesis (chapter 8) and its published comparisons (7.3), run on the model.
//!
//! A [`Study`] names rigs with settings, statements of the thesis about them, and for each statement a predicate over
//! the runs. The findings and the verdicts are always computed from the runs. Each drive runs from many starts, and a
//! verdict holds if it significantly holds in most of them. Each drive with a change is compared with one without it
//! from the same start: an effect that both show is not due to the change. The rigs of the thesis are not available,
//! so a statement that compares with one is undecided.

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
    /// Its name for the user.
    pub name: &'static str,
    /// Its section in the thesis.
    pub section: &'static str,
    /// Its question.
    pub about: &'static str,
    /// The drives that are run.
    pub variants: &'static [Variant],
    /// The findings of the thesis.
    pub statements: &'static [Statement],
}

/// A drive of a study: a built-in rig with settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// Its name in the study.
    pub name: &'static str,
    /// The built-in rig.
    pub rig: &'static str,
    /// `key=value` each.
    pub settings: &'static [&'static str],
}

/// A statement of the thesis, and how it is tested on the runs.
#[derive(Debug)]
pub struct Statement {
    /// The statement of the thesis.
    pub thesis: &'static str,
    /// Asks the runs of one start, which come in the order of the variants.
    pub judge: fn(&[Outcome]) -> Finding,
}
