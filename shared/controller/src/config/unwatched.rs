//! Checks that parameters leave without effect, though each is in its range and they go together.
//!
//! | check | is off where |
//! |---|---|
//! | [`Fault::PositionOutside`] | a limit is more than 1 m, and more than the soft limits are apart, beyond its soft limit |
//! | [`Fault::EncoderStep`] | the step is one at more than 20 m/s |
//! | [`Fault::HostSilent`] | `host_silence_ms` is 0 or more than 10 s |
//! | [`Fault::SensorRange`] | pressures are measured, and neither end of their converter is watched |
//! | [`Fault::NoMotion`] | `no_motion_ms` is 0 or more than 60 s, or `no_motion_counts` reach from one soft limit to the other |
//! | [`Fault::ModelAtBound`], [`Fault::PressureDoubtful`] | the law is "cascade" in a closed loop, and `model_bound_ms` or `pressure_doubt_ms` is 0 |

use super::NONE_IS_HIGH;
use crate::choice::Law;
use crate::fault::Fault;
use crate::parameters::{Parameters, id};

const METRE_PM: i64 = 1_000_000_000_000;
/// Picometres in a microsecond: 20 m/s. The fastest cylinders reach 10 m/s.
const FASTEST: i64 = 20_000_000;
const LONGEST_SILENCE_MS: i64 = 10_000;
const LONGEST_STANDSTILL_MS: i64 = 60_000;

/// The faults that these parameters never trip with, for a cause that there can be.
pub fn unwatched(parameters: &Parameters) -> impl Iterator<Item = Fault> {
    let get = |id| i64::from(parameters.scalar(id));
    let within = |value: i64, longest: i64| (1..=longest).contains(&value);
    let (soft_min, soft_max) = (get(id::END_MIN_COUNTS), get(id::END_MAX_COUNTS));
    let travel = soft_max - soft_min;
    let pm = get(id::ENCODER_PM_PER_COUNT);
    let is_far = |beyond: i64| beyond > travel && beyond > METRE_PM / pm.max(1);
    let sensors_off = get(id::SENSOR_LOW_RAW) < 0 && get(id::SENSOR_HIGH_RAW) == i64::from(NONE_IS_HIGH);
    let is_cascade = Law::of(parameters.scalar(id::LAW)) == Law::Cascade && get(id::OPEN_LOOP) == 0;
    [
        (
            Fault::PositionOutside,
            is_far(soft_min - get(id::POSITION_MIN_COUNTS))
                || is_far(get(id::POSITION_MAX_COUNTS) - soft_max),
        ),
        (Fault::EncoderStep, get(id::ENCODER_STEP_COUNTS).saturating_mul(pm) > FASTEST * get(id::PERIOD_US)),
        (Fault::HostSilent, !within(get(id::HOST_SILENCE_MS), LONGEST_SILENCE_MS)),
        (Fault::SensorRange, get(id::PRESSURE_SENSORS) != 0 && sensors_off),
        (
            Fault::NoMotion,
            !within(get(id::NO_MOTION_MS), LONGEST_STANDSTILL_MS) || get(id::NO_MOTION_COUNTS) >= travel,
        ),
        (Fault::ModelAtBound, is_cascade && get(id::MODEL_BOUND_MS) == 0),
        (Fault::PressureDoubtful, is_cascade && get(id::PRESSURE_DOUBT_MS) == 0),
    ]
    .into_iter()
    .filter_map(|(fault, is_off)| is_off.then_some(fault))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(changes: &[(u16, i32)]) -> Parameters {
        let mut parameters = Parameters::default();
        changes.iter().for_each(|&(id, value)| parameters.set(id, value).expect("within the table's range"));
        parameters
    }

    #[test]
    fn the_defaults_watch_everything() {
        assert_eq!(unwatched(&Parameters::default()).next(), None);
    }

    /// 1 m is 82,987 counts of 12.05 um; the soft limits are 0 and 24,896; 20 m/s are 2157 counts in 1.3 ms.
    #[test]
    fn each_check_is_off_from_where_the_table_says() {
        type Changes = &'static [(u16, i32)];
        let cases: [(Fault, Changes, Changes); 11] = [
            (
                Fault::PositionOutside,
                &[(id::POSITION_MIN_COUNTS, -82_987)],
                &[(id::POSITION_MIN_COUNTS, -82_988)],
            ),
            (
                Fault::PositionOutside,
                &[(id::POSITION_MAX_COUNTS, 24_896 + 82_987)],
                &[(id::POSITION_MAX_COUNTS, i32::MAX)],
            ),
            (Fault::EncoderStep, &[(id::ENCODER_STEP_COUNTS, 2157)], &[(id::ENCODER_STEP_COUNTS, 2158)]),
            (Fault::HostSilent, &[(id::HOST_SILENCE_MS, 10_000)], &[(id::HOST_SILENCE_MS, 10_001)]),
            (Fault::HostSilent, &[(id::HOST_SILENCE_MS, 1)], &[(id::HOST_SILENCE_MS, 0)]),
            (
                Fault::SensorRange,
                &[(id::SENSOR_LOW_RAW, -1)],
                &[(id::SENSOR_LOW_RAW, -1), (id::SENSOR_HIGH_RAW, 32_767)],
            ),
            (Fault::NoMotion, &[(id::NO_MOTION_MS, 60_000)], &[(id::NO_MOTION_MS, 60_001)]),
            (Fault::NoMotion, &[(id::NO_MOTION_MS, 1)], &[(id::NO_MOTION_MS, 0)]),
            (Fault::NoMotion, &[(id::NO_MOTION_COUNTS, 24_895)], &[(id::NO_MOTION_COUNTS, 24_896)]),
            (
                Fault::ModelAtBound,
                &[(id::LAW, Law::Cascade as i32)],
                &[(id::LAW, Law::Cascade as i32), (id::MODEL_BOUND_MS, 0)],
            ),
            (
                Fault::PressureDoubtful,
                &[(id::LAW, Law::GainProfile as i32), (id::PRESSURE_DOUBT_MS, 0)],
                &[(id::LAW, Law::Cascade as i32), (id::PRESSURE_DOUBT_MS, 0)],
            ),
        ];
        for (fault, on, off) in cases {
            assert_eq!(unwatched(&with(on)).next(), None, "{on:?}");
            assert!(unwatched(&with(off)).eq([fault]), "{off:?}");
        }
    }

    #[test]
    fn a_drive_without_pressure_sensors_lacks_no_check_of_them() {
        let without =
            with(&[(id::PRESSURE_SENSORS, 0), (id::SENSOR_LOW_RAW, -1), (id::SENSOR_HIGH_RAW, 32_767)]);
        assert_eq!(unwatched(&without).next(), None);
    }
}
