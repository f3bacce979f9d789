//! The hysteresis of a coil: play on a command that is constant between outputs, plus dither.
//!
//! The input is a function of time alone, so the instants at which the branch changes are known in
//! closed form: no step has to find them.

use crate::component::dither::SOLENOIDS;
use crate::component::dither::{CREST, Dither, TROUGH};
use crate::component::play::{Branch, Motion, Play};
use crate::component::valve::spool_travel;
use crate::key::keys;
use crate::values::Rig;

keys! {
    HYSTERESIS_PERCENT: f64 = number("operator.hysteresis_percent", 5.0, 0.0, 100.0, "C(29)", "Width of the hysteresis loop, of the spool's range from end to end (2 mm in servo-drive B).").of(SOLENOIDS).spread().vague();
    HYSTERESIS_SIDE: f64 = number("operator.hysteresis_side", 0.0, -1.0, 1.0, "", "Where the spool stands in its hysteresis as a test begins: 1 as after a command that fell, -1 as after one that rose, 0 in the middle.").of(SOLENOIDS);
}

/// Half of the hysteresis loop, m: the loop is `hysteresis_percent` of the spool's range wide, from end to end.
#[must_use]
pub fn half_width(rig: &Rig) -> f64 {
    rig.get(&keys::HYSTERESIS_PERCENT) / 100.0 * spool_travel(rig)
}

/// The play of a rig's operator at the start of its test.
pub(super) fn at_start(rig: &Rig) -> Play {
    Play::held(half_width(rig), rig.get(&keys::HYSTERESIS_SIDE) * half_width(rig))
}

/// Play on a command plus dither, all in m of spool travel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hysteresis {
    play: Play,
    dither: Dither,
    command: f64,
    /// When the branch changes next, if the command stays.
    next: f64,
}

impl Hysteresis {
    /// At rest as the play is, with the command `command` from t = 0.
    pub fn new(play: Play, dither: Dither, command: f64) -> Hysteresis {
        let mut hysteresis = Hysteresis { play, dither, command, next: f64::INFINITY };
        hysteresis.jump(0.0, command);
        hysteresis
    }

    fn input(&self, t: f64) -> f64 {
        self.command + self.dither.value(t)
    }

    /// The output at `t`, as long as [`Hysteresis::next_time_event`] has not been passed.
    pub fn output(&self, t: f64) -> f64 {
        self.play.output(self.input(t))
    }

    /// The output on the present branch: a constant, and whether the dither is added to it.
    pub fn course(&self) -> (f64, bool) {
        let w = self.play.half_width();
        match self.play.branch() {
            _ if w == 0.0 => (self.command, true),
            Branch::Held(s) => (s, false),
            Branch::DrivenUp => (self.command - w, true),
            Branch::DrivenDown => (self.command + w, true),
        }
    }

    /// The sinusoid on the command.
    pub fn dither(&self) -> Dither {
        self.dither
    }

    /// The command jumps to `command` at `t`.
    pub fn jump(&mut self, t: f64, command: f64) {
        let before = self.input(t);
        self.command = command;
        self.play.jump(before, self.input(t), self.dither.direction(t));
        self.next = self.next_after(t);
    }

    /// When the branch changes next, if the command stays; infinity for never.
    pub fn next_time_event(&self) -> f64 {
        self.next
    }

    fn next_after(&self, t: f64) -> f64 {
        let w = self.play.half_width();
        if w == 0.0 || self.dither.direction(t) == Motion::Still {
            return f64::INFINITY;
        }
        match self.play.branch() {
            Branch::DrivenUp => self.dither.next(t, CREST),
            Branch::DrivenDown => self.dither.next(t, TROUGH),
            Branch::Held(s) => {
                let up = self.dither.next_crossing(t, s + w - self.command, Motion::Rising);
                up.min(self.dither.next_crossing(t, s - w - self.command, Motion::Falling))
            }
        }
    }

    /// The instant, next after `t`, at which the output passes `level` on a driven branch: infinity
    /// for never.
    pub fn next_passage(&self, t: f64, level: f64) -> f64 {
        let (w, level) = (self.play.half_width(), level - self.command);
        let crossing = |level, motion| self.dither.next_crossing(t, level, motion);
        match self.play.branch() {
            _ if w == 0.0 => crossing(level, Motion::Rising).min(crossing(level, Motion::Falling)),
            Branch::Held(_) => f64::INFINITY,
            Branch::DrivenUp => crossing(level + w, Motion::Rising),
            Branch::DrivenDown => crossing(level - w, Motion::Falling),
        }
    }

