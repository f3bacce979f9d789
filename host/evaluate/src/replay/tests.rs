use pneudrive_controller::parameters::id;
use pneudrive_controller::{Move, Parameters, Sequence};
use pneudrive_records::record::{Record, RecordHead};
use pneudrive_records::rig_info::{Info, RigParameters};

use super::*;

/// Parameters with these changes to the defaults.
fn parameters(changes: &[(u16, i32)]) -> Parameters {
    let mut parameters = Parameters::default();
    for &(id, value) in changes {
        parameters.set(id, value).expect("in range");
    }
    parameters
}

fn info() -> Info {
    Info {
        version: 1,
        firmware: "pneudrive 0.1.0".to_owned(),
        build: "test".to_owned(),
        board: "bench".to_owned(),
        record_capacity: 4389,
    }
}

/// The file of these samples.
fn file(parameters: &Parameters, first_index: i32, samples: Vec<RecordedSample>) -> TargetFile {
    let head = RecordHead {
        test: "bench".to_owned(),
        samples: samples.len(),
        decimation: 1,
        pre_trigger: 0,
        first_index,
        measured_period_ns: 1_300_000,
        mean_spool_raw: 0,
        crc32: 0,
    };
    let parameters = RigParameters { values: parameters.clone(), lacking: Vec::new() };
    TargetFile::new(&Record { head, samples }, &info(), &parameters).expect("counted")
}

/// What the recorder stores of a run over these positions.
fn record(parameters: &Parameters, moves: &[(u32, i32)], positions: &[i32]) -> Vec<RecordedSample> {
    let config = &Config::new(parameters).expect("they go together");
    let mut sequence = Sequence::new(100_000);
    for &(at_sample, target) in moves {
        sequence.push(Move::step(at_sample, target)).expect("room");
    }
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("a new drive does not run");
    state.start(config, &sequence).expect("armed");
    let stored = positions.iter().map(|&position| {
        let input = Sample { position, pressure_1: 2000, pressure_2: 1900, spool: 7, home_switch: false };
        sample(config, &sequence, &mut state, &input);
        let seen = *state.observation();
        let _ = output(config, &mut state);
        seen
    });
    let stored = stored.take_while(|seen| seen.running);
    stored.map(|seen| recorded(&seen)).collect()
}

/// Replays a run over these positions that was recorded with these parameters.
fn replayed(parameters: &Parameters, moves: &[(u32, i32)], positions: &[i32]) -> Replay {
    replay(&file(parameters, 0, record(parameters, moves, positions))).expect("a whole record")
}

fn samples_of(file: &TargetFile) -> Vec<RecordedSample> {
    file.samples.iter().map(|(_, sample)| *sample).collect()
}

fn put(file: &mut TargetFile, key: &str, value: &str) {
    file.header.retain(|(name, _)| name != key);
    file.header.push((key.to_owned(), value.to_owned()));
}

fn remove(file: &mut TargetFile, k: usize) {
    file.samples.remove(k);
}

/// A walk from 8192 to 9000 and back.
fn walk() -> Vec<i32> {
    (8192..9000).step_by(20).chain((8300..9000).rev().step_by(33)).collect()
}

const THERE_AND_BACK: [(u32, i32); 2] = [(0, 9000), (40, 8300)];

#[test]
fn a_record_of_the_controller_replays_equal() {
    let replay = replayed(&Parameters::default(), &THERE_AND_BACK, &walk());
    assert_eq!((replay.first, replay.differences, replay.tripped), (None, 0, None));
    assert_eq!(replay.equal_samples(), walk().len());
    assert!(replay.replayed.iter().any(|output| output.command != 0));
    assert!(replay.notes.is_empty() && !replay.stepper && !replay.open_loop);
}

#[test]
fn a_changed_command_is_found_at_its_sample_with_both_sides() {
    let values = Parameters::default();
    let mut samples = record(&values, &THERE_AND_BACK, &walk());
    samples[11].command += 1;
    samples[23].command -= 5;
    let replay = replay(&file(&values, 0, samples.clone())).expect("whole");
    let first = replay.first.expect("different");
    assert_eq!((first.index, first.what, first.inferred), (11, ComparedQuantity::Command, false));
    assert_eq!((first.recorded, first.replayed), (samples[11].command, samples[11].command - 1));
    assert_eq!(replay.differences, 2);
}

