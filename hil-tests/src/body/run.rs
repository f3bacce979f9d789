//! A run of a rig on an execution level, and the comparison of its record with the simulation.

use std::sync::atomic::AtomicBool;

use pneudrive_app::recorder::recorded;
use pneudrive_controller::Observation;
use pneudrive_evaluate::replay::{Replay, replay};
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_records::record::Record;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::component::operator::OperatorKind;
use pneudrive_sim::{Accuracy, Rig, keys, run};

use crate::Target;

/// A built-in rig with settings, its commands within what a converter has codes for: boards refuse others.
///
/// # Panics
/// When there is no such rig, or a setting is invalid.
#[must_use]
pub fn rig(name: &str, settings: &[&str]) -> Rig {
    let rig = as_built_in(name, settings);
    if rig.get(&keys::operator::MODEL) == OperatorKind::Stepper {
        return rig;
    }
    let codes = keys::operator::MAX_COMMAND_COUNTS.setting(2047);
    as_built_in(name, &[settings, &[&codes]].concat())
}

/// A built-in rig with settings, the converter that of the thesis.
///
/// # Panics
/// As [`rig`].
#[must_use]
pub fn as_built_in(name: &str, settings: &[&str]) -> Rig {
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

/// Downloads, arms, starts and follows the rig's test, and pulls its record.
///
/// # Panics
/// When the execution level does not come to the end of the run.
#[must_use]
pub fn run_and_record(target: &dyn Target, rig: &Rig) -> Record {
    let mut client = target.connect().expect("a rig that answers");
    run_on(&mut client, rig);
    let record = client.record(|_, _| {}).expect("a record");
    client.disarm().expect("an answer");
    record
}

pub(super) fn run_on(client: &mut Client, rig: &Rig) {
    start_run(client, rig);
    assert_eq!(client.follow(&AtomicBool::new(false), |_| {}).expect("no fault").mode, Mode::Done);
}

/// Downloads, arms and starts the rig's test.
///
/// # Panics
/// When the drive is not ready for it.
pub fn start_run(client: &mut Client, rig: &Rig) {
    client.download_test(rig).expect("a disarmed rig takes a test");
    client.arm().expect("referenced");
    client.start().expect("armed");
}

/// The record of the execution level is the simulation of the rig.
///
/// # Panics
/// At the first sample that is different, with both sides.
pub fn assert_equal_in_every_integer(target: &dyn Target, rig: &Rig) {
    let what = format!("{}, {}", target.name(), rig.name());
    let simulated = run(rig, Accuracy::of(rig)).expect("a transient").observations;
    assert_is_the_simulation(&what, &run_and_record(target, rig), &simulated);
    if let Some(cost) = target.cost() {
        println!("{what}: {cost}");
    }
}

pub(super) fn assert_is_the_simulation(what: &str, record: &Record, simulated: &[Observation]) {
    assert_eq!(record.samples.len(), simulated.len(), "{what}: samples");
    for (k, (on_rig, seen)) in record.samples.iter().zip(simulated).enumerate() {
        assert_eq!(*on_rig, recorded(seen), "{what}: sample {k} (left: recorded, right: simulated)");
    }
    assert!(simulated.iter().any(|seen| seen.command != 0), "a test that moves nothing proves nothing");
}

/// What a replay of the rig's record gives, by way of a file.
pub(super) fn replayed(client: &mut Client) -> Replay {
    let (info, parameters) = (client.info().expect("an answer"), client.parameters().expect("an answer"));
    let record = client.record(|_, _| {}).expect("a record");
    let test = client.test().expect("an answer");
    let file = TargetFile::new(&record, &info, &parameters).expect("samples that files count to");
    let text = file.with_test(&test).to_text();
    replay(&TargetFile::from_text(&text).expect("a whole file")).expect("a record that can be replayed")
}
