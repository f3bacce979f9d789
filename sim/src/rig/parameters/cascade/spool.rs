//! The spool of a drive, as the law "cascade" knows it: in counts of command, of which 2048 ask for the travel.
//!
//! ```text
//! oscillator    [s - u, s'] -> Phi [s - u, s'] over a time, w^2 and D per mass                      both kinds of solenoid
//! in units      place: a count; speed: a count a sample, so that Phi_01 is over T and Phi_10 times T
//! coil          place of rest: travel/2048 of amplifier, coil over spring;   friction over spring, in the same
//! two samples   x_2 = Phi^2 x_0 + Phi g e_0 + g e_1,   g = [1 - Phi_00, -Phi_10]                    e: places of rest
//!               x_2 = [way, 0] is solved for e_0 = a way + b s',   e_1 = c way + d s'
//! ```

use pneudrive_controller::parameters::id;

use super::fixed::fixed;
use crate::component::operator::{OperatorKind, Oscillator};
use crate::component::valve::spool_travel;
use crate::keys;
use crate::values::Rig;

/// How much faster than it is the law makes a spool that is not measured: 3/2 in its equation.
const BOOST: f64 = 1.5;
/// Samples that a measured spool takes: two of its deadbeat, and what its friction and the reach of the coil cost.
const MEASURED_LAG: f64 = 4.5;
/// The part of the flow that its ways ask for, over that of others: what it misses in fast ones, its friction keeps.
const MEASURED_FLOW: f64 = 0.6;

/// Phi in units of samples.
type Phi = [[f64; 2]; 2];

pub(super) struct Spool {
    oscillator: Oscillator,
    measured: Option<Measured>,
    period: f64,
    delay: f64,
    /// Travel of the spool by a count, m, and of the command that the amplifier passes on.
    count: f64,
    of_command: f64,
}

/// What the law knows of a spool that is measured, m.
struct Measured {
    stiction: f64,
    friction: f64,
}

impl Spool {
    pub(super) fn of(rig: &Rig) -> Spool {
        use keys::{empirical, solenoid};
        let of_command = spool_travel(rig) / 2048.0 * rig.get(&keys::amplifier::AMPLIFIER_GAIN);
        let [period, delay] =
            [&keys::controller::PERIOD_S, &keys::controller::DELAY_S].map(|key| rig.get(key));
        if rig.get(&keys::operator::MODEL) != OperatorKind::Solenoid {
            let oscillator = Oscillator {
                stiffness_per_mass: rig.get(&empirical::STIFFNESS_PER_MASS_PER_S2),
                damping_per_mass: rig.get(&empirical::DAMPING_PER_S),
            };
            return Spool { oscillator, measured: None, period, delay, count: of_command, of_command };
        }
        let mass = rig.get(&solenoid::SPOOL_MASS_KG);
        let spring = 1e3 * rig.get(&solenoid::SPRING_N_PER_MM);
        let oscillator = Oscillator {
            stiffness_per_mass: spring / mass,
            damping_per_mass: rig.get(&solenoid::DAMPING_N_S_PER_M) / mass,
        };
        let measured = Measured {
            stiction: rig.get(&solenoid::STATIC_FRICTION_N) / spring,
            friction: rig.get(&solenoid::COULOMB_FRICTION_N) / spring,
        };
        let count = of_command * 1e3 * rig.get(&solenoid::FORCE_GAIN_N_PER_MM) / spring;
        Spool { oscillator, measured: Some(measured), period, delay, count, of_command }
    }

    /// From a command to the spool, s: 2 z/w.
    fn lag(&self) -> f64 {
        self.oscillator.damping_per_mass / self.oscillator.stiffness_per_mass
    }

    /// The part of tau that is the spool's, s.
    pub(super) fn dead_time(&self) -> f64 {
        if self.measured.is_some() { MEASURED_LAG * self.period } else { self.lag() / BOOST }
    }

    /// The part of the flow for the jerk of a way, over the usual one.
    pub(super) fn flow(&self) -> f64 {
        if self.measured.is_some() { MEASURED_FLOW } else { 1.0 }
    }

    fn phi(&self, time: f64) -> Phi {
        let [[place, speed], [pull, coast]] = self.oscillator.transition(time);
        [[place, speed / self.period], [pull * self.period, coast]]
    }

