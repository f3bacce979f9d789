//! Timing faults that trip a drive: a late sample, a silent host.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use pneudrive_controller::Fault;
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

use super::Start;
use super::run::{assert_equal_in_every_integer, rig, start_run};
use crate::Delayed;

/// Starts an execution level that can be made late, as [`Start`].
pub type StartDelayed = fn(&Rig) -> Box<dyn Delayed>;

/// Lateness on either side of the 100 us that are allowed.
const ALLOWED_US: u16 = 96;
const TOO_LATE_US: u16 = 112;

/// A sample that is too late trips before it is used, by name: the last one of the run is the one before it.
/// One that is a little late changes nothing.
///
/// # Panics
/// When it does not.
pub fn a_late_sample_trips_by_name(start: StartDelayed) {
    let rig = rig("servo-b-tuned", &["test.moves=[[0.0, 8192], [0.1, 16384]]", "test.duration_s=0.5"]);
    let target = start(&rig);
    target.delay_sample(200, ALLOWED_US);
    assert_equal_in_every_integer(&*target, &rig);

    target.delay_sample(200, TOO_LATE_US);
    let mut client = target.connect().expect("a rig that answers");
    start_run(&mut client, &rig);
    let error = client.follow(&AtomicBool::new(false), |_| {}).expect_err("it trips").to_string();
    assert!(
        error.contains("tripped at sample 199") && error.contains(": late-sample "),
        "{}: {error}",
        target.name()
    );
    let newest = client.events().expect("a log").first().copied().expect("logged");
    assert_eq!((newest.code, newest.index), (Fault::LateSample.code(), 199), "{}", target.name());
    assert_eq!(client.status().expect("an answer").command, 0);
}

/// A host that says nothing more while a move runs trips the drive once it has been silent for as long as is
/// allowed. For an execution level in real time, whose samples may lag behind the wall clock: how long a silence is allowed
/// to the millisecond is tested on a clock of its own (`firmware/app/tests/trips.rs`).
///
/// # Panics
/// When it does not.
pub fn a_silent_host_trips_by_name(start: Start) {
    let rig = rig("servo-b-tuned", &["test.duration_s=3000", "safety.host_silence_s=0.25"]);
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    start_run(&mut client, &rig);
    let mut silence = Duration::from_millis(400);
    // A computer that is busy with something else lets the rig's time lag behind; a question ends the silence.
    let status = loop {
        std::thread::sleep(silence);
        let status = client.status().expect("an answer");
        if status.mode != Mode::Running || silence > Duration::from_secs(20) {
            break status;
        }
        silence *= 2;
    };
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::HostSilent.code()), "{}", target.name());
    let newest = client.events().expect("a log").first().copied().expect("logged");
    assert_eq!(newest.code, Fault::HostSilent.code());
}
