//! How long a request blocks the control interrupt, in instructions: it is executed without interruption.

use std::time::Duration;

use anyhow::{Result, ensure};
use pneudrive_link::client::Client;

use crate::{QemuTarget, Target, body};

/// The most that a request may take while the drive is enabled, instructions. Requests are carried out after
/// an output; with the thesis's timing 800 us are left then until the next sample, and this is 444 us at 180 MHz
/// and two cycles an instruction.
pub const MAX_INSTRUCTIONS: u64 = 40_000;

/// A request and the most instructions of it that are carried out in one go.
pub type Request = (&'static str, u64);

/// Faults in the log: as many as it holds.
const FAULTS: u32 = 100;

/// Measures every request that a drive takes while it is enabled, at its worst: the log is full and the
/// record, too.
///
/// # Errors
/// When there is no emulated board.
pub fn measure() -> Result<Vec<Request>> {
    // So tolerant that the error left at rest is learned from.
    let learning = ["controller.learn_null_offset=true", "controller.tolerance_counts=200"];
    let rig = body::rig("servo-b-tuned", &["test.duration_s=5.6", learning[0], learning[1]]);
    let target = QemuTarget::start(&rig)?;
    fill_log(&target)?;
    let _ = body::run_and_record(&target, &rig);
    let mut client = target.connect()?;
    client.download_test(&rig)?;
    let mut meter = Meter { target: &target, client, requests: Vec::new() };
    meter.ask_in_a_run()?;
    meter.ask_after_the_run()?;
    Ok(meter.requests)
}

fn fill_log(target: &QemuTarget) -> Result<()> {
    let mut client = target.connect()?;
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
    fn ask(&mut self, name: &'static str, request: impl FnOnce(&mut Client) -> Result<()>) -> Result<()> {
        // What was asked before is told with the outputs that follow it.
        let settle = || std::thread::sleep(Duration::from_millis(20));
        settle();
        let _ = self.target.board().take_request_instructions();
        request(&mut self.client)?;
        settle();
        self.requests.push((name, self.target.board().take_request_instructions()));
        Ok(())
    }

    fn ask_in_a_run(&mut self) -> Result<()> {
        self.ask("arm", Client::arm)?;
        self.ask("start", Client::start)?;
        self.ask("status", |client| client.status().map(drop))?;
        self.ask("info", |client| client.info().map(drop))?;
        self.ask("config get", |client| client.parameters().map(drop))?;
        self.ask("config state", |client| client.config_state().map(drop))?;
        self.ask("motion", |client| client.motion().map(drop))?;
        self.ask("timing", |client| client.timing().map(drop))?;
        self.ask("faults, a full log", |client| client.events().map(drop))?;
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
