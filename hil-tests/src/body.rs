//! Test bodies that run on every execution level. They panic, as tests do.

pub mod axis;
pub mod jitter;
pub mod keeping;
pub mod kept;
pub mod records;
mod run;
pub mod soak;
pub mod stream;
pub mod watchdog;

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use pneudrive_controller::Fault;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_sim::{Accuracy, Rig, keys};

pub use run::{as_built_in, assert_equal_in_every_integer, rig, run_and_record, start_run};

use crate::Target;
use run::{assert_is_the_simulation, replayed, run_on};

/// Starts an execution level whose plant has the true parameters of a rig, and its controller the nominal ones.
pub type Start = fn(&Rig) -> Box<dyn Target>;

/// Steps of the servo-drives in closed loop.
///
/// # Panics
/// When a record is not the simulation.
pub fn closed_loop(start: Start) {
    let moves = "test.moves=[[0.0, 8192], [0.3, 16384], [1.72, 8192], [3.2, 12000]]";
    for name in ["servo-a", "servo-a-tuned", "servo-b", "servo-b-tuned", "servo-c", "servo-c-tuned"] {
        let rig = rig(name, &["test.duration_s=5", moves]);
        assert_equal_in_every_integer(&*start(&rig), &rig);
    }
}

/// A drive without pressure sensors: whatever its inputs read, it records none, and replays.
///
/// # Panics
/// When its record is not the simulation, or does not replay equal.
pub fn without_pressure_sensors(start: Start) {
    let rig = rig("servo-b-tuned", &["sensors.pressure=false", "test.duration_s=1"]);
    let target = start(&rig);
    assert_equal_in_every_integer(&*target, &rig);
    let mut client = target.connect().expect("a rig that answers");
    let replay = replayed(&mut client);
    assert_eq!((replay.first, replay.no_pressures), (None, true), "{}", target.name());
    assert!(replay.recorded.iter().all(|sample| [sample.pressure_1, sample.pressure_2] == [0, 0]));
}

/// Moves with every profile, with feed-forward: each execution level makes the same setpoints, and a replay makes them again from the
/// header of its file.
///
/// # Panics
/// When a record is not the simulation, or does not replay equal.
pub fn profiles(start: Start) {
    let gains = ["controller.velocity_feed_forward=900", "controller.acceleration_feed_forward=700"];
    let test = [PROFILES, "test.duration_s=4.4"];
    for name in ["servo-a-tuned", "servo-b-tuned", "servo-c"] {
        let rig = rig(name, &[&gains[..], &test].concat());
        let target = start(&rig);
        assert_equal_in_every_integer(&*target, &rig);
        let mut client = target.connect().expect("a rig that answers");
        assert_eq!(client.test().expect("an answer"), rig.sequence(), "{}, {name}", target.name());
        let replay = replayed(&mut client);
        assert_eq!((replay.first, replay.notes.as_slice()), (None, &[][..]), "{}, {name}", target.name());
    }
    let open = ["controller.loop=open", "test.position_m=0.15", "test.duration_s=0.7", OPEN_PROFILES];
    let rig = rig("servo-b", &open);
    assert_equal_in_every_integer(&*start(&rig), &rig);
}

/// A move of every profile: there within limits, back in a straight line, about where it stands.
pub const PROFILES: &str = "test.move=[\
    {profile = \"s-curve\", to_mm = 90, velocity_mm_s = 700, acceleration_mm_s2 = 9000, jerk_mm_s3 = 3e5}, \
    {profile = \"trapezoid\", to_mm = 160, velocity_mm_s = 250}, \
    {profile = \"linear\", to_mm = 130, duration_s = 0.3}, \
    {profile = \"sine\", to_mm = 130, amplitude_mm = 20, frequency_hz = 2, cycles = 2}, \
    {profile = \"chirp\", to_mm = 130, amplitude_mm = 3, frequency_hz = 1, end_frequency_hz = 9, duration_s = 0.8}, \
    {profile = \"prbs\", to_mm = 130, amplitude_mm = 1, hold_s = 0.02, order = 4}, \
    {profile = \"step\", to_mm = 100}]";

/// The same of valve commands.
const OPEN_PROFILES: &str = "test.move=[\
    {profile = \"trapezoid\", to_counts = 400, velocity_mm_s = 4000, acceleration_mm_s2 = 1e5}, \
    {profile = \"sine\", to_counts = 0, amplitude_counts = 700, frequency_hz = 10, cycles = 3}, \
    {profile = \"step\", to_counts = 0}]";