    /// The instant, `t` or next after it, at which an output inside a range leaves it on the present branch: infinity for
    /// never.
    pub fn next_exit(&self, t: f64, [low, high]: [f64; 2]) -> f64 {
        let w = self.play.half_width();
        let rises_to = |level| self.dither.next_crossing(t, level - self.command, Motion::Rising);
        let falls_to = |level| self.dither.next_crossing(t, level - self.command, Motion::Falling);
        let exit = match self.play.branch() {
            _ if w == 0.0 => rises_to(high).min(falls_to(low)),
            Branch::Held(_) => f64::INFINITY,
            Branch::DrivenUp => rises_to(high + w),
            Branch::DrivenDown => falls_to(low - w),
        };
        // What counts as passed, and so comes a whole cycle later, is now.
        let cycles = (exit - t) * self.dither.frequency_hz;
        if cycles.is_finite() && cycles > 1.0 - 5e-10 { t } else { exit }
    }

    /// Takes the branch that holds after [`Hysteresis::next_time_event`].
    pub fn pass_instant(&mut self) {
        let t = self.next;
        let input = self.input(t);
        // A held output that the input just touches at an extremum stays held.
        let touches = match (self.play.branch(), self.dither.direction(t)) {
            (Branch::Held(s), Motion::Rising) => input < s,
            (Branch::Held(s), _) => input > s,
            _ => false,
        };
        if !touches {
            self.play.turn(input);
        }
        self.next = self.next_after(t);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DITHER: Dither = Dither { amplitude: 0.2, frequency_hz: 50.0, phase_cycles: 0.0 };

    /// The textbook play by small steps of its input: s = max(u - w, min(u + w, s)).
    fn brute_force(command: impl Fn(f64) -> f64, w: f64, until: f64) -> f64 {
        let steps = 2_000_000;
        (0..=steps).fold(0.0_f64, |s, i| {
            let t = until * f64::from(i) / f64::from(steps);
            let u = command(t) + DITHER.value(t);
            s.clamp(u - w, u + w)
        })
    }

    fn follow(hysteresis: &mut Hysteresis, until: f64) -> f64 {
        while hysteresis.next_time_event() <= until {
            hysteresis.pass_instant();
        }
        hysteresis.output(until)
    }

    #[test]
    fn following_the_branches_gives_the_output_of_the_textbook_play() {
        // Half widths from none over the amplitude of the dither, which is touched at its crests, to
        // more than that.
        for w in [0.0, 0.05, 0.1, 0.199, 0.2, 0.3] {
            for until in [0.003, 0.005, 0.0117, 0.015, 0.04, 0.0951] {
                let got = follow(&mut Hysteresis::new(Play::held(w, 0.0), DITHER, 0.0), until);
                let expected = brute_force(|_| 0.0, w, until);
                assert!((got - expected).abs() < 1e-6, "w {w} at {until}: {got} {expected}");
            }
        }
    }

    #[test]
    fn a_jump_of_the_command_drags_the_output_only_as_far_as_the_slack_is_used_up() {
        for jump in [-0.7, -0.06, -0.01, 0.01, 0.06, 0.7] {
            for at in [0.0021, 0.006, 0.0123, 0.0178] {
                let mut hysteresis = Hysteresis::new(Play::held(0.05, 0.0), DITHER, 0.0);
                follow(&mut hysteresis, at);
                hysteresis.jump(at, jump);
                let got = follow(&mut hysteresis, 0.033);
                let expected = brute_force(|t| if t < at { 0.0 } else { jump }, 0.05, 0.033);
                assert!((got - expected).abs() < 1e-6, "{jump} at {at}: {got} {expected}");
            }
        }
    }

    /// The trap of EQUATIONS section 11 rule 3: 1300/500 us and 50 Hz put an output on an extremum.
    #[test]
    fn an_output_at_an_extremum_of_the_dither_is_held_not_driven() {
        let at = 0.085; // sample 65: 65 * 1.3 ms + 0.5 ms, a crest of the dither
        let mut hysteresis = Hysteresis::new(Play::held(0.05, 0.0), DITHER, 0.0);
        follow(&mut hysteresis, at - 1e-5);
        hysteresis.jump(at, 0.1);
        assert_eq!(hysteresis.play.branch(), Branch::Held(0.1 + 0.2 - 0.05));
        assert!(hysteresis.next_time_event() > at + 1e-3);
    }

    #[test]
    fn without_dither_nothing_happens_between_outputs() {
        let still = Dither { amplitude: 0.0, ..DITHER };
        let mut hysteresis = Hysteresis::new(Play::held(0.05, 0.0), still, 0.0);
        assert_eq!(hysteresis.next_time_event(), f64::INFINITY);
        hysteresis.jump(1.0, 0.25);
        assert_eq!((hysteresis.next_time_event(), hysteresis.output(1.0)), (f64::INFINITY, 0.2));
    }
}
