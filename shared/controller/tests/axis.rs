//! The axis as a machine has it: its limits and its moves.

use crate::bench::{ControllerBench, at};
use pneudrive_controller::parameters::id;
use pneudrive_controller::sequencer::Arrival;
use pneudrive_controller::{Fault, Mode, Refusal, Sample};

const OPEN_LOOP: (u16, i32) = (id::OPEN_LOOP, 1);
const FAR: &[(u32, i32)] = &[(0, 20_000)];

#[test]
fn an_open_or_shorted_pressure_sensor_trips_after_its_samples() {
    // What an open wire and a short really leave of 4095 is some 40 and 4050.
    for bad in [0, -5, 40, 63, 4032, 4050, 4095, i16::MAX] {
        let mut bench = ControllerBench::running(&[], FAR);
        let inputs = [Sample { pressure_1: bad, ..at(100) }, Sample { pressure_2: bad, ..at(100) }];
        for (k, input) in [inputs[0], inputs[1], inputs[0]].into_iter().enumerate() {
            assert_ne!(bench.take(input), 0, "sample {k}");
        }
        assert_eq!(bench.take(inputs[1]), 0, "off at the output of the fourth");
        assert_eq!(bench.mode(), Mode::Fault(Fault::SensorRange), "{bad}");
    }
}

#[test]
fn a_pressure_that_comes_back_in_time_is_forgotten() {
    let mut bench = ControllerBench::running(&[], FAR);
    for _ in 0..10 {
        bench.hold(Sample { pressure_1: 0, ..at(100) }, 3);
        bench.take(at(100));
    }
    assert_eq!(bench.mode(), Mode::Running);
}

#[test]
fn the_ends_of_a_converter_count_only_where_they_are_watched() {
    let mut bench = ControllerBench::running(&[(id::SENSOR_LOW_RAW, -1), (id::SENSOR_HIGH_RAW, 32_767)], FAR);
    for raw in [0, 40, 4050, 4095, i16::MAX] {
        bench.hold(Sample { pressure_1: raw, pressure_2: raw, ..at(100) }, 10);
        assert_eq!(bench.mode(), Mode::Running, "{raw}");
    }
}

#[test]
fn without_pressure_sensors_no_reading_trips() {
    for raw in [-1, 0, 40, 2000, 4095, i16::MAX] {
        let mut bench = ControllerBench::running(&[(id::PRESSURE_SENSORS, 0)], FAR);
        let driven = bench.hold(Sample { pressure_1: raw, pressure_2: raw, spool: 7, ..at(100) }, 10);
        assert_eq!((bench.mode(), driven), (Mode::Running, with_sensors()), "{raw}");
    }
}

/// The command of a drive with sensors in the same place.
fn with_sensors() -> i16 {
    ControllerBench::running(&[], FAR).hold(at(100), 10)
}

#[test]
fn a_step_of_the_encoder_as_long_as_allowed_does_not_trip() {
    for (step, mode) in [(540, Mode::Running), (541, Mode::Fault(Fault::EncoderStep))] {
        let mut bench = ControllerBench::running(&[], FAR);
        bench.take(at(1000));
        bench.take(at(1000 - step));
        assert_eq!(bench.mode(), mode, "{step}");
    }
}

/// What the recorder and the status show.
#[test]
fn a_sample_of_a_run_is_observed_as_it_came_with_what_was_made_of_it() {
    let mut bench = ControllerBench::running(&[], &[(0, 1000)]);
    bench.hold(at(100), 10);
    bench.take(Sample { position: 107, pressure_1: 1500, pressure_2: 2500, spool: 9, ..Sample::default() });
    let seen = *bench.state.observation();
    assert_eq!((seen.index, seen.running), (10, true));
    assert_eq!((seen.position, seen.setpoint, seen.error), (107, 1000, 893));
    assert_eq!((seen.velocity, seen.acceleration), (7, 7));
    assert_eq!((seen.pressure_1, seen.pressure_2, seen.spool), (1500, 2500, 9));
}

/// Swapped tubes, a lost encoder, a stuck spool: the law pushes and nothing moves.
#[test]
fn a_closed_loop_that_pushes_and_moves_nothing_trips() {
    let mut bench = ControllerBench::running(&[(id::NO_MOTION_MS, 13)], FAR);
    assert_eq!(bench.hold(at(100), 10), 2048, "the first sample had no command yet");
    assert_eq!(bench.take(at(100)), 0, "10 samples of 1.3 ms");
    assert_eq!(bench.mode(), Mode::Fault(Fault::NoMotion));
}

