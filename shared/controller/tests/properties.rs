//! What must hold for every input, every configuration and every order of requests.

use crate::bench::{one_move, running, wide_open};
use pneudrive_controller::law::Loop;
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_controller::{Command, Config, Fault, Mode, Parameters, Sample, State, output, sample};
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
                parameters.set(max, 2).ok()?;
            }
        }
        let [low, high] = [id::POSITION_MIN_COUNTS, id::POSITION_MAX_COUNTS].map(|id| parameters.get(id));
        let range = i64::from(high?) - i64::from(low?);
        let full = (1 << parameters.get(id::SENSOR_BITS)?) - 1;
        for (id, most) in [
            (id::LATE_SAMPLE_US, 1299),
            (id::LATE_OUTPUT_US, 799),
            (id::SENSOR_SAMPLES, 769),
            (id::SENSOR_HIGH_RAW, full),
            (id::ENCODER_STEP_COUNTS, range - 1),
        ] {
            let value = i64::from(parameters.get(id)?).min(most);
            parameters.set(id, value as i32).ok()?;
        }
        Config::new(&parameters).ok()
    })
}

fn any_sample() -> impl Strategy<Value = Sample> {
    let position = prop_oneof![Just(i32::MIN), Just(i32::MAX), -30_000..30_000, any::<i32>()];
    (position, any::<i16>(), any::<i16>(), any::<i16>(), any::<bool>()).prop_map(
        |(position, pressure_1, pressure_2, spool, home_switch)| Sample {
            position,
            pressure_1,
            pressure_2,
            spool,
            home_switch,
        },
    )
}

#[derive(Clone, Copy, Debug)]
enum Event {
    Sample(Sample),
    Arm,
    Disarm,
    Start,
    Home,
    Trip(Fault),
    Reference,
    ReferenceAt(i32),
}

fn any_event() -> impl Strategy<Value = Event> {
    prop_oneof![
        8 => any_sample().prop_map(Event::Sample),
        2 => Just(Event::Arm),
        1 => Just(Event::Disarm),
        2 => Just(Event::Start),
        2 => Just(Event::Home),
        1 => (0..Fault::ALL.len()).prop_map(|i| Event::Trip(Fault::ALL[i])),
        2 => Just(Event::Reference),
        1 => any::<i32>().prop_map(Event::ReferenceAt),
    ]
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
                Event::Arm => { let _ = state.arm(&config); }
                Event::Disarm => state.supervisor.disarm(),
                Event::Start => { let _ = state.start(&config, &sequence); }
                Event::Home => { let _ = state.home(&config); }
                Event::Trip(fault) => state.supervisor.trip(fault),
                Event::ReferenceAt(position) => state.reference(position),
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
            if after == Mode::Homing && before != Mode::Homing {
                prop_assert!(before == Mode::Armed && matches!(event, Event::Home));
            }
            if after == Mode::Running && config.law.control_loop == Loop::Closed {
                prop_assert!(state.supervisor.is_referenced());
            }
            if after == Mode::Armed {
                prop_assert_eq!(command.counts, 0, "armed is null");
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
        let (moves, mirrored) = (one_move(setpoint), one_move(-setpoint));
        let (mut state, mut mirror) = (running(&config, &moves), running(&config, &mirrored));
        for position in path {
            sample(&config, &moves, &mut state, &Sample { position, ..Sample::default() });
            sample(&config, &mirrored, &mut mirror, &Sample { position: -position, ..Sample::default() });
            prop_assert_eq!(output(&config, &mut state).counts, -output(&config, &mut mirror).counts);
        }
    }

    /// A gain that falls with the error, as Appendix IX has it, whatever its entries: mirrored errors give
    /// mirrored commands, within the range of the converter.
    #[test]
    fn a_monotone_gain_profile_gives_an_odd_and_bounded_command(
        mut profile in prop::collection::vec(0..=65_535i32, 256),
        span in 1..100i32,
        errors in prop::collection::vec(any::<i16>(), 1..50),
    ) {
        profile.sort_unstable_by(|a, b| b.cmp(a));
        let mut parameters = wide_open();
        for (id, gain) in (id::GAIN_PROFILE..).zip(profile) {
            parameters.set(id, gain).expect("in range");
        }
        for (id, value) in [(id::PROFILE_SPAN_COUNTS, span), (id::VELOCITY_GAIN, 0), (id::ACCELERATION_GAIN, 0)] {
            parameters.set(id, value).expect("in range");
        }
        let config = Config::new(&parameters).expect("they go together");
        for error in errors.into_iter().map(i32::from) {
            let [ahead, behind] = [-error, error].map(|position| {
                let mut state = running(&config, &one_move(0));
                sample(&config, &one_move(0), &mut state, &Sample { position, ..Sample::default() });
                output(&config, &mut state).counts
            });
            prop_assert_eq!(ahead, -behind);
            prop_assert!((-2048..=2048).contains(&ahead) && i32::from(ahead) * error >= 0);
        }
    }

    /// Hold is hold: after the run a closed loop goes on with the last setpoint, and nothing but a request
    /// or a trip changes that.
    #[test]
    fn a_closed_loop_that_is_done_holds_its_last_setpoint(
        target in -10_000..10_000i32,
        path in prop::collection::vec(-10_000..10_000i32, 1..40),
    ) {
        let config = Config::new(&wide_open()).expect("they go together");
        let sequence = one_move(target);
        let mut state = running(&config, &sequence);
        for position in std::iter::repeat_n(&0, 8).chain(&path) {
            sample(&config, &sequence, &mut state, &Sample { position: *position, ..Sample::default() });
            let _ = output(&config, &mut state);
        }
        prop_assert_eq!(state.supervisor.mode(), Mode::Done);
        prop_assert_eq!(state.observation().setpoint, target);
        prop_assert_eq!(state.observation().error, target - path[path.len() - 1]);
    }

    /// A trip acts at the output of the same sample.
    #[test]
    fn a_step_of_the_encoder_beyond_physics_is_off_at_the_same_output(
        start in -200..25_000, step in 541..100_000i32, down in any::<bool>(),
    ) {
        let config = Config::new(&Parameters::default()).expect("defaults");
        let sequence = one_move(8192);
        let mut state = running(&config, &sequence);
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
        let sequence = one_move(target);
        let mut state = running(&config, &sequence);
        let input = Sample { position: input.position.clamp(1 - i32::MAX, i32::MAX - 1), ..input };
        sample(&config, &sequence, &mut state, &input);
        prop_assert_eq!(i32::from(output(&config, &mut state).counts), target.clamp(-2048, 2048));
        prop_assert_eq!(state.observation().error, 0);
    }
}
