//! The dither of a valve amplifier: a sinusoid a sin(2 pi f t + phi) (C(32), C(33), C(34)).

use std::f64::consts::PI;

use crate::component::play::Motion;
use crate::key::keys;
use crate::number::Number;
use crate::values::Rig;

/// The operators that have an amplifier with a dither.
pub(crate) const SOLENOIDS: &[&str] = &["solenoid", "solenoid-empirical"];

keys! {
    DITHER_HZ: f64 = number("operator.dither_hz", 50.0, 0.0, 1000.0, "C(32)", "Frequency of the amplifier's dither.").of(SOLENOIDS);
    DITHER_MM: f64 = number("operator.dither_mm", 0.2, 0.0, 10.0, "C(33)", "Amplitude of the dither.").of(SOLENOIDS).spread();
    DITHER_PHASE_DEG: f64 = number("operator.dither_phase_deg", 0.0, -360.0, 360.0, "C(34)", "Phase of the dither at t = 0.").of(SOLENOIDS);
    DITHER_ADJUSTABLE: bool = switch("operator.dither_adjustable", false, "5.3.2", "Whether the user can set amplitude and frequency of the dither. Else no search changes them: a valve with an amplifier of its own has the dither that its maker gave it.").of(SOLENOIDS);
}

impl Dither {
    /// The dither of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Dither {
        Dither {
            amplitude: rig.get(&keys::DITHER_MM) * 1e-3,
            frequency_hz: rig.get(&keys::DITHER_HZ),
            phase_cycles: rig.get(&keys::DITHER_PHASE_DEG) / 360.0,
        }
    }
}

/// A sinusoid over time.
#[derive(Clone, Copy, Debug)]
pub struct Dither {
    /// a, in the unit of the quantity that it is added to.
    pub amplitude: f64,
    /// f, Hz.
    pub frequency_hz: f64,
    /// phi, as a fraction of a cycle.
    pub phase_cycles: f64,
}

/// |cos| below which an instant counts as an extremum: larger than the effect of rounding the time to 53 bits, and not smaller than the part that [`Dither::next`] counts as passed.
const AT_EXTREMUM: f64 = 1e-8;

/// The cycle at a crest and at a trough.
pub(crate) const CREST: f64 = 0.25;
pub(crate) const TROUGH: f64 = 0.75;

impl Dither {
    /// The part of a cycle that has gone at `t`, 0 to 1.
    fn cycle(&self, t: f64) -> f64 {
        let cycles = self.angle(t);
        cycles - cycles.floor()
    }

    /// The dither at `t` seconds.
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        if self.amplitude == 0.0 { 0.0 } else { self.amplitude * self.sine_and_cosine(t)[0] }
    }

    /// Sine and cosine of its angle at `t`.
    fn sine_and_cosine(&self, t: f64) -> [f64; 2] {
        self.angle(t).sine_and_cosine_of_cycles()
    }

    /// Its angle at `t`, cycles.
    pub(crate) fn angle(&self, t: f64) -> f64 {
        t * self.frequency_hz + self.phase_cycles
    }

    /// Its rate at `t`, per second.
    #[must_use]
    pub fn rate(&self, t: f64) -> f64 {
        let peak = 2.0 * PI * self.frequency_hz * self.amplitude;
        if peak == 0.0 { 0.0 } else { peak * self.sine_and_cosine(t)[1] }
    }

    /// Which way the dither moves just after `t`: by the slope, and by the curvature where the slope
    /// is zero within rounding (EQUATIONS section 11 rule 3: an output at an extremum is regular).
    #[must_use]
    pub fn direction(&self, t: f64) -> Motion {
        if self.amplitude == 0.0 || self.frequency_hz == 0.0 {
            return Motion::Still;
        }
        let [sine, slope] = self.sine_and_cosine(t);
        let rising = if slope.abs() > AT_EXTREMUM { slope > 0.0 } else { sine < 0.0 };
        if rising { Motion::Rising } else { Motion::Falling }
    }

    /// The first instant after `t` at which the cycle is at `cycle` (0 to 1); an instant nearer
    /// than 1e-9 cycles counts as passed.
    pub(crate) fn next(&self, t: f64, cycle: f64) -> f64 {
        let mut ahead = cycle - self.cycle(t);
        ahead -= ahead.floor();
        if !(1e-9..=1.0 - 1e-9).contains(&ahead) {
            ahead = 1.0;
        }
        t + ahead / self.frequency_hz
    }

    /// The first instant after `t` at which the dither passes `level` in the direction of `motion`;
    /// infinity for never.
    pub(crate) fn next_crossing(&self, t: f64, level: f64, motion: Motion) -> f64 {
        let sine = level / self.amplitude;
        if sine.is_nan() || sine.abs() > 1.0 || self.frequency_hz == 0.0 {
            return f64::INFINITY;
        }
        let rising = libm::asin(sine) / (2.0 * PI);
        let cycle = if motion == Motion::Rising { rising } else { 0.5 - rising };
        self.next(t, cycle - cycle.floor())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DITHER: Dither = Dither { amplitude: 0.2, frequency_hz: 50.0, phase_cycles: 0.125 };

    #[test]
    fn the_rate_is_the_slope_of_the_value() {
        for t in [0.0, 0.0031, 0.7777] {
            let slope = (DITHER.value(t + 1e-7) - DITHER.value(t - 1e-7)) / 2e-7;
            assert!((DITHER.rate(t) - slope).abs() < 1e-5 * 62.8, "{t}");
        }
    }

    #[test]
    fn crossings_are_where_the_value_is_the_level() {
        for motion in [Motion::Rising, Motion::Falling] {
            let t = DITHER.next_crossing(0.123, 0.07, motion);
            assert!(t > 0.123 && t <= 0.143);
            assert!((DITHER.value(t) - 0.07).abs() < 1e-12);
            assert_eq!(DITHER.direction(t), motion);
        }
        assert_eq!(DITHER.next_crossing(0.0, 0.21, Motion::Rising), f64::INFINITY);
    }

    #[test]
    fn at_an_extremum_the_curvature_decides() {
        let plain = Dither { phase_cycles: 0.0, ..DITHER };
        assert_eq!(plain.direction(0.085), Motion::Falling, "a crest");
        assert_eq!(plain.direction(0.095), Motion::Rising, "a trough");
    }
}
