//! Hysteresis as a play operator: the output follows its input with a slack of one half width on
//! either side (thesis 6.4.5, C(29); EQUATIONS section 7 and section 11 rule 3).
//!
//! ```text
//! driven up    s = u - w   while u rises
//! driven down  s = u + w   while u falls
//! held         s stays     while |u - s| < w
//! ```
//!
//! The input here is a command that is constant between outputs plus a sinusoidal dither, so the
//! instants at which the branch changes are known in closed form: no step has to find them.

use std::f64::consts::PI;

/// A sinusoid a sin(2 pi f t + phi).
#[derive(Clone, Copy, Debug)]
pub struct Dither {
    /// a, in the unit of the play's input.
    pub amplitude: f64,
    /// f, Hz.
    pub frequency_hz: f64,
    /// phi, as a fraction of a cycle.
    pub phase_cycles: f64,
}

/// |cos| below which an instant counts as an extremum of the dither: what rounding of the time to
/// 53 bits makes of an exact one, with a hundredfold margin.
const AT_EXTREMUM: f64 = 1e-10;

impl Dither {
    /// The part of a cycle that has gone at `t`, 0 to 1.
    fn cycle(&self, t: f64) -> f64 {
        let cycles = t * self.frequency_hz + self.phase_cycles;
        cycles - cycles.floor()
    }

    /// The dither at `t` seconds.
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        if self.amplitude == 0.0 { 0.0 } else { self.amplitude * libm::sin(2.0 * PI * self.cycle(t)) }
    }

    /// Which way the dither moves just after `t`: by the slope, and by the curvature where the slope
    /// is zero within rounding (EQUATIONS section 11 rule 3: an output at an extremum is regular).
    fn direction(&self, t: f64) -> Motion {
        if self.amplitude == 0.0 || self.frequency_hz == 0.0 {
            return Motion::Still;
        }
        let angle = 2.0 * PI * self.cycle(t);
        let (slope, curvature) = (libm::cos(angle), -libm::sin(angle));
        let rising = if slope.abs() > AT_EXTREMUM { slope > 0.0 } else { curvature > 0.0 };
        if rising { Motion::Rising } else { Motion::Falling }
    }

    /// The first instant after `t` at which the cycle stands at `cycle` (0 to 1); an instant nearer
    /// than 1e-9 cycles counts as passed.
    fn next(&self, t: f64, cycle: f64) -> f64 {
        let mut ahead = cycle - self.cycle(t);
        ahead -= ahead.floor();
        if !(1e-9..=1.0 - 1e-9).contains(&ahead) {
            ahead = 1.0;
        }
        t + ahead / self.frequency_hz
    }

    /// The first instant after `t` at which the dither passes `level` in the direction of `motion`.
    fn next_crossing(&self, t: f64, level: f64, motion: Motion) -> Option<f64> {
        let sine = level / self.amplitude;
        if sine.is_nan() || sine.abs() > 1.0 {
            return None;
        }
        let rising = libm::asin(sine) / (2.0 * PI);
        let cycle = if motion == Motion::Rising { rising } else { 0.5 - rising };
        Some(self.next(t, cycle - cycle.floor()))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Rising,
    Falling,
    Still,
}

/// What the output is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Branch {
    Held(f64),
    DrivenUp,
    DrivenDown,
}

/// The play operator on a command plus dither.
#[derive(Clone, Copy, Debug)]
pub struct Play {
    half_width: f64,
    dither: Dither,
    command: f64,
    branch: Branch,
    /// When the branch changes next, if the command stays.
    next: f64,
}

impl Play {
    /// A play at rest at 0 (EQUATIONS section 11 rule 4), with the command `command` from t = 0.
    #[must_use]
    pub fn new(half_width: f64, dither: Dither, command: f64) -> Play {
        let mut play = Play { half_width, dither, command, branch: Branch::Held(0.0), next: f64::INFINITY };
        play.jump(0.0, command);
        play
    }

    fn input(&self, t: f64) -> f64 {
        self.command + self.dither.value(t)
    }

    /// The output at `t`, as long as no instant of [`Play::next_instant`] has been passed.
    #[must_use]
    pub fn output(&self, t: f64) -> f64 {
        match self.branch {
            Branch::Held(s) => s,
            Branch::DrivenUp => self.input(t) - self.half_width,
            Branch::DrivenDown => self.input(t) + self.half_width,
        }
    }

    /// The command jumps to `command` at `t`: rule 3.
    pub fn jump(&mut self, t: f64, command: f64) {
        let held = self.output(t);
        self.command = command;
        let u = self.input(t);
        let s = if u >= held + self.half_width {
            u - self.half_width
        } else if u <= held - self.half_width {
            u + self.half_width
        } else {
            held
        };
        let w = self.half_width;
        self.branch = match self.dither.direction(t) {
            Motion::Rising if u - s >= w => Branch::DrivenUp,
            Motion::Falling if s - u >= w => Branch::DrivenDown,
            // u - s is w to within rounding where s was just set from u.
            Motion::Rising if u >= held + w => Branch::DrivenUp,
            Motion::Falling if u <= held - w => Branch::DrivenDown,
            _ => Branch::Held(s),
        };
        self.next = self.next_after(t);
    }

