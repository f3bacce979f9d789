//! `--json`: the figures of a command as one document on standard output, instead of its text (docs/reference/json.md).
//!
//! ```json
//! { "format": "pneudrive-eval 1", "program": "0.1.0", "exit": 0, "error": null, "result": { "moves": [] } }
//! ```
//!
//! Notes and errors stay on standard error. The document contains the findings of a command before it failed.

pub mod fields;

use std::sync::{Mutex, MutexGuard, PoisonError};

use clap::{Arg, ArgAction, ArgMatches, Command};
use serde_json::{Map, Value, json};

use crate::exit::Exit;
use crate::output::{Stream, leave_text_out};

/// The name of the option.
const JSON: &str = "json";

/// Adds `--json` to the commands that print figures.
#[must_use]
pub fn with_option(command: Command) -> Command {
    below(command, "")
}

fn below(command: Command, before: &str) -> Command {
    command.mut_subcommands(|subcommand| {
        let typed = format!("{before}{}", subcommand.get_name());
        let subcommand = below(subcommand, &format!("{typed} "));
        if version(&typed).is_none() {
            return subcommand;
        }
        let help = "Print the figures as a JSON document instead of text (docs/reference/json.md)";
        subcommand.arg(Arg::new(JSON).long(JSON).action(ArgAction::SetTrue).help(help))
    })
}

fn version(command: &str) -> Option<u32> {
    fields::of(command).map(|figures| figures.version)
}

/// The document in the making; None where text is wanted.
static DOCUMENT: Mutex<Option<Document>> = Mutex::new(None);

struct Document {
    /// The command as it is typed, such as "device status".
    command: String,
    result: Map<String, Value>,
}

fn document() -> MutexGuard<'static, Option<Document>> {
    DOCUMENT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Begins a document if the command line asks for one.
pub fn begin(matches: &ArgMatches) {
    let (mut at, mut words) = (matches, Vec::new());
    while let Some((name, below)) = at.subcommand() {
        words.push(name);
        at = below;
    }
    if at.try_get_one::<bool>(JSON).is_ok_and(|wanted| wanted == Some(&true)) {
        leave_text_out();
        *document() = Some(Document { command: words.join(" "), result: Map::new() });
    }
}

/// Whether a document is wanted, and no text.
#[must_use]
pub fn is_wanted() -> bool {
    document().is_some()
}

/// Adds the fields of an object to the result, if a document is wanted.
pub fn figures(of: impl FnOnce() -> Value) {
    if is_wanted()
        && let (Value::Object(fields), Some(document)) = (of(), document().as_mut())
    {
        document.result.extend(fields);
    }
}

/// Prints the findings so far as a document of one line, and begins the next one: for commands that continue.
pub fn line() {
    if let Some(document) = document().as_mut() {
        let result = std::mem::take(&mut document.result);
        print(&format!("{}\n", whole(&document.command, Exit::Done, None, result)));
    }
}

/// Prints the document of a command that has ended so.
pub fn end(exit: Exit, error: Option<&str>) {
    let Some(Document { command, result }) = document().take() else { return };
    // `monitor` prints a document per line, and has printed its last one.
    if command != MONITOR || error.is_some() {
        print(&format!("{:#}\n", whole(&command, exit, error, result)));
    }
}

/// The command that prints a document a line.
const MONITOR: &str = "monitor";

fn whole(command: &str, exit: Exit, error: Option<&str>, result: Map<String, Value>) -> Value {
    let version = version(command).unwrap_or_default();
    json!({
        "format": format!("pneudrive-{} {version}", command.replace(' ', "-")),
        "program": env!("CARGO_PKG_VERSION"),
        "exit": exit as u8,
        "error": error,
        "result": result,
    })
}

fn print(text: &str) {
    if Stream::Output.failure().is_none() {
        Stream::Output.note(Stream::Output.write(text.as_bytes()));
    }
}
