//! Moves with profiles: what a run makes of them.

use crate::bench::{at, wide_open};
use pneudrive_controller::law::Settings;
use pneudrive_controller::parameters::id;
use pneudrive_controller::profile::{Noise, Ramp, Wave};
use pneudrive_controller::sequencer::Arrival;
use pneudrive_controller::{
    Config, Fault, Mode, Move, Parameters, Profile, Refusal, Sequence, State, output, sample,
};
use proptest::prelude::*;

fn ramp(velocity: u32, acceleration: u32, jerk: u32) -> Profile {
    Profile::Ramp(Ramp::new(velocity, acceleration, jerk).expect("a ramp"))
}

fn with(changes: &[(u16, i32)]) -> Config {
    let mut parameters = wide_open();
    for &(id, value) in changes {
        parameters.set(id, value).expect("in range");
    }
    Config::new(&parameters).expect("they go together")
}

fn moves(all: &[Move]) -> Sequence {
    let mut sequence = Sequence::new(100_000);
    for next in all {
        sequence.push(*next).expect("room");
    }
    sequence
}

fn armed() -> State {
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("not running");
    state
}

/// A drive in a run, and whether the setpoint is worked out between its samples.
struct Run {
    config: Config,
    sequence: Sequence,
    state: State,
    ahead: bool,
}

impl Run {
    fn of(config: Config, all: &[Move]) -> Run {
        Run::through(config, moves(all))
    }

    fn through(config: Config, sequence: Sequence) -> Run {
        let mut state = armed();
        state.start(&config, &sequence).expect("armed");
        Run { config, sequence, state, ahead: false }
    }

    /// The setpoint at a sample where the axis stands at `position`.
    fn take(&mut self, position: i32) -> i32 {
        if self.ahead {
            self.state.prepare(&self.config, &self.sequence);
        }
        sample(&self.config, &self.sequence, &mut self.state, &at(position));
        let _ = output(&self.config, &mut self.state);
        self.state.observation().setpoint
    }

    /// The setpoints while an axis stands.
    fn standing(&mut self, position: i32, samples: u32) -> Vec<i32> {
        (0..samples).map(|_| self.take(position)).collect()
    }

    /// The setpoints while an axis is where it shall be.
    fn following(&mut self, samples: u32) -> Vec<i32> {
        let mut position = self.state.observation().setpoint;
        (0..samples)
            .map(|_| {
                position = self.take(position);
                position
            })
            .collect()
    }
}

#[test]
fn a_ramp_begins_at_the_setpoint_before_it_and_another_one_where_it_ends() {
    let all = [
        Move::step(0, 100),
        Move { at_sample: 2, target: 400, profile: ramp(3, 1, 1) },
        Move { at_sample: 6, target: 200, profile: ramp(2, 1, 1) },
    ];
    let mut run = Run::of(with(&[]), &all);
    assert_eq!(run.standing(100, 10), [100, 100, 100, 200, 300, 400, 400, 300, 200, 200]);
}

#[test]
fn a_first_ramp_begins_where_the_axis_stands() {
    for at_sample in [0, 3] {
        let mut run = Run::of(with(&[]), &[Move { at_sample, target: 1000, profile: ramp(5, 1, 1) }]);
        let setpoints = run.standing(500, 9);
        let at = at_sample as usize;
        assert_eq!(setpoints[..=at], vec![500; at + 1]);
        assert_eq!(setpoints[at + 1..at + 6], [600, 700, 800, 900, 1000]);
    }
}

#[test]
fn a_move_that_comes_early_goes_on_from_the_setpoint_in_force() {
    let all = [
        Move { at_sample: 0, target: 1000, profile: ramp(10, 1, 1) },
        Move { at_sample: 4, target: 0, profile: ramp(3, 1, 1) },
    ];
    assert_eq!(Run::of(with(&[]), &all).standing(0, 8), [0, 100, 200, 300, 300, 200, 100, 0]);
    let cut = [all[0], Move::step(4, 70)];
    assert_eq!(Run::of(with(&[]), &cut).standing(0, 7), [0, 100, 200, 300, 70, 70, 70]);
}

#[test]
fn moves_that_repeat_go_back_on_their_ramps() {
    let mut sequence = moves(&[
        Move { at_sample: 0, target: 30, profile: ramp(3, 1, 1) },
        Move { at_sample: 4, target: 0, profile: ramp(3, 1, 1) },
    ]);
    sequence.repeat_every(8).expect("behind the last move");
    let mut run = Run::through(with(&[]), sequence);
    assert_eq!(run.standing(0, 16), [[0, 10, 20, 30, 30, 20, 10, 0]; 2].concat());
}

