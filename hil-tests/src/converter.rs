//! The 12-bit converters at the pins of simulated boards: codes, voltages and the amplifier's command.
//!
//! ```text
//! DAC        U = U(ref) code / 4096
//! ADC        code = floor(U / U(ref) * 4096), within 0 to 4095
//! amplifier  counts = U / U(ref) * 4096 - 2048
//! ```

use pneudrive_controller::drive::MAX_COUNTS;

/// The reference of all converters, V.
const REFERENCE_V: f64 = 3.3;

/// Codes of a converter of 12 bits.
const CODES: f64 = 4096.0;

/// The voltage that a DAC makes of a code, V.
#[must_use]
pub fn output_v(code: u16) -> f64 {
    REFERENCE_V * f64::from(code) / CODES
}

/// The code that an ADC makes of a voltage, V.
#[must_use]
pub fn code_of(volts: f64) -> u16 {
    (volts / REFERENCE_V * CODES).floor().clamp(0.0, CODES - 1.0) as u16
}

/// The middle of the voltages for which an ADC gives a code, V.
#[must_use]
pub fn code_centre_v(code: i16) -> f64 {
    (f64::from(code) + 0.5) / CODES * REFERENCE_V
}

/// The command that an amplifier reads from a voltage, V: counts from null.
#[must_use]
pub fn command_of(volts: f64) -> i16 {
    (volts / REFERENCE_V * CODES).round() as i16 - MAX_COUNTS
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_controller::drive::{DacCode, DacConfig};

    #[test]
    fn every_code_comes_back_from_the_middle_of_its_voltages() {
        assert!((0..4096).all(|code| code_of(code_centre_v(code)) == code as u16));
        assert_eq!((code_of(-0.1), code_of(3.4)), (0, 4095));
    }

    #[test]
    fn the_amplifier_makes_of_every_code_the_counts_that_the_board_meant() {
        let dac = DacConfig { null_code: DacCode::MIDDLE, inverted: false, max_counts: 2047 };
        for counts in -2047..=2047 {
            assert_eq!(command_of(output_v(dac.code(counts).get())), counts);
        }
    }
}