#[test]
fn a_changed_spool_location_of_a_stepper_is_found() {
    let values = parameters(&[(id::STEPPER, 1), (id::SCALE, 65_536), (id::PROPORTIONAL_GAIN, 999)]);
    let mut samples = record(&values, &THERE_AND_BACK, &walk());
    assert!(replay(&file(&values, 0, samples.clone())).expect("whole").first.is_none());
    samples[5].spool += 1;
    let first = replay(&file(&values, 0, samples)).expect("whole").first.expect("different");
    assert_eq!((first.index, first.what), (5, ComparedQuantity::SpoolLocation));
}

#[test]
fn other_parameters_than_those_of_the_run_are_found() {
    let samples = record(&Parameters::default(), &THERE_AND_BACK, &walk());
    let other = parameters(&[(id::VELOCITY_GAIN, 2000)]);
    assert!(replay(&file(&other, 0, samples)).expect("whole").first.is_some());
}

#[test]
fn a_trip_of_the_controller_is_reproduced_and_ends_the_record() {
    let jump = [8192, 8200, 8210, 9210, 9220];
    let replay = replayed(&Parameters::default(), &[(0, 9000)], &jump);
    assert_eq!((replay.first, replay.recorded.len()), (None, 4), "the sample that trips is the last one");
    assert_eq!(replay.tripped, Some((Fault::EncoderStep, 3)));
    assert_eq!(replay.recorded[3].command, 0);

    let outside = [-240, -245, -250];
    let replay = replayed(&Parameters::default(), &[(0, 9000)], &outside);
    assert_eq!((replay.first, replay.tripped), (None, Some((Fault::PositionOutside, 2))));

    let still = [8192; 500];
    let replay = replayed(&Parameters::default(), &[(0, 20_000)], &still);
    assert!(replay.first.is_none());
    assert!(matches!(replay.tripped, Some((Fault::NoMotion, k)) if k as usize == replay.recorded.len() - 1));
}

#[test]
fn a_board_that_does_not_trip_where_the_pc_does_is_found() {
    let tame = parameters(&[(id::ENCODER_STEP_COUNTS, 5000)]);
    let samples = record(&tame, &[(0, 9000)], &[8192, 8200, 9200, 9210]);
    let replay = replay(&file(&Parameters::default(), 0, samples)).expect("whole");
    let first = replay.first.expect("different");
    assert_eq!(
        (first.index, first.what, replay.tripped),
        (2, ComparedQuantity::Command, Some((Fault::EncoderStep, 2)))
    );
}

#[test]
fn a_board_that_goes_on_after_a_trip_is_found() {
    let tame = parameters(&[(id::ENCODER_STEP_COUNTS, 5000)]);
    let mut samples = record(&tame, &[(0, 9000)], &[8192, 8200, 9200, 9210]);
    samples[2].command = 0;
    let first = replay(&file(&Parameters::default(), 0, samples)).expect("whole").first;
    assert!(matches!(first, Some(Difference { index: 3, what: ComparedQuantity::Sample, .. })), "{first:?}");
}

#[test]
fn a_record_that_was_stopped_from_outside_is_equal_up_to_there() {
    let values = Parameters::default();
    let samples = record(&values, &THERE_AND_BACK, &walk());
    for end in 1..samples.len() {
        let replay = replay(&file(&values, 0, samples[..end].to_vec())).expect("whole");
        assert_eq!((replay.first, replay.equal_samples(), replay.tripped), (None, end, None));
    }
}

