//! The valve: the command that makes the force change at a rate, and where that takes the spool.
//!
//! ```text
//! opening     g' = g - l (E - R),   C = (|g'| + l E)/E, or by R,   z = lap + span (C - l)/(1 - l)      l: leakage
//! spool       s'' = w^2 (u - s) - D s', then a play             [s - u, s'] -> Phi [s - u, s'] to the output and to the next sample,
//!                                                               of which a slower spool makes the part 1/pace ([`super::lag`])
//! command     u = s + b^2 (goal - s) - (b - 1) D/w^2 s'         b = 1.5: as if the spool were so much faster
//! goal        z +- half of the play when it has to be passed; within 2 counts of it the spool stays where it is
//! behind a port or tubes   C and z by `land`, E and R of a part that is open by `tubes`; a measured spool: `spring`, a stepper: `stepper`
//! ```
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | g, E, R | Q24 force a sample | | |
//! | C | Q16 | 0 to 1 | 2^-15 of it |
//! | s, z, u | Q16 counts of command | 2^12 | |
//! | s' | Q16 counts a sample | 2^15 | |
//! | Phi | Q30, from place to speed Q28 | | 2^-29 |

use super::air::Air;
use super::land::Land;
use super::number::{over, product, ratio, scaled, within};
use super::spring::{self, Spool};
use super::stepper::{self, Stepped};
use super::transition::{MOST, Transition};
use crate::parameters::{Parameters, id};

/// Places nearer than this are the same, Q16: 2 counts.
const NEAR: i32 = 2 << 16;

/// What it knows of the valve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// Largest command, counts.
    largest: i32,
    /// Q16.
    leakage: i32,
    lap: i32,
    /// span/(1 - l), Q16, and 1/span, Q28 of 2^-16.
    span: i32,
    by_span: i32,
    play: i32,
    lag: i32,
    share: i32,
    output: Transition,
    sample: Transition,
    land: Option<Land>,
    seen: Option<Seen>,
}

/// A spool whose place is known, by a sensor or by its steps.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Seen {
    Spring(spring::Constants),
    Stepper(stepper::Constants),
}

/// Where the spool is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Valve {
    place: i32,
    speed: i32,
    command: i32,
    /// What the play lets through.
    held: i32,
    /// One on a spring, that is measured.
    spool: Spool,
    /// One that a stepper moves.
    stepped: Stepped,
    /// The spool since the sample before, on average, Q16 counts of command.
    pub mean: i32,
}

impl Constants {
    pub(super) fn of(parameters: &Parameters) -> Constants {
        let get = |id| parameters.scalar(id);
        let land = Land::of(parameters);
        let leakage = land.as_ref().map_or(get(id::CASCADE_LEAKAGE), |land| land.shut as i32);
        let span = get(id::CASCADE_SPAN);
        let whole = u64::from(span.unsigned_abs());
        Constants {
            largest: get(id::MAX_COMMAND_COUNTS),
            leakage,
            lap: get(id::CASCADE_OVERLAP),
            span: ratio(whole << 16, u64::from(((1 << 16) - leakage).unsigned_abs())).min(1 << 28) as i32,
            by_span: ratio(1 << 44, whole).min(1 << 28) as i32,
            play: get(id::CASCADE_PLAY),
            lag: get(id::CASCADE_SPOOL_LAG),
            share: get(id::CASCADE_OUTPUT_SHARE),
            output: Transition::of(parameters, id::CASCADE_SPOOL_OUTPUT_PLACE),
            sample: Transition::of(parameters, id::CASCADE_SPOOL_SAMPLE_PLACE),
            land,
            seen: spring::Constants::of(parameters)
                .map(Seen::Spring)
                .or_else(|| stepper::Constants::of(parameters).map(Seen::Stepper)),
        }
    }

    /// C of a path whose land is at z, Q16.
    fn conductance(&self, z: i32) -> i32 {
        let open = product(z.saturating_sub(self.lap), self.by_span, 28).clamp(0, 1 << 16);
        self.leakage + scaled(open, (1 << 16) - self.leakage, 16)
    }

    /// E C(z) - R C(-z), Q24.
    pub(super) fn rate(&self, air: &Air, z: i32) -> i32 {
        if let Some(land) = &self.land {
            return self.rate_of_land(land, air, z);
        }
        scaled(air.extend, self.conductance(z), 16) - scaled(air.retract, self.conductance(-z), 16)
    }

    #[inline(never)]
    fn rate_of_land(&self, land: &Land, air: &Air, z: i32) -> i32 {
        let open = land.conductance(z.saturating_abs().saturating_sub(self.lap));
        let [extend, retract] = &air.sides;
        if z > 0 { extend.through(open) - retract.leak } else { extend.leak - retract.through(open) }
    }

