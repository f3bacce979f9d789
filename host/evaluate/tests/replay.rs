//! Whatever the controller does, its record replays equal, and a command that it did not compute is found.

use pneudrive_app::Recorder;
use pneudrive_controller::parameters::{Parameter, TABLE, id};
use pneudrive_controller::{
    Config, Fault, Move, Parameters, Refusal, Sample, Sequence, State, output, sample,
};
use pneudrive_evaluate::replay::{ComparedQuantity, replay};
use pneudrive_protocol::RecordedSample;
use pneudrive_records::record::{Record, RecordHead};
use pneudrive_records::rig_info::{Info, RigParameters};
use pneudrive_records::target::TargetFile;
use proptest::prelude::*;

/// A value of a parameter: the default most of all, the ends, anything between.
fn any_value(parameter: &'static Parameter) -> impl Strategy<Value = i32> {
    let Parameter { min, max, default, .. } = *parameter;
    prop_oneof![6 => Just(default), 1 => Just(min), 1 => Just(max), 2 => min..=max]
}

/// Any parameters that go together; those that decide about the path of the code evenly.
fn any_parameters() -> impl Strategy<Value = Parameters> {
    let values: Vec<_> = TABLE
        .iter()
        .flat_map(|p| {
            (p.id..p.id + p.len).map(move |id| any_value(p).prop_map(move |value| (id, value)).boxed())
        })
        .collect();
    let kind = (0..=3, prop::bool::weighted(0.2), any::<bool>(), any::<bool>(), 0..=2000, any::<bool>());
    (values, kind).prop_map(|(values, (law, open_loop, stepper, on_arrival, learning_gain, wide))| {
        let mut parameters = Parameters::default();
        let chosen = [
            (id::LAW, law),
            (id::OPEN_LOOP, i32::from(open_loop)),
            (id::STEPPER, i32::from(stepper)),
            (id::ON_ARRIVAL, i32::from(on_arrival)),
            (id::LEARNING_GAIN, learning_gain),
        ];
        set(&mut parameters, &values);
        set(&mut parameters, &chosen);
        set(&mut parameters, if wide { &WIDE } else { &[] });
        reconcile(&mut parameters);
        parameters
    })
}

fn set(parameters: &mut Parameters, changes: &[(u16, i32)]) {
    for &(id, value) in changes {
        parameters.set(id, value).expect("in range");
    }
}

/// Every setpoint lies between these soft limits.
const ENDLESS: [(u16, i32); 2] = [(id::END_MIN_COUNTS, -i32::MAX), (id::END_MAX_COUNTS, i32::MAX)];

/// Limits that no axis meets.
const WIDE: [(u16, i32); 6] = [
    (id::POSITION_MIN_COUNTS, -i32::MAX),
    (id::POSITION_MAX_COUNTS, i32::MAX),
    (id::ENCODER_STEP_COUNTS, i32::MAX),
    (id::SENSOR_LOW_RAW, -1),
    (id::SENSOR_HIGH_RAW, 32_767),
    (id::NO_MOTION_MS, 0),
];

/// Makes parameters go together: the defaults for those that do not.
fn reconcile(parameters: &mut Parameters) {
    let together: [&[u16]; 8] = [
        &[id::PRESSURE_SENSORS],
        &[id::PERIOD_US, id::DELAY_US, id::PULSE_WIDTH_US, id::DIRECTION_SETUP_US],
        &[id::LATE_SAMPLE_US, id::LATE_OUTPUT_US, id::SENSOR_SAMPLES, id::SENSOR_BITS, id::SENSOR_HIGH_RAW],
        &[id::POSITION_MIN_COUNTS, id::POSITION_MAX_COUNTS, id::ENCODER_STEP_COUNTS],
        &[id::END_MIN_COUNTS, id::END_MAX_COUNTS],
        &[id::PRESSURE_MIN_PA, id::PRESSURE_MAX_PA],
        &[id::SPOOL_MIN_NM, id::SPOOL_MAX_NM],
        &[id::HOMING_COMMAND_COUNTS],
    ];
    for group in together {
        if Config::new(parameters).is_ok() {
            return;
        }
        for &id in group {
            let default = Parameters::default().get(id).expect("in the table");
            parameters.set(id, default).expect("in range");
        }
    }
}

