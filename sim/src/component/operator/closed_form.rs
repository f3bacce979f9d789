//! The motion of a spool between two events, in closed form.
//!
//! As long as its friction keeps its direction and its coil its branch, a moving spool is a linear
//! oscillator under a constant and a sinusoidal force, and needs no steps:
//!
//! ```text
//! x'' + 2 a x' + w0^2 x = g + h sin(theta),   theta = 2 pi f t + phi
//! x  = g/w0^2 + p sin(theta) + q cos(theta) + c x_h + s (v_h + a x_h)
//! x' = 2 pi f (p cos(theta) - q sin(theta))  + c v_h - s (a v_h + w0^2 x_h)
//! c, s = exp(-a tau) (cos(w tau), sin(w tau) / w),   w^2 = w0^2 - a^2,   tau from the start
//! ```
//!
//! x_h and v_h are the differences of the start from the first three terms. Overdamped, c and s are hyperbolic.

mod first_limit;

use std::f64::consts::{FRAC_PI_2, PI};

use super::SpoolState;
use crate::component::dither::Dither;
use crate::number::{Number, Pair};
pub(crate) use first_limit::{Limit, Met, Quantity, Search, rounding};

/// A damped oscillator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Oscillator {
    /// w0^2, 1/s^2, above 0.
    pub stiffness_per_mass: f64,
    /// 2 a, 1/s.
    pub damping_per_mass: f64,
}

/// The forces on an oscillator, as accelerations, m/s^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forcing {
    /// g.
    pub steady: f64,
    /// h, with f and phi.
    pub swing: Dither,
}

/// The two parts of a motion at an instant.
#[derive(Clone, Copy, Debug, Default)]
struct Parts {
    /// The part of the swing, about the rest.
    swing: SpoolState,
    /// The remainder of the start.
    free: SpoolState,
}

/// The motion of a driven oscillator from a given state on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeMotion {
    since: f64,
    /// a.
    decay: f64,
    /// w0^2.
    stiffness: f64,
    /// w^2; negative where overdamped.
    free: f64,
    /// sqrt |w^2|, and one over it.
    frequency: f64,
    per_frequency: f64,
    /// The same in cycles a second.
    cycles_hz: f64,
    rest: f64,
    swing: Dither,
    /// p and q.
    in_phase: f64,
    across: f64,
    /// 2 pi f.
    angular: f64,
    /// The start: x_h and v_h.
    start: Parts,
    /// A quarter of the fastest period, s.
    quarter: f64,
}

/// |(w0^2 - (2 pi f)^2)^2 + (2 a 2 pi f)^2| below which, over w0^4, an oscillator without damping is in
/// resonance.
const RESONANCE: f64 = 1e-12;

impl Oscillator {
    /// Phi over a time: what becomes of a place of 1 and of a speed of 1 without a drive, position then velocity each.
    pub(crate) fn transition(self, time: f64) -> [[f64; 2]; 2] {
        let still =
            Forcing { steady: 0.0, swing: Dither { amplitude: 0.0, frequency_hz: 0.0, phase_cycles: 0.0 } };
        let from = |position, velocity| {
            let start = SpoolState { position, velocity };
            let end = FreeMotion::new(self, still, 0.0, start).map_or(start, |flight| flight.at(time));
            [end.position, end.velocity]
        };
        let [place, speed] = [from(1.0, 0.0), from(0.0, 1.0)];
        [[place[0], speed[0]], [place[1], speed[1]]]
    }
}

impl FreeMotion {
    /// From the state `start` at `t`; None in a resonance without damping.
    pub(super) fn new(
        oscillator: Oscillator,
        drive: Forcing,
        t: f64,
        start: SpoolState,
    ) -> Option<FreeMotion> {
        let (stiffness, decay) = (oscillator.stiffness_per_mass, 0.5 * oscillator.damping_per_mass);
        let angular = if drive.swing.amplitude == 0.0 { 0.0 } else { 2.0 * PI * drive.swing.frequency_hz };
        let (stiff, damped) = (stiffness - angular * angular, 2.0 * decay * angular);
        let size = stiff * stiff + damped * damped;
        if size < RESONANCE * stiffness * stiffness {
            return None;
        }
        let free = stiffness - decay * decay;
        let mut flight = FreeMotion {
            since: t,
            decay,
            stiffness,
            free,
            frequency: free.abs().sqrt(),
            per_frequency: 1.0 / free.abs().sqrt(),
            cycles_hz: free.abs().sqrt() / (2.0 * PI),
            rest: drive.steady / stiffness,
            swing: drive.swing,
            in_phase: drive.swing.amplitude * stiff / size,
            across: -drive.swing.amplitude * damped / size,
            angular: 2.0 * PI * drive.swing.frequency_hz,
            start: Parts::default(),
            quarter: FRAC_PI_2 / stiffness.sqrt().max(angular),
        };
        let swing = flight.swing_by(flight.swing.angle(t).sine_and_cosine_of_cycles());
        let free = SpoolState {
            position: start.position - (flight.rest + swing.position),
            velocity: start.velocity - swing.velocity,
        };
        flight.start = Parts { swing, free };
        Some(flight)
    }

    /// Where the spool is at `t`, and how fast.
    pub fn at(&self, t: f64) -> SpoolState {
        let Parts { swing, free } = self.parts(t);
        SpoolState {
            position: (self.rest + swing.position) + free.position,
            velocity: swing.velocity + free.velocity,
        }
    }

