//! A run that is streamed to the PC while it lasts.

use std::sync::atomic::AtomicBool;

use pneudrive_app::recorder::recorded;
use pneudrive_protocol::StreamedSample;
use pneudrive_sim::{Accuracy, run};

use super::Start;
use super::run::rig;

/// A run that the recorder has no room for: its stream is the simulation, and what is missing of it is
/// counted.
///
/// # Panics
/// When a sample is not the simulated one, or one is missing unseen.
pub fn a_run_that_the_memory_could_not_hold_is_streamed(start: Start) {
    let moves = "test.moves=[[0.0, 8192], [0.3, 16384], [3.2, 8192], [6.0, 12000]]";
    let rig = rig("servo-b-tuned", &["test.duration_s=7", moves]);
    let simulated = run(&rig, Accuracy::of(&rig)).expect("a transient").observations;
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    let capacity = client.info().expect("an answer").record_capacity as usize;
    client.download_test(&rig).expect("disarmed");
    client.stream_begin(1, 769.0).expect("an answer");
    client.arm().expect("referenced");
    client.start().expect("armed");
    let mut rows = Vec::new();
    let keep = |row: &StreamedSample| {
        rows.push(*row);
        Ok(())
    };
    let (_, lost) = client.follow_streamed(&AtomicBool::new(false), |_| {}, keep).expect("no fault");
    let what = target.name();
    for row in &rows {
        let k = row.index as usize;
        assert_eq!(
            row.sample,
            recorded(&simulated[k]),
            "{what}: sample {k} (left: streamed, right: simulated)"
        );
    }
    assert_eq!(rows.len() as u64 + lost, simulated.len() as u64, "{what}: each is there or counted");
    assert!(rows.len() > capacity, "{what}: {} samples, {} lost", rows.len(), lost);
}
