//! A spool on a spring with dry friction, whose place is measured: where it is, and the command that brings it to a place.
//!
//! ```text
//! spool       s'' = w^2 (p - s - f sgn(s')) - D s'        p: pull of the coil, f: friction in motion;  stands while |p - s| <= f_0
//! pull        p follows the command u through the play
//! sensor      s += 0.7 e,   s' += 0.4 e/T,   mean place of the last sample += 0.5 e             e: measured place less that of the model
//! to a place  without friction e_0 and e_1, a sample each, bring it from (s, s') to (s + travel, 0):
//!             e_0 = s + a travel + b s',   e_1 = s + c travel + d s'                      two samples are a deadbeat of the second order
//! reach       the part of the travel for which e_0 and e_1 with the friction are within what the coil can pull
//! pull        p = e_0 +- f,   from rest no less than 1.05 f_0;   u = p +- half of the play where it moves p
//! ```
//!
//! A spool that stands within 8 counts of its goal stays there. It stands below the speed that its friction takes from it in a quarter of
//! a sample, and its friction has the sign of its speed above twice of that. Within a time in which it stops it has lost its speed
//! evenly, and what still pulls it then takes it back.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | s, p, e, f, u | Q16 counts of command | 2^12 |
//! | s' | Q16 counts a sample | 2^15 |
//! | a to d | Q24 | -128 to 128 |

use super::number::{product, ratio, scaled, within};
use super::transition::{MOST, Transition};
use crate::parameters::{Parameters, id};

/// Places nearer than this are the same, Q16: 8 counts.
const NEAR: i32 = 8 << 16;
/// A pull that is not worth a change of the command, Q16: 2 counts.
const SMALL: i32 = 2 << 16;
/// 0.7, 0.4 and 1.05 in Q16.
const OF_PLACE: i32 = 45_875;
const OF_SPEED: i32 = 26_214;
const AWAY: i32 = 68_813;
/// 1 of a part.
const ONE: i32 = 1 << 16;

/// What it knows of the spool.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Constants {
    /// Place at raw 0, Q16, and of a raw count, Q24.
    offset: i32,
    gain: i32,
    /// a and b, c and d.
    first: [i32; 2],
    second: [i32; 2],
    /// f_0 and f.
    stiction: i32,
    friction: i32,
    /// 1.05 f_0.
    away: i32,
    /// Below this speed it stands.
    still: i32,
    play: i32,
    /// Largest pull, and largest command in counts.
    strongest: i32,
    largest: i32,
    /// Part of a period before the output.
    share: i32,
    output: Transition,
    sample: Transition,
}

/// Where the spool is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Spool {
    /// Whether it has been measured.
    begun: bool,
    place: i32,
    speed: i32,
    /// u, and p.
    command: i32,
    pull: i32,
    /// Since the sample before, on average.
    pub mean: i32,
}

impl Constants {
    /// Those of a drive whose spool is measured.
    pub(super) fn of(parameters: &Parameters) -> Option<Constants> {
        let get = |id| parameters.scalar(id);
        if get(id::CASCADE_SPOOL_GAIN) == 0 {
            return None;
        }
        let [output, sample] = [id::CASCADE_SPOOL_OUTPUT_PLACE, id::CASCADE_SPOOL_SAMPLE_PLACE]
            .map(|first| Transition::of(parameters, first));
        let (friction, play) = (get(id::CASCADE_SPOOL_FRICTION), get(id::CASCADE_PLAY));
        let largest = get(id::MAX_COMMAND_COUNTS);
        let by_spring = output.pull().saturating_add(sample.pull()).saturating_abs();
        Some(Constants {
            offset: get(id::CASCADE_SPOOL_OFFSET),
            gain: get(id::CASCADE_SPOOL_GAIN),
            first: [get(id::CASCADE_SPOOL_FIRST_WAY), get(id::CASCADE_SPOOL_FIRST_SPEED)],
            second: [get(id::CASCADE_SPOOL_SECOND_WAY), get(id::CASCADE_SPOOL_SECOND_SPEED)],
            stiction: get(id::CASCADE_SPOOL_STICTION),
            friction,
            away: product(get(id::CASCADE_SPOOL_STICTION), AWAY, 16),
            still: product(friction, by_spring, 30).max(1 << 14),
            play,
            strongest: (largest << 16).saturating_sub(play).max(0),
            largest,
            share: get(id::CASCADE_OUTPUT_SHARE),
            output,
            sample,
        })
    }
}

/// `a/(a + b)`, Q16; nothing of nothing.
fn part(a: i32, b: i32) -> i32 {
    let (a, b) = (u64::from(a.unsigned_abs()), u64::from(b.unsigned_abs()));
    if a == 0 { 0 } else { ratio(a << 16, a + b).min(1 << 16) as i32 }
}

