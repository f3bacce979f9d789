//! Requirements of a machine on an axis: named faults, homing, moves that wait, requirements on a step.

use std::sync::atomic::AtomicBool;

use pneudrive_controller::Fault;
use pneudrive_protocol::Mode;
use pneudrive_sim::{Accuracy, Rig, keys, run};

use super::Start;
use super::run::{assert_equal_in_every_integer, replayed, rig, run_and_record, run_on};

/// The tuned drive B with a fault of its plant.
fn faulty(event: &str) -> Rig {
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let text = format!("{text}\n[[faults.event]]\n{event}\n");
    let codes = [keys::operator::MAX_COMMAND_COUNTS.setting(2047)];
    Rig::read_with("servo-b-tuned", &text, &codes).unwrap_or_else(|problems| panic!("{problems}"))
}

/// Faults of the plant end in the fault and at the sample of the simulation, and stand in the log.
///
/// # Panics
/// When one does not.
pub fn faults_of_the_plant_trip_by_name(start: Start) {
    for (event, fault) in [
        ("kind = \"encoder-jump\"\nat_s = 0.35\ncounts = 1000", Fault::EncoderStep),
        ("kind = \"sensor-open\"\nat_s = 0.35\nsensor = \"pressure-2\"", Fault::SensorRange),
        ("kind = \"encoder-loss\"\nat_s = 0.35", Fault::NoMotion),
        ("kind = \"swapped-tubes\"\nat_s = 0.0", Fault::NoMotion),
    ] {
        let rig = faulty(event);
        let simulated = run(&rig, Accuracy::of(&rig)).expect("a transient").fault;
        let (expected, k) = simulated.unwrap_or_else(|| panic!("{event} is not noticed"));
        assert_eq!(expected, fault, "{event}");
        let target = start(&rig);
        let mut client = target.connect().expect("a rig that answers");
        client.download_test(&rig).expect("disarmed");
        client.arm().expect("disarmed");
        client.start().expect("referenced");
        let error = client.follow(&AtomicBool::new(false), |_| {}).expect_err("it trips").to_string();
        assert!(error.contains(&format!("tripped at sample {k}: ")), "{}: {error}", target.name());
        let events = client.events().expect("a log");
        let newest = events.first().expect("logged");
        assert_eq!((newest.code, newest.index), (fault.code(), k), "{}: {event}", target.name());
        assert_eq!(client.status().expect("an answer").mode, Mode::Fault);
    }
}

/// A homing run ends at the stop; the moves after it count from there.
///
/// # Panics
/// When it does not.
pub fn homing_finds_the_stop(start: Start) {
    let rig = rig("servo-b-tuned", &["controller.homing_position_counts=100"]);
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    client.arm().expect("disarmed");
    client.home().expect("armed");
    while client.status().expect("an answer").mode == Mode::Homing {
        std::thread::yield_now();
    }
    let status = client.status().expect("an answer");
    assert_eq!((status.mode, status.referenced), (Mode::Armed, true), "{}", target.name());
    // The rod is shaken by dither, so it does not stay on the very count.
    assert!((status.position - 100).abs() <= 60, "{}: {}", target.name(), status.position);
}

/// An encoder that counts nothing stands still everywhere, which was taken for a stop.
///
/// # Panics
/// When the axis is homed, or nothing trips.
pub fn a_dead_encoder_is_not_homed(start: Start) {
    let event = "faults.event=[{kind = \"encoder-loss\", at_s = 0.0}]";
    let target = start(&rig("servo-b-tuned", &[event]));
    let mut client = target.connect().expect("a rig that answers");
    client.arm().expect("disarmed");
    client.home().expect("armed");
    while client.status().expect("an answer").mode == Mode::Homing {
        std::thread::yield_now();
    }
    let status = client.status().expect("an answer");
    let found = (status.mode, status.fault, status.referenced);
    assert_eq!(found, (Mode::Fault, Fault::NoMotion.code(), false), "{}", target.name());
}

