//! Skips rounds of a task that only polls.
//!
//! The idle task polls its port once per round. A round without a write to a peripheral, an interrupt or a byte in either
//! direction repeats identically until something happens.

/// Rounds that are gone through before the rest is left out: the first may be the end of some work, and each goes on a
/// little with what the task does beside.
const ROUNDS: u32 = 3;

/// What the task has done lately.
#[derive(Clone, Copy, Debug, Default)]
pub struct Idle {
    quiet: u32,
}

impl Idle {
    /// The next round may find something to do.
    pub fn something_happens(&mut self) {
        self.quiet = 0;
    }

    /// A round begins; whether the time may go on to the next event.
    pub fn begin_round(&mut self) -> bool {
        self.quiet += 1;
        let polls = self.quiet > ROUNDS;
        if polls {
            self.quiet = 0;
        }
        polls
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_rounds_in_which_nothing_happens_are_left_out() {
        let mut idle = Idle::default();
        let mut begin = || (0..ROUNDS).map(|_| idle.begin_round()).collect::<Vec<_>>();
        assert_eq!(begin(), [false; ROUNDS as usize]);
        idle.something_happens();
        assert!(!idle.begin_round());
    }
}