#[test]
fn one_that_moves_or_keeps_its_valve_shut_does_not() {
    let mut moving = ControllerBench::running(&[(id::NO_MOTION_MS, 13)], FAR);
    for k in 0..100 {
        moving.take(at(100 + 5 * k));
    }
    assert_eq!(moving.mode(), Mode::Running);
    let mut shut = ControllerBench::running(&[(id::NO_MOTION_MS, 13)], &[(0, 202)]);
    assert_eq!(shut.hold(at(100), 10_000), 102, "the dead zone of the valve");
    assert_eq!(shut.mode(), Mode::Running);
    let mut offset =
        ControllerBench::running(&[(id::NO_MOTION_MS, 13), (id::NULL_OFFSET_COUNTS, 600)], &[(0, 202)]);
    assert_eq!(offset.hold(at(100), 10_000), 702, "it counts from the null");
    assert_eq!(offset.mode(), Mode::Running);
    let mut open = ControllerBench::running(&[(id::NO_MOTION_MS, 13), OPEN_LOOP], &[(0, 2048)]);
    assert_eq!(open.hold(at(100), 100), 2048, "an open loop may stand at a stop");
    let mut off = ControllerBench::running(&[(id::NO_MOTION_MS, 0)], FAR);
    assert_eq!(off.hold(at(100), 1000), 2048);
}

/// Below half of the valve nothing was noticed: 12 mm of error drove it for nine seconds.
#[test]
fn the_less_the_valve_is_open_the_longer_a_lost_encoder_takes_to_trip() {
    let samples_to_trip = |command: i32| {
        let gain = [(id::LAW, 1), (id::PROPORTIONAL_GAIN, 256), (id::NO_MOTION_MS, 13)];
        let mut bench = ControllerBench::running(&gain, &[(0, 1000 + command)]);
        assert_eq!(bench.take(at(1000)), command as i16);
        (1..10_000).find(|_| {
            bench.take(at(1000));
            bench.mode() == Mode::Fault(Fault::NoMotion)
        })
    };
    // (1024 - 102) * 10 samples / (command - 102), rounded up.
    let cases =
        [(2048, 10), (1024, 10), (1023, 11), (512, 23), (256, 60), (123, 440), (-256, 60), (103, 9220)];
    for (command, samples) in cases {
        assert_eq!(samples_to_trip(command), Some(samples), "{command} of 2048");
    }
}

/// The rod on its stop goes on by a few counts while the pressure rises.
#[test]
fn a_stop_that_gives_way_a_little_is_no_motion() {
    let mut bench = ControllerBench::running(&[(id::NO_MOTION_MS, 13)], FAR);
    for k in 0..10 {
        assert_eq!(bench.take(at(100 + 4 * k)), 2048);
    }
    bench.take(at(140));
    assert_eq!(bench.mode(), Mode::Fault(Fault::NoMotion), "40 counts are no motion");
    let mut bench = ControllerBench::running(&[(id::NO_MOTION_MS, 13)], FAR);
    bench.hold(at(100), 10);
    bench.take(at(141));
    bench.hold(at(141), 9);
    assert_eq!(bench.mode(), Mode::Running, "41 are");
}

/// It was watched in a run alone, since simulated plants stood frozen behind it.
#[test]
fn a_closed_loop_that_holds_after_its_run_trips_as_one_that_runs_when_it_pushes_and_moves_nothing() {
    let mut bench = ControllerBench::running_for(3, &[(id::NO_MOTION_MS, 13)], FAR);
    assert_eq!(bench.hold(at(100), 10), 2048);
    assert_eq!(bench.mode(), Mode::Done);
    bench.take(at(100));
    assert_eq!(bench.mode(), Mode::Fault(Fault::NoMotion));
}

/// Once the setpoint was 0 until the first move came: full retraction.
#[test]
fn before_its_first_move_a_closed_loop_holds_the_count_of_its_first_sample() {
    let mut bench = ControllerBench::running(&[], &[(3, 9000)]);
    for (position, error) in [(8192, 0), (8200, -8), (8190, 2)] {
        bench.take(at(position));
        let seen = bench.state.observation();
        assert_eq!((seen.setpoint, seen.error), (8192, error), "at {position}");
    }
    bench.take(at(8192));
    assert_eq!(bench.state.observation().setpoint, 9000, "the move has come");
    assert_eq!(bench.state.sequencer().begun(&bench.sequence), 1, "what was held before is no move");
}

