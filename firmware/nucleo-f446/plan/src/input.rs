//! Counts and conversions as a sample.

use pneudrive_controller::Sample;

/// Channels that are converted at a sample: pressure 1, pressure 2, spool.
pub const CHANNELS: usize = 3;

/// What stands for a conversion that did not come: below every range, so it trips as an open sensor does.
pub const NO_CONVERSION: i16 = -1;

/// The sample of an encoder counter, the conversions (if they came) and the home switch.
#[must_use]
pub fn sample(counter: u32, inverted: bool, converted: Option<[u16; CHANNELS]>, home_switch: bool) -> Sample {
    let [pressure_1, pressure_2, spool] = match converted {
        Some(raw) => raw.map(|raw| raw.cast_signed()),
        None => [NO_CONVERSION; CHANNELS],
    };
    Sample { position: position(counter, inverted), pressure_1, pressure_2, spool, home_switch }
}

/// The count of a 32-bit encoder timer, positive toward extension. It starts at 0 and wraps as the
/// controller's differences do.
fn position(counter: u32, inverted: bool) -> i32 {
    let count = counter.cast_signed();
    if inverted { count.wrapping_neg() } else { count }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_controller::Config;

    #[test]
    fn the_counter_is_signed_and_an_inverted_encoder_is_turned() {
        let at = |counter, inverted| sample(counter, inverted, None, false).position;
        assert_eq!((at(5, false), at(5, true)), (5, -5));
        assert_eq!((at(u32::MAX, false), at(u32::MAX, true)), (-1, 1));
        assert_eq!(at(1 << 31, true), i32::MIN);
    }

    #[test]
    fn conversions_are_twelve_bits_in_the_order_of_the_wiring() {
        let seen = sample(0, false, Some([0, 4095, 2048]), true);
        assert_eq!((seen.pressure_1, seen.pressure_2, seen.spool), (0, 4095, 2048));
        assert!(seen.home_switch);
    }

    #[test]
    fn conversions_that_do_not_come_are_no_pressure() {
        let seen = sample(0, false, None, false);
        assert!(seen.pressure_1 < Config::default().limits.sensor_low);
        assert!(seen.pressure_2 < Config::default().limits.sensor_low);
    }
}