impl Spool {
    /// What the sensor makes of the last sample; `null`: the command at which the valve is at its null, counts.
    pub(super) fn sense(&mut self, constants: &Constants, raw: i16, null: i32) {
        let measured = constants.offset.saturating_add(product(constants.gain, raw.into(), 8));
        let measured = within(measured.saturating_sub(within(null, 1 << 12) << 16), 2 * MOST);
        if !self.begun {
            *self = Spool { begun: true, place: measured, mean: measured, ..Spool::default() };
            return;
        }
        let error = measured.saturating_sub(self.place);
        self.place = self.place.saturating_add(scaled(error, OF_PLACE, 16));
        self.speed = within(self.speed.saturating_add(scaled(error, OF_SPEED, 16)), 2 * MOST);
        self.mean = self.mean.saturating_add(error / 2);
    }

    /// The command that brings it to a place, in counts.
    pub(super) fn drive(&mut self, constants: &Constants, wanted: i32) -> i32 {
        let share = constants.share;
        let before = self.glide(constants, constants.output, share);
        let change = within(self.pull_to(constants, wanted), constants.strongest).saturating_sub(self.pull);
        let command = match change {
            small if small.saturating_abs() < SMALL => self.command,
            more => {
                self.pull.saturating_add(more).saturating_add(constants.play.saturating_mul(more.signum()))
            }
        };
        let counts = (command.saturating_add(1 << 15) >> 16).min(constants.largest).max(-constants.largest);
        self.command = counts << 16;
        self.pull =
            self.pull.min(self.command + constants.play).max(self.command.saturating_sub(constants.play));
        let after = self.glide(constants, constants.sample, ONE - share);
        self.mean = scaled(before, share, 16).saturating_add(scaled(after, ONE - share, 16));
        counts
    }

    /// p.
    fn pull_to(&self, constants: &Constants, wanted: i32) -> i32 {
        let travel = within(wanted.saturating_sub(self.place), 2 * MOST);
        let still = self.speed.saturating_abs() < constants.still;
        if still && travel.saturating_abs() < NEAR {
            return self.place;
        }
        let moves = self.speed.saturating_abs() > 2 * constants.still;
        let sign = if moves { self.speed.signum() } else { travel.signum() };
        let friction = constants.friction.saturating_mul(sign);
        let [first, second] = [constants.first, constants.second].map(|[of_travel, of_speed]| {
            let stay = self.place.saturating_add(product(self.speed, of_speed, 24)).saturating_add(friction);
            (stay, product(travel, of_travel, 24))
        });
        let reach = reach(first, constants.strongest).min(reach(second, constants.strongest));
        let pull = first.0.saturating_add(scaled(first.1, reach, 16));
        let away = self.place.saturating_add(constants.away.saturating_mul(travel.signum()));
        let too_weak = pull.saturating_sub(away).signum() == -travel.signum();
        if still && too_weak { away } else { pull }
    }

    /// Its motion over a time (Q16 samples) under the present pull; returns its mean place.
    fn glide(&mut self, constants: &Constants, transition: Transition, time: i32) -> i32 {
        let (place, speed) = (self.place, self.speed);
        let free = self.pull.saturating_sub(place);
        if speed == 0 && free.saturating_abs() <= constants.stiction {
            return place;
        }
        let sign = if speed == 0 { free.signum() } else { speed.signum() };
        let rest = self.pull.saturating_sub(constants.friction.saturating_mul(sign));
        let (from, then) = transition.moved(place.saturating_sub(rest), speed);
        if then.signum() == -sign {
            self.stop(constants, transition, then, time);
        } else {
            (self.place, self.speed) = (rest.saturating_add(from), then);
        }
        self.place = within(self.place, 2 * MOST);
        (place >> 1) + (self.place >> 1)
    }

    /// A time in which it stops, as it would have the speed `then` at its end; and goes back, if it is pulled on.
    fn stop(&mut self, constants: &Constants, transition: Transition, then: i32, time: i32) {
        let gone = part(self.speed, then);
        let travel = scaled(scaled(self.speed, gone, 16), time, 17);
        (self.place, self.speed) = (self.place.saturating_add(travel), 0);
        let free = self.pull.saturating_sub(self.place);
        if free.saturating_abs() > constants.stiction {
            let left = ONE - gone;
            let drive = free.saturating_sub(constants.friction.saturating_mul(free.signum()));
            self.speed = scaled(product(drive.saturating_neg(), transition.pull(), 28), left, 16);
            self.place = self.place.saturating_add(scaled(scaled(self.speed, left, 16), time, 17));
        }
    }
}

/// The part (Q16) of a change for which a pull that begins at `stay` is within what the coil has.
fn reach((stay, change): (i32, i32), strongest: i32) -> i32 {
    let end = i64::from(stay) + i64::from(change);
    if end.unsigned_abs() <= u64::from(strongest.unsigned_abs()) {
        return ONE;
    }
    let room = if change > 0 { strongest.saturating_sub(stay) } else { stay.saturating_add(strongest) };
    let room = u64::from(room.max(0).unsigned_abs());
    ratio(room << 16, u64::from(change.unsigned_abs())).min(1 << 16) as i32
}
