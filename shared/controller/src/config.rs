//! The validated form of the parameters: what the law runs on, immutable while it does.

mod consistency;
mod error;
mod unwatched;

use core::num::NonZeroU32;

pub use error::ConfigError;
pub use unwatched::unwatched;

use crate::choice::HomingKind;
use crate::drive::{DacCode, DacConfig, DriveConfig, MAX_COUNTS, Translator};
use crate::estimator::EstimatorConfig;
use crate::homing::HomingConfig;
use crate::law::{self, LawConfig, Loop, Settings};
use crate::limits::{Limits, NULL_DRIFT, NULL_SAMPLES, StallDetector};
use crate::parameters::{Parameters, id};
use crate::sequencer::{FeedForward, MotionConfig};

/// Everything that stays as it is while the controller runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Config {
    /// When to sample and when to drive.
    pub timing: Timing,
    /// Windows of the differences.
    pub estimator: EstimatorConfig,
    /// Gains, profile and scale.
    pub law: LawConfig,
    /// When a move is complete.
    pub motion: MotionConfig,
    /// The run that gives counts their meaning.
    pub homing: HomingConfig,
    /// What trips the supervisor.
    pub limits: Limits,
    /// What drives the valve.
    pub drive: DriveConfig,
    /// Whether the board turns the sign of its encoder.
    pub encoder_inverted: bool,
    /// The bits of a converted pressure that a board passes on: all, or none without sensors.
    pub pressure_mask: i16,
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
    /// An output later than this after its sample is a fault, microseconds.
    pub latest_output_us: u32,
    /// Silence of the host that is a fault while a move runs, milliseconds; 0: none is.
    pub host_silence_ms: u32,
    /// How long an enabled drive stands without a host before it is disarmed, milliseconds.
    pub hold_ms: u32,
    /// How long digital inputs must be unchanged before they count, milliseconds.
    pub input_debounce_ms: u32,
    /// How long the start input and the number must be unchanged before a start takes effect, milliseconds.
    pub input_settling_ms: u32,
}