#[test]
fn moves_that_wait_for_arrival_come_at_the_same_samples_and_teach_the_same_null() {
    let values = parameters(&[
        (id::ON_ARRIVAL, 1),
        (id::LEARNING_GAIN, 500),
        (id::TOLERANCE_COUNTS, 30),
        (id::FORCED_EXIT_US, 26_000),
    ]);
    let moves = [(0, 9000), (0, 8300), (0, 8700), (0, 8650)];
    let samples = record(&values, &moves, &walk());
    let replay = replay(&file(&values, 0, samples)).expect("whole");
    assert_eq!(replay.first, None);
    let timed = parameters(&[(id::LEARNING_GAIN, 500), (id::TOLERANCE_COUNTS, 30)]);
    assert_eq!(replayed(&timed, &THERE_AND_BACK, &walk()).first, None);
}

#[test]
fn a_move_that_comes_to_its_setpoint_after_the_forced_exit_teaches_nothing() {
    let values = parameters(&[
        (id::ON_ARRIVAL, 1),
        (id::LEARNING_GAIN, 5000),
        (id::TOLERANCE_COUNTS, 30),
        (id::FORCED_EXIT_US, 13_000),
    ]);
    let moves = [(0, 8600), (30, 8700)];
    let late = [[8192; 12], [8590; 12], [8590; 12]].concat();
    assert_eq!(replayed(&values, &moves, &late).first, None);
    let early = [[8590; 12], [8590; 12], [8590; 12]].concat();
    let command = |positions: &[i32]| record(&values, &moves, positions)[35].command;
    assert_ne!(command(&late), command(&early), "one that arrives in time does");
}

#[test]
fn a_record_whose_first_move_comes_late_replays_equal() {
    for on_arrival in [0, 1] {
        let values = parameters(&[(id::ON_ARRIVAL, on_arrival), (id::LEARNING_GAIN, 50)]);
        let samples = record(&values, &[(5, 9000), (20, 8300)], &walk());
        assert_eq!(samples[0].error, 0, "it holds where it stands");
        let replay = replay(&file(&values, 0, samples)).expect("a whole record");
        assert_eq!((replay.first, replay.equal_samples()), (None, walk().len()));
    }
}

#[test]
fn a_run_that_begins_with_the_setpoint_zero_learns_as_it_did() {
    let values = parameters(&[(id::LEARNING_GAIN, 5000), (id::TOLERANCE_COUNTS, 30)]);
    let rest = [[20; 10].as_slice(), &[30, 60, 100, 150, 200, 250]].concat();
    for moves in [&[(0, 0), (10, 400)][..], &[(10, 400)]] {
        assert_eq!(replayed(&values, moves, &rest).first, None, "{moves:?}");
    }
    let learned = |moves: &[(u32, i32)]| record(&values, moves, &rest)[12].command;
    assert_ne!(learned(&[(0, 0), (10, 400)]), learned(&[(10, 400)]), "a move that rests teaches");
}

#[test]
fn the_end_of_the_last_move_is_not_the_end_of_the_replay() {
    let values = parameters(&[(id::ON_ARRIVAL, 1)]);
    let hidden = [(0, 9000), (0, 9000), (0, 9000)];
    assert_eq!(replayed(&values, &hidden, &[8600, 9000, 8900]).equal_samples(), 3);
}

/// Nothing in the file says that there was such a move: the command that stays at its exit differs.
#[test]
fn a_move_to_the_setpoint_that_holds_differs_where_it_ends_at_once() {
    let values = parameters(&[(id::ON_ARRIVAL, 1)]);
    let replay = replayed(&values, &[(0, 9000), (0, 9000), (0, 9000)], &[8600, 9000, 9000]);
    assert_eq!(replay.first.map(|first| (first.index, first.what)), Some((2, ComparedQuantity::Command)));
}

#[test]
fn an_open_loop_has_its_moves_from_its_commands() {
    let values = parameters(&[(id::OPEN_LOOP, 1), (id::END_MAX_COUNTS, 8600)]);
    let pushed: Vec<i32> = (8192..8600).step_by(50).chain([8600, 8590, 8600, 8590]).collect();
    let replay = replayed(&values, &[(0, 100), (3, 9999)], &pushed);
    assert_eq!((replay.first, replay.open_loop), (None, true));
    assert!(replay.recorded.iter().any(|seen| seen.command == 2048));
    let mut beyond = record(&values, &[(0, 100)], &pushed);
    beyond[2].command = 2049;
    let first = super::replay(&file(&values, 0, beyond)).expect("whole").first.expect("no converter can");
    assert_eq!((first.index, first.recorded, first.replayed), (2, 2049, 2048));
}