#[test]
fn an_axis_that_follows_its_ramp_arrives_when_that_is_over() {
    let changes = [(id::ON_ARRIVAL, 1), (id::TOLERANCE_COUNTS, 20)];
    let all = [
        Move { at_sample: 0, target: 100, profile: ramp(10, 1, 1) },
        Move { at_sample: 0, target: 0, profile: ramp(10, 1, 1) },
    ];
    let mut run = Run::of(with(&changes), &all);
    let there = run.following(11);
    assert_eq!(there, (0..=10).map(|k| 10 * k).collect::<Vec<_>>());
    assert_eq!(run.state.sequencer().arrival(), Arrival::Arrived, "with the last sample of the ramp");
    assert_eq!(run.following(11), (0..=10).map(|k| 100 - 10 * k).collect::<Vec<_>>());
}

#[test]
fn a_forced_exit_cuts_a_ramp_short() {
    let changes = [(id::ON_ARRIVAL, 1), (id::FORCED_EXIT_US, 4 * 1300), (id::TOLERANCE_COUNTS, 1)];
    let all = [Move { at_sample: 0, target: 100, profile: ramp(10, 1, 1) }, Move::step(0, 7)];
    let mut run = Run::of(with(&changes), &all);
    assert_eq!(run.standing(0, 5), [0, 10, 20, 30, 7]);
    assert_eq!(run.state.sequencer().not_reached(), 1);
}

#[test]
fn a_stop_in_the_middle_of_a_profile_takes_the_valve_to_its_null_and_the_next_run_begins_anew() {
    let all = [Move { at_sample: 0, target: 5000, profile: ramp(40, 20, 10) }];
    let mut run = Run::of(with(&[(id::VELOCITY_FEED_FORWARD, 2000)]), &all);
    let before = run.standing(0, 30);
    assert!(run.state.observation().command != 0 && before[29] > 0 && before[29] < 5000);
    run.state.supervisor.trip(Fault::Stop);
    let command = output(&run.config, &mut run.state);
    assert_eq!((command.counts, command.drive_enable), (0, false));
    let stopped = run.standing(0, 5);
    assert_eq!(stopped, [before[29]; 5], "the setpoint goes on no more");
    assert_eq!(run.state.observation().command, 0);
    run.state.supervisor.arm().expect("out of the fault");
    run.state.start(&run.config, &run.sequence).expect("armed");
    assert_eq!(run.standing(0, 30), before);
}

#[test]
fn behind_a_run_that_ends_in_a_profile_the_setpoint_stands_and_nothing_is_fed_forward() {
    let wave = Wave { amplitude: 1000, samples: 400, rate: 1 << 57, sweep: 0 };
    let all = [Move { at_sample: 0, target: 0, profile: Profile::Wave(wave) }];
    let mut sequence = moves(&all);
    sequence.duration_samples = 9;
    let mut run = Run::through(with(&[(id::VELOCITY_FEED_FORWARD, 60_000)]), sequence);
    let setpoints = run.standing(0, 12);
    assert_eq!(run.state.supervisor.mode(), Mode::Done);
    assert_eq!(setpoints[9..], [setpoints[9]; 3]);
    let mut standing = Run::of(with(&[]), &[Move::step(0, setpoints[9])]);
    standing.standing(0, 2);
    assert_eq!(run.state.observation().command, standing.state.observation().command);
}

#[test]
fn a_wave_or_noise_beyond_a_soft_limit_is_refused_before_it_begins() {
    let config = with(&[(id::END_MIN_COUNTS, 0), (id::END_MAX_COUNTS, 1000)]);
    let wave = |amplitude| Profile::Wave(Wave { amplitude, samples: 9, rate: 1, sweep: 0 });
    let noise = |amplitude| Profile::Noise(Noise { amplitude, samples: 9, hold: 1, taps: 3 });
    for (target, profile, allowed) in [
        (700, wave(300), true),
        (700, wave(-300), true),
        (700, wave(301), false),
        (300, noise(-301), false),
        (300, noise(300), true),
        (1001, ramp(5, 1, 1), false),
        (i32::MAX, wave(i32::MIN), false),
    ] {
        let sequence = moves(&[Move { at_sample: 0, target, profile }]);
        let started = armed().start(&config, &sequence);
        assert_eq!(
            started,
            if allowed { Ok(()) } else { Err(Refusal::BeyondSoftLimit) },
            "{target} {profile:?}"
        );
    }
}

#[test]
fn an_open_loop_takes_a_profile_as_commands() {
    let all = [Move { at_sample: 0, target: 400, profile: ramp(4, 1, 1) }];
    let mut run = Run::of(with(&[(id::OPEN_LOOP, 1)]), &all);
    let commands: Vec<i16> = (0..6)
        .map(|_| {
            run.take(0);
            run.state.observation().command
        })
        .collect();
    assert_eq!(commands, [0, 100, 200, 300, 400, 400]);
}

