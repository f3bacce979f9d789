//! How long a request locks the control interrupt out: the longest of the pieces in which it is carried out, in
//! instructions.

use std::time::Duration;

use anyhow::{Result, ensure};
use pneudrive_link::client::Client;
use pneudrive_protocol::MAX_VALUES;
use pneudrive_sim::Rig;

use crate::{QemuTarget, Target, body};

/// The most that a piece of a request may take while the drive is enabled, instructions: 80 us at 180 MHz and six cycles an
/// instruction. A board begins a piece when so much time is left before the control is due, and a sample may be late by
/// 100 us.
pub const MAX_INSTRUCTIONS: u64 = 2_400;

/// A request and the instructions of its longest piece.
pub type Request = (&'static str, u64);

/// Faults in the log: as many as it holds.
const FAULTS: u32 = 100;

/// A question that a host may ask an enabled drive.
pub struct Question {
    /// Its name in docs/reference/firmware-figures.md.
    pub name: &'static str,
    /// Asks it; an error if the drive does not answer as it must.
    pub ask: fn(&mut Client, &Rig) -> Result<()>,
}

/// All that a host may ask of a drive in a run. The last five are for a disarmed drive, so they are refused.
pub const IN_A_RUN: [Question; 13] = [
    Question { name: "status", ask: |client, _| client.status().map(drop) },
    Question { name: "info", ask: |client, _| client.info().map(drop) },
    Question { name: "owner", ask: |client, _| client.owner().map(drop) },
    Question { name: "config get", ask: |client, _| client.parameters().map(drop) },
    Question { name: "config state", ask: |client, _| client.config_state().map(drop) },
    Question { name: "motion", ask: |client, _| client.motion().map(drop) },
    Question { name: "timing", ask: |client, _| client.timing().map(drop) },
    Question { name: "faults, a full log", ask: |client, _| client.events().map(drop) },
    Question {
        name: "config set, refused",
        ask: |client, rig| refused(client.set_parameters(1, &some_values(rig))),
    },
    Question { name: "test, refused", ask: |client, rig| refused(client.download_test(rig)) },
    Question {
        name: "parameters and test, refused",
        ask: |client, rig| refused(client.prepare(rig, 1, Some(&rig.parameters())).map(drop)),
    },
    Question { name: "config save, refused", ask: |client, _| refused(client.save_parameters()) },
    Question { name: "reference, refused", ask: |client, _| refused(client.reference(0)) },
];

fn refused(asked: Result<()>) -> Result<()> {
    ensure!(asked.is_err(), "an enabled drive has carried out what is for a disarmed one");
    Ok(())
}

/// As many values as a request holds.
fn some_values(rig: &Rig) -> Vec<i32> {
    rig.parameters().iter().take(MAX_VALUES).map(|(_, value)| value).collect()
}

/// What makes a run end with a null offset to be learned: the tolerance is so wide that the error left at rest counts.
pub const LEARNING: [&str; 2] = ["controller.learn_null_offset=true", "controller.tolerance_counts=200"];

/// Measures every request that a drive takes while it is enabled, at its worst: the log is full and the
/// record, too.
///
/// # Errors
/// When there is no emulated board.
pub fn measure() -> Result<Vec<Request>> {
    let rig = body::as_built_in("servo-b-tuned", &["test.duration_s=5.6", LEARNING[0], LEARNING[1]]);
    let target = QemuTarget::start(&rig)?;
    fill_log(&mut target.connect()?)?;
    let _ = body::run_and_record(&target, &rig);
    let mut client = target.connect()?;
    client.download_test(&rig)?;
    let mut meter = Meter { target: &target, client, requests: Vec::new() };
    meter.ask_in_a_run(&rig)?;
    meter.ask_after_the_run()?;
    Ok(meter.requests)
}

/// Fills the fault log of a referenced drive.
///
/// # Errors
/// When the drive does not answer, or cannot be armed.
pub fn fill_log(client: &mut Client) -> Result<()> {
    for _ in 0..FAULTS {
        client.arm()?;
        client.stop()?;
    }
    client.arm()?;
    client.disarm()
}

/// Asks a board, and keeps what that cost.
struct Meter<'a> {
    target: &'a QemuTarget,
    client: Client,
    requests: Vec<Request>,
}

impl Meter<'_> {
    fn ask<T>(&mut self, name: &'static str, request: impl FnOnce(&mut Client) -> Result<T>) -> Result<()> {
        // What was asked before is told with the outputs that follow it.
        let settle = || std::thread::sleep(Duration::from_millis(20));
        settle();
        let _ = self.target.board().take_request_instructions();
        request(&mut self.client)?;
        settle();
        self.requests.push((name, self.target.board().take_request_instructions()));
        Ok(())
    }

    fn ask_in_a_run(&mut self, rig: &Rig) -> Result<()> {
        self.ask("arm", Client::arm)?;
        self.ask("start", Client::start)?;
        for question in &IN_A_RUN {
            self.ask(question.name, |client| (question.ask)(client, rig))?;
        }
        self.ask("follow to the end", |client| client.follow(&false.into(), |_| {}).map(drop))
    }

    fn ask_after_the_run(&mut self) -> Result<()> {
        self.ask("record, a full recorder", |client| client.record(|_, _| {}).map(drop))?;
        let learned = |client: &mut Client| Ok::<_, anyhow::Error>(client.motion()?.learned_null_offset != 0);
        self.ask("motion, after the run", |client| {
            ensure!(learned(client)?, "the run has learned no null offset for an arm to take over");
            Ok(())
        })?;
        self.ask("arm, a null offset learned", Client::arm)?;
        self.ask("motion, armed again", |client| {
            ensure!(!learned(client)?, "the null offset that was learned was not taken over");
            Ok(())
        })?;
        self.ask("stop", Client::stop)
    }
}