    pub(super) fn values(&self, rig: &Rig) -> Vec<(u16, i32)> {
        let lap = rig.get(&keys::valve::UNDERLAP_MM) * 1e-3;
        let play = rig.get(&keys::hysteresis::HYSTERESIS_PERCENT) / 100.0 * spool_travel(rig);
        let [output, sample] = [self.delay, self.period - self.delay].map(|time| self.phi(time));
        let lag = if self.measured.is_some() { 0.0 } else { self.lag() };
        let mut values = vec![
            (id::CASCADE_SPOOL_OUTPUT_PLACE, fixed(output[0][0], 30)),
            (id::CASCADE_SPOOL_OUTPUT_SPEED, fixed(output[0][1], 30)),
            (id::CASCADE_SPOOL_OUTPUT_PULL, fixed(output[1][0], 28)),
            (id::CASCADE_SPOOL_OUTPUT_COAST, fixed(output[1][1], 30)),
            (id::CASCADE_SPOOL_SAMPLE_PLACE, fixed(sample[0][0], 30)),
            (id::CASCADE_SPOOL_SAMPLE_SPEED, fixed(sample[0][1], 30)),
            (id::CASCADE_SPOOL_SAMPLE_PULL, fixed(sample[1][0], 28)),
            (id::CASCADE_SPOOL_SAMPLE_COAST, fixed(sample[1][1], 30)),
            (id::CASCADE_SPOOL_LAG, fixed(lag / self.period, 16)),
            (id::CASCADE_OUTPUT_SHARE, fixed(self.delay / self.period, 16)),
            (id::CASCADE_OVERLAP, fixed(lap / self.count, 16)),
            (id::CASCADE_SPAN, fixed((spool_travel(rig) - lap) / self.count, 16)),
            (id::CASCADE_PLAY, fixed(play / self.of_command, 16)),
        ];
        if let Some(measured) = &self.measured {
            values.extend(self.of_measured(rig, measured));
        }
        values
    }

    fn of_measured(&self, rig: &Rig, measured: &Measured) -> Vec<(u16, i32)> {
        let counts = |metres: f64, bits: i32| fixed(metres / self.count, bits);
        let [low, high] =
            [&keys::sensors::SPOOL_MIN_MM, &keys::sensors::SPOOL_MAX_MM].map(|key| 1e-3 * rig.get(key));
        let full = f64::from((1_u32 << rig.get(&keys::sensors::BITS)) - 1);
        let [first, second] = deadbeat(&self.phi(self.period));
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

    /// The land before a port, in counts.
    pub(super) fn counts(&self, metres: f64) -> i32 {
        fixed(metres / self.count, 16)
    }
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
    // What is left of a way and of a speed.
    let solved = |[x, v]: [f64; 2]| {
        [(x * last[1] - v * last[0]) / determinant, (first[0] * v - first[1] * x) / determinant]
    };
    let (by_way, by_speed) = (solved([1.0, 0.0]), solved([-coast[0], -coast[1]]));
    [[by_way[0], by_speed[0]], [by_way[1], by_speed[1]]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From any motion: a sample under each of the two places of rest ends at the goal, without speed.
    #[test]
    fn two_samples_bring_a_spool_to_a_place_and_stop_it() {
        let oscillator = Oscillator { stiffness_per_mass: 1.087e6, damping_per_mass: 100.0 };
        let spool =
            Spool { oscillator, measured: None, period: 5e-4, delay: 2e-4, count: 1.0, of_command: 1.0 };
        let phi = spool.phi(5e-4);
        let [first, second] = deadbeat(&phi);
        for (way, speed) in [(1.0, 0.0), (0.0, 3.0), (-40.0, 12.0)] {
            let rests = [first, second].map(|[by_way, by_speed]| by_way * way + by_speed * speed);
            let end = rests.into_iter().fold([0.0, speed], |[place, speed], rest| {
                let [from, speed] = turned(&phi, [place - rest, speed]);
                [rest + from, speed]
            });
            assert!((end[0] - way).abs() < 1e-9 && end[1].abs() < 1e-9, "{end:?}");
        }
    }
}
