//! A stream that is taken piece by piece, by a program that does other things meanwhile.

use pneudrive_link::client::Client;
use pneudrive_link::stream::Arrivals;
use pneudrive_protocol::{Mode, StreamedSample};
use pneudrive_sim::Rig;

use crate::simulated_link::{Faults, Random, SimulatedRig};

/// All rows of a run of 1 s that is looked at between the pieces, and how many were lost.
fn streamed(rig: &SimulatedRig) -> (Client, Vec<StreamedSample>, u64) {
    let settings = ["test.duration_s=1", "controller.loop=open", "test.moves=[[0.0, 5]]"].map(str::to_owned);
    let text = pneudrive_sim::rigfile::builtin("servo-b").expect("a built-in rig");
    let test = Rig::read_with("servo-b", text, &settings).expect("a test");
    rig.change(|simulation| simulation.take_samples());
    let mut client = rig.connect().expect("an answer");
    client.import_parameters(&test.parameters()).expect("disarmed");
    client.prepare(&test, test.last_sample(), None).expect("disarmed");
    client.stream_begin(1, 769.0).expect("an answer");
    client.arm().expect("in open loop without a reference");
    client.start().expect("armed");
    let (mut arrivals, mut rows) = (Arrivals::default(), Vec::new());
    while client.status().expect("an answer").mode == Mode::Running {
        rows.extend(client.stream_take(&mut arrivals, false).expect("rows"));
    }
    loop {
        match client.stream_take(&mut arrivals, true).expect("rows") {
            rest if rest.is_empty() => return (client, rows, arrivals.lost()),
            rest => rows.extend(rest),
        }
    }
}

#[test]
fn over_a_good_line_the_pieces_are_the_record() {
    let (mut client, rows, lost) = streamed(&SimulatedRig::with_record(&[]));
    let record = client.record(|_, _| {}).expect("a record").samples;
    assert_eq!((rows.len(), lost), (record.len(), 0));
    for (k, (row, recorded)) in rows.iter().zip(&record).enumerate() {
        assert_eq!((row.index as usize, row.sample), (k, *recorded), "sample {k}");
    }
}

#[test]
fn over_a_faulty_line_each_row_comes_once_and_in_order_and_what_is_missing_shows_in_the_indices() {
    for seed in 0..10 {
        let faults = Faults { random: Random(seed), per_mille: 50, disconnects: false };
        let rig = SimulatedRig::with_record(&[]).with_faults(&faults);
        let (mut client, rows, lost) = streamed(&rig);
        let record = client.record(|_, _| {}).expect("a record").samples;
        assert!(rows.is_sorted_by(|a, b| a.index < b.index), "in order and once");
        assert!(rows.iter().all(|row| row.sample == record[row.index as usize]), "seed {seed}");
        assert_eq!(rows.len() as u64 + lost, record.len() as u64, "seed {seed}");
    }
}
