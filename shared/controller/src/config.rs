//! The validated form of the parameters: what the law runs on, immutable while it does.

use core::num::NonZeroU32;

use crate::drive::{DacConfig, DriveConfig};
use crate::estimator::EstimatorConfig;
use crate::law::{LawConfig, LawKind, Loop};
use crate::parameters::{Parameters, id};
use crate::supervisor::Limits;

/// Everything that stays as it is while the controller runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Config {
    /// When to sample and when to drive.
    pub timing: Timing,
    /// Windows of the differences.
    pub estimator: EstimatorConfig,
    /// Gains, profile and scale.
    pub law: LawConfig,
    /// What trips the supervisor.
    pub limits: Limits,
    /// What drives the valve.
    pub drive: DriveConfig,
    /// Whether the board turns the sign of its encoder.
    pub encoder_inverted: bool,
}

/// The clock of the control task and what counts as late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Sample period, microseconds.
    pub period_us: NonZeroU32,
    /// Sample to output, microseconds; less than the period.
    pub delay_us: NonZeroU32,
    /// A sample later than this is a fault, microseconds.
    pub late_sample_us: u32,
    /// Silence of the host that is a fault while a move runs, milliseconds; 0: none is.
    pub host_silence_ms: u32,
}

/// Which parameters do not go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// `delay_us` must be less than `period_us`.
    DelayNotBelowPeriod,
    /// `position_min_counts` must be below `position_max_counts`.
    PositionLimitsCrossed,
    /// `pressure_min_pa` must be below `pressure_max_pa`.
    PressureRangeEmpty,
    /// `spool_min_nm` must be below `spool_max_nm`.
    SpoolRangeEmpty,
    /// A divisor (`period_us`, `delay_us`, `profile_span_counts`, `scale`) is not positive.
    DivisorNotPositive,
}

impl ConfigError {
    /// The parameter to change, and what it must be.
    #[must_use]
    pub fn advice(self) -> &'static str {
        match self {
            ConfigError::DelayNotBelowPeriod => "delay_us must be less than period_us",
            ConfigError::PositionLimitsCrossed => "position_min_counts must be below position_max_counts",
            ConfigError::PressureRangeEmpty => "pressure_min_pa must be below pressure_max_pa",
            ConfigError::SpoolRangeEmpty => "spool_min_nm must be below spool_max_nm",
            ConfigError::DivisorNotPositive => {
                "period_us, delay_us, profile_span_counts and scale must be positive"
            }
        }
    }
}

/// The thesis's controller: what [`Config::new`] makes of the default parameters.
impl Default for Config {
    fn default() -> Self {
        const PERIOD_US: NonZeroU32 = NonZeroU32::new(1300).unwrap();
        const DELAY_US: NonZeroU32 = NonZeroU32::new(500).unwrap();
        const PROFILE_SPAN: NonZeroU32 = NonZeroU32::new(4).unwrap();
        const SCALE: NonZeroU32 = NonZeroU32::new(256).unwrap();
        Config {
            timing: Timing {
                period_us: PERIOD_US,
                delay_us: DELAY_US,
                late_sample_us: 100,
                host_silence_ms: 500,
            },
            estimator: EstimatorConfig { velocity_window: 5, acceleration_window: 3 },
            law: LawConfig {
                control_loop: Loop::Closed,
                kind: LawKind::GainProfile,
                gain_profile: Parameters::default().gain_profile,
                profile_span: PROFILE_SPAN,
                proportional_gain: 1,
                velocity_gain: 1,
                acceleration_gain: 1,
                velocity_dead_band: 0,
                dead_band: 0,
                dead_zone: 102,
                relay_hysteresis: 0,
                pressure_feedback_gain: 775,
                scale: SCALE,
                null_offset: 0,
            },
            limits: Limits { position_min: -249, position_max: 25_145, encoder_step: 540 },
            drive: DriveConfig::Dac(DacConfig { null_code: 2048, inverted: false }),
            encoder_inverted: false,
        }
    }
}

impl Config {
    /// Checks the parameters against each other and builds what the law runs on.
    ///
    /// # Errors
    /// The [`ConfigError`] that names the parameters which do not go together.
    pub fn new(parameters: &Parameters) -> Result<Config, ConfigError> {
        let get = |id| parameters.scalar(id);
        let unsigned = |id| parameters.scalar(id).unsigned_abs();
        let divisor = |id| NonZeroU32::new(unsigned(id)).ok_or(ConfigError::DivisorNotPositive);

        let period_us = divisor(id::PERIOD_US)?;
        let delay_us = divisor(id::DELAY_US)?;
        ensure(delay_us < period_us, ConfigError::DelayNotBelowPeriod)?;
        let limits = Limits {
            position_min: get(id::POSITION_MIN_COUNTS),
            position_max: get(id::POSITION_MAX_COUNTS),
            encoder_step: unsigned(id::ENCODER_STEP_COUNTS),
        };
        ensure(limits.position_min < limits.position_max, ConfigError::PositionLimitsCrossed)?;
        ensure(get(id::PRESSURE_MIN_PA) < get(id::PRESSURE_MAX_PA), ConfigError::PressureRangeEmpty)?;
        ensure(get(id::SPOOL_MIN_NM) < get(id::SPOOL_MAX_NM), ConfigError::SpoolRangeEmpty)?;

        Ok(Config {
            timing: Timing {
                period_us,
                delay_us,
                late_sample_us: unsigned(id::LATE_SAMPLE_US),
                host_silence_ms: unsigned(id::HOST_SILENCE_MS),
            },
            estimator: EstimatorConfig {
                velocity_window: unsigned(id::VELOCITY_WINDOW_SAMPLES) as u8,
                acceleration_window: unsigned(id::ACCELERATION_WINDOW_SAMPLES) as u8,
            },
            law: law(parameters, &divisor)?,
            limits,
            drive: drive(parameters),
            encoder_inverted: get(id::ENCODER_INVERTED) != 0,
        })
    }
}

