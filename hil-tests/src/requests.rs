//! How long a request keeps the control interrupt out, in instructions: it is carried out in one go.

use std::time::Duration;

use anyhow::{Result, ensure};
use pneudrive::client::Client;

use crate::{QemuTarget, Target, body};

/// The most that a request may take while the drive is enabled, instructions. Requests are carried out after
/// an output; with the thesis's timing 800 us are left then until the next sample, and this is 444 us at 180 MHz
/// and two cycles an instruction.
pub const MOST: u64 = 40_000;

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
    let mut client = target.connect()?;
    for _ in 0..FAULTS {
        client.arm()?;
        client.stop()?;
    }
    client.arm()?;
    client.disarm()?;
    drop(client);
    let _ = body::run_and_record(&target, &rig);
    let mut client = target.connect()?;
    client.download_test(&rig)?;
    let mut requests = Vec::new();
    let mut ask = |name, request: &mut dyn FnMut(&mut Client) -> Result<()>| -> Result<()> {
        // What was asked before is told with the outputs that follow it.
        let settle = || std::thread::sleep(Duration::from_millis(20));
        settle();
        let _ = target.board().take_request_instructions();
        request(&mut client)?;
        settle();
        requests.push((name, target.board().take_request_instructions()));
        Ok(())
    };
    ask("arm", &mut Client::arm)?;
    ask("start", &mut Client::start)?;
    ask("status", &mut |client| client.status().map(drop))?;
    ask("info", &mut |client| client.info().map(drop))?;
    ask("config get", &mut |client| client.parameters().map(drop))?;
    ask("config state", &mut |client| client.config_state().map(drop))?;
    ask("motion", &mut |client| client.motion().map(drop))?;
    ask("timing", &mut |client| client.timing().map(drop))?;
    ask("faults, a full log", &mut |client| client.events().map(drop))?;
    ask("follow to the end", &mut |client| client.follow(&false.into(), |_| {}).map(drop))?;
    ask("record, a full recorder", &mut |client| client.record(|_, _| {}).map(drop))?;
    let learned = |client: &mut Client| Ok::<_, anyhow::Error>(client.motion()?.learned_null_offset != 0);
    ask("motion, after the run", &mut |client| {
        ensure!(learned(client)?, "the run has learned no null offset for an arm to take over");
        Ok(())
    })?;
    ask("arm, a null offset learned", &mut Client::arm)?;
    ask("motion, armed again", &mut |client| {
        ensure!(!learned(client)?, "the null offset that was learned was not taken over");
        Ok(())
    })?;
    ask("stop", &mut Client::stop)?;
    Ok(requests)
}