/// Fv = Kv on a drive that moves as its setpoint does: what brakes it and what pushes it are the same.
#[test]
fn feed_forward_with_the_feedback_gains_leaves_nothing_of_an_even_motion() {
    let same = 3000;
    let gains = [
        (id::VELOCITY_GAIN, same),
        (id::VELOCITY_FEED_FORWARD, same),
        (id::ACCELERATION_GAIN, 500),
        (id::ACCELERATION_FEED_FORWARD, 500),
    ];
    let all = [Move { at_sample: 0, target: 10_000, profile: ramp(1000, 1, 1) }];
    let mut run = Run::of(with(&gains), &all);
    let mut position = 0;
    for k in 0..100 {
        sample(&run.config, &run.sequence, &mut run.state, &at(position));
        position = run.state.observation().setpoint;
        // The axis is a sample late: 10 counts of error, and 5 samples of window at 10 counts each.
        if k > 20 {
            let Settings::GainProfile(law) = &run.config.law.settings else { panic!("the thesis's law") };
            let profile = law.gains[2];
            assert_eq!(i32::from(run.state.observation().command), 10 * i32::from(profile) / 256, "{k}");
        }
        position = position.min(10 * k);
    }
}

fn any_profile() -> impl Strategy<Value = Profile> {
    let ramps = (1..9_u32, 0..9_u32, 0..20_u32).prop_map(|(j, a, v)| ramp(2 * j + a + v, j + a, j));
    let waves = (-500..500_i32, 0..60_u32, any::<u64>(), any::<i64>()).prop_map(
        |(amplitude, samples, rate, sweep)| Profile::Wave(Wave { amplitude, samples, rate, sweep }),
    );
    let noises =
        (-500..500_i32, 0..60_u32, 0..5_u32, any::<u32>()).prop_map(|(amplitude, samples, hold, taps)| {
            Profile::Noise(Noise { amplitude, samples, hold, taps })
        });
    prop_oneof![Just(Profile::Step), ramps, waves, noises]
}

proptest! {
    /// Whether and when the next setpoint is worked out between two samples changes nothing.
    #[test]
    fn a_setpoint_worked_out_ahead_is_that_of_the_sample_itself(
        moves in prop::collection::vec((0..40_u32, -2000..2000_i32, any_profile()), 1..6),
        ahead in prop::collection::vec(any::<bool>(), 200), waits in any::<bool>(),
        gains in (0..60_000_i32, 0..60_000_i32),
    ) {
        let mut at_sample = 0;
        let all: Vec<Move> = moves.into_iter().map(|(wait, target, profile)| {
            at_sample += wait;
            Move { at_sample, target, profile }
        }).collect();
        let changes = [
            (id::ON_ARRIVAL, i32::from(waits)), (id::TOLERANCE_COUNTS, 300),
            (id::VELOCITY_FEED_FORWARD, gains.0), (id::ACCELERATION_FEED_FORWARD, gains.1),
        ];
        let (mut late, mut early) = (Run::of(with(&changes), &all), Run::of(with(&changes), &all));
        let mut position = 0;
        for ahead in ahead {
            early.ahead = ahead;
            prop_assert_eq!(late.take(position), early.take(position));
            prop_assert_eq!(late.state.observation(), early.state.observation());
            prop_assert_eq!(late.state.sequencer().arrival(), early.state.sequencer().arrival());
            position += (late.state.observation().setpoint - position) / 8;
        }
    }
}

/// A drive with these changes along the path of an axis that swings about its moves.
fn commands(changes: &[(u16, i32)], profile: Profile) -> Vec<i16> {
    let mut run = Run::of(with(changes), &[Move { at_sample: 0, target: 900, profile }]);
    let swing = (0..80_i32).map(|k| 10 * k + 37 * (k % 7 - 3));
    swing
        .map(|position| {
            run.take(position);
            run.state.observation().command
        })
        .collect()
}

#[test]
fn feed_forward_acts_along_a_profile_and_never_on_a_step() {
    let gains = [(id::VELOCITY_FEED_FORWARD, 2000), (id::ACCELERATION_FEED_FORWARD, 3000)];
    assert_eq!(commands(&gains, Profile::Step), commands(&[], Profile::Step));
    let [with, without] = [&gains[..], &[]].map(|changes| commands(changes, ramp(60, 10, 5)));
    let over = 60 + 10 + 5 - 2;
    assert!(with[5] > without[5] && with[30] > without[30], "{with:?} {without:?}");
    assert_eq!(with[over..], without[over..], "when the ramp is over");
}

#[test]
fn the_gains_of_the_feed_forward_are_zero_by_default() {
    let parameters = Parameters::default();
    assert_eq!(
        [id::VELOCITY_FEED_FORWARD, id::ACCELERATION_FEED_FORWARD].map(|id| parameters.get(id)),
        [Some(0); 2]
    );
}
