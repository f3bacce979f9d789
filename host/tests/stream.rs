//! A run that is streamed: over a good line every sample is there, over a bad one each that is not is counted.

use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};

use pneudrive_app::recorder::CAPACITY;
use pneudrive_controller::Fault;
use pneudrive_link::client::Client;
use pneudrive_protocol::{Mode, StreamedSample, UNTIL_STOPPED};
use pneudrive_sim::Rig;

use crate::simulated_link::{Faults, Random, SimulatedRig};

use crate::program::{folder, ok, transcript, virtual_rig};

/// A run of 4 s on a rig at the end of a line, begun with its stream.
fn started(rig: &SimulatedRig, every: u16) -> Client {
    let settings = ["test.duration_s=4", "controller.loop=open", "test.moves=[[0.0, 5]]"];
    begun(rig, every, &settings, Rig::last_sample)
}

/// A run with these settings that ends with a sample of its own.
fn begun(rig: &SimulatedRig, every: u16, settings: &[&str], last_sample: impl FnOnce(&Rig) -> u32) -> Client {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    let text = pneudrive_sim::rigfile::builtin("servo-b").expect("a built-in rig");
    let test = Rig::read_with("servo-b", text, &settings).expect("a test");
    rig.change(|simulation| simulation.take_samples());
    let mut client = rig.connect().expect("an answer");
    client.import_parameters(&test.parameters()).expect("disarmed");
    client.prepare(&test, last_sample(&test), None).expect("disarmed");
    client.stream_begin(every, 769.0).expect("an answer");
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

/// Twice as long as the board's memory, and it would go on.
#[test]
fn a_run_without_an_end_is_streamed_until_it_is_stopped_and_its_moves_come_again() {
    let rig = SimulatedRig::with_record(&[]);
    let settings = ["controller.loop=open", "test.moves=[[0.0, 5], [0.5, -5]]", "test.repeat_every_s=1"];
    let mut client = begun(&rig, 1, &settings, |_| UNTIL_STOPPED);
    let (stop, mut rows) = (AtomicBool::new(false), Vec::new());
    let keep = |row: &StreamedSample| {
        rows.push(*row);
        stop.store(rows.len() > 2 * CAPACITY, Ordering::Relaxed);
        Ok(())
    };
    let (status, lost) = client.follow_streamed(&stop, |_| {}, keep).expect("no fault");
    assert_eq!((status.duration_samples, lost), (UNTIL_STOPPED, 0));
    assert_eq!(status.mode, Mode::Disarmed, "an end, not a fault");
    // A second is 769.2 samples, so a round has 770; its second half begins at sample 385.
    for (k, row) in (0..).zip(&rows) {
        let command = if k % 770 < 385 { 5 } else { -5 };
        assert_eq!((row.index, row.sample.command), (k, command), "sample {k}");
    }
    assert!(rows.len() > 2 * CAPACITY);
    assert_eq!(rows.len(), status.index as usize + 1, "to the last sample");
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
    let printed = transcript(folder.path(), &run);
    assert!(printed.contains("run.csv: 154 samples, none missing\nservo-b-tuned: done\n"), "{printed}");
    let text = fs::read_to_string(folder.path().join("run.csv")).expect("written");
    assert!(
        text.starts_with("# format = pneudrive-stream 1\n# test = servo-b-tuned\n# decimation = 2\n"),
        "{text}"
    );
    let end = text.find("\n# samples = 154\n# missing = 0\n# crc32 = ").expect("an end");
    assert_eq!(text[end + 1..].lines().count(), 3, "{text}");

    ok(folder.path(), &format!("record --port {port}"));
    let record = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("written");
    let data = |text: &str, step: usize| -> Vec<String> {
        let data = text.lines().skip_while(|line| !line.starts_with("index,")).skip(1);
        data.filter(|line| !line.starts_with('#')).step_by(step).map(str::to_owned).collect()
    };
    assert_eq!(data(&text, 1), data(&record, 2), "the stream is the record");

    let again = transcript(folder.path(), &run);
    assert!(again.contains("run.csv already exists") && again.ends_with("= 1"), "{again}");

    let printed =
        ok(folder.path(), &format!("monitor --port {port} --every 0.01 --count 3 --csv values.csv"));
    assert_eq!(printed.lines().count(), 3);
    assert!(printed.starts_with("done ") && printed.contains(" kPa  at 0.399 s"), "{printed}");
    let values = fs::read_to_string(folder.path().join("values.csv")).expect("written");
    assert_eq!(values.lines().count(), 4, "{values}");
    assert!(values.starts_with("time_s,mode,index,setpoint_counts,"), "{values}");

    let longer = run.replace("--set test.duration_s=0.4", "--for 1s").replace("run.csv", "longer.csv");
    assert!(transcript(folder.path(), &longer).contains("longer.csv: 385 samples, none missing\n"));
    let never = longer.replace("--for 1s", "--for 900d");
    assert!(
        transcript(folder.path(), &never).contains("! error: --for: at 1300 us per sample, a run can last")
    );
}

#[test]
fn a_streamed_run_is_replayed_evaluated_and_overlaid_as_a_record_is() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let printed = |arguments: &str| transcript(folder.path(), arguments);
    let port = rig.port();
    let run = format!("run servo-b-tuned --config --set test.duration_s=0.4 --port {port} --stream run.txt");
    assert!(printed(&run).contains("run.txt: 308 samples, none missing"));
    let replayed = printed("replay run.txt");
    assert!(replayed.starts_with("run.txt: 308 samples, every command as recorded\n"), "{replayed}");
    assert!(replayed.ends_with("= 0"), "{replayed}");
    ok(folder.path(), &format!("record --port {port}"));
    let [streamed, recorded] = ["run.txt", "TARGET01.DAT"].map(|file| {
        ok(folder.path(), &format!("eval {file} --csv {file}.csv"));
        fs::read_to_string(folder.path().join(format!("{file}.csv"))).expect("written")
    });
    let positions = |csv: &str| -> Vec<String> {
        csv.lines().map(|line| line.split(',').nth(2).unwrap_or_default().to_owned()).collect()
    };
    assert_eq!(positions(&streamed), positions(&recorded));
    let printed_by_both = printed("overlay TARGET01.DAT run.txt");
    assert!(
        printed_by_both.ends_with("= 0") && printed_by_both.contains("deviation of run.txt"),
        "{printed_by_both}"
    );
}