/// The thesis's controller: what [`Config::new`] makes of the default parameters.
impl Default for Config {
    fn default() -> Self {
        const PERIOD_US: NonZeroU32 = NonZeroU32::new(1300).unwrap();
        const DELAY_US: NonZeroU32 = NonZeroU32::new(500).unwrap();
        const SCALE: NonZeroU32 = NonZeroU32::new(256).unwrap();
        Config {
            timing: Timing {
                period_us: PERIOD_US,
                delay_us: DELAY_US,
                late_sample_us: 100,
                latest_output_us: 600,
                host_silence_ms: 500,
                hold_ms: 60_000,
                input_debounce_ms: 10,
                input_settling_ms: 20,
            },
            estimator: EstimatorConfig { velocity_window: 5, acceleration_window: 3 },
            law: LawConfig {
                control_loop: Loop::Closed,
                settings: Settings::of(&Parameters::default()),
                velocity_gain: 1,
                acceleration_gain: 1,
                velocity_dead_band: None,
                dead_band: 0,
                pressure_gain: 0,
                scale: SCALE,
                null_offset: 0,
                learning_gain: 0,
                largest: MAX_COUNTS,
            },
            motion: MotionConfig {
                on_arrival: false,
                tolerance: 8,
                monitoring: 0,
                dwell: 0,
                forced_exit: 1093,
                feed_forward: FeedForward { velocity: 0, acceleration: 0 },
            },
            homing: HomingConfig {
                kind: HomingKind::Stop,
                command: -200,
                position: 0,
                back_off: 400,
                still_samples: 384,
                still_counts: 40,
                timeout_samples: 7692,
            },
            limits: Limits {
                largest_command: MAX_COUNTS,
                position_min: -249,
                position_max: 25_145,
                encoder_step: 540,
                sensor_low: 63,
                sensor_high: 4032,
                sensor_samples: 4,
                stall_detector: StallDetector { idle: 102, full: 1024, most: 384 * (1024 - 102) - 1 },
                null_motion: 345,
                null_drift: 1380,
                no_motion_counts: 40,
                soft_min: 0,
                soft_max: 24_896,
            },
            drive: DriveConfig::Dac(DacConfig {
                null_code: DacCode::MIDDLE,
                inverted: false,
                max_counts: MAX_COUNTS,
            }),
            encoder_inverted: false,
            pressure_mask: ALL_BITS,
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
        consistency::check(parameters)?;
        let drive = drive(parameters);

        Ok(Config {
            timing: Timing {
                period_us,
                delay_us,
                late_sample_us: unsigned(id::LATE_SAMPLE_US),
                latest_output_us: delay_us.get().saturating_add(unsigned(id::LATE_OUTPUT_US)),
                host_silence_ms: unsigned(id::HOST_SILENCE_MS),
                hold_ms: unsigned(id::HOLD_MS),
                input_debounce_ms: unsigned(id::INPUT_DEBOUNCE_MS),
                input_settling_ms: unsigned(id::INPUT_SETTLING_MS),
            },
            estimator: EstimatorConfig {
                velocity_window: unsigned(id::VELOCITY_WINDOW_SAMPLES) as u8,
                acceleration_window: unsigned(id::ACCELERATION_WINDOW_SAMPLES) as u8,
            },
            law: law(parameters, divisor(id::SCALE)?, drive.largest()),
            motion: motion(parameters, period_us),
            homing: homing(parameters, period_us),
            limits: limits(parameters, period_us, drive.largest()),
            drive,
            encoder_inverted: get(id::ENCODER_INVERTED) != 0,
            pressure_mask: if has_pressure_sensors(parameters) { ALL_BITS } else { 0 },
        })
    }
}

/// A mask that leaves a number as it is.
const ALL_BITS: i16 = -1;

fn has_pressure_sensors(parameters: &Parameters) -> bool {
    parameters.scalar(id::PRESSURE_SENSORS) != 0
}

fn law(parameters: &Parameters, scale: NonZeroU32, largest: i16) -> LawConfig {
    let unsigned = |id| parameters.scalar(id).unsigned_abs();
    LawConfig {
        control_loop: Loop::of(parameters.scalar(id::OPEN_LOOP)),
        settings: Settings::of(parameters),
        velocity_gain: unsigned(id::VELOCITY_GAIN) as u16,
        acceleration_gain: unsigned(id::ACCELERATION_GAIN) as u16,
        velocity_dead_band: NonZeroU32::new(unsigned(id::VELOCITY_DEAD_BAND)),
        dead_band: unsigned(id::DEAD_BAND_COUNTS),
        pressure_gain: law::pressure_gain(parameters),
        scale,
        null_offset: parameters.scalar(id::NULL_OFFSET_COUNTS) as i16,
        learning_gain: unsigned(id::LEARNING_GAIN) as u16,
        largest,
    }
}

/// Whole samples in a time.
fn samples(time_us: u32, period_us: NonZeroU32) -> u32 {
    time_us / period_us
}

/// Whole samples in a time, from milliseconds: up to an hour, which fits 32 bits of microseconds.
fn samples_of_ms(time_ms: u32, period_us: NonZeroU32) -> u32 {
    samples(time_ms.saturating_mul(1000), period_us)
}

fn motion(parameters: &Parameters, period_us: NonZeroU32) -> MotionConfig {
    let unsigned = |id| parameters.scalar(id).unsigned_abs();
    MotionConfig {
        on_arrival: parameters.scalar(id::ON_ARRIVAL) != 0,
        tolerance: unsigned(id::TOLERANCE_COUNTS),
        monitoring: samples(unsigned(id::MONITORING_US), period_us),
        dwell: samples(unsigned(id::DWELL_US), period_us),
        // A move at sample s ends with the first sample at which the time is over, as a timed one would.
        forced_exit: unsigned(id::FORCED_EXIT_US).div_ceil(period_us.get()),
        feed_forward: feed_forward(parameters),
    }
}

fn feed_forward(parameters: &Parameters) -> FeedForward {
    let unsigned = |id| parameters.scalar(id).unsigned_abs();
    let velocity_window = unsigned(id::VELOCITY_WINDOW_SAMPLES);
    let both = velocity_window.saturating_mul(unsigned(id::ACCELERATION_WINDOW_SAMPLES));
    FeedForward {
        velocity: unsigned(id::VELOCITY_FEED_FORWARD).saturating_mul(velocity_window),
        acceleration: unsigned(id::ACCELERATION_FEED_FORWARD).saturating_mul(both),
    }
}

fn homing(parameters: &Parameters, period_us: NonZeroU32) -> HomingConfig {
    let unsigned = |id| parameters.scalar(id).unsigned_abs();
    HomingConfig {
        kind: HomingKind::of(parameters.scalar(id::HOMING_SWITCH)),
        command: parameters.scalar(id::HOMING_COMMAND_COUNTS) as i16,
        position: parameters.scalar(id::HOMING_POSITION_COUNTS),
        // A shorter back-off could not be told from standing still.
        back_off: unsigned(id::HOMING_BACK_OFF_COUNTS).max(unsigned(id::NO_MOTION_COUNTS).saturating_add(1)),
        still_counts: unsigned(id::NO_MOTION_COUNTS),
        still_samples: samples_of_ms(unsigned(id::HOMING_STILL_MS), period_us),
        timeout_samples: samples_of_ms(unsigned(id::HOMING_TIMEOUT_MS), period_us),
    }
}

/// The parameter's value for "no raw pressure is that of a shorted sensor".
const NONE_IS_HIGH: i32 = 32_767;

/// Raw pressures at or below the first, or at or above the second, are those of a sensor that is open or shorted.
/// Without sensors every reading is allowed.
fn sensor_ends(parameters: &Parameters) -> [i32; 2] {
    match parameters.scalar(id::SENSOR_HIGH_RAW) {
        _ if !has_pressure_sensors(parameters) => [i16::MIN.into(), NONE_IS_HIGH + 1],
        NONE_IS_HIGH => [parameters.scalar(id::SENSOR_LOW_RAW), NONE_IS_HIGH + 1],
        high => [parameters.scalar(id::SENSOR_LOW_RAW), high],
    }
}

fn limits(parameters: &Parameters, period_us: NonZeroU32, largest: i16) -> Limits {
    let get = |id| parameters.scalar(id);
    let no_motion_ms = get(id::NO_MOTION_MS).unsigned_abs();
    // A time below a period is one sample, not "off".
    let no_motion_samples = samples_of_ms(no_motion_ms, period_us).max(u32::from(no_motion_ms > 0));
    let [sensor_low, sensor_high] = sensor_ends(parameters);
    let null_motion = get(id::ENCODER_STEP_COUNTS).unsigned_abs().saturating_mul(NULL_SAMPLES) / 100;
    Limits {
        largest_command: largest,
        position_min: get(id::POSITION_MIN_COUNTS),
        position_max: get(id::POSITION_MAX_COUNTS),
        encoder_step: get(id::ENCODER_STEP_COUNTS).unsigned_abs(),
        sensor_low: sensor_low as i16,
        sensor_high,
        sensor_samples: get(id::SENSOR_SAMPLES).unsigned_abs(),
        null_motion,
        null_drift: null_motion.saturating_mul(NULL_DRIFT),
        stall_detector: StallDetector::of(
            no_motion_samples,
            largest,
            get(id::DEAD_ZONE_COUNTS).unsigned_abs(),
        ),
        no_motion_counts: get(id::NO_MOTION_COUNTS).unsigned_abs(),
        soft_min: get(id::END_MIN_COUNTS),
        soft_max: get(id::END_MAX_COUNTS),
    }
}

fn drive(parameters: &Parameters) -> DriveConfig {
    if parameters.scalar(id::STEPPER) == 0 {
        DriveConfig::Dac(DacConfig {
            null_code: DacCode::new(parameters.scalar(id::NULL_CODE).unsigned_abs() as u16),
            inverted: parameters.scalar(id::OUTPUT_INVERTED) != 0,
            max_counts: parameters.scalar(id::MAX_COMMAND_COUNTS) as i16,
        })
    } else {
        DriveConfig::Stepper {
            max_steps: parameters.scalar(id::MAX_STEPS) as i16,
            translator: Translator {
                pulse_width_us: parameters.scalar(id::PULSE_WIDTH_US).unsigned_abs(),
                direction_setup_us: parameters.scalar(id::DIRECTION_SETUP_US).unsigned_abs(),
            },
        }
    }
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
            (id::OUTPUT_INVERTED, 1),
            (id::ENCODER_INVERTED, 1),
            (id::LATE_SAMPLE_US, 9),
            (id::HOST_SILENCE_MS, 10),
            (id::ENCODER_STEP_COUNTS, 11),
            (id::HOLD_MS, 12),
            (id::LATE_OUTPUT_US, 13),
            (id::MAX_COMMAND_COUNTS, 14),
        ])
        .expect("they go together");
        let proportional = law::proportional::Settings { gain: 2 };
        assert_eq!(
            (config.law.control_loop, config.law.settings),
            (Loop::Open, Settings::Proportional(proportional))
        );
        assert_eq!((config.law.velocity_gain, config.law.acceleration_gain), (3, 4));
        assert_eq!((config.law.velocity_dead_band, config.law.dead_band), (NonZeroU32::new(5), 6));
        assert_eq!(config.law.null_offset, -7);
        assert!(config.encoder_inverted);
        let dac = DacConfig { null_code: DacCode::MIDDLE, inverted: true, max_counts: 14 };
        assert_eq!(config.drive, DriveConfig::Dac(dac));
        assert_eq!((config.limits.largest_command, config.law.largest), (14, 14));
        assert_eq!((config.timing.late_sample_us, config.timing.host_silence_ms), (9, 10));
        assert_eq!((config.limits.encoder_step, config.timing.hold_ms), (11, 12));
        assert_eq!(config.timing.latest_output_us, 513);
    }

    #[test]
    fn a_law_has_constants_of_its_own() {
        let settings = |changes: &[(u16, i32)]| with(changes).map(|config| config.law.settings);
        let Ok(Settings::GainProfile(profile)) = settings(&[(id::PROFILE_SPAN_COUNTS, 8)]) else {
            panic!("the default law")
        };
        assert_eq!((profile.gains[0], profile.span.get()), (8192, 8));
        let moore = [(id::LAW, 2), (id::PROPORTIONAL_GAIN, 3), (id::DEAD_ZONE_COUNTS, 4)];
        let expected = law::moore_proportional::Settings { gain: 3, dead_zone: 4 };
        assert_eq!(settings(&moore), Ok(Settings::MooreProportional(expected)));
        let relay = [(id::LAW, 3), (id::PROPORTIONAL_GAIN, 5), (id::RELAY_HYSTERESIS_COUNTS, 6)];
        assert_eq!(settings(&relay), Ok(Settings::OnOff(law::on_off::Settings { gain: 5, hysteresis: 6 })));
    }

    #[test]
    fn a_stepper_is_a_drive_stage_of_its_own() {
        let config = with(&[(id::STEPPER, 1), (id::MAX_STEPS, 12)]).expect("they go together");
        assert!(matches!(config.drive, DriveConfig::Stepper { max_steps: 12, .. }));
        assert_eq!((config.limits.largest_command, config.drive.largest()), (12, 12));
    }

    #[test]
    fn a_time_without_motion_below_a_period_is_one_sample_and_none_is_off() {
        let most = |ms| with(&[(id::NO_MOTION_MS, ms)]).map(|config| config.limits.stall_detector.most);
        assert_eq!([0, 1, 13].map(most), [u32::MAX, 921, 9219].map(Ok), "periods of 1.3 ms");
    }
}
