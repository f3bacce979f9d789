//! Conditions between parameters: a value in its own range can still leave a check without effect.
//!
//! | parameters | must hold, or else |
//! |---|---|
//! | `delay_us`, `period_us` | `delay < period`: a command would be driven after the next sample |
//! | `late_sample_us`, `period_us` | `late < period`: a sample that is missing is late by one period, and would never trip |
//! | `delay_us`, `late_output_us`, `period_us` | `delay + late < period`: a late output would be noticed only after the next sample |
//! | `sensor_samples`, `period_us` | `samples * period <= 1 s`: an open sensor would be watched too late |
//! | `sensor_high_raw`, `sensor_bits` | within the converter, or off: no reading would reach it |
//! | `encoder_step_counts`, position limits | less than they are apart: no step within them would trip |
//! | limits of positions, ends, pressures, spool | the lower below the upper one |
//! | `homing_command_counts` | not 0: the axis would stand |
//! | `direction_setup_us`, `pulse_width_us`, `period_us` | together below the period |
//! | `law`, `cascade_stroke`, `pressure_sensors` | the law cascade has a model of its drive and knows the pressures |
//! | the law's gain on pressures, `pressure_sensors` | no gain without sensors |

use super::{ConfigError, NONE_IS_HIGH};
use crate::choice::Law;
use crate::law::pressure_gain;
use crate::parameters::{Parameters, id};

/// An open sensor trips within this time, microseconds.
const SENSOR_WATCH_US: i64 = 1_000_000;

/// The first rule that does not hold.
///
/// # Errors
/// The rule.
#[cold]
#[inline(never)]
pub(super) fn check(parameters: &Parameters) -> Result<(), ConfigError> {
    let broken = rules(parameters).into_iter().find(|(holds, _)| !holds);
    broken.map_or(Ok(()), |(_, error)| Err(error))
}

