//! Parameters that do not go together.

/// Which parameters do not go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// `delay_us` must be less than `period_us`.
    DelayNotBelowPeriod,
    /// `late_sample_us` must be less than `period_us`.
    LateSampleNotBelowPeriod,
    /// `delay_us` and `late_output_us` together must be less than `period_us`.
    LateOutputBehindPeriod,
    /// `sensor_samples` periods must be at most a second.
    SensorWatchTooSlow,
    /// `sensor_high_raw` must be within the converter of `sensor_bits`, or 32767.
    SensorHighBeyondConverter,
    /// `encoder_step_counts` must be less than the position limits are apart.
    EncoderStepSpansLimits,
    /// `position_min_counts` must be below `position_max_counts`.
    PositionLimitsCrossed,
    /// `pressure_min_pa` must be below `pressure_max_pa`.
    PressureRangeEmpty,
    /// `spool_min_nm` must be below `spool_max_nm`.
    SpoolRangeEmpty,
    /// `end_min_counts` must be below `end_max_counts`.
    SoftLimitsCrossed,
    /// `homing_command_counts` must not be 0.
    HomingStandsStill,
    /// `direction_setup_us` and `pulse_width_us` together must be less than `period_us`.
    PulseTooLong,
    /// Without pressure sensors the gain of the law on pressures must be 0.
    NothingToFeedBack,
    /// The law cascade needs a model of its drive (`cascade_stroke` above 0), pressure sensors and a valve with a
    /// converter, and learns no null offset.
    NoModel,
    /// A divisor (`period_us`, `delay_us`, `scale`) is not positive.
    DivisorNotPositive,
}

impl ConfigError {
    /// The parameter to change, and what it must be.
    #[must_use]
    pub fn advice(self) -> &'static str {
        match self {
            ConfigError::DelayNotBelowPeriod => "delay_us must be less than period_us",
            ConfigError::LateSampleNotBelowPeriod => "late_sample_us must be less than period_us",
            ConfigError::LateOutputBehindPeriod => {
                "delay_us and late_output_us together must be less than period_us"
            }
            ConfigError::SensorWatchTooSlow => "sensor_samples must be a second of periods at most",
            ConfigError::SensorHighBeyondConverter => {
                "sensor_high_raw must be within the converter's sensor_bits, or 32767 (off)"
            }
            ConfigError::EncoderStepSpansLimits => {
                "encoder_step_counts must be less than the position limits are apart"
            }
            ConfigError::PositionLimitsCrossed => "position_min_counts must be below position_max_counts",
            ConfigError::PressureRangeEmpty => "pressure_min_pa must be below pressure_max_pa",
            ConfigError::SpoolRangeEmpty => "spool_min_nm must be below spool_max_nm",
            ConfigError::SoftLimitsCrossed => "end_min_counts must be below end_max_counts",
            ConfigError::HomingStandsStill => "homing_command_counts must be other than 0",
            ConfigError::PulseTooLong => {
                "direction_setup_us and pulse_width_us together must be less than period_us"
            }
            ConfigError::NothingToFeedBack => {
                "pressure_feedback_gain (on-off law) or pressure_damping_gain (other laws) must be 0 where pressure_sensors is 0"
            }
            ConfigError::NoModel => {
                "law must be another than cascade without the parameters cascade_... of a rig file, with pressure_sensors = 0, or with a learning_gain"
            }
            ConfigError::DivisorNotPositive => "period_us, delay_us and scale must be positive",
        }
    }
}