#[test]
fn before_its_first_move_an_open_loop_is_at_null() {
    let mut bench = ControllerBench::running(&[OPEN_LOOP], &[(2, 700)]);
    assert_eq!([8192, 8192, 8192].map(|position| bench.take(at(position))), [0, 0, 700]);
}

#[test]
fn setpoints_beyond_a_soft_limit_are_refused_before_they_move_anything() {
    let ends = [(id::END_MIN_COUNTS, 1000), (id::END_MAX_COUNTS, 2000)];
    for (target, refused) in [(999, true), (1000, false), (2000, false), (2001, true)] {
        let mut bench = ControllerBench::armed(&ends, &[(0, 1500), (5, target)]);
        let started = bench.state.start(&bench.config, &bench.sequence);
        assert_eq!(started, if refused { Err(Refusal::BeyondSoftLimit) } else { Ok(()) }, "{target}");
        assert_eq!(bench.mode(), if refused { Mode::Armed } else { Mode::Running });
    }
}

#[test]
fn an_open_loop_pushes_no_further_than_a_soft_limit() {
    let ends = [(id::END_MIN_COUNTS, 1000), (id::END_MAX_COUNTS, 2000), OPEN_LOOP];
    for (target, position, command) in [
        (300, 1999, 300),
        (300, 2000, 0),
        (300, 2100, 0),
        (-300, 2100, -300),
        (-300, 1001, -300),
        (-300, 1000, 0),
        (300, 900, 300),
    ] {
        let mut bench = ControllerBench::running(&ends, &[(0, target)]);
        assert_eq!(bench.take(at(position)), command, "{target} at {position}");
    }
}

/// Counts mean nothing before a reference, so there is no end to hold back at.
#[test]
fn an_open_loop_without_a_reference_is_not_held_back() {
    let ends = [(id::END_MIN_COUNTS, 1000), (id::END_MAX_COUNTS, 2000), OPEN_LOOP];
    let mut bench = ControllerBench::armed(&ends, &[(0, 300)]);
    bench.state.supervisor.clear_referenced();
    bench.state.start(&bench.config, &bench.sequence).expect("an open loop needs none");
    assert_eq!(bench.take(at(2100)), 300);
}

#[test]
fn positions_count_from_where_the_axis_was_referenced() {
    let mut bench = ControllerBench::armed(&[], &[(0, 500)]);
    bench.take(at(12_345));
    bench.state.reference(500);
    bench.state.start(&bench.config, &bench.sequence).expect("armed");
    assert_eq!(bench.take(at(12_345)), 0);
    let seen = *bench.state.observation();
    assert_eq!((seen.position, seen.error, seen.velocity), (500, 0, 0));
    bench.take(at(12_347));
    assert_eq!((bench.state.observation().position, bench.state.observation().error), (502, -2));
}

/// They were tried, and the drive leaned on its stop.
#[test]
fn setpoints_outside_the_stroke_are_refused_unless_the_soft_limits_say_otherwise() {
    let started = |changes: &[(u16, i32)], target| {
        let mut bench = ControllerBench::armed(changes, &[(0, target)]);
        bench.state.start(&bench.config, &bench.sequence)
    };
    // The stroke of servo-drive B: 300 mm of 0.01205 mm a count.
    for (target, refused) in [(-1, true), (0, false), (24_896, false), (24_897, true)] {
        let expected = if refused { Err(Refusal::BeyondSoftLimit) } else { Ok(()) };
        assert_eq!(started(&[], target), expected, "{target}");
    }
    assert_eq!(started(&[(id::END_MIN_COUNTS, -200)], -1), Ok(()));
}

/// A disarmed axis is pushed by hand, and one that was driven coasts.
#[test]
fn an_open_loop_that_runs_away_behind_its_moves_trips_once_it_had_time_to_come_to_rest() {
    let after = |counts_a_sample: i32| {
        let mut bench = ControllerBench::running_for(3, &[OPEN_LOOP], &[(0, 0)]);
        (0..3000).find(|k| {
            bench.take(at(12_000 + (counts_a_sample * k) % 10_000));
            bench.mode() == Mode::Fault(Fault::MotionAtNull)
        })
    };
    assert_eq!(after(0), None, "it stands");
    assert_eq!(after(3), Some(4 + 768 + 460), "1 s, and the 460 samples in which it creeps 1380 counts");
    assert_eq!(after(10), Some(4 + 768 + 35), "1 s, and the 35 samples in which it goes 345 counts");
}

