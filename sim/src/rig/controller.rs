//! From a rig's keys to the parameters of the controller, in its integers.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;

use super::{Rig, Value};

/// The laws, in the order of the controller's parameter.
const LAWS: [&str; 4] = ["gain-profile", "proportional", "moore-proportional", "on-off"];

impl Rig {
    /// The controller's parameters that this rig asks for.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.try_parameters()
            .unwrap_or_else(|(id, value)| panic!("parameter {id} = {value} of a checked rig"))
    }

    /// The same for a rig that has not been checked, or the id and value that is out of range.
    pub(super) fn try_parameters(&self) -> Result<Parameters, (u16, i32)> {
        let mut parameters = Parameters::default();
        for (id, value) in self.parameter_values() {
            parameters.set(id, value).map_err(|_| (id, value))?;
        }
        Ok(parameters)
    }

    fn parameter_values(&self) -> Vec<(u16, i32)> {
        let whole = |path: &str| i32::try_from(self.integer(path)).unwrap_or(i32::MAX);
        let scaled = |path: &str, factor: f64| (self.number(path) * factor).round() as i32;
        let choice = |path: &str, word: &str| i32::from(self.word(path) == word);
        let pulse_m = self.number("encoder.mm_per_count") * 1e-3;
        let counts = |metres: f64| (metres / pulse_m).floor() as i32;
        let margin = self.number("safety.position_margin_mm") * 1e-3;
        let step = self.number("safety.max_speed_m_s") * self.number("controller.period_s");
        let mut values = vec![
            (id::PERIOD_US, self.microseconds("controller.period_s") as i32),
            (id::DELAY_US, self.microseconds("controller.delay_s") as i32),
            (id::OPEN_LOOP, choice("controller.loop", "open")),
            (
                id::LAW,
                LAWS.iter().position(|&law| law == self.word("controller.law")).map_or(0, |i| i as i32),
            ),
            (id::PROFILE_SPAN_COUNTS, whole("controller.profile_span_counts")),
            (id::PROPORTIONAL_GAIN, whole("controller.proportional_gain")),
            (id::VELOCITY_GAIN, whole("controller.velocity_gain")),
            (id::ACCELERATION_GAIN, whole("controller.acceleration_gain")),
            (id::VELOCITY_WINDOW_SAMPLES, whole("controller.velocity_window_samples")),
            (id::ACCELERATION_WINDOW_SAMPLES, whole("controller.acceleration_window_samples")),
            (id::VELOCITY_DEAD_BAND, whole("controller.velocity_dead_band")),
            (id::DEAD_BAND_COUNTS, whole("controller.dead_band_counts")),
            (id::SCALE, whole("controller.scale")),
            (id::NULL_OFFSET_COUNTS, whole("controller.null_offset_counts")),
            (id::POSITION_MIN_COUNTS, counts(-margin)),
            (id::POSITION_MAX_COUNTS, counts(self.number("actuator.stroke_m") + margin)),
            (id::ENCODER_STEP_COUNTS, (step / pulse_m).ceil() as i32),
            (id::LATE_SAMPLE_US, whole("safety.late_sample_us")),
            (id::HOST_SILENCE_MS, scaled("safety.host_silence_s", 1e3)),
            (id::HOLD_MS, scaled("safety.hold_s", 1e3)),
            (id::ENCODER_INVERTED, i32::from(self.integer("encoder.polarity") < 0)),
            (id::ENCODER_PM_PER_COUNT, scaled("encoder.mm_per_count", 1e9)),
            (id::SENSOR_BITS, whole("sensors.bits")),
            (id::PRESSURE_MIN_PA, scaled("sensors.pressure_min_pa", 1.0)),
            (id::PRESSURE_MAX_PA, scaled("sensors.pressure_max_pa", 1.0)),
            (id::SPOOL_MIN_NM, scaled("sensors.spool_min_mm", 1e6)),
            (id::SPOOL_MAX_NM, scaled("sensors.spool_max_mm", 1e6)),
            (id::STEPPER, choice("operator.model", "stepper")),
            (id::MAX_STEPS, whole("operator.max_steps")),
            (id::DEAD_ZONE_COUNTS, whole("controller.dead_zone_counts")),
            (id::RELAY_HYSTERESIS_COUNTS, whole("controller.relay_hysteresis_counts")),
            (id::TOLERANCE_COUNTS, self.tolerance_counts()),
            (id::MONITORING_US, scaled("controller.monitoring_s", 1e6)),
            (id::DWELL_US, scaled("controller.dwell_s", 1e6)),
            (id::FORCED_EXIT_US, scaled("controller.forced_exit_s", 1e6)),
            (id::ON_ARRIVAL, i32::from(self.switch("controller.exit_on_dead_band"))),
            (id::HOMING_SWITCH, choice("controller.homing", "switch")),
            (id::HOMING_COMMAND_COUNTS, whole("controller.homing_command_counts")),
            (id::HOMING_POSITION_COUNTS, whole("controller.homing_position_counts")),
            (id::HOMING_STILL_MS, scaled("controller.homing_still_s", 1e3)),
            (id::HOMING_TIMEOUT_MS, scaled("controller.homing_timeout_s", 1e3)),
            (id::PULSE_WIDTH_US, whole("operator.pulse_width_us")),
            (id::DIRECTION_SETUP_US, whole("operator.direction_setup_us")),
            (id::NO_MOTION_MS, scaled("safety.no_motion_s", 1e3)),
        ];
        let [low, high] = self.open_sensors();
        values.extend([(id::SENSOR_LOW_RAW, low), (id::SENSOR_HIGH_RAW, high)]);
        for (id, path) in
            [(id::END_MIN_COUNTS, "safety.end_min_mm"), (id::END_MAX_COUNTS, "safety.end_max_mm")]
        {
            values.extend(self.optional_number(path).map(|mm| (id, counts(mm * 1e-3))));
        }
        if self.switch("controller.learn_null_offset") {
            values.push((id::LEARNING_GAIN, whole("controller.learning_gain")));
        }
        if self.word("controller.law") == "on-off" {
            values.push((id::PRESSURE_FEEDBACK_GAIN, self.pressure_feedback_gain()));
        }
        values.extend(self.gain_profile().into_iter().zip(id::GAIN_PROFILE..).map(|(gain, id)| (id, gain)));
        values
    }

    /// An error inside the tolerance is less than the dead band, as the thesis compares it (8.2.3), where
    /// there is one and the file says nothing else.
    fn tolerance_counts(&self) -> i32 {
        let dead_band = self.integer("controller.dead_band_counts");
        let given = self.set[Rig::index("controller.tolerance_counts")];
        let tolerance =
            if dead_band > 0 && !given { dead_band - 1 } else { self.integer("controller.tolerance_counts") };
        i32::try_from(tolerance).unwrap_or(i32::MAX)
    }

    /// The raw pressures of an open and of a shorted sensor, where no pressure of the drive is read so: the
    /// chambers stay above the exhaust, and below one and a half times the supply.
    fn open_sensors(&self) -> [i32; 2] {
        let [min, max] = ["min", "max"].map(|end| self.number(&format!("sensors.pressure_{end}_pa")));
        let watched = self.switch("safety.sensor_watch");
        let low = watched && self.number("exhaust.pressure_pa") > min + 0.01 * (max - min);
        let high = watched && 1.5 * self.number("supply.pressure_pa") < max;
        let full = (1 << self.integer("sensors.bits")) - 1;
        [if low { 0 } else { -1 }, if high { full } else { i32::from(i16::MAX) }]
    }

    /// k5 on raw pressures, from counts of error per kPa.
    fn pressure_feedback_gain(&self) -> i32 {
        let range = self.number("sensors.pressure_max_pa") - self.number("sensors.pressure_min_pa");
        let kpa_per_raw = range / 1e3 / f64::from((1 << self.integer("sensors.bits")) - 1);
        let scale = self.integer("controller.scale") as f64;
        (self.number("controller.pressure_feedback_gain") * kpa_per_raw * scale).round() as i32
    }

    /// The gain profile, its last entry repeated to 256.
    fn gain_profile(&self) -> Vec<i32> {
        let given: &[i64] = match self.value("controller.gain_profile") {
            Some(Value::Integers(given)) => given,
            _ => &[],
        };
        let last = given.last().copied().unwrap_or(0);
        let entries = given.iter().copied().chain(std::iter::repeat(last));
        entries.take(256).map(|gain| gain as i32).collect()
    }
}
