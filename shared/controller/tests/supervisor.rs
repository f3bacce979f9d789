//! Modes and requests: what is refused, what is held, what a trip does.

use crate::bench::{ControllerBench, at, one_move, running, wide_open};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{
    Command, Config, Fault, Mode, Parameters, Refusal, Sample, Sequence, State, output, sample,
};

#[test]
fn positions_outside_the_stroke_by_more_than_the_margin_trip() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    for (position, trips) in [(-249, false), (-250, true), (25_145, false), (25_146, true)] {
        let mut state = running(&config, &one_move(0));
        sample(&config, &one_move(0), &mut state, &at(position));
        let expected = if trips { Mode::Fault(Fault::PositionOutside) } else { Mode::Running };
        assert_eq!(state.supervisor.mode(), expected, "{position}");
    }
}

/// The drive was armed again and ran to positions that were wrong by the jump.
#[test]
fn an_encoder_step_takes_the_reference_away_and_no_other_fault_does() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    for (position, fault) in [(641, Fault::EncoderStep), (-250, Fault::PositionOutside)] {
        let mut state = running(&config, &one_move(0));
        sample(&config, &one_move(0), &mut state, &at(if fault == Fault::EncoderStep { 100 } else { -240 }));
        sample(&config, &one_move(0), &mut state, &at(position));
        assert_eq!(state.supervisor.mode(), Mode::Fault(fault));
        assert_eq!(state.supervisor.is_referenced(), fault == Fault::PositionOutside, "{fault:?}");
    }
    let mut state = running(&config, &one_move(0));
    sample(&config, &one_move(0), &mut state, &at(100));
    sample(&config, &one_move(0), &mut state, &at(641));
    state.arm(&config).expect("tripped");
    assert_eq!(state.start(&config, &one_move(0)), Err(Refusal::NotReferenced));
}

#[test]
fn a_disarmed_axis_may_be_pushed_anywhere() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    let mut state = State::default();
    for position in [0, 100_000, -100_000] {
        sample(&config, &one_move(0), &mut state, &at(position));
        assert_eq!(state.supervisor.mode(), Mode::Disarmed);
    }
}

#[test]
fn a_closed_loop_holds_its_last_setpoint_when_done_and_an_open_loop_goes_to_null() {
    for (open_loop, held) in [(0, 400), (1, 0)] {
        let mut parameters = wide_open();
        parameters.set(id::OPEN_LOOP, open_loop).expect("in range");
        let config = Config::new(&parameters).expect("they go together");
        let sequence = one_move(400);
        let mut state = running(&config, &sequence);
        let input = Sample::default();
        for k in 0..=5 {
            assert_eq!(state.supervisor.mode(), Mode::Running, "before sample {k}");
            sample(&config, &sequence, &mut state, &input);
            assert_eq!(state.observation().index, k);
        }
        assert_eq!(state.supervisor.mode(), Mode::Running, "until the output of sample 5 is over");
        sample(&config, &sequence, &mut state, &input);
        assert_eq!(state.supervisor.mode(), Mode::Done);
        assert!(!state.observation().running);
        assert_eq!(output(&config, &mut state), Command { counts: held, step: 0, drive_enable: true });
    }
}

#[test]
fn an_armed_drive_stands_at_null_whatever_the_error() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("referenced");
    sample(&config, &one_move(9000), &mut state, &at(5000));
    assert_eq!(output(&config, &mut state), Command { counts: 0, step: 0, drive_enable: true });
}

#[test]
fn requests_that_may_not_be_are_refused_by_name() {
    let mut state = State::default();
    let config = Config::new(&Parameters::default()).expect("defaults");
    let sequence = one_move(500);
    state.supervisor.arm().expect("not running");
    assert_eq!(state.start(&config, &Sequence::new(9)), Err(Refusal::NoMoves));
    assert_eq!(state.start(&config, &sequence), Err(Refusal::NotReferenced));
    assert_eq!(state.supervisor.mode(), Mode::Armed, "a refusal changes nothing");
    state.supervisor.disarm();
    assert_eq!(state.start(&config, &sequence), Err(Refusal::NotArmed));
    assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::CommandWhileDisarmed));
    state.supervisor.disarm();
    assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::CommandWhileDisarmed), "a fault stays latched");
    state.supervisor.trip(Fault::Stop);
    assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::CommandWhileDisarmed), "the first fault stays");
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("re-armed");
    state.start(&config, &sequence).expect("armed");
    assert_eq!(state.supervisor.arm(), Err(Refusal::Running));
    assert_eq!(state.start(&config, &sequence), Err(Refusal::Running));
    assert_eq!(state.home(&config), Err(Refusal::Running));
}