/// A step of more than 32,767 counts: the recorder limits its error to 16 bits.
///
/// # Panics
/// When the record is not the simulation, or the error stays within 16 bits.
pub fn an_error_beyond_16_bits(start: Start) {
    let settings = ["encoder.mm_per_count=0.001", "test.moves=[[0.0, 50000]]", "test.duration_s=0.3"];
    let rig = rig("servo-b-tuned", &settings);
    assert_equal_in_every_integer(&*start(&rig), &rig);
    let simulated = pneudrive_sim::run(&rig, Accuracy::of(&rig)).expect("a transient").observations;
    assert!(
        simulated.iter().any(|seen| seen.error < i32::from(i16::MIN)),
        "an error of 16 bits proves nothing"
    );
}

/// A first move that comes late: until then the drive holds the count of its first sample.
///
/// # Panics
/// When a record is not the simulation, or does not replay equal.
pub fn a_late_first_move(start: Start) {
    for name in ["servo-a", "servo-b-tuned"] {
        let rig = rig(name, &["test.duration_s=0.8", "test.moves=[[0.4, 12000]]"]);
        let target = start(&rig);
        assert_equal_in_every_integer(&*target, &rig);
        let mut client = target.connect().expect("a rig that answers");
        run_on(&mut client, &rig);
        let replay = replayed(&mut client);
        assert_eq!(replay.first, None, "{}, {name}", target.name());
        let first = replay.recorded[0];
        assert_eq!(first.error, 0, "{}, {name}: it holds where it is", target.name());
    }
}

/// A jump of the encoder after the moves of a run: the plant lives on, and what is wrong with it trips the drive.
///
/// # Panics
/// When nothing notices it, or the record is not the simulation of the run.
pub fn a_fault_after_the_moves(start: Start) {
    let event = "faults.event=[{kind = \"encoder-jump\", at_s = 0.6, counts = 1000}]";
    let rig = rig("servo-b-tuned", &["test.duration_s=0.4", "test.moves=[[0.0, 9000]]", event]);
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    start_run(&mut client, &rig);
    assert_eq!(fault_after_the_moves(&mut client), Some(Fault::EncoderStep.code()), "{}", target.name());
    let record = client.record(|_, _| {}).expect("a record");
    let simulated = pneudrive_sim::run(&rig, Accuracy::of(&rig)).expect("a transient").observations;
    assert_is_the_simulation(target.name(), &record, &simulated);
}

/// A valve off its null behind the moves of an open loop: the axis goes on by itself until the drive trips.
///
/// # Panics
/// When it does not trip, or by another fault.
pub fn an_open_loop_that_runs_away(start: Start) {
    let settings = [
        "controller.loop=open",
        "test.moves=[[0.0, 0]]",
        "test.duration_s=0.1",
        "test.position_m=0.28",
        "valve.null_offset_mm=0.1",
    ];
    let rig = rig("servo-b-tuned", &settings);
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    start_run(&mut client, &rig);
    assert_eq!(fault_after_the_moves(&mut client), Some(Fault::MotionAtNull.code()), "{}", target.name());
}

