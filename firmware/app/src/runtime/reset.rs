//! Why the board was reset, and whether that is a fault.

use pneudrive_controller::Fault;

/// The note that the program leaves in memory when it breaks down. Memory does not hold it by chance after power-on.
pub const PANICKED: u32 = 0x50d7_1e01;

/// The note after a failure of the clock.
pub const CLOCK_FAILED: u32 = 0x50d7_1e02;

/// The meaning of a note; None for anything else.
#[must_use]
pub fn noted(note: u32) -> Option<Fault> {
    match note {
        PANICKED => Some(Fault::Panic),
        CLOCK_FAILED => Some(Fault::ClockFailed),
        _ => None,
    }
}

/// The known facts after a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reset {
    /// The independent watchdog did it.
    pub watchdog: bool,
    /// The program did it.
    pub software: bool,
    /// The power came: memory holds anything.
    pub power: bool,
    /// The place of the program's note.
    pub note: u32,
}

impl Reset {
    /// The fault that it was. A breakdown that hung while it was noted, and was ended by the watchdog, is
    /// a breakdown.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        let broke_down = if self.software || self.watchdog { noted(self.note) } else { None };
        match broke_down {
            _ if self.power => None,
            None => self.watchdog.then_some(Fault::Watchdog),
            noted => noted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUIET: Reset = Reset { watchdog: false, software: false, power: false, note: 0 };

    #[test]
    fn the_button_and_the_programmer_are_no_faults() {
        assert_eq!(QUIET.fault(), None);
        assert_eq!(Reset { software: true, ..QUIET }.fault(), None);
        assert_eq!(Reset { note: PANICKED, ..QUIET }.fault(), None);
    }

    #[test]
    fn the_watchdog_and_a_breakdown_are() {
        assert_eq!(Reset { watchdog: true, ..QUIET }.fault(), Some(Fault::Watchdog));
        let noted = Reset { note: PANICKED, ..QUIET };
        assert_eq!(Reset { software: true, ..noted }.fault(), Some(Fault::Panic));
        assert_eq!(Reset { watchdog: true, ..noted }.fault(), Some(Fault::Panic));
        let clock = Reset { note: CLOCK_FAILED, ..QUIET };
        assert_eq!(clock.fault(), None);
        assert_eq!(Reset { software: true, ..clock }.fault(), Some(Fault::ClockFailed));
    }

    #[test]
    fn after_a_power_cut_memory_says_nothing() {
        let reset = Reset { watchdog: true, software: true, power: true, note: PANICKED };
        assert_eq!(reset.fault(), None);
    }
}
