//! The trial of a watchdog, as a client asks for it.

use std::time::Duration;

use anyhow::bail;
use pneudrive_controller::Fault;
use pneudrive_link::client::Trial;
use pneudrive_protocol::Mode;

use crate::simulated_link::{SimulatedRig, Simulation};

/// Longer than any test waits.
const LONG: Duration = Duration::from_secs(600);

/// A rig with a watchdog, in this boot.
fn watched(boot: u32) -> SimulatedRig {
    let rig = SimulatedRig::with_record(&[]);
    rig.change(|simulation| {
        simulation.board.has_watchdog = true;
        simulation.board.store.boot = boot;
    });
    rig
}

#[test]
fn a_board_that_cannot_tell_its_boots_apart_is_not_tried() {
    let mut client = watched(0).connect().expect("an answer");
    let error = client.try_watchdog(LONG, &mut || Ok(())).expect_err("no boot to tell").to_string();
    assert!(error.contains("the board cannot tell one boot from the next"), "{error}");
    assert_eq!(client.status().expect("an answer").mode, Mode::Disarmed, "nothing was begun");
}

#[test]
fn a_reset_is_seen_and_a_wait_goes_on_only_while_it_is_let() {
    let rig = watched(3);
    let mut client = rig.connect().expect("an answer");
    let mut asked = 0;
    let trial = client.try_watchdog(LONG, &mut || {
        asked += 1;
        if asked == 3 {
            rig.change(Simulation::reset);
        }
        Ok(())
    });
    assert!(matches!(trial, Ok(Trial::Reset(_))) && asked == 3, "{trial:?}, {asked}");
    client.arm().expect("it means the new boot");
    client.disarm().expect("an answer");

    let error = client.try_watchdog(LONG, &mut || bail!("ended at the drive")).expect_err("ended");
    let said = format!("{error:#}");
    assert!(said.contains("the trial of the watchdog stays on"), "{said}");
    assert!(said.contains("arming it ends the trial") && said.ends_with(": ended at the drive"), "{said}");
    let status = client.status().expect("an answer");
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::WatchdogTried.code()));
    client.arm().expect("that ends it");
}
