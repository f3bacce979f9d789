//! What becomes of drawn rigs: each is refused by `rig check` with the key or the answer that causes it, or its test runs to
//! its end within a minute of processor time. Each rig has a process of its own; those that fail are listed with what makes
//! them again.
//!
//! ```text
//! cargo run --release -p pneudrive-design --example campaign -- [RIGS OF A KIND] [FIRST SEED] [KIND ...]
//! ```
//!
//! | kind | draws |
//! |---|---|
//! | `edge` | drives at the edge of what anybody builds |
//! | `keys` | every key over its range, with every model |
//! | `catalogue` | answers to `rig new`, from the catalogue and beyond it |

#[path = "../tests/drawn/mod.rs"]
mod drawn;
#[path = "../../../sim/tests/extreme/mod.rs"]
mod extreme;
#[path = "../tests/outcome/mod.rs"]
mod outcome;

use std::process::Command;

use nix::sys::resource::{Resource, setrlimit};
use pneudrive_sim::{Accuracy, IntegrationError, Rig, run};

use extreme::every_key;
use outcome::{Outcome, outcome};

/// Processor time that a rig may take, s.
const LIMIT_S: u64 = 60;

/// The kinds of draws.
const KINDS: [&str; 3] = ["edge", "keys", "catalogue"];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [one, kind, seed] = &arguments[..]
        && one == "one"
    {
        return println!("{}", in_words(&drawn_rig(kind, seed.parse().expect("a seed"))));
    }
    let number = |i: usize| arguments.get(i).map(|text| text.parse::<u64>().expect("a number"));
    let (rigs, first) = (number(0).unwrap_or(170), number(1).unwrap_or(0));
    for kind in KINDS {
        if arguments.len() < 3 || arguments[2..].iter().any(|chosen| chosen == kind) {
            campaign(kind, first..first + rigs);
        }
    }
}

/// A process for each seed, and what became of all.
fn campaign(kind: &str, seeds: std::ops::Range<u64>) {
    let [mut run, mut refused, mut failed] = [0; 3];
    for seed in seeds {
        match of_a_process(kind, seed) {
            Outcome::Runs => run += 1,
            Outcome::Refused => refused += 1,
            Outcome::Fails(how) => {
                failed += 1;
                println!("{kind} {seed}: {how}");
            }
        }
    }
    println!("{kind}: {run} run, {refused} are refused, {failed} fail");
}

/// What becomes of a rig within the limit.
fn of_a_process(kind: &str, seed: u64) -> Outcome {
    let program = std::env::current_exe().expect("this program");
    let ended = Command::new(program).args(["one", kind, &seed.to_string()]).output().expect("a process");
    match String::from_utf8_lossy(&ended.stdout).trim() {
        "runs" => Outcome::Runs,
        "refused" => Outcome::Refused,
        "" => Outcome::Fails(format!("{}: {}", ended.status, String::from_utf8_lossy(&ended.stderr))),
        how => Outcome::Fails(how.to_owned()),
    }
}

fn in_words(outcome: &Outcome) -> &str {
    match outcome {
        Outcome::Runs => "runs",
        Outcome::Refused => "refused",
        Outcome::Fails(how) => how,
    }
}

/// What becomes of the rig of a seed in this process, which ends at the limit.
fn drawn_rig(kind: &str, seed: u64) -> Outcome {
    setrlimit(Resource::RLIMIT_CPU, LIMIT_S, LIMIT_S).expect("a limit");
    match kind {
        "edge" => match extreme::rig(seed) {
            Ok(rig) => simulated(&rig, &extreme::settings(seed)),
            Err(problems) if problems.0.iter().all(|problem| problem.key.contains('.')) => Outcome::Refused,
            Err(problems) => Outcome::Fails(problems.to_string()),
        },
        "keys" => {
            let drawn = every_key::rig(seed);
            let from = format!("{} --set {}", drawn.name, drawn.settings.join(" --set "));
            simulated(&drawn.rig, &[from])
        }
        "catalogue" => outcome(seed),
        _ => panic!("the kinds are {}", KINDS.join(", ")),
    }
}

/// Runs the test of a rig; `rig check` does so too, and refuses a rig whose piston runs through its end cover by key.
fn simulated(rig: &Rig, settings: &[String]) -> Outcome {
    match run(rig, Accuracy::of(rig)) {
        Ok(run) if run.rows.iter().all(|row| row.values().iter().all(|value| value.is_finite())) => {
            Outcome::Runs
        }
        Ok(_) => Outcome::Fails(format!("a row is no number: {}", settings.join(" --set "))),
        Err(IntegrationError::BeyondModel { .. }) => Outcome::Refused,
        Err(error) => Outcome::Fails(format!("{error}: {}", settings.join(" --set "))),
    }
}
