//! `pneudrive device bring-up`.

use std::io::{BufRead, IsTerminal, stderr, stdin};
use std::time::Duration;

use anyhow::{Context, Result};
use pneudrive_link::client::Client;
use pneudrive_records::whole_file;
use pneudrive_session::bring_up::{Check, Operator, Options, Report, Verdict, bring_up};
use pneudrive_session::firmware_notes::report_boots;
use serde_json::{Value, json};

use super::super::interrupts::Interrupts;
use crate::cli::BringUp;
use crate::exit::Exit;
use crate::json;
use crate::output::Stream;

pub(super) fn execute(client: &mut Client, arguments: &BringUp) -> Result<()> {
    let somebody = stdin().is_terminal() && stderr().is_terminal();
    if !(arguments.yes || somebody) {
        return Err(Exit::Usage.error(
            "a bring-up asks before the cylinder moves, and nobody can answer here; --yes lets it move without being asked",
        ));
    }
    report_boots(client);
    let options = Options {
        push_wait: Duration::from_secs(arguments.push_wait.into()),
        most_percent: arguments.most,
        ..Options::default()
    };
    let mut person = Person { interrupts: Interrupts::watch(), yes: arguments.yes };
    let report = bring_up(client, &mut person, options)?;
    if let Some(file) = &arguments.report {
        whole_file::put(file, report.markdown().as_bytes())
            .with_context(|| format!("cannot write {}", file.display()))?;
        tell!("report: {}", file.display());
    }
    json::figures(|| figures(&report));
    say!("{}", report.summary());
    let wrong: Vec<&str> = report.wrong().map(|check| check.name).collect();
    match wrong.is_empty() {
        true => Ok(()),
        false => {
            Err(Exit::Failed.error(format!("wrong: {}; what to do is listed with each", wrong.join(", "))))
        }
    }
}

/// The user who called the program, as the operator.
struct Person {
    interrupts: Interrupts,
    yes: bool,
}

/// An answer at the terminal; anything but yes is no.
pub(in crate::command) fn asked(question: &str) -> bool {
    Stream::Errors.note(Stream::Errors.write(format!("{question} [y/N] ").as_bytes()));
    let mut answer = String::new();
    let read = stdin().lock().read_line(&mut answer);
    read.is_ok() && matches!(answer.trim().to_lowercase().as_str(), "y" | "yes")
}

impl Operator for Person {
    fn tell(&mut self, text: &str) {
        tell!("{text}");
    }

    fn done(&mut self, check: &Check) {
        let Check { name, saw, must, verdict, advice, .. } = check;
        say!("{:<12} {name}: {saw}", verdict.word());
        if *verdict == Verdict::Wrong {
            say!("             must be: {must}");
        }
        for line in advice {
            say!("             do: {line}");
        }
    }

    fn lets_it_move(&mut self, question: &str) -> bool {
        if self.yes {
            tell!("the cylinder moves now (--yes)");
        }
        self.yes || asked(question)
    }

    fn answers(&mut self, question: &str) -> Option<bool> {
        (!self.yes).then(|| asked(question))
    }

    fn goes_on(&mut self) -> Result<()> {
        match self.interrupts.look() {
            true => Err(Exit::Interrupted.error("the bring-up was ended; the drive is disarmed")),
            false => Ok(()),
        }
    }
}

fn figures(report: &Report) -> Value {
    let checks: Vec<Value> = report.checks.iter().map(Check::to_json).collect();
    json!({ "board": report.board, "firmware": report.firmware, "checks": checks })
}