    /// As [`Constants::opening`], of a land.
    #[inline(never)]
    fn opening_of_land(&self, land: &Land, air: &Air, rate: i32, least: i32) -> i32 {
        let [extend, retract] = &air.sides;
        let net = rate.saturating_sub(extend.leak - retract.leak);
        if net.unsigned_abs() < least.unsigned_abs() {
            return 0;
        }
        let (side, open) = if net > 0 { (extend, air.extend) } else { (retract, air.retract) };
        let asked = net.saturating_abs().saturating_add(side.leak);
        let beyond = if asked < open {
            land.opening(over(asked as u32, side.without, 31), side.twice)
        } else {
            land.span
        };
        let place = self.lap.saturating_add(beyond);
        place.clamp(0, MOST).saturating_mul(net.signum())
    }

    /// Whether a rate is more than 1.2 of what the open valve makes.
    pub(super) fn is_short(&self, air: &Air, rate: i32) -> bool {
        let open = if rate > 0 { air.extend } else { air.retract };
        i64::from(rate.saturating_abs()) * 5 > i64::from(open) * 6
    }

    /// z of a rate (Q24); 0 for one that is smaller than `least`.
    pub(super) fn opening(&self, air: &Air, rate: i32, least: i32) -> i32 {
        if let Some(land) = &self.land {
            return self.opening_of_land(land, air, rate, least);
        }
        let leak = scaled(air.extend - air.retract, self.leakage, 16);
        let net = rate.saturating_sub(leak);
        let open = if net > 0 { air.extend } else { air.retract };
        if net.unsigned_abs() < least.unsigned_abs() {
            return 0;
        }
        let asked = net.saturating_abs().saturating_add(scaled(open, self.leakage, 16));
        let share =
            ratio(u64::from(asked.unsigned_abs()) << 16, u64::from(open.unsigned_abs())).min(1 << 16) as i32;
        let place = self.lap.saturating_add(product(self.span, (share - self.leakage).max(0), 16));
        place.clamp(0, MOST).saturating_mul(net.signum())
    }
}

impl Valve {
    /// Goes on over a time; `by_pace` in Q16.
    #[inline(always)]
    fn go_on(&mut self, over: Transition, by_pace: i32) {
        let from = self.place.saturating_sub(self.command);
        let (next, speed) = over.moved(from, self.speed);
        let nearer = product(next.saturating_sub(from), by_pace, 16);
        self.speed = self.speed.saturating_add(product(speed.saturating_sub(self.speed), by_pace, 16));
        self.place = within(self.place.saturating_add(nearer), 2 * MOST);
    }

    /// Takes a spool that is measured or stepped, if the drive has one; `null`: the command at which the valve is at its null, counts.
    #[inline(always)]
    pub(super) fn sense(&mut self, constants: &Constants, raw: i16, null: i32) {
        match &constants.seen {
            Some(Seen::Spring(spring)) => {
                self.spool.sense(spring, raw, null);
                self.mean = self.spool.mean;
            }
            Some(Seen::Stepper(stepper)) => {
                self.stepped.sense(stepper, raw, null);
                self.mean = self.stepped.mean;
            }
            None => {}
        }
    }

    /// The command that brings the spool to a place (Q16), in counts.
    pub(super) fn drive(&mut self, constants: &Constants, by_pace: i32, wanted: i32) -> i32 {
        match &constants.seen {
            Some(Seen::Spring(spring)) => return self.spool.drive(spring, wanted),
            Some(Seen::Stepper(stepper)) => return self.stepped.drive(stepper, wanted),
            None => {}
        }
        let first = self.through_play(constants.play);
        self.go_on(constants.output, by_pace);
        let goal = if wanted > self.held.saturating_add(NEAR) {
            wanted.saturating_add(constants.play)
        } else if wanted < self.held.saturating_sub(NEAR) {
            wanted.saturating_sub(constants.play)
        } else {
            self.place
                .min(self.held.saturating_add(constants.play))
                .max(self.held.saturating_sub(constants.play))
        };
        let travel = within(goal.saturating_sub(self.place), 4 * MOST);
        let braked = product(self.speed, constants.lag, 17);
        let command = self.place.saturating_add(product(travel, 9, 2)).saturating_sub(braked);
        let counts = (command.saturating_add(1 << 15) >> 16).min(constants.largest).max(-constants.largest);
        self.command = counts << 16;
        let middle = self.through_play(constants.play);
        self.go_on(constants.sample, by_pace);
        let last = self.through_play(constants.play);
        let before = scaled(first.saturating_add(middle), constants.share, 17);
        let after = scaled(middle.saturating_add(last), (1 << 16) - constants.share, 17);
        self.mean = before.saturating_add(after);
        counts
    }

    fn through_play(&mut self, play: i32) -> i32 {
        self.held = self.held.min(self.place.saturating_add(play)).max(self.place.saturating_sub(play));
        self.held
    }
}
