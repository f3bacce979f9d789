//! The spool of a drive, as the law "cascade" knows it: in counts of command, of which 2048 ask for the travel.
//!
//! ```text
//! oscillator    [s - u, s'] -> Phi [s - u, s'] over a time, w^2 and D per mass                      both kinds of solenoid
//! in units      place: a count; speed: a count a sample, so that Phi_01 is over T and Phi_10 times T
//! coil          place of rest: travel/2048 of amplifier, coil over spring;   friction over spring, in the same
//! two samples   x_2 = Phi^2 x_0 + Phi g e_0 + g e_1,   g = [1 - Phi_00, -Phi_10]                    e: places of rest
//!               x_2 = [travel, 0] is solved for e_0 = a travel + b s',   e_1 = c travel + d s'
//! ```

use pneudrive_controller::parameters::id;

use super::fixed::fixed;
use crate::component::operator::{OperatorKind, Oscillator, hysteresis};
use crate::component::valve::spool_travel;
use crate::keys;
use crate::values::Rig;

/// Counts to either side.
const COUNTS: f64 = 2048.0;
/// How much faster than it is the law makes a spool that is not measured: 3/2 in its equation.
const BOOST: f64 = 1.5;
/// Samples that a measured spool takes: two of its deadbeat, and what its friction and the reach of the coil cost.
const MEASURED_LAG: f64 = 4.5;
/// The part of the flow that its trajectories ask for, over that of others: what it misses in fast ones, its friction keeps.
const MEASURED_FLOW: f64 = 0.6;

/// Phi in units of samples.
type Phi = [[f64; 2]; 2];

pub(super) struct Spool {
    kind: Kind,
    period: f64,
    delay: f64,
    /// How far it goes to either side, m: its travel, or less where 2048 counts or the farthest step ask for less.
    pub reach: f64,
    /// Travel of the spool by a count, m, and of the command that the amplifier passes on.
    count: f64,
    of_command: f64,
}

/// What moves it.
enum Kind {
    /// An oscillator follows the command.
    Follows(Oscillator),
    /// A coil against a spring, and a sensor shows it.
    Measured(Measured),
    /// A stepper, with a step of this length (m) a sample.
    Stepped { step: f64 },
}

/// What the law knows of a spool that is measured, m.
struct Measured {
    oscillator: Oscillator,
    stiction: f64,
    friction: f64,
}

impl Spool {
    pub(super) fn of(rig: &Rig) -> Spool {
        use keys::{empirical, solenoid, stepper};
        let [period, delay] =
            [&keys::controller::PERIOD_S, &keys::controller::DELAY_S].map(|key| rig.get(key));
        let travel = spool_travel(rig);
        let of_command = travel / COUNTS * rig.get(&keys::amplifier::AMPLIFIER_GAIN);
        let spool =
            |kind, count| Spool { kind, period, delay, reach: travel.min(COUNTS * count), count, of_command };
        match rig.get(&keys::operator::MODEL) {
            OperatorKind::Stepper => {
                let step = 1e-3 * rig.get(&stepper::MM_PER_STEP);
                let reach = step * rig.get(&stepper::MAX_STEPS) as f64;
                Spool { reach, ..spool(Kind::Stepped { step }, reach / COUNTS) }
            }
            OperatorKind::Solenoid => {
                let mass = rig.get(&solenoid::SPOOL_MASS_KG);
                let spring = 1e3 * rig.get(&solenoid::SPRING_N_PER_MM);
                let oscillator = Oscillator {
                    stiffness_per_mass: spring / mass,
                    damping_per_mass: rig.get(&solenoid::DAMPING_N_S_PER_M) / mass,
                };
                let measured = Measured {
                    oscillator,
                    stiction: rig.get(&solenoid::STATIC_FRICTION_N) / spring,
                    friction: rig.get(&solenoid::COULOMB_FRICTION_N) / spring,
                };
                let count = of_command * 1e3 * rig.get(&solenoid::FORCE_GAIN_N_PER_MM) / spring;
                spool(Kind::Measured(measured), count)
            }
            _ => {
                let oscillator = Oscillator {
                    stiffness_per_mass: rig.get(&empirical::STIFFNESS_PER_MASS_PER_S2),
                    damping_per_mass: rig.get(&empirical::DAMPING_PER_S),
                };
                spool(Kind::Follows(oscillator), of_command)
            }
        }
    }

    /// The part of tau that is the spool's, s; `opened`: in how many steps a stepper opens the valve, a step's length (m) given.
    pub(super) fn dead_time(&self, opened: impl Fn(f64) -> i64) -> f64 {
        match &self.kind {
            Kind::Follows(oscillator) => lag(oscillator) / BOOST,
            Kind::Measured(_) => MEASURED_LAG * self.period,
            Kind::Stepped { step } => 0.5 * opened(*step) as f64 * self.period,
        }
    }

    /// The part of the flow for the jerk of a trajectory, over the usual one.
    pub(super) fn flow(&self) -> f64 {
        match self.kind {
            Kind::Measured(_) => MEASURED_FLOW,
            Kind::Follows(_) | Kind::Stepped { .. } => 1.0,
        }
    }

    pub(super) fn values(&self, rig: &Rig) -> Vec<(u16, i32)> {
        let lap = rig.get(&keys::valve::UNDERLAP_MM) * 1e-3;
        let values = vec![
            (id::CASCADE_OUTPUT_SHARE, fixed(self.delay / self.period, 16)),
            (id::CASCADE_OVERLAP, self.counts(lap)),
            (id::CASCADE_SPAN, self.counts(self.reach - lap)),
        ];
        let own = match &self.kind {
            Kind::Follows(oscillator) => self.of_oscillator(rig, oscillator, lag(oscillator)),
            Kind::Measured(measured) => {
                [self.of_oscillator(rig, &measured.oscillator, 0.0), self.of_measured(rig, measured)].concat()
            }
            Kind::Stepped { .. } => vec![(id::CASCADE_SPOOL_LAG, 0)],
        };
        [values, own].concat()
    }

