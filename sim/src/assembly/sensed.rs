//! Pressure sensors that follow the air with a first-order lag:
//!
//! ```text
//! P_s' = (P - P_s) / lag,   P_s = P at the start
//! ```
//!
//! P is the pressure at the port of the chamber, and P_s the input of the converter. That is the pressure in the chamber, but where the
//! spear of a cushion is in, that in front of it. Without a lag P_s is P, and its states rest.

use super::{Assembly, StateVector, slot};
use crate::number::Pair;

impl Assembly {
    /// The readings of the sensors for the pressures in a state, Pa.
    #[inline]
    pub fn sensed_pressures(&self, x: &StateVector) -> [f64; 2] {
        match self.parts.sensor_lag {
            Some(_) => slot::SENSED.map(|i| x[i]),
            None => self.at_sensors(x, self.pressures(x)),
        }
    }

    /// The pressures in a state, Pa.
    #[inline]
    pub fn pressures(&self, x: &StateVector) -> [f64; 2] {
        let exners = slot::EXNER.map(|i| x[i]);
        self.parts.gas.pressure_of(Pair::new(exners)).to_array()
    }

    /// The rates of the lagged states.
    #[inline(always)]
    pub(super) fn follow_pressures(&self, pressures: [f64; 2], x: &StateVector, slope: &mut StateVector) {
        if let Some(lag) = self.parts.sensor_lag {
            for (place, pressure) in slot::SENSED.into_iter().zip(self.at_sensors(x, pressures)) {
                slope[place] = (pressure - x[place]) / lag;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Integration, scale_of};
    use super::*;
    use crate::assembly::build;
    use crate::follow;
    use crate::plant::{Accuracy, Plant};
    use crate::values::Rig;
    use pneudrive_solver::Method;

    fn rig(lag: f64, overlap: f64) -> Rig {
        let text = format!(
            "[controller]\nloop = \"open\"\n[operator]\ndither_mm = 0.0\n[valve]\nunderlap_mm = {overlap}\nspool_diameter_mm = 10.0\n[sensors]\npressure_lag_s = {lag}\n"
        );
        Rig::read("lagged", &text).expect("valid")
    }

    /// An overlap without clearance shuts the valve, so that the air in the chambers rests.
    #[test]
    fn a_step_of_the_pressure_is_followed_by_an_exponential() {
        let (lag, step) = (0.004, 5e4);
        let (parts, mut x) = build::drive(&rig(lag, 0.1));
        let pressures = slot::EXNER.map(|i| parts.gas.pressure(x[i]));
        for (place, pressure) in slot::SENSED.into_iter().zip(pressures) {
            x[place] = pressure - step;
        }
        let scale = scale_of(&parts);
        let mut assembly = Assembly::new(parts, &x);
        let mut integrator = Integration::of_parts(Method::DormandPrince, 1e-11, scale, x);
        for k in 1..10 {
            let t = 2e-3 * f64::from(k);
            integrator.integrate_to(&mut assembly, t, f64::INFINITY).expect("integrated");
            let sensed = assembly.sensed_pressures(integrator.state(t));
            for (sensed, pressure) in sensed.into_iter().zip(pressures) {
                let expected = pressure - step * (-t / lag).exp();
                assert!((sensed - expected).abs() < 1e-3, "{t} s: {sensed} Pa, not {expected}");
            }
        }
    }

    /// A lag L delays a slow change by L.
    #[test]
    fn readings_lag_and_the_air_does_not() {
        let lag = 5e-4;
        let timing = follow::Timing { period_us: 1300, delay_us: 500 };
        let command = pneudrive_controller::Command { counts: 700, step: 0, drive_enable: true };
        let of = |lag| follow::follow(&rig(lag, 0.0), Accuracy::default(), timing, &[command; 100]);
        let (sharp, lagged) = (of(0.0).expect("followed"), of(lag).expect("followed"));
        for k in 40..98 {
            assert!((sharp[k].position - lagged[k].position).abs() < 1e-8);
            for i in 0..2 {
                let slope = (sharp[k + 1].pressures[i] - sharp[k - 1].pressures[i]) / 2.6e-3;
                let behind = sharp[k].pressures[i] - lagged[k].pressures[i];
                assert!(
                    (behind - lag * slope).abs() < 0.1 * (lag * slope).abs() + 20.0,
                    "{k}, {i}: {behind}"
                );
            }
        }
    }

    #[test]
    fn without_a_lag_the_readings_are_the_pressures_to_the_bit() {
        let mut plant = Plant::new(&rig(0.0, 0.0), Accuracy::default(), 0);
        for _ in 0..50 {
            plant.next_sample().expect("a sample");
        }
        let looked = plant.look(50.0 * 1.3e-3).expect("the present sample");
        assert_eq!(
            plant.reading().expect("a reading").pressures.map(f64::to_bits),
            looked.pressures.map(f64::to_bits)
        );
    }
}
