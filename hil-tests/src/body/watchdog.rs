//! The trial of a board's watchdog.

use std::time::{Duration, Instant};

use pneudrive_controller::Fault;
use pneudrive_link::client::Trial;
use pneudrive_protocol::Mode;

use super::Start;
use super::run::rig;

/// The emulated board counts virtual time, which follows the computer's while it rests.
const WAIT: Duration = Duration::from_secs(60);

/// A board that feeds its watchdog no more is reset, and says so: disabled, and with both in its fault log.
///
/// # Panics
/// When it is not reset, or not for this reason.
pub fn a_watchdog_that_is_tried_resets_the_board(start: Start) {
    let rig = rig("servo-b", &[]);
    let target = start(&rig);
    let mut client = target.connect().expect("a board that answers");
    client.save_parameters().expect("disarmed");
    let trial = client.try_watchdog(WAIT, &mut || Ok(())).expect("disarmed");
    assert!(matches!(trial, Trial::Reset(_)), "{}: {trial:?}", target.name());
    let begun = Instant::now();
    let logged = loop {
        let events = client.events().expect("a log");
        if events.first().is_some_and(|newest| client.is_of_this_boot(newest)) || begun.elapsed() > WAIT {
            break events.iter().take(2).map(|event| (event.code, event.boot)).collect::<Vec<_>>();
        }
    };
    let boot = logged.first().expect("an event").1;
    let expected = [(Fault::Watchdog.code(), boot), (Fault::WatchdogTried.code(), boot - 1)];
    assert_eq!(logged, expected, "{}", target.name());
    let status = client.status().expect("an answer");
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::Watchdog.code()), "{}", target.name());
    assert_eq!(client.parameters().expect("an answer").values, rig.parameters(), "stored before");
    client.arm().expect("arming leaves the fault");
    client.disarm().expect("an answer");
}