    /// Of a solenoid, with its play.
    fn of_oscillator(&self, rig: &Rig, oscillator: &Oscillator, lag: f64) -> Vec<(u16, i32)> {
        let play = hysteresis::half_width(rig);
        let [output, sample] =
            [self.delay, self.period - self.delay].map(|time| phi(oscillator, time, self.period));
        vec![
            (id::CASCADE_SPOOL_OUTPUT_PLACE, fixed(output[0][0], 30)),
            (id::CASCADE_SPOOL_OUTPUT_SPEED, fixed(output[0][1], 30)),
            (id::CASCADE_SPOOL_OUTPUT_PULL, fixed(output[1][0], 28)),
            (id::CASCADE_SPOOL_OUTPUT_COAST, fixed(output[1][1], 30)),
            (id::CASCADE_SPOOL_SAMPLE_PLACE, fixed(sample[0][0], 30)),
            (id::CASCADE_SPOOL_SAMPLE_SPEED, fixed(sample[0][1], 30)),
            (id::CASCADE_SPOOL_SAMPLE_PULL, fixed(sample[1][0], 28)),
            (id::CASCADE_SPOOL_SAMPLE_COAST, fixed(sample[1][1], 30)),
            (id::CASCADE_SPOOL_LAG, fixed(lag / self.period, 16)),
            (id::CASCADE_PLAY, fixed(play / self.of_command, 16)),
        ]
    }

    fn of_measured(&self, rig: &Rig, measured: &Measured) -> Vec<(u16, i32)> {
        let counts = |metres: f64, bits: i32| fixed(metres / self.count, bits);
        let [low, high] =
            [&keys::sensors::SPOOL_MIN_MM, &keys::sensors::SPOOL_MAX_MM].map(|key| 1e-3 * rig.get(key));
        let full = f64::from((1_u32 << rig.get(&keys::sensors::BITS)) - 1);
        let [first, second] = deadbeat(&phi(&measured.oscillator, self.period, self.period));
        vec![
            (id::CASCADE_SPOOL_OFFSET, counts(low, 16)),
            (id::CASCADE_SPOOL_GAIN, counts((high - low) / full, 24)),
            (id::CASCADE_SPOOL_FIRST_WAY, fixed(first[0], 24)),
            (id::CASCADE_SPOOL_FIRST_SPEED, fixed(first[1], 24)),
            (id::CASCADE_SPOOL_SECOND_WAY, fixed(second[0], 24)),
            (id::CASCADE_SPOOL_SECOND_SPEED, fixed(second[1], 24)),
            (id::CASCADE_SPOOL_STICTION, counts(measured.stiction, 16)),
            (id::CASCADE_SPOOL_FRICTION, counts(measured.friction, 16)),
        ]
    }

    /// A length of spool, in counts.
    pub(super) fn counts(&self, metres: f64) -> i32 {
        fixed(metres / self.count, 16)
    }
}

/// From a command to the spool, s: 2 z/w.
fn lag(oscillator: &Oscillator) -> f64 {
    oscillator.damping_per_mass / oscillator.stiffness_per_mass
}

/// Over a time, for speeds in a period.
fn phi(oscillator: &Oscillator, time: f64, period: f64) -> Phi {
    let [[place, speed], [pull, coast]] = oscillator.transition(time);
    [[place, speed / period], [pull * period, coast]]
}

fn turned(phi: &Phi, [place, speed]: [f64; 2]) -> [f64; 2] {
    phi.map(|[by_place, by_speed]| by_place * place + by_speed * speed)
}

/// [a, b] and [c, d].
fn deadbeat(phi: &Phi) -> [[f64; 2]; 2] {
    let last = [1.0 - phi[0][0], -phi[1][0]];
    let first = turned(phi, last);
    let determinant = first[0] * last[1] - first[1] * last[0];
    let coast = turned(phi, turned(phi, [0.0, 1.0]));
    // What is left of a travel and of a speed.
    let solved = |[x, v]: [f64; 2]| {
        [(x * last[1] - v * last[0]) / determinant, (first[0] * v - first[1] * x) / determinant]
    };
    let (by_travel, by_speed) = (solved([1.0, 0.0]), solved([-coast[0], -coast[1]]));
    [[by_travel[0], by_speed[0]], [by_travel[1], by_speed[1]]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From any motion: a sample under each of the two places of rest ends at the goal, without speed.
    #[test]
    fn two_samples_bring_a_spool_to_a_place_and_stop_it() {
        let oscillator = Oscillator { stiffness_per_mass: 1.087e6, damping_per_mass: 100.0 };
        let phi = phi(&oscillator, 5e-4, 5e-4);
        let [first, second] = deadbeat(&phi);
        for (travel, speed) in [(1.0, 0.0), (0.0, 3.0), (-40.0, 12.0)] {
            let rests = [first, second].map(|[by_travel, by_speed]| by_travel * travel + by_speed * speed);
            let end = rests.into_iter().fold([0.0, speed], |[place, speed], rest| {
                let [from, speed] = turned(&phi, [place - rest, speed]);
                [rest + from, speed]
            });
            assert!((end[0] - travel).abs() < 1e-9 && end[1].abs() < 1e-9, "{end:?}");
        }
    }
}
