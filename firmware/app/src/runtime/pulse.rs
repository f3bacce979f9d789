//! The step pulse of a translator as values of a one-pulse timer.
//!
//! The timer counts microseconds from 0, drives its output from the compare value on, and stops after the reload
//! value. So the hardware keeps direction set-up time and pulse, whatever the processor does meanwhile.

use pneudrive_controller::drive::Translator;

/// Longest of the two times, microseconds: both together fit a 16-bit timer.
const LONGEST_US: u32 = 0x7fff;

/// The settings of the timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// The output is driven from this count on. Never 0: it would be driven at rest.
    pub compare: u16,
    /// The last count.
    pub reload: u16,
}

impl Pulse {
    /// The pulse that a translator needs. Each time is at least one microsecond.
    #[must_use]
    pub fn of(translator: &Translator) -> Pulse {
        let compare = translator.direction_setup_us.clamp(1, LONGEST_US);
        let width = translator.pulse_width_us.clamp(1, LONGEST_US);
        Pulse { compare: compare as u16, reload: (compare + width - 1) as u16 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pulse(direction_setup_us: u32, pulse_width_us: u32) -> (u16, u16) {
        let Pulse { compare, reload } = Pulse::of(&Translator { direction_setup_us, pulse_width_us });
        (compare, reload)
    }

    #[test]
    fn the_direction_stands_for_its_set_up_time_and_the_pulse_for_its_width() {
        for (setup, width) in [(1, 1), (10, 10), (20, 5), (1000, 1000)] {
            let (compare, reload) = pulse(setup, width);
            assert_eq!(u32::from(compare), setup);
            assert_eq!(u32::from(reload) + 1 - u32::from(compare), width, "counts with the output driven");
        }
    }

    #[test]
    fn no_time_is_too_short_or_too_long_for_the_timer() {
        assert_eq!(pulse(0, 0), (1, 1));
        assert_eq!(pulse(u32::MAX, u32::MAX), (0x7fff, 0xfffd));
    }
}