    #[inline(always)]
    fn parts(&self, t: f64) -> Parts {
        let tau = t - self.since;
        // Both angles at once.
        let angles = Pair::new([self.swing.angle(t), self.cycles_hz * tau]);
        let [sines, cosines] = angles.sine_and_cosine_of_cycles();
        let [c, s] = self.free_motion(tau, [sines.lane(1), cosines.lane(1)]);
        let SpoolState { position, velocity } = self.start.free;
        Parts {
            swing: self.swing_by([sines.lane(0), cosines.lane(0)]),
            free: SpoolState {
                position: c * position + s * (velocity + self.decay * position),
                velocity: c * velocity - s * (self.decay * velocity + self.stiffness * position),
            },
        }
    }

    /// A step no longer than this meets every turn of the motion, s.
    pub fn quarter_period(&self) -> f64 {
        self.quarter
    }

    /// By sine and cosine of the swing.
    #[inline(always)]
    fn swing_by(&self, [sine, cosine]: [f64; 2]) -> SpoolState {
        SpoolState {
            position: self.in_phase * sine + self.across * cosine,
            velocity: self.angular * (self.in_phase * cosine - self.across * sine),
        }
    }

    /// c and s, by sine and cosine of w tau.
    #[inline(always)]
    fn free_motion(&self, tau: f64, [sine, cosine]: [f64; 2]) -> [f64; 2] {
        let w = self.frequency;
        if self.free > 0.0 {
            let fade = (-self.decay * tau).exponential();
            [fade * cosine, fade * (sine * self.per_frequency)]
        } else if self.free == 0.0 {
            let fade = libm::exp(-self.decay * tau);
            [fade, fade * tau]
        } else {
            // a - w without the loss of digits.
            let slow = libm::exp(-self.stiffness / (self.decay + w) * tau);
            let gone = libm::expm1(-2.0 * w * tau);
            [0.5 * slow * (2.0 + gone), -0.5 * slow * gone / w]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SWING: Dither = Dither { amplitude: 200.0, frequency_hz: 50.0, phase_cycles: 0.1 };
    const START: SpoolState = SpoolState { position: 2e-4, velocity: -0.1 };

    /// The half of a time twice is the whole, and a short one is its rate, at all dampings.
    #[test]
    fn a_transition_is_an_exponential() {
        for damping_per_mass in [0.0, 300.0, 1013.13, 4000.0] {
            let oscillator = Oscillator { stiffness_per_mass: 256_610.0, damping_per_mass };
            let [half, whole] = [0.5e-3, 1e-3].map(|time| oscillator.transition(time));
            for i in 0..2 {
                for j in 0..2 {
                    let twice = half[i][0] * half[0][j] + half[i][1] * half[1][j];
                    let scale = [[1.0, 1e-3], [500.0, 1.0]][i][j];
                    assert!((twice - whole[i][j]).abs() < 1e-12 * scale, "{damping_per_mass}: {i} {j}");
                }
            }
            let short = 1e-9;
            let rate = oscillator.transition(short)[1];
            assert!(
                (rate[0] / short + oscillator.stiffness_per_mass).abs()
                    < 1e-5 * oscillator.stiffness_per_mass
            );
            assert!(
                ((1.0 - rate[1]) / short - damping_per_mass).abs()
                    < 1e-3 * oscillator.stiffness_per_mass.sqrt()
            );
        }
    }

    /// Below, at and above the critical damping, and without any.
    const OSCILLATORS: [Oscillator; 4] = [
        Oscillator { stiffness_per_mass: 1.09e6, damping_per_mass: 100.0 },
        Oscillator { stiffness_per_mass: 1e6, damping_per_mass: 2000.0 },
        Oscillator { stiffness_per_mass: 1e6, damping_per_mass: 9000.0 },
        Oscillator { stiffness_per_mass: 1e6, damping_per_mass: 0.0 },
    ];

    #[test]
    fn it_begins_where_the_spool_is() {
        for oscillator in OSCILLATORS {
            let flight = FreeMotion::new(oscillator, Forcing { steady: 50.0, swing: SWING }, 0.3, START);
            let begin = flight.expect("no resonance").at(0.3);
            assert!((begin.position - START.position).abs() < 1e-18, "{begin:?}");
            assert!((begin.velocity - START.velocity).abs() < 1e-15, "{begin:?}");
        }
    }

    /// By central differences over 0.1 us.
    #[test]
    fn it_meets_the_equation_of_motion() {
        let d = 1e-7;
        for oscillator in OSCILLATORS {
            let drive = Forcing { steady: 50.0, swing: SWING };
            let flight = FreeMotion::new(oscillator, drive, 0.3, START).expect("no resonance");
            for t in [0.3, 0.3004, 0.31, 0.4] {
                let [before, now, after] = [t - d, t, t + d].map(|t| flight.at(t));
                let velocity = (after.position - before.position) / (2.0 * d);
                assert!((velocity - now.velocity).abs() < 1e-6, "{oscillator:?} at {t}");
                let acceleration = (after.velocity - before.velocity) / (2.0 * d);
                let expected = drive.steady + SWING.value(t)
                    - oscillator.damping_per_mass * now.velocity
                    - oscillator.stiffness_per_mass * now.position;
                assert!(
                    (acceleration - expected).abs() < 3e-2,
                    "{oscillator:?} at {t}: {acceleration} {expected}"
                );
            }
        }
    }

    #[test]
    fn a_resonance_without_damping_is_left_to_the_integrator() {
        let angular = 2.0 * PI * 50.0;
        let oscillator = Oscillator { stiffness_per_mass: angular * angular, damping_per_mass: 0.0 };
        assert!(FreeMotion::new(oscillator, Forcing { steady: 0.0, swing: SWING }, 0.0, START).is_none());
    }
}
