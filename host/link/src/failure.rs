//! Why a request to a rig failed: a kind for programs, and a message for people.

use std::error::Error as StdError;
use std::fmt::{self, Debug, Display, Formatter};

use anyhow::Error;

/// The kind of failure of a request or a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The port cannot be opened, or nothing answers there.
    NoAnswer,
    /// The rig refuses: its state does not allow it, or another host commands the drive.
    Refused,
    /// The drive has tripped.
    Tripped,
    /// The run was stopped because the caller asked for it.
    Interrupted,
}

impl Failure {
    /// An error of this kind.
    pub fn error(self, message: impl Display) -> Error {
        self.of(anyhow::anyhow!("{message}"))
    }

    /// The same error, marked as one of this kind.
    #[must_use]
    pub fn of(self, error: Error) -> Error {
        Marked { mark: self, error }.into()
    }

    /// The kind of one cause in the chain of an error; None if the cause is not of this crate.
    #[must_use]
    pub fn of_cause(cause: &(dyn StdError + 'static)) -> Option<Failure> {
        cause.downcast_ref::<Marked<Failure>>().map(|marked| marked.mark)
    }
}

/// An error marked with its kind; it reads like the error itself.
#[derive(Debug)]
pub struct Marked<K> {
    /// The kind.
    pub mark: K,
    /// The error.
    pub error: Error,
}

impl<K> Display for Marked<K> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Display::fmt(&self.error, f)
    }
}

impl<K: Debug> StdError for Marked<K> {
    fn source(&self) -> Option<&(dyn StdError + 'static)> {
        self.error.source()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn an_error_keeps_its_kind_and_its_text_under_any_context() {
        let error = Failure::Tripped.of(anyhow::anyhow!("the cause").context("it tripped"));
        let error = Err::<(), _>(error).context("run").context("demo").expect_err("an error");
        assert_eq!(error.chain().find_map(Failure::of_cause), Some(Failure::Tripped));
        assert_eq!(format!("{error:#}"), "demo: run: it tripped: the cause");
    }

    #[test]
    fn an_error_of_another_crate_has_no_kind() {
        assert_eq!(anyhow::anyhow!("a file").chain().find_map(Failure::of_cause), None);
    }
}