/// The code of the fault that a drive trips with in 20 s after the moves of its run.
fn fault_after_the_moves(client: &mut Client) -> Option<u8> {
    let begun = Instant::now();
    // Done may be over before anybody has asked.
    while begun.elapsed() < Duration::from_secs(20) {
        let status = client.status().expect("an answer");
        if status.mode == Mode::Fault {
            return Some(status.fault);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    None
}

/// The largest commands of a DAC to both sides are in force and recorded as such, whatever is asked for.
///
/// # Panics
/// When the record is not the simulation, or one of them is missing.
pub fn the_largest_commands_of_the_dac(start: Start) {
    let moves = "test.moves=[[0.0, 2047], [0.2, -2048], [0.4, 3000]]";
    let rig = rig("servo-b", &["controller.loop=open", moves, "test.duration_s=0.6"]);
    let target = start(&rig);
    let simulated = pneudrive_sim::run(&rig, Accuracy::of(&rig)).expect("a transient").observations;
    let record = run_and_record(&*target, &rig);
    assert_is_the_simulation(target.name(), &record, &simulated);
    for (k, command) in [(0, 2047), (200, -2047), (400, 2047)] {
        assert_eq!(record.samples[k].command, command, "{}: sample {k}", target.name());
    }
}

/// A board refuses to arm where its converter has no code for the largest command, by name, and arms with one code less.
///
/// # Panics
/// When it arms, or refuses for another reason.
pub fn commands_without_a_code(start: Start) {
    let target = start(&rig("servo-b", &[]));
    let mut client = target.connect().expect("a board that answers");
    for (null_code, most) in [(2048, 2047), (2000, 2000), (2100, 1995)] {
        let beyond = [(id::NULL_CODE, null_code), (id::MAX_COMMAND_COUNTS, most + 1)];
        client.change_parameters(&beyond).expect("disarmed");
        let refused = client.arm().expect_err("there is no code for it").to_string();
        assert!(refused.contains(keys::operator::MAX_COMMAND_COUNTS.name()), "{}: {refused}", target.name());
        client.set_parameters(id::MAX_COMMAND_COUNTS, &[most]).expect("disarmed");
        client.arm().expect("a code for each command");
        client.disarm().expect("an answer");
    }
}

/// Commands to the servo-drives in open loop, to where the limit of the drive stage is met.
///
/// # Panics
/// When a record is not the simulation.
pub fn open_loop(start: Start) {
    let steps = "test.moves=[[0.0, 0], [0.1, 12], [0.5, -10], [1.2, 4], [3.0, -60]]";
    let counts = "test.moves=[[0.0, 0], [0.1, 512], [0.5, -512], [1.2, 200], [3.0, -2048]]";
    for (name, moves) in [("servo-a", steps), ("servo-b", counts), ("servo-c", counts)] {
        let rig = rig(name, &["controller.loop=open", moves, "test.duration_s=5"]);
        assert_equal_in_every_integer(&*start(&rig), &rig);
    }
}

/// Moore's law, the relay and the valve that is thrown over; as long as the recorder holds.
///
/// # Panics
/// When a record is not the simulation.
pub fn other_built_in_rigs(start: Start) {
    for name in ["lut-stepper", "lut-solenoid", "burrows", "bang-bang"] {
        let rig = rig(name, &["test.duration_s=2.1"]);
        assert_equal_in_every_integer(&*start(&rig), &rig);
    }
}

/// Pressures and spool are read one after the other; the relay of the on-off law acts on both pressures.
///
/// # Panics
/// When a record is not the simulation.
pub fn channels_read_in_turn(start: Start) {
    for name in ["servo-b-tuned", "burrows"] {
        let rig = rig(name, &["test.duration_s=1", "sensors.channel_skew_s=0.00004"]);
        assert_equal_in_every_integer(&*start(&rig), &rig);
    }
}

/// The drive has lived for a while before its controller starts.
///
/// # Panics
/// When a record is not the simulation.
pub fn a_late_controller(start: Start) {
    for name in ["servo-a", "servo-b-tuned"] {
        let rig = rig(name, &["test.duration_s=0.6", "controller.start_s=0.2345"]);
        assert_equal_in_every_integer(&*start(&rig), &rig);
    }
}

/// Servo-drive B with a stepper in the place of its solenoid.
///
/// # Panics
/// When the record is not the simulation.
pub fn stepper(start: Start) {
    let moves = "test.moves=[[0.0, 8192], [0.3, 16384], [1.72, 8192]]";
    let rig = rig("servo-b", &["operator.model=stepper", "test.duration_s=5", moves]);
    assert_equal_in_every_integer(&*start(&rig), &rig);
}

/// Servo-drive C under the law on a model, which follows its spool by the sensor.
#[must_use]
pub fn with_a_measured_spool() -> Rig {
    rig(
        "servo-c",
        &[
            "controller.law=cascade",
            "controller.period_s=0.0005",
            "controller.delay_s=0.0002",
            "operator.dither_mm=0",
            "test.moves=[[0.0, 8192], [0.1, 13171], [0.7, 8192]]",
            "test.duration_s=1.2",
        ],
    )
}

/// A spool on a spring that its sensor shows to the law, behind ports and tubes.
///
/// # Panics
/// When the record is not the simulation.
pub fn a_measured_spool(start: Start) {
    let rig = with_a_measured_spool();
    assert_equal_in_every_integer(&*start(&rig), &rig);
}

/// Servo-drive A under the law on a model, which moves its spool by a stepper.
///
/// # Panics
/// When the record is not the simulation.
pub fn a_stepped_spool(start: Start) {
    let rig = rig(
        "servo-a",
        &[
            "controller.law=cascade",
            "controller.period_s=0.0005",
            "controller.delay_s=0.0002",
            "test.moves=[[0.0, 8192], [0.1, 13171], [0.7, 8192]]",
            "test.duration_s=1.2",
        ],
    );
    assert_equal_in_every_integer(&*start(&rig), &rig);
}

/// The inputs of an execution level's record, as `pneudrive record` leaves it, through the controller on the PC.
/// The recorded inputs make the recorded outputs on the PC: what is done with a record from a real cylinder.
///
/// # Panics
/// When a record does not replay equal.
pub fn records_replay(start: Start) {
    for name in ["servo-a", "servo-b", "servo-b-tuned", "lut-stepper", "burrows"] {
        let rig = rig(name, &["test.duration_s=2.1"]);
        let target = start(&rig);
        let mut client = target.connect().expect("a rig that answers");
        run_on(&mut client, &rig);
        let replay = replayed(&mut client);
        assert_eq!(replay.first, None, "{}, {name}", target.name());
        assert_eq!(replay.recorded.len(), rig.last_sample() as usize + 1, "{name}: samples");
        assert!(replay.replayed.iter().any(|output| output.command != 0), "{name} moves");
    }
}

/// One run of a test on a real cylinder, with the parameters and the reference that the drive has: the
/// recorded inputs make the recorded outputs on the PC.
///
/// # Panics
/// When the run does not come to its end, or does not replay equal.
pub fn the_record_of_a_real_cylinder_replays(start: &dyn Fn(&Rig) -> Box<dyn Target>, rig: &Rig) {
    let target = start(rig);
    let mut client = target.connect().expect("a rig that answers");
    run_on(&mut client, rig);
    let replay = replayed(&mut client);
    client.disarm().expect("an answer");
    assert_eq!(replay.first, None, "{}, {}", target.name(), rig.name());
    println!("{}: {} samples replay equal", target.name(), replay.equal_samples());
    assert!(replay.replayed.iter().any(|output| output.command != 0), "a test that moves nothing");
}

/// A run that was stopped in the middle replays equal up to there, and the stop is no difference.
///
/// # Panics
/// When it does not.
pub fn the_record_of_a_stopped_run_replays(start: Start) {
    let (_target, mut client) = in_a_long_run(start);
    while client.status().expect("an answer").index < 100 {}
    client.stop().expect("an answer");
    let replay = replayed(&mut client);
    assert_eq!((replay.first, replay.tripped), (None, None));
    assert!(replay.equal_samples() > 100, "{} samples", replay.equal_samples());
}

/// Two runs one after the other.
///
/// # Panics
/// When the records are not equal.
pub fn each_start_begins_from_the_same_state(start: Start) {
    let rig = rig("servo-b", &["test.duration_s=0.6"]);
    let target = start(&rig);
    let first = run_and_record(&*target, &rig).samples;
    assert_eq!(run_and_record(&*target, &rig).samples, first);
}

/// A period that is not that of the plant's rig file.
///
/// # Panics
/// When the record is not the simulation with that period.
pub fn another_period(start: Start) {
    let file = rig("servo-b", &["test.duration_s=0.5"]);
    let other = rig("servo-b", &["test.duration_s=0.5", "controller.period_s=0.002"]);
    let target = start(&file);
    let mut client = target.connect().expect("a rig that answers");
    client.import_parameters(&other.parameters()).expect("disarmed");
    drop(client);
    assert_equal_in_every_integer(&*target, &other);
}

/// A rig in the middle of a run that will not end by itself, and who started it.
///
/// # Panics
/// When it does not start.
#[must_use]
pub fn in_a_long_run(start: Start) -> (Box<dyn Target>, Client) {
    let rig = rig("servo-b", &["test.duration_s=3000"]);
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    start_run(&mut client, &rig);
    (target, client)
}

/// A stop in the middle of a run.
///
/// # Panics
/// When the run does not end in the fault, or arming does not leave it.
pub fn a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it(start: Start) {
    let (_target, mut client) = in_a_long_run(start);
    client.stop().expect("an answer");
    let error = client.follow(&AtomicBool::new(false), |_| {}).expect_err("stopped").to_string();
    assert!(error.contains("stop (a stop was requested)"), "{error}");
    client.arm().expect("arming leaves the fault");
    assert_eq!(client.status().expect("an answer").mode, Mode::Armed);
}
