//! What must hold for every input, every configuration and every order of requests.

use pneudrive_controller::law::Loop;
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_controller::{
    Command, Config, Fault, Mode, Move, Parameters, Refusal, Sample, Sequence, State, output, sample,
};
use proptest::prelude::*;

/// Any parameters that go together, each anywhere in its range, the ends most of all.
fn any_config() -> impl Strategy<Value = Config> {
    let values: Vec<_> = TABLE
        .iter()
        .flat_map(|p| (p.id..p.id + p.len).map(move |id| (id, p.min, p.max)))
        .map(|(id, min, max)| {
            prop_oneof![Just(min), Just(max), min..=max].prop_map(move |value| (id, value)).boxed()
        })
        .collect();
    values.prop_filter_map("parameters that go together", |values| {
        let mut parameters = Parameters::default();
        for (id, value) in values {
            parameters.set(id, value).ok()?;
        }
        parameters.set(id::PERIOD_US, 1300).ok()?;
        parameters.set(id::DELAY_US, 500).ok()?;
        for (min, max) in [
            (id::POSITION_MIN_COUNTS, id::POSITION_MAX_COUNTS),
            (id::PRESSURE_MIN_PA, id::PRESSURE_MAX_PA),
            (id::SPOOL_MIN_NM, id::SPOOL_MAX_NM),
        ] {
            if parameters.get(min) >= parameters.get(max) {
                parameters.set(min, 0).ok()?;
                parameters.set(max, 1).ok()?;
            }
        }
        Config::new(&parameters).ok()
    })
}

fn any_sample() -> impl Strategy<Value = Sample> {
    let position = prop_oneof![Just(i32::MIN), Just(i32::MAX), -30_000..30_000, any::<i32>()];
    (position, any::<i16>(), any::<i16>(), any::<i16>()).prop_map(
        |(position, pressure_1, pressure_2, spool)| Sample { position, pressure_1, pressure_2, spool },
    )
}

#[derive(Clone, Copy, Debug)]
enum Event {
    Sample(Sample),
    Arm,
    Disarm,
    Start,
    Trip(Fault),
    Reference,
}

fn any_event() -> impl Strategy<Value = Event> {
    prop_oneof![
        8 => any_sample().prop_map(Event::Sample),
        2 => Just(Event::Arm),
        1 => Just(Event::Disarm),
        2 => Just(Event::Start),
        1 => (0..Fault::ALL.len()).prop_map(|i| Event::Trip(Fault::ALL[i])),
        2 => Just(Event::Reference),
    ]
}

fn one_move(target: i32) -> Sequence {
    let mut sequence = Sequence::new(5);
    sequence.push(Move { at_sample: 0, target }).expect("room");
    sequence
}

fn running(config: &Config) -> State {
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm(config.law.control_loop).expect("referenced");
    state.start().expect("armed");
    state
}

fn wide_open() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.set(id::POSITION_MIN_COUNTS, -i32::MAX).expect("in range");
    parameters.set(id::POSITION_MAX_COUNTS, i32::MAX).expect("in range");
    parameters.set(id::ENCODER_STEP_COUNTS, i32::MAX).expect("in range");
    parameters
}

