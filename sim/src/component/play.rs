//! Hysteresis as a play operator: the output follows its input with a slack of one half width on
//! either side (thesis 6.4.5, C(29); EQUATIONS section 7 and section 11 rule 3).
//!
//! ```text
//! driven up    s = u - w   while u rises
//! driven down  s = u + w   while u falls
//! held         s stays     while |u - s| < w
//! ```
//!
//! Every operator with hysteresis shares this file. The operator knows the input u, and so the instant at which a
//! branch ends.

/// Which way an input moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Up.
    Rising,
    /// Down.
    Falling,
    /// Not at all.
    Still,
}

impl Motion {
    /// By the sign of a rate.
    #[must_use]
    pub fn of_rate(rate: f64) -> Motion {
        match rate {
            rate if rate > 0.0 => Motion::Rising,
            rate if rate < 0.0 => Motion::Falling,
            _ => Motion::Still,
        }
    }
}

/// The state of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Branch {
    /// Stays at this value.
    Held(f64),
    /// Follows a rising input.
    DrivenUp,
    /// Follows a falling input.
    DrivenDown,
}

/// Larger than the rounding of an input, m: for a position of 0.3 m that is 6e-17 m, and a controller's gain makes it
/// a hundred times larger.
const ROUNDING: f64 = 1e-14;

/// Guards that a play has: against a rising input, and against a falling one.
pub(crate) const GUARDS: usize = 2;

/// The play operator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Play {
    half_width: f64,
    branch: Branch,
}

impl Play {
    /// A play at rest, whose output is held at `output`: at 0 where nothing says otherwise (EQUATIONS section 11 rule 4).
    #[must_use]
    pub fn held(half_width: f64, output: f64) -> Play {
        Play { half_width, branch: Branch::Held(output) }
    }

    /// The present branch.
    #[must_use]
    pub fn branch(&self) -> Branch {
        self.branch
    }

    /// w.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// The output for the input `u` on the present branch. Without slack it is the input.
    #[must_use]
    pub fn output(&self, u: f64) -> f64 {
        match self.branch {
            _ if self.half_width == 0.0 => u,
            Branch::Held(s) => s,
            Branch::DrivenUp => u - self.half_width,
            Branch::DrivenDown => u + self.half_width,
        }
    }

    /// The input jumps from `before` to `u` and then moves on as given: rule 3.
    pub fn jump(&mut self, before: f64, u: f64, motion: Motion) {
        let (held, w) = (self.output(before), self.half_width);
        let s = if u >= held + w {
            u - w
        } else if u <= held - w {
            u + w
        } else {
            held
        };
        // u - s is w to within rounding where s was just set from u: so `held` is asked, too.
        self.branch = match motion {
            Motion::Rising if u - s >= w || u >= held + w => Branch::DrivenUp,
            Motion::Falling if s - u >= w || u <= held - w => Branch::DrivenDown,
            _ => Branch::Held(s),
        };
    }

    /// Not negative as long as the branch holds, for an input that is no function of time alone: one
    /// guard for either way that the input can move. A branch that a turn leaves begins at one end of
    /// the slack, and may come to the other within a step.
    ///
    /// It leaves that end with no speed: the rounding of u must not look like a return to it.
    pub(crate) fn guards(&self, u: f64, rate: f64) -> [f64; GUARDS] {
        match self.branch {
            _ if self.half_width == 0.0 => [1.0; GUARDS],
            Branch::Held(s) => {
                [self.half_width - (u - s), self.half_width + (u - s)].map(|room| room + ROUNDING)
            }
            Branch::DrivenUp => [1.0, rate],
            Branch::DrivenDown => [-rate, 1.0],
        }
    }

    /// Takes the branch that follows the present one at its end, the input being `u`.
    pub fn turn(&mut self, u: f64) {
        self.branch = match self.branch {
            Branch::Held(s) if u > s => Branch::DrivenUp,
            Branch::Held(_) => Branch::DrivenDown,
            Branch::DrivenUp | Branch::DrivenDown => Branch::Held(self.output(u)),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driven(play: &mut Play, inputs: &[f64]) -> f64 {
        inputs.windows(2).for_each(|pair| play.jump(pair[0], pair[1], Motion::Still));
        play.output(*inputs.last().expect("an input"))
    }

    #[test]
    fn the_output_follows_with_the_slack_and_keeps_its_place_within_it() {
        let mut play = Play::held(0.05, 0.0);
        assert!((driven(&mut play, &[0.0, 0.25]) - 0.2).abs() < 1e-15);
        assert!((driven(&mut play, &[0.25, 0.2]) - 0.2).abs() < 1e-15, "within the slack nothing moves");
        assert!((driven(&mut play, &[0.2, 0.0]) - 0.05).abs() < 1e-15);
    }

    #[test]
    fn a_branch_ends_where_its_guard_says() {
        let mut play = Play::held(0.05, 0.0);
        assert!(play.guards(0.05 - 1e-13, 1.0)[0] > 0.0 && play.guards(0.05 + 1e-13, 1.0)[0] < 0.0);
        assert!(play.guards(-0.05 + 1e-13, -1.0)[1] > 0.0 && play.guards(-0.05 - 1e-13, -1.0)[1] < 0.0);
        play.turn(0.05);
        assert_eq!(play.branch(), Branch::DrivenUp);
        assert!(play.guards(0.3, 1.0) == [1.0; 2] && play.guards(0.3, -1.0) == [1.0, -1.0]);
        play.turn(0.3);
        assert_eq!(play.branch(), Branch::Held(0.25));
        play.turn(0.2);
        assert_eq!(play.branch(), Branch::DrivenDown);
    }

    #[test]
    fn without_slack_the_output_is_the_input() {
        let mut play = Play::held(0.0, 0.0);
        assert_eq!(driven(&mut play, &[0.0, 0.3, -0.2]), -0.2);
        assert_eq!(play.guards(-0.2, -5.0), [1.0; 2]);
    }
}
