//! The drive stages: from a command to the valve at the output instant.
//!
//! - **DAC** (solenoid valve, thesis 6.3.2.2): the command is in counts of a 12-bit converter. The board writes
//!   `clamp(null_code + polarity * counts, 0, 4095)`; only the board forms that code. At a null code of 2048 the
//!   command +2048 has no code of its own and would get that of +2047, so a board arms with `max_command_counts` of at
//!   most 2047 there ([`DacConfig::has_codes`]).
//! - **Stepper** (thesis 6.3.2.1): the command is a spool location in steps. One pulse a sample goes toward it.
//!   SPLLOC counts the pulses, since nothing measures the location.

/// The largest command of a DAC, counts: half the range of a 12-bit converter.
pub const MAX_COUNTS: i16 = 2048;

/// The largest code of the converter.
pub const MAX_CODE: u16 = 4095;

/// What drives the valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveConfig {
    /// A converter, for a solenoid.
    Dac(DacConfig),
    /// A translator of step pulses.
    Stepper {
        /// Largest distance from mid-travel, steps; at most [`MAX_COUNTS`].
        max_steps: i16,
        /// The timing of the translator's two lines.
        translator: Translator,
    },
}

/// The timing of a step/direction translator. The board keeps it, usually with hardware timers: the direction stands
/// for `direction_setup_us` before the pulse, which lasts `pulse_width_us`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Translator {
    /// Length of a pulse, us.
    pub pulse_width_us: u32,
    /// The direction stands this long before the pulse, us.
    pub direction_setup_us: u32,
}

/// A code of the converter, 0 to [`MAX_CODE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DacCode(u16);

impl DacCode {
    /// The middle of the range.
    pub const MIDDLE: DacCode = DacCode(MAX_COUNTS as u16);

    /// A code; one beyond the range is the largest.
    #[must_use]
    pub const fn new(code: u16) -> DacCode {
        DacCode(if code > MAX_CODE { MAX_CODE } else { code })
    }

    /// As the converter takes it.
    #[inline]
    #[must_use]
    pub const fn get(self) -> u16 {
        self.0
    }
}

/// How commands become codes of the converter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DacConfig {
    /// The code at which the valve is at its null.
    pub null_code: DacCode,
    /// Whether a larger code retracts.
    pub inverted: bool,
    /// The largest command to either side, counts; at most [`MAX_COUNTS`].
    pub max_counts: i16,
}

impl DriveConfig {
    /// Whether a stepper drives the valve.
    #[must_use]
    pub fn is_stepper(&self) -> bool {
        matches!(self, DriveConfig::Stepper { .. })
    }

    /// The largest command to either side: counts of a DAC, steps of a stepper.
    #[must_use]
    pub fn largest(&self) -> i16 {
        match self {
            DriveConfig::Dac(dac) => dac.max_counts,
            DriveConfig::Stepper { max_steps, .. } => *max_steps,
        }
    }

    /// Whether a converter of 12 bits has a code for every command. A stepper needs none.
    #[must_use]
    pub fn has_codes(&self) -> bool {
        match self {
            DriveConfig::Dac(dac) => dac.has_codes(),
            DriveConfig::Stepper { .. } => true,
        }
    }
}

impl DacConfig {
    /// Whether each command up to the largest has a code of its own.
    #[must_use]
    pub fn has_codes(&self) -> bool {
        let (null, largest) = (self.null_code.0, self.max_counts.unsigned_abs());
        largest <= null && largest <= MAX_CODE - null
    }

    /// The code for a command, within the converter's range for any command.
    #[must_use]
    pub fn code(&self, counts: i16) -> DacCode {
        let counts = i32::from(counts);
        let signed = if self.inverted { -counts } else { counts };
        DacCode((i32::from(self.null_code.0) + signed).clamp(0, i32::from(MAX_CODE)) as u16)
    }
}

/// The spool location of a stepper valve: SPLLOC, steps from mid-travel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpoolLocation(i16);

impl SpoolLocation {
    /// A location this many steps from mid-travel.
    #[must_use]
    pub fn at(steps: i16) -> SpoolLocation {
        SpoolLocation(steps)
    }

    /// Steps from mid-travel.
    #[must_use]
    pub fn steps(self) -> i16 {
        self.0
    }

    /// The pulse toward `target`: -1, 0 or 1. Updates the location.
    pub(crate) fn step_toward(&mut self, target: i16) -> i8 {
        let step = (i32::from(target) - i32::from(self.0)).signum();
        self.0 = self.0.saturating_add(step as i16);
        step as i8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAC: DacConfig = DacConfig { null_code: DacCode::MIDDLE, inverted: false, max_counts: MAX_COUNTS };

    #[test]
    fn null_is_the_null_code_and_polarity_turns_the_sign() {
        let inverted = DacConfig { inverted: true, ..DAC };
        assert_eq!((DAC.code(0).get(), inverted.code(0).get()), (2048, 2048));
        assert_eq!((DAC.code(100).get(), inverted.code(100).get()), (2148, 1948));
        assert_eq!(
            [2046, 2047, 2048].map(|counts| DAC.code(counts).get()),
            [4094, 4095, 4095],
            "one code for two"
        );
        assert_eq!([-2046, -2047, -2048].map(|counts| DAC.code(counts).get()), [2, 1, 0]);
        assert_eq!((inverted.code(i16::MIN).get(), inverted.code(i16::MAX).get()), (4095, 0));
    }

    /// The command is read back from the code, for every command that the drive stage lets pass.
    #[test]
    fn each_command_up_to_the_largest_has_a_code_of_its_own_exactly_where_the_stage_says_so() {
        for (null_code, most) in
            [(0, 0), (1, 1), (2000, 2000), (2048, 2047), (2100, 1995), (4094, 1), (4095, 0)]
        {
            for (max_counts, inverted) in (1..=MAX_COUNTS).flat_map(|most| [(most, false), (most, true)]) {
                let dac = DacConfig { null_code: DacCode::new(null_code), inverted, max_counts };
                let sign = if inverted { -1 } else { 1 };
                let at_pin = |counts: i16| sign * (dac.code(counts).get() as i16 - null_code as i16);
                let ends = [-max_counts, max_counts];
                assert_eq!(dac.has_codes(), max_counts <= most, "{dac:?}");
                assert_eq!(dac.has_codes(), ends.map(at_pin) == ends, "{dac:?}");
                assert_eq!(DriveConfig::Dac(dac).largest(), max_counts);
            }
        }
        let dac = DacConfig { max_counts: 2047, ..DAC };
        assert!((-2047..=2047).all(|counts| dac.code(counts).get() == (2048 + counts) as u16));
    }

    #[test]
    fn a_stepper_goes_one_pulse_a_sample_and_stays_at_its_target() {
        let mut location = SpoolLocation::default();
        let pulses: [i8; 5] = core::array::from_fn(|_| location.step_toward(3));
        assert_eq!((pulses, location.steps()), ([1, 1, 1, 0, 0], 3));
        assert_eq!((location.step_toward(-1), location.steps()), (-1, 2));
    }

    #[test]
    fn the_ends_of_the_number_range_do_not_overflow() {
        let mut location = SpoolLocation(i16::MAX);
        assert_eq!((location.step_toward(i16::MAX), location.steps()), (0, i16::MAX));
        assert_eq!((location.step_toward(i16::MIN), location.steps()), (-1, i16::MAX - 1));
    }
}
