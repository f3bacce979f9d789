//! Errors of the tool-chain as exceptions: the kind tells what to do, and the text is that of the command.

use std::any::Any;
use std::io;

use anyhow::Error;
use pneudrive_link::failure::Failure;
use pneudrive_sim::IntegrationError;
use pneudrive_sim::rig::{Problem, Problems};
use pyo3::prelude::*;
use pyo3::{PyErr, import_exception};

import_exception!(pneudrive.errors, InternalError);
import_exception!(pneudrive.errors, Interrupted);
import_exception!(pneudrive.errors, NoAnswer);
import_exception!(pneudrive.errors, NotBorneOut);
import_exception!(pneudrive.errors, NotThere);
import_exception!(pneudrive.errors, PneudriveError);
import_exception!(pneudrive.errors, Refused);
import_exception!(pneudrive.errors, RigError);
import_exception!(pneudrive.errors, SimulationError);
import_exception!(pneudrive.errors, Tripped);
import_exception!(pneudrive.errors, Unwritten);

/// The exception of an error, by the first cause in its chain that has a kind.
pub fn of(error: &Error) -> PyErr {
    let text = format!("{error:#}");
    for cause in error.chain() {
        if let Some(problems) = cause.downcast_ref::<Problems>() {
            return of_problems(problems);
        }
        if let Some(failure) = Failure::of_cause(cause) {
            return of_failure(failure, text);
        }
        if cause.is::<IntegrationError>() {
            return SimulationError::new_err(text);
        }
        if let Some(error) = cause.downcast_ref::<io::Error>() {
            return of_system(error.kind(), text);
        }
    }
    PneudriveError::new_err(text)
}

/// Everything that is wrong with a rig, each with its source, line, key and message.
pub fn of_problems(problems: &Problems) -> PyErr {
    let parts = |problem: &Problem| {
        let Problem { source, line, key, message } = problem.clone();
        (source, line, key, message)
    };
    RigError::new_err((problems.to_string(), problems.0.iter().map(parts).collect::<Vec<_>>()))
}

fn of_failure(failure: Failure, text: String) -> PyErr {
    match failure {
        Failure::NoAnswer => NoAnswer::new_err(text),
        Failure::Refused => Refused::new_err(text),
        Failure::Tripped => Tripped::new_err(text),
        Failure::Interrupted => Interrupted::new_err(text),
    }
}

fn of_system(kind: io::ErrorKind, text: String) -> PyErr {
    use io::ErrorKind as Kind;
    match kind {
        Kind::NotFound => NotThere::new_err(text),
        Kind::StorageFull | Kind::QuotaExceeded | Kind::FileTooLarge | Kind::ReadOnlyFilesystem => {
            Unwritten::new_err(text)
        }
        Kind::ConnectionRefused
        | Kind::ConnectionReset
        | Kind::ConnectionAborted
        | Kind::NotConnected
        | Kind::BrokenPipe => NoAnswer::new_err(text),
        _ => PneudriveError::new_err(text),
    }
}

/// A defect of the program: what the panic says.
pub fn of_panic(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("it does not say why");
    InternalError::new_err(format!("a defect of pneudrive; please report it: {text}"))
}

/// Turns the errors of the tool-chain into exceptions.
pub trait OrRaise<T> {
    /// The value, or the exception.
    fn or_raise(self) -> PyResult<T>;
}

impl<T> OrRaise<T> for anyhow::Result<T> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|error| of(&error))
    }
}

impl<T> OrRaise<T> for Result<T, Problems> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|problems| of_problems(&problems))
    }
}