#[test]
fn a_streamed_run_with_a_gap_is_read_beside_the_gap_and_a_long_one_in_parts() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let printed = |arguments: &str| transcript(folder.path(), arguments);
    let port = rig.port();
    ok(
        folder.path(),
        &format!("run servo-b-tuned --config --set test.duration_s=0.4 --port {port} --stream run.txt"),
    );
    ok(folder.path(), &format!("record --port {port}"));
    let text = fs::read_to_string(folder.path().join("run.txt")).expect("written");
    let at = text.find("\n100,").expect("a sample") + 1;
    let line = text[at..].find('\n').expect("an end") + 1;
    let gap = format!("{}# gap = 1 samples before index 101\n{}", &text[..at], &text[at + line..]);
    let changed = gap.replace("# samples = 308\n# missing = 0", "# samples = 307\n# missing = 1");
    fs::write(folder.path().join("gap.txt"), &changed).expect("written");
    assert!(printed("eval gap.txt").contains("its samples are damaged or changed"));
    let gap = changed[..changed.find("# crc32").expect("an end")].to_owned();
    fs::write(folder.path().join("gap.txt"), gap).expect("written");
    let refused = printed("eval gap.txt");
    assert!(refused.contains("gap.txt: samples are missing between 0.1287 s and 0.1313 s"), "{refused}");
    assert!(printed("eval gap.txt --from 0.14").ends_with("= 0"));
    assert!(printed("overlay TARGET01.DAT gap.txt").contains("gap.txt: samples are missing between"));
    assert!(printed("overlay TARGET01.DAT gap.txt --from 0.14").ends_with("= 0"));
    assert!(printed("replay gap.txt").ends_with("= 1"));

    let head = text.find("\n0,").expect("a sample") + 1;
    let many: String = (0..250_001).map(|k| format!("{k},8192,1332,1638,0,0,2047\n")).collect();
    fs::write(folder.path().join("long.txt"), text[..head].to_owned() + &many).expect("written");
    assert!(printed("eval long.txt").contains("long.txt has 250001 samples in this interval"));
    assert!(printed("eval long.txt --from 10 --to 11").ends_with("= 0"));
}
