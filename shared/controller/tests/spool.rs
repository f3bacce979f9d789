//! The spool of a stepper valve: where it is, how it is brought to mid-travel, and what is kept of it.

use crate::bench::{at, one_move, running, wide_open};
use pneudrive_controller::drive::SpoolLocation;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Config, Fault, Mode, Refusal, Sample, Sequence, State, output, sample};

/// A rig with a stepper, running towards a setpoint far away.
fn stepper_at_work() -> (Config, Sequence, State) {
    let mut parameters = wide_open();
    parameters.set(id::STEPPER, 1).expect("in range");
    let config = Config::new(&parameters).expect("they go together");
    let sequence = one_move(20_000);
    let mut state = running(&config, &sequence);
    for k in 1..=5 {
        sample(&config, &sequence, &mut state, &Sample::default());
        let command = output(&config, &mut state);
        assert_eq!(command, Command { counts: 40, step: 1, drive_enable: true });
        assert_eq!(state.observation().spool, k - 1, "SPLLOC at the sample");
    }
    (config, sequence, state)
}

#[test]
fn a_tripped_stepper_gets_target_zero_at_once_and_walks_there_one_pulse_a_sample() {
    let (config, sequence, mut state) = stepper_at_work();
    state.supervisor.trip(Fault::Stop);
    let pulses: [(i8, bool); 7] = core::array::from_fn(|_| {
        let command = output(&config, &mut state);
        assert_eq!(command.counts, 0);
        sample(&config, &sequence, &mut state, &Sample::default());
        (command.step, command.drive_enable)
    });
    let walking = (-1, true);
    assert_eq!(pulses, [walking, walking, walking, walking, walking, (0, false), (0, false)]);
}

#[test]
fn a_stepper_that_is_not_at_null_yet_does_not_start() {
    let (config, sequence, mut state) = stepper_at_work();
    state.supervisor.disarm();
    state.supervisor.arm().expect("referenced");
    assert_eq!(state.start(&config, &sequence), Err(Refusal::ValveNotAtNull));
    assert_eq!(state.home(&config), Err(Refusal::ValveNotAtNull));
    let pulses: [i8; 6] = core::array::from_fn(|_| output(&config, &mut state).step);
    assert_eq!(pulses, [-1, -1, -1, -1, -1, 0], "armed is null at once, whatever the last sample asked for");
    assert_eq!(state.start(&config, &sequence), Ok(()));
}

/// It was set to mid-travel, and the next stepper began from there with the valve open.
#[test]
fn a_drive_that_is_changed_to_a_dac_and_back_still_knows_where_its_spool_is() {
    let (stepper, sequence, mut state) = stepper_at_work();
    let dac = Config::new(&wide_open()).expect("they go together");
    state.supervisor.disarm();
    assert_eq!(output(&dac, &mut state), Command::OFF, "a solenoid does not wait for a stepper's spool");
    state.arm(&dac).expect("referenced");
    assert_eq!(state.start(&dac, &sequence), Ok(()));
    state.supervisor.disarm();
    let pulses: [i8; 6] = core::array::from_fn(|_| output(&stepper, &mut state).step);
    assert_eq!(pulses, [-1, -1, -1, -1, -1, 0]);
}

#[test]
fn a_spool_that_was_open_at_a_reset_gets_no_pulse_and_no_arming_before_it_is_sought() {
    let (config, sequence, _) = stepper_at_work();
    let mut state = State::default();
    state.take_up_spool(Some(SpoolLocation::at(-3)));
    sample(&config, &sequence, &mut state, &Sample::default());
    assert_eq!(output(&config, &mut state), Command::OFF);
    assert_eq!(state.arm(&config), Err(Refusal::SpoolInDoubt));
    assert!(state.spool_is_open(&config));
    state.seek_null().expect("it is known where it was");
    let walk: [(i8, bool); 4] = core::array::from_fn(|_| {
        let command = output(&config, &mut state);
        (command.step, command.drive_enable)
    });
    assert_eq!(walk, [(1, true), (1, true), (1, true), (0, false)]);
    assert_eq!(state.arm(&config), Ok(()));
}

#[test]
fn a_spool_of_which_nothing_is_known_is_not_sought_but_must_be_said_to_be_at_null() {
    let (config, ..) = stepper_at_work();
    let mut state = State::default();
    state.take_up_spool(None);
    assert_eq!(state.arm(&config), Err(Refusal::SpoolLost));
    assert_eq!(state.seek_null(), Err(Refusal::SpoolLost));
    assert_eq!(state.at_null(), Ok(()));
    assert_eq!(state.arm(&config), Ok(()));
    let dac = Config::new(&wide_open()).expect("they go together");
    state.take_up_spool(None);
    assert_eq!(state.arm(&dac), Ok(()), "a solenoid's spool has a spring");
}

#[test]
fn a_spool_that_was_at_mid_travel_at_a_reset_is_there() {
    let (config, ..) = stepper_at_work();
    let mut state = State::default();
    state.take_up_spool(Some(SpoolLocation::default()));
    assert_eq!(state.arm(&config), Ok(()));
}

#[test]
fn a_drive_that_is_armed_while_its_spool_walks_to_mid_travel_may_move_until_it_is_there() {
    let (config, sequence, mut state) = stepper_at_work();
    let mut limits = config.clone();
    limits.limits.null_motion = 345;
    state.supervisor.disarm();
    state.arm(&limits).expect("tripped");
    let mut position = 0;
    while state.spool_location() != SpoolLocation::default() {
        position += 400;
        sample(&limits, &sequence, &mut state, &at(position));
        assert_eq!(state.supervisor.mode(), Mode::Armed);
        let _ = output(&limits, &mut state);
    }
    for counts in [0, 400] {
        sample(&limits, &sequence, &mut state, &at(position + counts));
    }
    assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::MotionAtNull));
}

#[test]
fn a_spool_on_its_way_is_not_said_to_be_at_null() {
    let (_, _, mut state) = stepper_at_work();
    state.supervisor.disarm();
    assert_eq!(state.at_null(), Err(Refusal::ValveNotAtNull));
}

/// The board keeps it before the pulse is given: a reset in the middle of a pulse must not lose an open spool.
#[test]
fn what_is_kept_of_a_spool_is_where_its_pulse_takes_it_and_open_until_its_last_pulse_is_over() {
    let (config, _, mut state) = stepper_at_work();
    let working = Command { counts: 40, step: 1, drive_enable: true };
    assert_eq!(state.spool_to_keep(&config, &working), Some(SpoolLocation::at(5)));
    state.supervisor.disarm();
    let kept: [Option<SpoolLocation>; 6] = core::array::from_fn(|_| {
        let command = output(&config, &mut state);
        state.spool_to_keep(&config, &command)
    });
    assert_eq!(kept, [4, 3, 2, 1, 1, 0].map(|steps| Some(SpoolLocation::at(steps))));
}

#[test]
fn nothing_is_kept_of_a_spool_that_is_in_doubt_and_of_a_solenoid() {
    let (config, _, working) = stepper_at_work();
    let dac = Config::new(&wide_open()).expect("they go together");
    assert_eq!(working.spool_to_keep(&dac, &Command::OFF), None, "a solenoid has none");
    for kept in [None, Some(SpoolLocation::at(-3))] {
        let mut state = State::default();
        state.take_up_spool(kept);
        assert_eq!(state.spool_to_keep(&config, &Command::OFF), None, "{kept:?} is kept already");
    }
    assert_eq!(State::default().spool_to_keep(&config, &Command::OFF), Some(SpoolLocation::default()));
}