proptest! {
    /// Whatever happens in whatever order: commands stay within the limits, and a drive that is
    /// disarmed or in a fault is off.
    #[test]
    fn no_order_of_events_drives_a_drive_that_may_not_move(
        config in any_config(),
        target in any::<i32>(),
        events in prop::collection::vec(any_event(), 1..40),
    ) {
        let sequence = one_move(target);
        let mut state = State::default();
        let mut before = state.supervisor.mode();
        for event in events {
            match event {
                Event::Sample(input) => sample(&config, &sequence, &mut state, &input),
                Event::Arm => { let _ = state.supervisor.arm(config.law.control_loop); }
                Event::Disarm => state.supervisor.disarm(),
                Event::Start => { let _ = state.start(); }
                Event::Trip(fault) => state.supervisor.trip(fault),
                Event::Reference => state.supervisor.set_referenced(),
            }
            let walking = state.spool_location().steps() != 0;
            let command = output(&config, &mut state);
            let after = state.supervisor.mode();
            prop_assert!((-2048..=2048).contains(&command.counts));
            prop_assert!(command.counts.unsigned_abs() <= config.drive.largest().unsigned_abs());
            if matches!(after, Mode::Disarmed | Mode::Fault(_)) {
                prop_assert_eq!(command.counts, 0);
                let stepper = matches!(config.drive, pneudrive_controller::drive::DriveConfig::Stepper { .. });
                prop_assert_eq!(command.drive_enable, stepper && walking, "only a spool on its way is powered");
            }
            if matches!(before, Mode::Fault(_)) && before != after {
                prop_assert!(matches!(event, Event::Arm), "only arm leaves a fault");
            }
            if after == Mode::Running && before != Mode::Running {
                prop_assert!(before == Mode::Armed && matches!(event, Event::Start));
            }
            if after == Mode::Running && config.law.control_loop == Loop::Closed {
                prop_assert!(state.supervisor.is_referenced());
            }
            before = after;
        }
    }

    /// Mirrored setpoint and path give the mirrored command: the law has no favourite direction.
    #[test]
    fn the_closed_loop_is_odd(
        law in 0..=1,
        gains in (0..=65_535, 0..=65_535, 0..=65_535),
        setpoint in -1_000_000..1_000_000,
        path in prop::collection::vec(-1_000_000..1_000_000, 1..30),
    ) {
        let mut parameters = wide_open();
        for (id, value) in [
            (id::LAW, law), (id::PROPORTIONAL_GAIN, gains.0),
            (id::VELOCITY_GAIN, gains.1), (id::ACCELERATION_GAIN, gains.2),
        ] {
            parameters.set(id, value).expect("in range");
        }
        let config = Config::new(&parameters).expect("they go together");
        let (mut state, mut mirror) = (running(&config), running(&config));
        for position in path {
            sample(&config, &one_move(setpoint), &mut state, &Sample { position, ..Sample::default() });
            sample(&config, &one_move(-setpoint), &mut mirror, &Sample { position: -position, ..Sample::default() });
            prop_assert_eq!(output(&config, &mut state).counts, -output(&config, &mut mirror).counts);
        }
    }

    /// A trip acts at the output of the same sample.
    #[test]
    fn a_step_of_the_encoder_beyond_physics_is_off_at_the_same_output(
        start in -200..25_000, step in 541..100_000i32, down in any::<bool>(),
    ) {
        let config = Config::new(&Parameters::default()).expect("defaults");
        let sequence = one_move(8192);
        let mut state = running(&config);
        sample(&config, &sequence, &mut state, &Sample { position: start, ..Sample::default() });
        prop_assert!(output(&config, &mut state).drive_enable);
        let position = if down { start - step } else { start + step };
        sample(&config, &sequence, &mut state, &Sample { position, ..Sample::default() });
        prop_assert_eq!(output(&config, &mut state), Command::OFF);
        prop_assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::EncoderStep));
        prop_assert_eq!(state.observation().index, 1, "the sample that tripped has its own number");
    }

    /// A demand within the limits is what open loop drives; a larger one is limited.
    #[test]
    fn open_loop_drives_the_move_itself(target in any::<i32>(), input in any_sample()) {
        let mut parameters = wide_open();
        parameters.set(id::OPEN_LOOP, 1).expect("in range");
        let config = Config::new(&parameters).expect("they go together");
        let mut state = running(&config);
        let input = Sample { position: input.position.max(-i32::MAX), ..input };
        sample(&config, &one_move(target), &mut state, &input);
        prop_assert_eq!(i32::from(output(&config, &mut state).counts), target.clamp(-2048, 2048));
        prop_assert_eq!(state.observation().error, 0);
    }
}

#[test]
fn positions_outside_the_stroke_by_more_than_the_margin_trip() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    for (position, trips) in [(-249, false), (-250, true), (25_145, false), (25_146, true)] {
        let mut state = running(&config);
        sample(&config, &one_move(0), &mut state, &Sample { position, ..Sample::default() });
        let expected = if trips { Mode::Fault(Fault::PositionOutside) } else { Mode::Running };
        assert_eq!(state.supervisor.mode(), expected, "{position}");
    }
}

#[test]
fn a_disarmed_axis_may_be_pushed_anywhere() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    let mut state = State::default();
    for position in [0, 100_000, -100_000] {
        sample(&config, &one_move(0), &mut state, &Sample { position, ..Sample::default() });
        assert_eq!(state.supervisor.mode(), Mode::Disarmed);
    }
}