const ON_ARRIVAL: (u16, i32) = (id::ON_ARRIVAL, 1);

/// Thesis 6.3.2: at the second interrupt an exit brings the new position, "otherwise, the spool command is determined".
#[test]
fn at_an_exit_no_command_is_given() {
    let mut bench = ControllerBench::running(&[ON_ARRIVAL], &[(0, 100), (0, 200)]);
    let before = bench.take(at(50));
    assert_ne!(before, 0);
    assert_eq!(bench.take(at(98)), before, "arrived: the valve stays where it is");
    let after = bench.take(at(98));
    assert!(after > before, "{after}: the next move");
    let mut forced =
        ControllerBench::running(&[ON_ARRIVAL, (id::FORCED_EXIT_US, 2600)], &[(0, 500), (0, 100)]);
    assert_eq!(forced.take(at(100)), 400);
    assert_eq!(forced.take(at(300)), 400, "the time of the move is over");
    assert!(forced.take(at(300)) < 0, "back to 100");
}

#[test]
fn at_an_exit_a_stepper_gets_no_pulse() {
    let stepper = [ON_ARRIVAL, (id::STEPPER, 1), (id::SCALE, 1)];
    let mut bench = ControllerBench::running(&stepper, &[(0, 100), (0, 5000)]);
    let mut steps = [0, 1, 2, 3].map(|_| bench.take_whole(at(50)).step);
    assert_eq!(steps, [1; 4]);
    steps = [98, 98, 98, 98].map(|position| bench.take_whole(at(position)).step);
    assert_eq!(steps, [0, 1, 1, 1], "an exit, then the next move");
    assert_eq!(bench.state.spool_location().steps(), 7);
}

#[test]
fn moves_on_arrival_go_on_at_the_sample_after_the_arrival_and_end_the_run() {
    let mut bench = ControllerBench::running(&[ON_ARRIVAL], &[(0, 100), (0, 200)]);
    bench.take(at(50));
    assert_eq!(bench.state.sequencer().arrival(), Arrival::Moving);
    bench.take(at(92));
    assert_eq!(bench.state.sequencer().arrival(), Arrival::Arrived, "8 counts are inside");
    bench.take(at(95));
    assert_eq!(
        (bench.state.observation().setpoint, bench.state.sequencer().begun(&bench.sequence)),
        (200, 2)
    );
    bench.take(at(200));
    assert_eq!(bench.mode(), Mode::Running, "until the next sample");
    bench.take(at(200));
    assert_eq!(bench.mode(), Mode::Done);
    assert_eq!(bench.state.sequencer().not_reached(), 0);
}

#[test]
fn a_move_that_is_cut_off_by_the_end_of_the_run_was_not_reached() {
    let mut bench = ControllerBench::running_for(2, &[], &[(0, 100)]);
    bench.hold(at(50), 4);
    assert_eq!((bench.mode(), bench.state.sequencer().not_reached()), (Mode::Done, 1));
    assert_eq!(bench.state.sequencer().arrival(), Arrival::NotReached);
}

/// 8.2.3: the error that is left where a move ends goes into the null offset.
#[test]
fn the_null_offset_is_learned_where_a_move_ends_that_has_arrived() {
    let learning = [(id::LEARNING_GAIN, 256), (id::LAW, 1), (id::PROPORTIONAL_GAIN, 256)];
    let learning = [learning.as_slice(), &[(id::VELOCITY_GAIN, 0), (id::ACCELERATION_GAIN, 0)]].concat();
    let mut bench = ControllerBench::running(&learning, &[(0, 100), (3, 200), (6, 400)]);
    assert_eq!(bench.hold(at(93), 3), 7);
    assert_eq!(bench.take(at(193)), 7 + 7, "what was left of the first move is added");
    assert_eq!(bench.state.learned_null_offset(), 7);
    bench.hold(at(150), 2);
    assert_eq!(bench.take(at(300)), 100 + 7, "the second one was pushed away again: that is no rest");
    assert_eq!(bench.state.learned_null_offset(), 7);
    bench.state.forget_null_offset();
    assert_eq!(bench.state.learned_null_offset(), 0, "it is in the parameters now");
}