    /// When the branch changes next, if the command stays; infinity for never.
    #[must_use]
    pub fn next_instant(&self) -> f64 {
        self.next
    }

    fn next_after(&self, t: f64) -> f64 {
        if self.dither.direction(t) == Motion::Still {
            return f64::INFINITY;
        }
        match self.branch {
            Branch::DrivenUp => self.dither.next(t, 0.25),
            Branch::DrivenDown => self.dither.next(t, 0.75),
            Branch::Held(s) => {
                let up = self.dither.next_crossing(t, s + self.half_width - self.command, Motion::Rising);
                let down = self.dither.next_crossing(t, s - self.half_width - self.command, Motion::Falling);
                up.unwrap_or(f64::INFINITY).min(down.unwrap_or(f64::INFINITY))
            }
        }
    }

    /// The instants, next after `t`, at which the output passes `level` on a driven branch:
    /// infinity for never.
    #[must_use]
    pub fn next_passage(&self, t: f64, level: f64) -> f64 {
        let crossing = match self.branch {
            Branch::Held(_) => None,
            Branch::DrivenUp => {
                self.dither.next_crossing(t, level + self.half_width - self.command, Motion::Rising)
            }
            Branch::DrivenDown => {
                self.dither.next_crossing(t, level - self.half_width - self.command, Motion::Falling)
            }
        };
        crossing.unwrap_or(f64::INFINITY)
    }

    /// Takes the branch that holds after [`Play::next_instant`].
    pub fn pass_instant(&mut self) {
        let t = self.next;
        self.branch = match self.branch {
            Branch::Held(_) if self.dither.direction(t) == Motion::Rising => Branch::DrivenUp,
            Branch::Held(_) => Branch::DrivenDown,
            Branch::DrivenUp | Branch::DrivenDown => Branch::Held(self.output(t)),
        };
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

    fn follow(play: &mut Play, from: f64, until: f64) -> f64 {
        assert!(play.next_instant() >= from);
        while play.next_instant() <= until {
            play.pass_instant();
        }
        play.output(until)
    }

    #[test]
    fn following_the_branches_gives_the_output_of_the_textbook_play() {
        for until in [0.003, 0.0117, 0.04, 0.0951] {
            let got = follow(&mut Play::new(0.05, DITHER, 0.0), 0.0, until);
            assert!((got - brute_force(|_| 0.0, 0.05, until)).abs() < 1e-6, "{until}");
        }
    }

    #[test]
    fn a_jump_of_the_command_drags_the_output_only_as_far_as_the_slack_is_used_up() {
        for jump in [-0.7, -0.06, -0.01, 0.01, 0.06, 0.7] {
            for at in [0.0021, 0.006, 0.0123, 0.0178] {
                let mut play = Play::new(0.05, DITHER, 0.0);
                follow(&mut play, 0.0, at);
                play.jump(at, jump);
                let got = follow(&mut play, at, 0.033);
                let expected = brute_force(|t| if t < at { 0.0 } else { jump }, 0.05, 0.033);
                assert!((got - expected).abs() < 1e-6, "{jump} at {at}: {got} {expected}");
            }
        }
    }

    /// The trap of EQUATIONS section 11 rule 3: 1300/500 us and 50 Hz put an output on an extremum.
    #[test]
    fn an_output_at_an_extremum_of_the_dither_is_held_not_driven() {
        let at = 0.085; // sample 65: 65 * 1.3 ms + 0.5 ms, a crest of the dither
        let mut play = Play::new(0.05, DITHER, 0.0);
        follow(&mut play, 0.0, at - 1e-5);
        play.jump(at, 0.1);
        assert_eq!(play.branch, Branch::Held(0.1 + 0.2 - 0.05));
        assert!(play.next_instant() > at + 1e-3);
    }

    #[test]
    fn without_dither_the_output_moves_with_jumps_alone() {
        let still = Dither { amplitude: 0.0, ..DITHER };
        let mut play = Play::new(0.05, still, 0.0);
        assert_eq!(play.next_instant(), f64::INFINITY);
        play.jump(1.0, 0.25);
        assert!((play.output(1.0) - 0.2).abs() < 1e-15);
        play.jump(2.0, 0.2);
        assert!((play.output(2.0) - 0.2).abs() < 1e-15, "within the slack nothing moves");
        play.jump(3.0, 0.0);
        assert!((play.output(3.0) - 0.05).abs() < 1e-15);
    }
}
