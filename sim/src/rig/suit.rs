//! Values that follow from others where a file does not give them.

use super::table::preset_value;
use crate::component::actuator::vent::VentedKind;
use crate::component::controller::Law;
use crate::component::operator::OperatorKind;
use crate::key::Kind;
use crate::values::{Rig, Value};
use crate::{keys, start};

/// Samples and outputs are late beyond this, microseconds, where the file does not say.
const LATE_US: i64 = 100;

impl Rig {
    /// Puts in the values that were not set and that follow from others.
    pub(crate) fn suit_others(&mut self) {
        self.suit_drive_stage();
        self.suit_law();
        self.suit_period();
        self.suit_start();
    }

    /// With chamber 1 vented, P_2 holds the load at the start where the file does not say.
    fn suit_start(&mut self) {
        let key = &keys::test::PRESSURE_2_PA;
        if self.get(&keys::vent::VENTED) == VentedKind::Chamber1 && !self.is_set(key) {
            let balanced = start::equilibrium_pressure_2(self);
            let Kind::Number { min, max } = key.kind else { return };
            // Of a cylinder without areas it is no number; the checks refuse that.
            let value = if balanced.is_finite() { balanced.clamp(min, max) } else { min };
            self.put(key.path, Some(Value::Number(value)));
        }
    }

    /// A number that is put in for one that follows from others holds from now on.
    pub(super) fn keep(&mut self, path: &'static str) {
        if path == keys::test::PRESSURE_2_PA.path && self.get(&keys::vent::VENTED) == VentedKind::Chamber1 {
            self.set.insert(path);
        }
    }

    /// A limit of lateness must lie before the next sample: at most half of the time until then.
    fn suit_period(&mut self) {
        let [period, delay] =
            [&keys::controller::PERIOD_S, &keys::controller::DELAY_S].map(|key| self.get(key));
        let until =
            [(&keys::safety::LATE_SAMPLE_US, period), (&keys::safety::LATE_OUTPUT_US, period - delay)];
        for (key, left_s) in until {
            if !self.is_set(key) {
                let half_us = (left_s * 0.5e6).max(1.0) as i64;
                self.put(key.path, Some(Value::Integer(half_us.min(LATE_US))));
            }
        }
    }

    /// C(68) is Burrows': the other laws feed pressures back only if the file says so.
    fn suit_law(&mut self) {
        let gain = &keys::controller::PRESSURE_FEEDBACK_GAIN;
        if !self.is_set(gain) {
            let on_off = self.get(&keys::controller::LAW) == Law::OnOff;
            self.put(gain.path, if on_off { preset_value(&gain.preset) } else { Some(Value::Number(0.0)) });
        }
    }

    /// Values in commands follow the drive stage if the file does not give them: the scale of the law (6.3.3), and
    /// the dead zone of the valve, 0.05 mm.
    fn suit_drive_stage(&mut self) {
        let of_stepper = [
            (&keys::controller::SCALE, 65_536),
            (&keys::controller::DEAD_ZONE_COUNTS, 4),
            (&keys::controller::HOMING_COMMAND_COUNTS, -4),
        ];
        let stepper = self.get(&keys::operator::MODEL) == OperatorKind::Stepper;
        for (key, value) in of_stepper {
            if !self.is_set(key) {
                self.put(
                    key.path,
                    if stepper { Some(Value::Integer(value)) } else { preset_value(&key.preset) },
                );
            }
        }
    }
}