fn law(
    parameters: &Parameters,
    divisor: &impl Fn(u16) -> Result<NonZeroU32, ConfigError>,
) -> Result<LawConfig, ConfigError> {
    let unsigned = |id| parameters.scalar(id).unsigned_abs();
    Ok(LawConfig {
        control_loop: if parameters.scalar(id::OPEN_LOOP) == 0 { Loop::Closed } else { Loop::Open },
        kind: match parameters.scalar(id::LAW) {
            1 => LawKind::Proportional,
            2 => LawKind::MooreProportional,
            3 => LawKind::OnOff,
            _ => LawKind::GainProfile,
        },
        gain_profile: parameters.gain_profile,
        profile_span: divisor(id::PROFILE_SPAN_COUNTS)?,
        proportional_gain: unsigned(id::PROPORTIONAL_GAIN) as u16,
        velocity_gain: unsigned(id::VELOCITY_GAIN) as u16,
        acceleration_gain: unsigned(id::ACCELERATION_GAIN) as u16,
        velocity_dead_band: unsigned(id::VELOCITY_DEAD_BAND),
        dead_band: unsigned(id::DEAD_BAND_COUNTS),
        dead_zone: unsigned(id::DEAD_ZONE_COUNTS) as u16,
        relay_hysteresis: unsigned(id::RELAY_HYSTERESIS_COUNTS),
        pressure_feedback_gain: unsigned(id::PRESSURE_FEEDBACK_GAIN) as u16,
        scale: divisor(id::SCALE)?,
        null_offset: parameters.scalar(id::NULL_OFFSET_COUNTS) as i16,
    })
}

fn drive(parameters: &Parameters) -> DriveConfig {
    if parameters.scalar(id::STEPPER) == 0 {
        DriveConfig::Dac(DacConfig {
            null_code: parameters.scalar(id::NULL_CODE).unsigned_abs() as u16,
            inverted: parameters.scalar(id::OUTPUT_INVERTED) != 0,
        })
    } else {
        DriveConfig::Stepper { max_steps: parameters.scalar(id::MAX_STEPS) as i16 }
    }
}

fn ensure(holds: bool, error: ConfigError) -> Result<(), ConfigError> {
    if holds { Ok(()) } else { Err(error) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(changes: &[(u16, i32)]) -> Result<Config, ConfigError> {
        let mut parameters = Parameters::default();
        for &(id, value) in changes {
            parameters.set(id, value).expect("within the table's range");
        }
        Config::new(&parameters)
    }

    #[test]
    fn the_defaults_are_the_thesis_controller() {
        assert_eq!(with(&[]), Ok(Config::default()));
    }

    #[test]
    fn each_parameter_reaches_its_place() {
        let config = with(&[
            (id::OPEN_LOOP, 1),
            (id::LAW, 1),
            (id::PROPORTIONAL_GAIN, 2),
            (id::VELOCITY_GAIN, 3),
            (id::ACCELERATION_GAIN, 4),
            (id::VELOCITY_DEAD_BAND, 5),
            (id::DEAD_BAND_COUNTS, 6),
            (id::NULL_OFFSET_COUNTS, -7),
            (id::PROFILE_SPAN_COUNTS, 8),
            (id::OUTPUT_INVERTED, 1),
            (id::ENCODER_INVERTED, 1),
            (id::LATE_SAMPLE_US, 9),
            (id::HOST_SILENCE_MS, 10),
            (id::ENCODER_STEP_COUNTS, 11),
        ])
        .expect("they go together");
        assert_eq!((config.law.control_loop, config.law.kind), (Loop::Open, LawKind::Proportional));
        assert_eq!(
            (config.law.proportional_gain, config.law.velocity_gain, config.law.acceleration_gain),
            (2, 3, 4)
        );
        assert_eq!((config.law.velocity_dead_band, config.law.dead_band), (5, 6));
        assert_eq!((config.law.null_offset, config.law.profile_span.get()), (-7, 8));
        assert!(config.encoder_inverted);
        assert_eq!(config.drive, DriveConfig::Dac(DacConfig { null_code: 2048, inverted: true }));
        assert_eq!((config.timing.late_sample_us, config.timing.host_silence_ms), (9, 10));
        assert_eq!(config.limits.encoder_step, 11);
    }

    #[test]
    fn a_stepper_is_a_drive_stage_of_its_own() {
        let config = with(&[(id::STEPPER, 1), (id::MAX_STEPS, 12)]).expect("they go together");
        assert_eq!(config.drive, DriveConfig::Stepper { max_steps: 12 });
    }

    #[test]
    fn parameters_that_do_not_go_together_are_named() {
        let cases: [(&[(u16, i32)], ConfigError); 4] = [
            (&[(id::PERIOD_US, 500)], ConfigError::DelayNotBelowPeriod),
            (
                &[(id::POSITION_MIN_COUNTS, 10), (id::POSITION_MAX_COUNTS, 10)],
                ConfigError::PositionLimitsCrossed,
            ),
            (&[(id::PRESSURE_MIN_PA, 1_000_000)], ConfigError::PressureRangeEmpty),
            (&[(id::SPOOL_MIN_NM, 1_250_000)], ConfigError::SpoolRangeEmpty),
        ];
        for (changes, error) in cases {
            assert_eq!(with(changes), Err(error));
            assert!(error.advice().contains("must be"));
        }
        assert!(with(&[(id::PERIOD_US, 501)]).is_ok(), "a delay just below the period");
    }
}