#[test]
fn codes_of_faults_and_refusals_are_fixed_and_unique() {
    let faults = Fault::ALL.map(Fault::code);
    assert_eq!(faults, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18]);
    for fault in Fault::ALL {
        assert_eq!(Fault::from_code(fault.code()), Some(fault));
    }
    assert_eq!(Fault::from_code(0), None);
    let refusals = Refusal::ALL.map(Refusal::code);
    assert_eq!(refusals, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
    for refusal in Refusal::ALL {
        assert_eq!(Refusal::from_code(refusal.code()), Some(refusal));
    }
    assert_eq!(Refusal::from_code(0), None);
}

#[test]
fn a_start_begins_anew_at_sample_zero_with_a_fresh_history() {
    let mut parameters = wide_open();
    parameters.set(id::VELOCITY_GAIN, 60_000).expect("in range");
    let config = Config::new(&parameters).expect("they go together");
    let sequence = one_move(1000);
    let mut state = running(&config, &sequence);
    for position in [0, 300, 600, 1000, 1300, 1600, 1900] {
        sample(&config, &sequence, &mut state, &at(position));
    }
    assert_eq!(state.supervisor.mode(), Mode::Done);
    state.supervisor.disarm();
    state.supervisor.arm().expect("referenced");
    state.start(&config, &sequence).expect("armed");
    sample(&config, &sequence, &mut state, &Sample { position: 1000, ..Sample::default() });
    let seen = state.observation();
    assert_eq!((seen.index, seen.velocity, seen.acceleration, seen.command), (0, 0, 0, 0));
}

/// Stop and arm may both come between a sample and its output. Once the command of the stopped run
/// was driven then, with the drive enabled.
#[test]
fn a_drive_that_is_re_armed_between_a_sample_and_its_output_is_at_null() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    let mut state = running(&config, &one_move(0));
    sample(&config, &one_move(9000), &mut state, &at(5000));
    assert_ne!(state.observation().command, 0);
    state.supervisor.trip(Fault::Stop);
    state.supervisor.arm().expect("referenced");
    let null = Command { counts: 0, step: 0, drive_enable: true };
    assert_eq!(output(&config, &mut state), null);
    state.start(&config, &one_move(9000)).expect("armed");
    assert_eq!(output(&config, &mut state), null, "nothing is driven before the first sample of a run");
}

/// A spool that has lost steps, an amplifier that fails: the valve is not where its null is taken to be.
#[test]
fn an_armed_drive_that_moves_trips_and_so_does_one_that_creeps_far_from_where_it_stood() {
    let after = |counts_a_sample: i32| {
        let mut bench = ControllerBench::armed(&[], &[(0, 0)]);
        let samples = (0..2000).find(|k| {
            bench.take(at(12_000 + counts_a_sample * k));
            bench.mode() == Mode::Fault(Fault::MotionAtNull)
        });
        samples.map(|k| (k, bench.take(at(0))))
    };
    // 345 counts in 64 samples: 50 mm/s of the 5 m/s that the encoder may do.
    assert_eq!(after(0), None);
    assert_eq!([6, -6, 100].map(after), [Some((58, 0)), Some((58, 0)), Some((4, 0))]);
    // Four times as far, however slowly: 16.6 mm.
    assert_eq!([5, -5, 1].map(after), [Some((277, 0)), Some((277, 0)), Some((1381, 0))]);
}

/// The board judges a host's silence by it.
#[test]
fn the_cylinder_is_on_its_way_in_a_run_and_in_a_homing_run_alone() {
    let mut bench = ControllerBench::armed(&[], &[(0, 500)]);
    assert!(!bench.state.supervisor.moves(), "armed");
    bench.state.home(&bench.config).expect("armed");
    assert!(bench.state.supervisor.moves(), "homing");
    bench.state.supervisor.trip(Fault::Stop);
    assert!(!bench.state.supervisor.moves(), "tripped");
    let mut bench = ControllerBench::running_for(3, &[], &[(0, 500)]);
    assert!(bench.state.supervisor.moves(), "running");
    bench.hold(at(500), 5);
    assert_eq!((bench.mode(), bench.state.supervisor.moves()), (Mode::Done, false));
}
