//! The law trips when its drive is not what it takes it for, and when a pressure sensor fails within its range.

use super::{Draws, Drive};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Config, Fault, Mode, Move, Sample, Sequence, output, sample};

/// A step there and back, again and again.
fn there_and_back(drive: &Drive, counts: i32, moves: u32) -> Sequence {
    let samples = |seconds: f64| (seconds / drive.period) as u32;
    let mut sequence = Sequence::new(samples(0.5 * f64::from(moves) + 0.02));
    for n in 0..moves {
        let to = if n % 2 == 0 { counts } else { 0 };
        sequence.push(Move::step(samples(0.02 + 0.5 * f64::from(n)), drive.start + to)).expect("room");
    }
    sequence
}

/// Runs a drive whose readings are made others from a time on; returns the fault, s from then on, and how far it went in them, m.
fn fails(
    drive: &mut Drive,
    sequence: &Sequence,
    at: f64,
    fail: fn(&Sample, Sample) -> Sample,
) -> Option<(Fault, f64, f64)> {
    drive.state.locate(0);
    drive.state.supervisor.arm().expect("at rest");
    drive.state.start(&drive.config, sequence).expect("a run");
    let mut seen = drive.plant.sample().expect("a sample");
    let (mut then, mut moved) = (None, 0.0_f64);
    for k in 0..=sequence.duration_samples {
        let time = f64::from(k) * drive.period;
        let place = drive.plant.look(time).expect("a state").position;
        if time >= at {
            let (reading, from) = then.get_or_insert((seen, place));
            moved = moved.max((place - *from).abs());
            seen = fail(reading, seen);
        }
        sample(&drive.config, sequence, &mut drive.state, &seen);
        if let Mode::Fault(fault) = drive.state.supervisor.mode() {
            return Some((fault, time - at, moved));
        }
        seen = drive.plant.advance(output(&drive.config, &mut drive.state)).expect("a sample");
    }
    None
}

/// A drive with other limits of its supervision.
fn watched(mut drive: Drive, limits: &[(u16, i32)]) -> Drive {
    let mut parameters = super::rig(&[]).parameters();
    limits.iter().for_each(|&(id, value)| parameters.set(id, value).expect("in range"));
    drive.config = Config::new(&parameters).expect("they go together");
    drive
}

fn sound(_: &Sample, now: Sample) -> Sample {
    now
}

/// Within what can be learned a drive runs on. Four times the mass stay at the bound of two and a half; it may run with the limit off.
#[test]
fn a_load_beyond_what_can_be_learned_trips() {
    for (mass, limits, expected) in [
        (2.0, &[][..], None),
        (4.0, &[], Some(Fault::ModelAtBound)),
        (4.0, &[(id::MODEL_BOUND_MS, 0), (id::PRESSURE_DOUBT_MS, 0)], None),
    ] {
        let mut drive = watched(Drive::unlike(&[], [mass, 1.0, 1.0], 0.05), limits);
        let sequence = there_and_back(&drive, 12_000, 8);
        let fault = fails(&mut drive, &sequence, 0.0, sound).map(|(fault, _, _)| fault);
        assert_eq!(fault, expected, "{mass} times the mass, {limits:?}");
    }
}

/// The time at a bound counts in motion alone, so a shorter limit trips sooner, and none of them at rest.
#[test]
fn the_time_at_a_bound_is_that_of_the_parameter() {
    let trips = |ms: i32| {
        let mut drive = watched(Drive::unlike(&[], [4.0, 1.0, 1.0], 0.05), &[(id::MODEL_BOUND_MS, ms)]);
        let sequence = there_and_back(&drive, 12_000, 8);
        fails(&mut drive, &sequence, 0.0, sound).map(|(fault, after, _)| (fault, (1e3 * after) as i32))
    };
    let [soon, later] = [100, 400].map(|ms| trips(ms).expect("at the bound"));
    assert_eq!((soon.0, later.0), (Fault::ModelAtBound, Fault::ModelAtBound));
    assert!(later.1 - soon.1 >= 290, "{soon:?} {later:?}");
}

/// What a sensor does from an instant on, by its reading then and its reading now.
type Failure = (&'static str, fn(&Sample, Sample) -> Sample, f64);

/// In the middle of a move of 60 mm. The last number is how long each may go unseen, s.
const FAILURES: [Failure; 7] = [
    ("1 stays", |then, now| Sample { pressure_1: then.pressure_1, ..now }, 0.1),
    ("2 stays", |then, now| Sample { pressure_2: then.pressure_2, ..now }, 0.1),
    ("1 halves", |_, now| Sample { pressure_1: now.pressure_1 / 2, ..now }, 0.003),
    ("2 halves", |_, now| Sample { pressure_2: now.pressure_2 / 2, ..now }, 0.003),
    ("1 reads 1.5 bar more", |_, now| Sample { pressure_1: now.pressure_1 + 614, ..now }, 0.003),
    ("2 reads 1.5 bar less", |_, now| Sample { pressure_2: now.pressure_2 - 614, ..now }, 0.003),
    (
        "they are swapped",
        |_, now| Sample { pressure_1: now.pressure_2, pressure_2: now.pressure_1, ..now },
        0.02,
    ),
];

#[test]
fn a_sensor_that_fails_within_its_range_trips() {
    let mut draws = Draws(0x1f83_d9ab_fb41_bd6b);
    for (what, fail, longest) in FAILURES {
        for index in 0..4 {
            let start = draws.between(0.03, 0.15);
            let mut drive = Drive::drawn(&[], &mut draws, start);
            let sequence = there_and_back(&drive, 6000, 2);
            let seen = fails(&mut drive, &sequence, 0.06, fail);
            let (fault, after, _) = seen.unwrap_or_else(|| panic!("{what}, draw {index}: not seen"));
            assert!(fault == Fault::PressureDoubtful && after <= longest, "{what}, draw {index}: {seen:?}");
        }
    }
}

/// One reading that is wrong, by half of a sensor's range, is no sensor that fails.
#[test]
fn a_single_wrong_reading_does_not_trip() {
    let mut drive = Drive::unlike(&[], [1.0; 3], 0.05);
    let sequence = there_and_back(&drive, 6000, 2);
    let once: fn(&Sample, Sample) -> Sample = |then, now| {
        let is_first = then.position == now.position && then.pressure_2 == now.pressure_2;
        Sample { pressure_1: if is_first { now.pressure_1 / 2 } else { now.pressure_1 }, ..now }
    };
    assert_eq!(fails(&mut drive, &sequence, 0.06, once), None);
}

/// Readings that swap are seen before the piston runs into its stop, and with the limit off they are not.
#[test]
fn a_limit_of_none_sees_no_sensor() {
    let mut drive = watched(Drive::unlike(&[], [1.0; 3], 0.1), &[(id::PRESSURE_DOUBT_MS, 0)]);
    let sequence = there_and_back(&drive, 6000, 2);
    let (_, fail, _) = FAILURES[2];
    let fault = fails(&mut drive, &sequence, 0.06, fail).map(|(fault, _, _)| fault);
    assert_ne!(fault, Some(Fault::PressureDoubtful));
}