/// Samples on a path of small and some large steps that rests now and then, with pressures that are bad now and
/// then.
fn any_path() -> impl Strategy<Value = Vec<Sample>> {
    let step = prop_oneof![4 => Just(0), 4 => -30..=30, 3 => -400..=400, 1 => -2000..=2000];
    let pressure = || prop_oneof![6 => 1500i16..2500, 1 => Just(0i16), 1 => any::<i16>()];
    let stay = prop_oneof![1usize..3, 3usize..40];
    let pieces = prop::collection::vec((step, pressure(), pressure(), any::<i16>(), stay), 1..60);
    (0..16_000, pieces).prop_map(|(start, pieces)| {
        let mut position: i32 = start;
        let mut path = Vec::new();
        for (step, pressure_1, pressure_2, spool, stay) in pieces {
            for _ in 0..stay {
                // Within 16 bits of every setpoint.
                position = (position + step).clamp(-16_000, 16_000);
                path.push(Sample { position, pressure_1, pressure_2, spool, home_switch: false });
            }
        }
        path
    })
}

/// Moves that are seen: each to another setpoint than the one before, and not at the same sample as it, unless
/// it waits for it.
fn any_moves() -> impl Strategy<Value = Vec<(u32, i32)>> {
    let target = prop_oneof![Just(0), -3000..=3000, -16_000..=16_000];
    prop::collection::vec((0u32..60, target), 1..12).prop_map(|pieces| {
        let mut moves: Vec<(u32, i32)> = Vec::new();
        for (gap, target) in pieces {
            let (at, before) = moves.last().map_or((gap % 5, 0), |&(at, target)| (at + gap.max(1), target));
            if target != before || (moves.is_empty() && at == 0) {
                moves.push((at, target));
            }
        }
        if moves.is_empty() { vec![(3, 1234)] } else { moves }
    })
}

#[derive(Clone, Debug)]
struct Run {
    parameters: Parameters,
    moves: Vec<(u32, i32)>,
    path: Vec<Sample>,
    /// The sample before which a stop comes from outside.
    stop: usize,
}

fn any_run() -> impl Strategy<Value = Run> {
    (any_parameters(), any_moves(), any_path(), 1usize..2000).prop_map(
        |(mut parameters, mut moves, path, stop)| {
            if moves[0].0 > 0 && moves[0].1 == path[0].position {
                // A move to what is held already is not seen.
                moves[0].1 += 1;
            }
            if parameters.get(id::ON_ARRIVAL) == Some(1) && stop % 2 == 0 {
                let first = moves[0].0;
                moves.iter_mut().for_each(|(at, _)| *at = first);
            }
            let config = Config::new(&parameters).expect("they go together");
            if !moves
                .iter()
                .all(|&(_, target)| (config.limits.soft_min..=config.limits.soft_max).contains(&target))
            {
                set(&mut parameters, &ENDLESS);
            }
            Run { parameters, moves, path, stop }
        },
    )
}

/// Runs the controller, and records it as the board does.
fn record(run: &Run) -> Result<Vec<RecordedSample>, Refusal> {
    let config = Config::new(&run.parameters).expect("they go together");
    let mut sequence = Sequence::new(run.path.len() as u32);
    for &(at_sample, target) in &run.moves {
        sequence.push(Move::step(at_sample, target)).expect("room");
    }
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("a new drive does not run");
    state.start(&config, &sequence)?;
    let mut recorder = Box::<Recorder>::default();
    recorder.arm(1, 0);
    recorder.start();
    for (k, input) in run.path.iter().enumerate() {
        if k == run.stop {
            state.supervisor.trip(Fault::Stop);
        }
        sample(&config, &sequence, &mut state, input);
        let seen = *state.observation();
        let _ = output(&config, &mut state);
        if seen.running {
            recorder.store(&seen);
        }
    }
    Ok((0..recorder.len()).filter_map(|i| recorder.get(i).map(RecordedSample::from_bytes)).collect())
}

