//! Exit codes: one for each kind of end, so that a script can distinguish them.

use std::error::Error as StdError;
use std::fmt::Display;
use std::io::{self, ErrorKind};
use std::process::ExitCode;

use anyhow::Error;
use pneudrive_link::failure::{Failure, Marked};

macro_rules! exits {
    ($($name:ident = $code:literal: $meaning:literal)*) => {
        /// A way in which the program ends. Its number is the exit code and never changes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Exit {
            $(#[doc = $meaning] $name = $code,)*
        }

        /// Every end, and what it means to a user.
        pub const EXITS: &[(Exit, &str)] = &[$((Exit::$name, $meaning)),*];
    };
}

exits! {
    Done = 0: "done; a simulated drive that trips and a run that has not converged also count as done, unless `--strict` is given"
    Failed = 1: "failed for a reason without a code of its own, such as errors in a rig or a file"
    Usage = 2: "wrong usage: the command line is wrong or incomplete"
    NotThere = 3: "no such rig, file or folder"
    NoAnswer = 4: "no rig can be reached: the port cannot be opened, nothing answers, or the link broke"
    Refused = 5: "the rig refuses: its state does not allow the request, or another program commands the drive"
    Tripped = 6: "the drive tripped during the run or the homing run; with `simulate --strict`, also a simulated drive"
    NotBorneOut = 7: "the model does not fit, the data cannot decide, or a replay differs from the record"
    Unwritten = 8: "a file or the output cannot be written: the disk is full, or a limit is reached"
    Unconverged = 9: "with `simulate --strict`: the run has not converged"
    // As a shell reports a program that was ended by SIGINT, or by SIGPIPE.
    Interrupted = 130: "stopped by Ctrl-C, SIGTERM or SIGHUP"
    ReaderGone = 141: "the reader of the output has gone, as in `pneudrive study list | head -1`"
}

/// The text of `pneudrive --help` after the list of commands.
#[must_use]
pub fn help() -> String {
    let lines = EXITS.iter().map(|(exit, meaning)| format!("  {:>3}  {meaning}\n", *exit as u8));
    format!("Start with: pneudrive demo\n\nExit codes:\n{}", lines.collect::<String>())
}

impl Exit {
    /// An error that ends the program with this code.
    pub fn error(self, message: impl Display) -> Error {
        self.of(anyhow::anyhow!("{message}"))
    }

    /// The same error, marked to end the program with this code.
    #[must_use]
    pub fn of(self, error: Error) -> Error {
        Marked { mark: self, error }.into()
    }

    /// The exit code of an error: the one it is marked with or, for a system error, the one of its kind.
    #[must_use]
    pub fn after(error: &Error) -> Exit {
        error.chain().find_map(Exit::of_cause).unwrap_or(Exit::Failed)
    }

    /// The exit code of one cause in the chain of an error.
    fn of_cause(cause: &(dyn StdError + 'static)) -> Option<Exit> {
        let ending = cause.downcast_ref::<Marked<Exit>>().map(|ending| ending.mark);
        let of_link = || Failure::of_cause(cause).map(Exit::from);
        let of_system = || cause.downcast_ref::<io::Error>().and_then(|error| of_kind(error.kind()));
        ending.or_else(of_link).or_else(of_system)
    }
}

impl From<Failure> for Exit {
    fn from(failure: Failure) -> Exit {
        match failure {
            Failure::NoAnswer => Exit::NoAnswer,
            Failure::Refused => Exit::Refused,
            Failure::Tripped => Exit::Tripped,
            Failure::Interrupted => Exit::Interrupted,
        }
    }
}

fn of_kind(kind: ErrorKind) -> Option<Exit> {
    match kind {
        ErrorKind::NotFound => Some(Exit::NotThere),
        ErrorKind::StorageFull
        | ErrorKind::QuotaExceeded
        | ErrorKind::FileTooLarge
        | ErrorKind::ReadOnlyFilesystem => Some(Exit::Unwritten),
        ErrorKind::ConnectionRefused
        | ErrorKind::ConnectionReset
        | ErrorKind::ConnectionAborted
        | ErrorKind::NotConnected
        | ErrorKind::BrokenPipe => Some(Exit::NoAnswer),
        _ => None,
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn an_error_keeps_its_exit_code_and_its_text_under_any_context() {
        let error = Exit::Tripped.of(anyhow::anyhow!("the cause").context("it tripped"));
        let error = Err::<(), _>(error).context("run").context("demo").expect_err("an error");
        assert_eq!(Exit::after(&error), Exit::Tripped);
        assert_eq!(format!("{error:#}"), "demo: run: it tripped: the cause");
    }

    #[test]
    fn a_failure_of_the_link_ends_as_its_kind_does() {
        let after = |failure: Failure| Exit::after(&failure.error("a rig").context("run"));
        assert_eq!(after(Failure::NoAnswer), Exit::NoAnswer);
        assert_eq!(after(Failure::Refused), Exit::Refused);
        assert_eq!(after(Failure::Tripped), Exit::Tripped);
        assert_eq!(after(Failure::Interrupted), Exit::Interrupted);
    }

    #[test]
    fn an_error_of_the_system_ends_as_its_kind_does() {
        let after = |kind: ErrorKind| Exit::after(&Error::new(io::Error::from(kind)).context("cannot"));
        assert_eq!(after(ErrorKind::NotFound), Exit::NotThere);
        assert_eq!(after(ErrorKind::StorageFull), Exit::Unwritten);
        assert_eq!(after(ErrorKind::FileTooLarge), Exit::Unwritten);
        assert_eq!(after(ErrorKind::ConnectionReset), Exit::NoAnswer);
        assert_eq!(after(ErrorKind::PermissionDenied), Exit::Failed);
        assert_eq!(Exit::after(&anyhow::anyhow!("anything")), Exit::Failed);
    }

    /// A code never changes its meaning.
    #[test]
    fn the_table_has_every_code_once_in_order_and_the_documentation_has_the_table() {
        assert!(EXITS.is_sorted_by(|(a, _), (b, _)| (*a as u8) < (*b as u8)));
        let documented = include_str!("../../docs/reference/exit-codes.md");
        let rows: Vec<&str> = documented.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
        let row = |(exit, meaning): &(Exit, &str)| format!("| {} | {meaning} |", *exit as u8);
        let table: Vec<String> = EXITS.iter().map(row).collect();
        assert_eq!(rows, table);
        assert!(
            table.iter().all(
                |row| help().contains(row.split(" | ").nth(1).expect("a meaning").trim_end_matches(" |"))
            )
        );
    }
}