/// Whether each rule holds.
fn rules(parameters: &Parameters) -> [(bool, ConfigError); 14] {
    let get = |id| i64::from(parameters.scalar(id));
    let below = |lower, upper| get(lower) < get(upper);
    let within_period = |first, second| get(first) + get(second) < get(id::PERIOD_US);
    let full = (1 << get(id::SENSOR_BITS)) - 1;
    let none_is_high = get(id::SENSOR_HIGH_RAW) == i64::from(NONE_IS_HIGH);
    let is_cascade = Law::of(parameters.scalar(id::LAW)) == Law::Cascade && get(id::OPEN_LOOP) == 0;
    let has_model = get(id::CASCADE_STROKE) > 0 && get(id::PRESSURE_SENSORS) != 0;
    // The law cascade leaves an error that friction holds, which says nothing of the valve's null.
    let learns_null = get(id::LEARNING_GAIN) != 0;
    let range = get(id::POSITION_MAX_COUNTS) - get(id::POSITION_MIN_COUNTS);
    [
        (below(id::DELAY_US, id::PERIOD_US), ConfigError::DelayNotBelowPeriod),
        (below(id::LATE_SAMPLE_US, id::PERIOD_US), ConfigError::LateSampleNotBelowPeriod),
        (within_period(id::DELAY_US, id::LATE_OUTPUT_US), ConfigError::LateOutputBehindPeriod),
        (get(id::SENSOR_SAMPLES) * get(id::PERIOD_US) <= SENSOR_WATCH_US, ConfigError::SensorWatchTooSlow),
        (none_is_high || get(id::SENSOR_HIGH_RAW) <= full, ConfigError::SensorHighBeyondConverter),
        (range > 0, ConfigError::PositionLimitsCrossed),
        (get(id::ENCODER_STEP_COUNTS) < range, ConfigError::EncoderStepSpansLimits),
        (below(id::END_MIN_COUNTS, id::END_MAX_COUNTS), ConfigError::SoftLimitsCrossed),
        (below(id::PRESSURE_MIN_PA, id::PRESSURE_MAX_PA), ConfigError::PressureRangeEmpty),
        (below(id::SPOOL_MIN_NM, id::SPOOL_MAX_NM), ConfigError::SpoolRangeEmpty),
        (get(id::HOMING_COMMAND_COUNTS) != 0, ConfigError::HomingStandsStill),
        (within_period(id::DIRECTION_SETUP_US, id::PULSE_WIDTH_US), ConfigError::PulseTooLong),
        (get(id::PRESSURE_SENSORS) != 0 || pressure_gain(parameters) == 0, ConfigError::NothingToFeedBack),
        (!is_cascade || (has_model && !learns_null), ConfigError::NoModel),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    fn with(changes: &[(u16, i32)]) -> Result<(), ConfigError> {
        let mut parameters = Parameters::default();
        for &(id, value) in changes {
            parameters.set(id, value).expect("within the table's range");
        }
        Config::new(&parameters).map(|_| ())
    }

    /// Each rule at its edge: the last values that hold, and the first that do not.
    #[test]
    fn each_rule_ends_where_it_says() {
        use ConfigError as Error;
        type Changes = &'static [(u16, i32)];
        let cases: [(Changes, Changes, Error); 14] = [
            (&[(id::DELAY_US, 1199)], &[(id::DELAY_US, 1300)], Error::DelayNotBelowPeriod),
            (&[(id::LATE_SAMPLE_US, 1299)], &[(id::LATE_SAMPLE_US, 1300)], Error::LateSampleNotBelowPeriod),
            (&[(id::LATE_OUTPUT_US, 799)], &[(id::LATE_OUTPUT_US, 800)], Error::LateOutputBehindPeriod),
            (&[(id::SENSOR_SAMPLES, 769)], &[(id::SENSOR_SAMPLES, 770)], Error::SensorWatchTooSlow),
            (
                &[(id::SENSOR_BITS, 10), (id::SENSOR_HIGH_RAW, 1023)],
                &[(id::SENSOR_BITS, 10), (id::SENSOR_HIGH_RAW, 1024)],
                Error::SensorHighBeyondConverter,
            ),
            (
                &[(id::POSITION_MIN_COUNTS, 24_000)],
                &[(id::POSITION_MIN_COUNTS, 25_145)],
                Error::PositionLimitsCrossed,
            ),
            (
                &[(id::ENCODER_STEP_COUNTS, 25_393)],
                &[(id::ENCODER_STEP_COUNTS, 25_394)],
                Error::EncoderStepSpansLimits,
            ),
            (&[(id::END_MIN_COUNTS, 24_895)], &[(id::END_MIN_COUNTS, 24_896)], Error::SoftLimitsCrossed),
            (
                &[(id::PRESSURE_MIN_PA, 999_999)],
                &[(id::PRESSURE_MIN_PA, 1_000_000)],
                Error::PressureRangeEmpty,
            ),
            (&[(id::SPOOL_MIN_NM, 1_249_999)], &[(id::SPOOL_MIN_NM, 1_250_000)], Error::SpoolRangeEmpty),
            (&[(id::HOMING_COMMAND_COUNTS, 1)], &[(id::HOMING_COMMAND_COUNTS, 0)], Error::HomingStandsStill),
            (
                &[(id::DIRECTION_SETUP_US, 999), (id::PULSE_WIDTH_US, 300)],
                &[(id::DIRECTION_SETUP_US, 1000), (id::PULSE_WIDTH_US, 300)],
                Error::PulseTooLong,
            ),
            (
                &[(id::PRESSURE_SENSORS, 0), (id::LAW, 3), (id::PRESSURE_FEEDBACK_GAIN, 0)],
                &[(id::PRESSURE_SENSORS, 0), (id::PRESSURE_DAMPING_GAIN, 1)],
                Error::NothingToFeedBack,
            ),
            (
                &[(id::LAW, Law::Cascade as i32), (id::CASCADE_STROKE, 1)],
                &[(id::LAW, Law::Cascade as i32), (id::CASCADE_STROKE, 0)],
                Error::NoModel,
            ),
        ];
        assert_eq!(cases.len(), rules(&Parameters::default()).len(), "a case for each");
        for (holds, breaks, error) in cases {
            assert_eq!((with(holds), with(breaks)), (Ok(()), Err(error)));
            assert!(error.advice().contains("must be"), "{}", error.advice());
        }
    }

    /// The default of `late_sample_us` is 100, too.
    #[test]
    fn at_the_shortest_period_the_defaults_do_not_leave_a_check_without_effect() {
        let shortest = [(id::PERIOD_US, 100), (id::DELAY_US, 50)];
        assert_eq!(with(&shortest), Err(ConfigError::LateSampleNotBelowPeriod));
        let told = [shortest[0], shortest[1], (id::LATE_SAMPLE_US, 99), (id::LATE_OUTPUT_US, 49)];
        assert_eq!(with(&told), Ok(()));
    }

    #[test]
    fn a_sensor_that_is_not_watched_needs_no_converter_that_reaches_it() {
        assert_eq!(with(&[(id::SENSOR_BITS, 10), (id::SENSOR_HIGH_RAW, 32_767)]), Ok(()));
        assert_eq!(
            with(&[(id::SENSOR_BITS, 10)]),
            Err(ConfigError::SensorHighBeyondConverter),
            "its default"
        );
    }
}