/// The file of a record, written and read again.
fn file(run: &Run, samples: Vec<RecordedSample>) -> TargetFile {
    let head = RecordHead {
        test: "any".to_owned(),
        samples: samples.len(),
        decimation: 1,
        pre_trigger: 0,
        first_index: 0,
        measured_period_ns: 1_300_000,
        mean_spool_raw: 0,
        crc32: 0,
    };
    let record = Record { head, samples };
    let info = Info {
        version: 1,
        firmware: String::new(),
        build: String::new(),
        board: String::new(),
        record_capacity: 4389,
    };
    let parameters = RigParameters { values: run.parameters.clone(), lacking: Vec::new() };
    let text = TargetFile::new(&record, &info, &parameters).expect("counted").to_text();
    TargetFile::from_text(&text).expect("what was written is read")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn every_record_of_the_controller_replays_equal(run in any_run()) {
        let samples = record(&run).expect("it starts");
        let count = samples.len();
        let replay = replay(&file(&run, samples)).expect("a whole record");
        prop_assert_eq!(replay.first, None);
        prop_assert_eq!((replay.equal_samples(), replay.differences), (count, 0));
    }

    #[test]
    fn any_changed_command_is_found_at_its_sample(
        mut run in any_run(), at in any::<prop::sample::Index>(), delta in 1i16..=i16::MAX,
    ) {
        // In open loop the moves are the commands: there, any command within the range may be one.
        set(&mut run.parameters, &[(id::OPEN_LOOP, 0)]);
        set(&mut run.parameters, &ENDLESS);
        // A first setpoint that leaves no choice, and that no other move has.
        run.moves[0] = (0, 16_001);
        let mut samples = record(&run).expect("it starts");
        let at = at.index(samples.len());
        samples[at].command = samples[at].command.wrapping_add(delta);
        let changed = samples[at].command;
        let first = replay(&file(&run, samples)).expect("a whole record").first.expect("a difference");
        prop_assert_eq!((first.index as usize, first.what, first.recorded), (at, ComparedQuantity::Command, changed));
    }

    #[test]
    fn any_changed_spool_location_of_a_stepper_is_found_at_its_sample(
        mut run in any_run(), at in any::<prop::sample::Index>(), delta in 1i16..=i16::MAX,
    ) {
        set(&mut run.parameters, &[(id::STEPPER, 1)]);
        set(&mut run.parameters, &ENDLESS);
        run.moves[0] = (0, 16_001);
        let mut samples = record(&run).expect("it starts");
        let at = at.index(samples.len());
        samples[at].spool = samples[at].spool.wrapping_add(delta);
        let first = replay(&file(&run, samples)).expect("a whole record").first.expect("a difference");
        prop_assert_eq!((first.index as usize, first.what), (at, ComparedQuantity::SpoolLocation));
    }

    /// Steps so long that the recorded error is at the limit of its 16 bits, with an axis that comes near
    /// enough to each setpoint.
    #[test]
    fn long_steps_replay_equal(
        mut run in any_run(), targets in prop::collection::vec(-1_000_000..1_000_000, 1..5),
    ) {
        set(&mut run.parameters, &WIDE);
        set(&mut run.parameters, &ENDLESS);
        set(&mut run.parameters, &[(id::ON_ARRIVAL, 0)]);
        run.stop = usize::MAX;
        run.moves.clear();
        run.path.clear();
        let mut position = 0;
        for target in targets {
            run.moves.push((run.path.len() as u32, target));
            for part in 0..=50 {
                let at = position + (target - position) / 50 * part;
                run.path.push(Sample { position: at, pressure_1: 2000, pressure_2: 2000, ..Sample::default() });
            }
            position = target - (target - position) % 50;
        }
        let samples = record(&run).expect("it starts");
        let replay = replay(&file(&run, samples)).expect("each move comes near its setpoint");
        prop_assert_eq!(replay.first, None);
    }
}