/// Targets that wait for the arrival at the one before: the record is the simulation, and the moves are
/// counted.
///
/// # Panics
/// When it is not.
pub fn moves_on_arrival(start: Start) {
    let settings = [
        "test.duration_s=5",
        "test.targets=[10000, 12000, 9000]",
        "controller.exit_on_dead_band=true",
        "controller.monitoring_s=0.05",
        "controller.tolerance_counts=30",
        "controller.learn_null_offset=true",
    ];
    let text = pneudrive_sim::rigfile::builtin("servo-a-tuned").expect("a built-in rig");
    let text = text.replace("moves = [[0.0, 8192], [0.3, 16384], [1.72, 8192]]", "");
    let settings = settings.map(str::to_owned);
    let rig =
        Rig::read_with("servo-a-tuned", &text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
    let simulated = run(&rig, Accuracy::of(&rig)).expect("a transient").observations;
    let last = simulated.iter().rposition(|seen| seen.running).expect("samples");
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    run_on(&mut client, &rig);
    let motion = client.motion().expect("an answer");
    assert_eq!((motion.begun, motion.arrival, motion.not_reached), (3, 2, 0), "{}", target.name());
    let record = client.record(|_, _| {}).expect("a record");
    assert_eq!(record.samples.len(), last + 1, "{}: the run ends with its last move", target.name());
    for (k, (on_rig, seen)) in record.samples.iter().zip(&simulated).enumerate() {
        assert_eq!((on_rig.command, on_rig.position), (seen.command, seen.position), "sample {k}");
    }
}

/// A load that has come to rest outside the tolerance of its move is told of, and one that rests within it is not.
///
/// # Panics
/// When it is not.
pub fn a_rest_outside_the_tolerance_is_told(start: Start) {
    for (tolerance, outside) in [(0, true), (100, false)] {
        let tolerance_counts = keys::controller::TOLERANCE_COUNTS.setting(tolerance);
        let rig =
            rig("press", &["test.moves_mm=[[0.0, 60], [0.1, 60.2]]", "test.duration_s=2", &tolerance_counts]);
        let target = start(&rig);
        let mut client = target.connect().expect("a rig that answers");
        run_on(&mut client, &rig);
        let (motion, status) = (client.motion().expect("an answer"), client.status().expect("an answer"));
        let what = format!("{}: {tolerance} counts, {} off", target.name(), status.error);
        assert_eq!(status.error.abs() > tolerance, outside, "{what}");
        assert_eq!(motion.arrival, if outside { 4 } else { 2 }, "{what}");
    }
}

/// Requirements on a step of the tuned drive B, from its record alone: 98.7 mm with less than a millimetre
/// of overshoot, at rest within a millimetre.
///
/// # Panics
/// When one is not met.
pub fn a_step_meets_its_requirements(start: Start) {
    let rig = rig("servo-b-tuned", &["test.moves=[[0.0, 8192], [0.3, 16384]]", "test.duration_s=1.7"]);
    let record = run_and_record(&*start(&rig), &rig);
    let mm = |counts: i32| f64::from(counts) * 0.01205;
    let positions: Vec<f64> = record.samples.iter().map(|sample| mm(sample.position)).collect();
    let (high, rest) = (mm(16_384), &positions[positions.len() - 300..]);
    assert!(positions.iter().all(|position| *position < high + 1.0), "overshoot");
    assert!(rest.iter().all(|position| (position - high).abs() < 1.0), "rest: {}", rest[0]);
}

/// Parameters that are saved stay saved, and the drive says so.
///
/// # Panics
/// When they do not.
pub fn parameters_are_saved(start: Start) {
    let rig = rig("servo-b", &["test.duration_s=0.3"]);
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    client.save_parameters().expect("disarmed");
    let state = client.config_state().expect("an answer");
    assert_eq!((state.source, state.saves, state.saved), (1, 1, true), "{}", target.name());
    client.set_parameters(pneudrive_controller::parameters::id::VELOCITY_GAIN, &[7]).expect("disarmed");
    assert!(!client.config_state().expect("an answer").saved);
    client.arm().expect("disarmed");
    assert!(client.save_parameters().is_err(), "flash is written while disarmed alone");
    client.disarm().expect("an answer");
    client.import_parameters(&rig.parameters()).expect("disarmed");
    drop(client);
    assert_equal_in_every_integer(&*target, &rig);
}

/// Absolute encoders, wherever they read 0, on the tuned drive B: its gains are as large a millimetre.
pub const ABSOLUTE_ENCODERS: [&[&str]; 2] = [
    &["encoder.model=ssi", "encoder.zero_mm=-7.3", "encoder.bits=16"],
    &[
        "encoder.model=potentiometer",
        "encoder.zero_mm=-5",
        "encoder.range_mm=310",
        "encoder.linearity_percent=0.2",
        "controller.gain_profile=[11000, 8500, 6700, 4900, 3600, 2500, 1750, 1610]",
        "controller.profile_span_counts=1",
        "controller.velocity_gain=12500",
        "controller.acceleration_gain=25000",
        "test.moves=[[0.0, 1304], [0.3, 2608], [1.72, 1304]]",
    ],
];

/// An axis with an absolute encoder is homed when the drive starts, at the position where it stands, and a homing run
/// moves nothing.
///
/// # Panics
/// When it is not, a record is not the simulation, or does not replay equal.
pub fn absolute_encoders_need_no_homing(start: Start) {
    for settings in ABSOLUTE_ENCODERS {
        let rig = rig("servo-b-tuned", settings);
        let target = start(&rig);
        let mut client = target.connect().expect("a rig that answers");
        assert!(client.status().expect("an answer").referenced, "{}, {settings:?}", target.name());
        assert_equal_in_every_integer(&*target, &rig);
        run_on(&mut client, &rig);
        let replay = replayed(&mut client);
        assert_eq!((replay.first, replay.notes.as_slice()), (None, &[][..]), "{}", target.name());
        client.arm().expect("not running");
        let before = client.status().expect("an answer").position;
        client.home().expect("armed");
        let status = client.status().expect("an answer");
        assert_eq!((status.mode, status.referenced), (Mode::Armed, true), "{}", target.name());
        assert!((status.position - before).abs() <= 60, "{}: {before} before", target.name());
    }
}
