//! Downloads over a line that drops, doubles, reorders, flips, cuts, adds noise, stalls and is pulled: they
//! end with the record as it is, or with an error that says what happened. On a virtual clock.
//!
//! A thousand downloads, or as many as `PNEUDRIVE_DOWNLOADS` says (`cargo xtask soak-link`).

use std::time::Duration;

use pneudrive_protocol::RecordedSample;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use crate::simulated_link::{Faults, Random, SimulatedRig, any_samples, cases};

#[derive(Clone, Debug)]
struct Case {
    seed: u64,
    samples: usize,
    per_mille: usize,
    disconnects: bool,
}

fn any_case() -> impl Strategy<Value = Case> {
    let samples = prop_oneof![4 => 1..1000usize, 1 => 1..=4389usize];
    (any::<u64>(), samples, 0..=50usize, any::<bool>())
        .prop_map(|(seed, samples, per_mille, disconnects)| Case { seed, samples, per_mille, disconnects })
}

#[derive(Debug, Default)]
struct Figures {
    identical: u32,
    named_errors: u32,
    frames: usize,
    damaged: usize,
    asked_again: u32,
    longest: Duration,
}

/// What an error may say.
const NAMED: [&str; 3] =
    ["the link to the simulated rig broke", "no answer from the simulated rig", "cannot write to"];

fn download(case: &Case, figures: &mut Figures) -> Result<(), TestCaseError> {
    let mut random = Random(case.seed);
    let samples = any_samples(&mut random, case.samples);
    let faults = Faults { random, per_mille: case.per_mille, disconnects: case.disconnects };
    let rig = SimulatedRig::with_record(&samples).with_faults(&faults);
    let record = rig.connect().and_then(|mut client| {
        let record = client.record(|_, _| {});
        figures.asked_again += client.losses().1;
        record
    });
    rig.change(|simulation| {
        figures.frames += simulation.up.frames + simulation.down.frames;
        figures.damaged += simulation.up.damaged + simulation.down.damaged;
        figures.longest = figures.longest.max(simulation.now());
    });
    match record {
        Ok(record) => {
            prop_assert!(record.samples == samples, "another record than the rig has");
            figures.identical += 1;
        }
        Err(error) => {
            let text = format!("{error:#}");
            prop_assert!(case.disconnects, "without a pulled cable every download is whole: {}", text);
            prop_assert!(NAMED.iter().any(|name| text.starts_with(name)), "no name: {}", text);
            figures.named_errors += 1;
        }
    }
    // Virtual time: nothing hangs.
    prop_assert!(rig.change(|simulation| simulation.now()) < Duration::from_secs(60));
    Ok(())
}

#[test]
fn a_download_over_a_faulty_line_is_the_record_or_a_named_error() {
    let mut figures = Figures::default();
    let config =
        Config { cases: cases("PNEUDRIVE_DOWNLOADS", 1000), failure_persistence: None, ..Config::default() };
    let counted = std::cell::RefCell::new(&mut figures);
    let result = TestRunner::new(config).run(&any_case(), |case| download(&case, &mut counted.borrow_mut()));
    println!("{figures:?}");
    result.unwrap_or_else(|failure| panic!("{failure}"));
    assert!(figures.damaged > 0 && figures.asked_again > 0 && figures.named_errors > 0, "{figures:?}");
}

/// Bytes that the line could have carried from the first request for the record to its last chunk.
#[test]
fn a_download_leaves_no_more_than_a_twentieth_of_the_line_idle() {
    let samples = any_samples(&mut Random(1), 4389);
    let rig = SimulatedRig::with_record(&samples);
    let mut client = rig.connect().expect("a good line");
    // The rig has had a second to itself since the run.
    rig.change(|simulation| simulation.rest(769));
    let before = rig.change(|simulation| (simulation.now(), simulation.down.carried));
    assert_eq!(client.record(|_, _| {}).expect("a good line").samples, samples);
    let (elapsed, carried) = rig.change(|s| (s.now() - before.0, s.down.carried - before.1));
    let allowed = elapsed.as_nanos() as f64 * 92_160.0 / 1e9;
    let payload = samples.len() * RecordedSample::BYTES;
    let overhead = (carried - payload) as f64 / samples.len() as f64;
    println!(
        "{carried} of {allowed:.0} bytes that 921,600 baud allow: {:.1} %; of them {payload} are samples: {overhead:.2} bytes of overhead a sample",
        100.0 * carried as f64 / allowed
    );
    assert!(carried as f64 >= 0.95 * allowed, "{carried} of {allowed:.0} bytes");
    assert!(overhead < 0.6, "{overhead} bytes of overhead a sample");
    assert_eq!(client.losses(), (0, 0), "nothing was asked for twice");
}