#[test]
fn a_closed_loop_holds_its_last_setpoint_when_done_and_an_open_loop_goes_to_null() {
    for (open_loop, held) in [(0, 400), (1, 0)] {
        let mut parameters = wide_open();
        parameters.set(id::OPEN_LOOP, open_loop).expect("in range");
        let config = Config::new(&parameters).expect("they go together");
        let mut state = running(&config);
        let sequence = one_move(400);
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
    state.supervisor.arm(Loop::Closed).expect("referenced");
    sample(&config, &one_move(9000), &mut state, &Sample { position: 5000, ..Sample::default() });
    assert_eq!(output(&config, &mut state), Command { counts: 0, step: 0, drive_enable: true });
}

#[test]
fn requests_that_may_not_be_are_refused_by_name() {
    let mut state = State::default();
    assert_eq!(state.supervisor.arm(Loop::Closed), Err(Refusal::NotReferenced));
    assert_eq!(state.supervisor.arm(Loop::Open), Ok(()));
    state.supervisor.disarm();
    assert_eq!(state.start(), Err(Refusal::NotArmed));
    assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::CommandWhileDisarmed));
    state.supervisor.disarm();
    assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::CommandWhileDisarmed), "a fault stays latched");
    state.supervisor.trip(Fault::Stop);
    assert_eq!(state.supervisor.mode(), Mode::Fault(Fault::CommandWhileDisarmed), "the first fault stays");
    state.supervisor.set_referenced();
    state.supervisor.arm(Loop::Closed).expect("re-armed");
    state.start().expect("armed");
    assert_eq!(state.supervisor.arm(Loop::Closed), Err(Refusal::Running));
    assert_eq!(state.start(), Err(Refusal::Running));
}

#[test]
fn codes_of_faults_and_refusals_are_fixed_and_unique() {
    let faults = Fault::ALL.map(Fault::code);
    assert_eq!(faults, [1, 2, 3, 4, 5, 6]);
    for fault in Fault::ALL {
        assert_eq!(Fault::from_code(fault.code()), Some(fault));
    }
    assert_eq!(Fault::from_code(0), None);
    let refusals = Refusal::ALL.map(Refusal::code);
    assert_eq!(refusals, [1, 2, 3, 4, 5, 6]);
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
    let mut state = running(&config);
    for position in [0, 300, 600, 1000, 1300, 1600, 1900] {
        sample(&config, &sequence, &mut state, &Sample { position, ..Sample::default() });
    }
    assert_eq!(state.supervisor.mode(), Mode::Done);
    state.supervisor.disarm();
    state.supervisor.arm(Loop::Closed).expect("referenced");
    state.start().expect("armed");
    sample(&config, &sequence, &mut state, &Sample { position: 1000, ..Sample::default() });
    let seen = state.observation();
    assert_eq!((seen.index, seen.velocity, seen.acceleration, seen.command), (0, 0, 0, 0));
}

/// A rig with a stepper, running towards a setpoint far away.
fn stepper_at_work() -> (Config, Sequence, State) {
    let mut parameters = wide_open();
    parameters.set(id::STEPPER, 1).expect("in range");
    let config = Config::new(&parameters).expect("they go together");
    let (sequence, mut state) = (one_move(20_000), running(&config));
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
    let (config, _, mut state) = stepper_at_work();
    state.supervisor.disarm();
    state.supervisor.arm(Loop::Closed).expect("referenced");
    assert_eq!(state.start(), Err(Refusal::ValveNotAtNull));
    let pulses: [i8; 6] = core::array::from_fn(|_| output(&config, &mut state).step);
    assert_eq!(pulses, [-1, -1, -1, -1, -1, 0], "armed is null at once, whatever the last sample asked for");
    assert_eq!(state.start(), Ok(()));
}

/// Stop and arm may both come between a sample and its output. Once the command of the stopped run
/// was driven then, with the drive enabled.
#[test]
fn a_drive_that_is_re_armed_between_a_sample_and_its_output_is_at_null() {
    let config = Config::new(&Parameters::default()).expect("defaults");
    let mut state = running(&config);
    sample(&config, &one_move(9000), &mut state, &Sample { position: 5000, ..Sample::default() });
    assert_ne!(state.observation().command, 0);
    state.supervisor.trip(Fault::Stop);
    state.supervisor.arm(Loop::Closed).expect("referenced");
    let null = Command { counts: 0, step: 0, drive_enable: true };
    assert_eq!(output(&config, &mut state), null);
    state.start().expect("armed");
    assert_eq!(output(&config, &mut state), null, "nothing is driven before the first sample of a run");
}

#[test]
fn a_drive_that_is_changed_to_a_dac_forgets_where_a_stepper_was() {
    let (_, _, mut state) = stepper_at_work();
    let dac = Config::new(&wide_open()).expect("they go together");
    state.supervisor.disarm();
    let _ = output(&dac, &mut state);
    state.supervisor.arm(Loop::Closed).expect("referenced");
    assert_eq!(state.start(), Ok(()));
}