#[test]
fn an_open_loop_that_was_not_referenced_may_be_anywhere() {
    let values = parameters(&[(id::OPEN_LOOP, 1)]);
    let mut samples = record(&values, &[(0, 100)], &[0, 1, 2]);
    for (far, sample) in (-9000..).zip(&mut samples) {
        sample.position = far;
    }
    assert_eq!(replay(&file(&values, 0, samples)).expect("whole").first, None);
}

#[test]
fn samples_from_before_the_start_are_left_out() {
    let values = Parameters::default();
    let before = vec![RecordedSample { position: -5, ..RecordedSample::default() }; 3];
    let samples = [before, record(&values, &THERE_AND_BACK, &walk())].concat();
    let replay = replay(&file(&values, -3, samples)).expect("whole");
    assert_eq!((replay.first, replay.recorded.len()), (None, walk().len()));
}

#[test]
fn a_file_that_cannot_be_replayed_is_refused_by_name() {
    let values = Parameters::default();
    let good = || file(&values, 0, record(&values, &THERE_AND_BACK, &walk()));
    let refused = |change: fn(&mut TargetFile)| {
        let mut file = good();
        change(&mut file);
        replay(&file).expect_err("refused").to_string()
    };
    for (change, expected) in [
        (
            (|file| put(file, "decimation", "2")) as fn(&mut TargetFile),
            "record the run again with test.decimation=1",
        ),
        (|file| file.samples.clear(), "it has no sample k = 0"),
        (|file| remove(file, 0), "it has no sample k = 0"),
        (|file| remove(file, 7), "sample 8 is in the place of sample 7"),
        (|file| put(file, "param.velocity_gain", "fast"), "`# param.velocity_gain = ...`: \"fast\""),
        (|file| put(file, "param.velocity_gain", "1,2"), "`# param.velocity_gain = ...`"),
        (
            |file| put(file, "param.gain_profile", "1,70000"),
            "gain_profile = 70000, which is out of range: 0 to 65535",
        ),
        (|file| put(file, "param.delay_us", "1300"), "delay_us must be less than period_us"),
        (|file| put(file, "param.end_max_counts", "8500"), "a setpoint lies beyond a soft limit"),
        (|file| file.samples[9].1.error = i16::MAX, "the setpoint of samples 9 to 9 is not in the file"),
        (|file| file.samples[9].1.position = i32::MAX, "sample 9 give no setpoint of 32 bits"),
    ] {
        let error = refused(change);
        assert!(error.contains(expected), "{error}");
    }
    let mut many = good();
    for (_, sample) in &mut many.samples {
        sample.error = 1;
    }
    assert!(replay(&many).is_ok(), "a move a sample is a run, as long as there are not too many");
    let more = file(&values, 0, [samples_of(&many), samples_of(&many)].concat());
    assert_eq!(replay(&more).err(), Some(ReplayError::TooManyMoves(64)));
}

#[test]
fn parameters_that_only_one_side_has_are_told() {
    let values = Parameters::default();
    let mut file = file(&values, 0, record(&values, &THERE_AND_BACK, &walk()));
    file.header.retain(|(key, _)| key != "param.no_motion_ms" && key != "param.sensor_samples");
    file.header.push(("param.jerk_limit".to_owned(), "4".to_owned()));
    let replay = replay(&file).expect("whole");
    assert_eq!(replay.first, None);
    let [missing, unknown] = &replay.notes[..] else { panic!("{:?}", replay.notes) };
    assert!(missing.starts_with("sensor_samples, no_motion_ms: not in the file"), "{missing}");
    assert!(unknown.starts_with("jerk_limit: in the file, but this version does not know it"), "{unknown}");
}
