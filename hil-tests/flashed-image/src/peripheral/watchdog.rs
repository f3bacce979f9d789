//! Independent watchdog. RM0390 section 21.
//!
//! ```text
//! timeout = (RLR + 1) * 4 * 2^PR / f(LSI)
//! ```
//!
//! PR and RLR are taken over within five cycles of its clock (PVU, RVU of SR).

use crate::register::Write;
use crate::time::{SECOND, Ticks};

const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const SR: u32 = 0x0c;

const START: u32 = 0xcccc;
const FEED: u32 = 0xaaaa;
const UNLOCK: u32 = 0x5555;

/// The peripheral.
pub struct Watchdog {
    clock_hz: Ticks,
    prescaler: u32,
    reload: u32,
    unlocked: bool,
    /// When it bites, once it runs.
    bites: Option<Ticks>,
    taken_over: Ticks,
    /// A debugger holds it, with this much of its time left.
    held: Option<Ticks>,
}

impl Watchdog {
    /// After a reset; its clock, Hz.
    #[must_use]
    pub fn new(clock_hz: u64) -> Watchdog {
        Watchdog {
            clock_hz,
            prescaler: 0,
            reload: 0xfff,
            unlocked: false,
            bites: None,
            taken_over: 0,
            held: None,
        }
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32, now: Ticks) -> u32 {
        match offset {
            PR => self.prescaler,
            RLR => self.reload,
            SR if now < self.taken_over => 3,
            _ => 0,
        }
    }

    /// Writes a register.
    pub fn write(&mut self, write: Write, now: Ticks) {
        match (write.offset, write.value) {
            (KR, START) => self.feed(now),
            (KR, FEED) if self.bites.is_some() => self.feed(now),
            (KR, key) => self.unlocked = key == UNLOCK,
            (PR, value) if self.unlocked => self.set(value & 7, self.reload, now),
            (RLR, value) if self.unlocked => self.set(self.prescaler, value & 0xfff, now),
            _ => {}
        }
    }

    /// When it bites; None while it does not run.
    #[must_use]
    pub fn bites_at(&self) -> Option<Ticks> {
        if self.held.is_some() { None } else { self.bites }
    }

    /// A debugger holds it, or lets it go on.
    pub fn hold(&mut self, held: bool, now: Ticks) {
        match (held, self.held) {
            (true, None) => self.held = self.bites.map(|bites| bites.saturating_sub(now)),
            (false, Some(left)) => (self.bites, self.held) = (Some(now + left), None),
            _ => {}
        }
    }

    fn set(&mut self, prescaler: u32, reload: u32, now: Ticks) {
        (self.prescaler, self.reload) = (prescaler, reload);
        self.taken_over = now + 5 * SECOND / self.clock_hz;
    }

    fn feed(&mut self, now: Ticks) {
        self.unlocked = false;
        let cycles = Ticks::from(self.reload + 1) * (4 << self.prescaler);
        self.bites = Some(now + cycles * SECOND / self.clock_hz);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MILLISECOND;

    #[test]
    fn it_bites_unless_it_is_fed_and_not_before_it_was_started() {
        let mut watchdog = Watchdog::new(32_000);
        for (offset, value) in [(KR, UNLOCK), (PR, 2), (RLR, 499)] {
            watchdog.write(Write::of(offset, 4, value.into()), 0);
        }
        assert_eq!((watchdog.bites_at(), watchdog.read(SR, 0)), (None, 3));
        watchdog.write(Write::of(KR, 4, START.into()), 0);
        assert_eq!(watchdog.bites_at(), Some(250 * MILLISECOND));
        watchdog.write(Write::of(KR, 4, FEED.into()), 100 * MILLISECOND);
        assert_eq!(watchdog.bites_at(), Some(350 * MILLISECOND));
    }

    #[test]
    fn its_times_cannot_be_changed_without_the_key() {
        let mut watchdog = Watchdog::new(32_000);
        watchdog.write(Write::of(RLR, 4, 1), 0);
        assert_eq!(watchdog.read(RLR, 0), 0xfff);
    }

    #[test]
    fn a_debugger_that_holds_it_takes_none_of_its_time() {
        let mut watchdog = Watchdog::new(32_000);
        watchdog.write(Write::of(KR, 4, START.into()), 0);
        let whole = watchdog.bites_at().expect("it runs");
        watchdog.hold(true, 100);
        assert_eq!(watchdog.bites_at(), None);
        watchdog.hold(false, 1100);
        assert_eq!(watchdog.bites_at(), Some(whole + 1000));
    }
}
