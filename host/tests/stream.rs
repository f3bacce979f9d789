//! A run that is streamed: over a good line every sample is there, over a bad one each that is not is counted.

mod program;
mod simulated_link;

use std::fs;
use std::sync::atomic::AtomicBool;

use pneudrive::client::Client;
use pneudrive_controller::Fault;
use pneudrive_protocol::{Mode, StreamedSample};
use pneudrive_sim::Rig;
use simulated_link::{Faults, Random, SimulatedRig};

use program::{folder, ok, transcript, virtual_rig};

/// A run of 4 s on a rig at the end of a line, begun with its stream.
fn started(rig: &SimulatedRig, every: u16) -> Client {
    let settings = ["test.duration_s=4", "controller.loop=open", "test.moves=[[0.0, 5]]"].map(str::to_owned);
    let text = pneudrive_sim::rig::builtin("servo-b").expect("a built-in rig");
    let test = Rig::read_with("servo-b", text, &settings).expect("a test");
    rig.change(|simulation| simulation.take_samples());
    let mut client = rig.connect().expect("an answer");
    client.import_parameters(&test.parameters()).expect("disarmed");
    client.download_test(&test).expect("disarmed");
    client.stream_begin(every, 769.0).expect("version 3");
    client.arm().expect("in open loop without a reference");
    client.start().expect("armed");
    client
}

/// The run: the rows that came, and those that the link has lost.
fn streamed(rig: &SimulatedRig, every: u16) -> (Client, Vec<StreamedSample>, u64) {
    let mut client = started(rig, every);
    let mut rows = Vec::new();
    let keep = |row: &StreamedSample| {
        rows.push(*row);
        Ok(())
    };
    let (_, lost) = client.follow_streamed(&AtomicBool::new(false), |_| {}, keep).expect("no fault");
    (client, rows, lost)
}

#[test]
fn over_a_good_line_the_stream_is_the_record() {
    let rig = SimulatedRig::with_record(&[]);
    let (mut client, rows, lost) = streamed(&rig, 1);
    assert_eq!((rows.len(), lost, client.losses()), (3077, 0, (0, 0)));
    let record = client.record(|_, _| {}).expect("a record").samples;
    for (k, (row, recorded)) in rows.iter().zip(&record).enumerate() {
        assert_eq!((row.index as usize, row.sample), (k, *recorded), "sample {k}");
    }
    assert_eq!(record.len(), 3077);
}

#[test]
fn every_nth_sample_is_streamed() {
    let (_, rows, lost) = streamed(&SimulatedRig::with_record(&[]), 100);
    assert_eq!(lost, 0);
    assert!(rows.iter().map(|row| row.index).eq((0..=3076).step_by(100)));
}

/// Nobody would watch the cylinder any more.
#[test]
fn a_stream_that_cannot_be_kept_stops_the_drive() {
    let rig = SimulatedRig::with_record(&[]);
    let mut client = started(&rig, 1);
    let mut taken = 0;
    let full_disk = |_: &StreamedSample| {
        taken += 1;
        if taken > 100 { Err(std::io::Error::other("no space").into()) } else { Ok(()) }
    };
    let error = client.follow_streamed(&AtomicBool::new(false), |_| {}, full_disk).expect_err("no space");
    assert!(error.to_string().contains("no space"), "{error:#}");
    let status = client.status().expect("an answer");
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::Stop.code()));
    assert!(status.index < 3000, "long before the end of the run: {}", status.index);
}

#[test]
fn over_a_faulty_line_rows_are_had_again_and_none_is_lost_unseen() {
    let (mut again, mut missing) = (0, 0);
    for seed in 0..20 {
        let faults = Faults { random: Random(seed), per_mille: 50, disconnects: false };
        let rig = SimulatedRig::with_record(&[]).with_faults(&faults);
        let (mut client, rows, lost) = streamed(&rig, 1);
        let record = client.record(|_, _| {}).expect("a record").samples;
        for row in &rows {
            assert_eq!(row.sample, record[row.index as usize], "sample {}", row.index);
        }
        assert!(rows.is_sorted_by(|a, b| a.index < b.index), "in order and once");
        assert_eq!(rows.len() as u64 + lost, 3077, "seed {seed}");
        (again, missing) = (again + client.losses().0, missing + lost);
    }
    println!(
        "20 runs of 3077 samples, 5 % of the frames harmed: {again} frames came damaged, {missing} rows are missing"
    );
    assert!(again > 0);
}

#[test]
fn a_run_is_streamed_to_a_file_and_watched_from_the_command_line() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let port = rig.port();
    let run = format!("run servo-b-tuned --set test.duration_s=0.4 --port {port} --stream run.csv --every 2");
    let said = transcript(folder.path(), &run);
    assert!(said.contains("run.csv: 154 samples, none missing\nservo-b-tuned: done\n"), "{said}");
    let text = fs::read_to_string(folder.path().join("run.csv")).expect("written");
    assert!(
        text.starts_with("# format = pneudrive-stream 1\n# test = servo-b-tuned\n# decimation = 2\n"),
        "{text}"
    );
    assert!(text.ends_with("\n# samples = 154\n# missing = 0\n"), "{text}");

    ok(folder.path(), &format!("record --port {port}"));
    let record = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("written");
    let data = |text: &str, step: usize| -> Vec<String> {
        let data = text.lines().skip_while(|line| !line.starts_with("index,")).skip(1);
        data.filter(|line| !line.starts_with('#')).step_by(step).map(str::to_owned).collect()
    };
    assert_eq!(data(&text, 1), data(&record, 2), "the stream is the record");

    let again = transcript(folder.path(), &run);
    assert!(again.contains("run.csv is there already") && again.ends_with("= 1"), "{again}");

    let said = ok(folder.path(), &format!("monitor --port {port} --every 0.01 --count 3 --csv values.csv"));
    assert_eq!(said.lines().count(), 3);
    assert!(said.starts_with("done ") && said.contains(" kPa  sample 307"), "{said}");
    let values = fs::read_to_string(folder.path().join("values.csv")).expect("written");
    assert_eq!(values.lines().count(), 4, "{values}");
    assert!(values.starts_with("time_s,mode,index,setpoint_counts,"), "{values}");
}
