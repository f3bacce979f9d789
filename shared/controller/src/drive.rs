//! The drive stage of a solenoid valve: a 12-bit DAC (thesis 6.3.2.2).
//!
//! The law's demand is limited to +-2048 counts. What the board writes to its converter is
//! `clamp(null_code + polarity * counts, 0, 4095)`; only the board forms it.

/// The largest command, counts: half the range of a 12-bit converter.
pub const MAX_COUNTS: i16 = 2048;

/// The largest code of the converter.
pub const MAX_CODE: u16 = 4095;

/// How commands become codes of the converter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DacConfig {
    /// The code at which the valve is at its null.
    pub null_code: u16,
    /// Whether a larger code retracts.
    pub inverted: bool,
}

/// The demand within the limits of the DAC: -[`MAX_COUNTS`] to [`MAX_COUNTS`].
pub(crate) fn limit(demand: i32) -> i16 {
    demand.clamp(-i32::from(MAX_COUNTS), i32::from(MAX_COUNTS)) as i16
}

impl DacConfig {
    /// The code for a command. Always within the converter's range, for any command.
    #[must_use]
    pub fn code(&self, counts: i16) -> u16 {
        let counts = i32::from(counts);
        let signed = if self.inverted { -counts } else { counts };
        (i32::from(self.null_code) + signed).clamp(0, i32::from(MAX_CODE)) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_demand_is_limited_to_the_range_of_the_converter() {
        for (demand, counts) in
            [(0, 0), (2047, 2047), (2048, 2048), (2049, 2048), (-2049, -2048), (i32::MIN, -2048)]
        {
            assert_eq!(limit(demand), counts);
        }
    }

    #[test]
    fn null_is_the_null_code_and_polarity_turns_the_sign() {
        let normal = DacConfig { null_code: 2048, inverted: false };
        let inverted = DacConfig { null_code: 2048, inverted: true };
        assert_eq!((normal.code(0), inverted.code(0)), (2048, 2048));
        assert_eq!((normal.code(100), inverted.code(100)), (2148, 1948));
        assert_eq!((normal.code(2048), normal.code(-2048)), (4095, 0));
        assert_eq!((inverted.code(i16::MIN), inverted.code(i16::MAX)), (4095, 0));
    }
}
