//! The first limit that a motion meets.
//!
//! ```text
//! g(t + h) >= g + g' h - m h^2 / 2,   m >= -g'' from t to t + h
//! ```
//!
//! The room g to a limit of position or velocity is positive up to the first root of the parabola. The search goes to
//! that root, and on from there. It approaches the limit from before, with the third power of the remaining distance, and
//! skips none. Two consecutive derivatives are bounded from t on:
//!
//! ```text
//! |y^(n)| <= r,   |y^(n+1)| <= w0 r,   r^2 = y^(n)^2 + (y^(n+1) / w0)^2
//! ```
//!
//! Every derivative of the free part y obeys its equation of motion, whose energy decays. The derivatives of the
//! swing have an amplitude.

use super::{FreeMotion, Parts};

/// The limited quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// m.
    Position,
    /// m/s.
    Velocity,
}

/// Whose a limit is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Met {
    /// The edge of this land.
    Edge(usize),
    /// The operator's guard of this index.
    Guard(usize),
}

/// A limit of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    pub of: Quantity,
    /// m or m/s.
    pub level: f64,
    /// Whether it must not be exceeded; else it must not be fallen below.
    pub upper: bool,
    pub met: Met,
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Search {
    /// No limit is met.
    Clear,
    /// This one is, then.
    Found(Met, f64),
    /// The motion begins at a limit, or grazes one.
    Undecided,
}

/// To how much of a span of time a limit is located.
const RESOLUTION: f64 = 1e-13;

/// A motion that is not clear of its limits for this part of a span begins at one.
const DEPARTURE: f64 = 1e-6;

/// In SI: the uncertainty of a position or a velocity at `t` by rounding. A dither of 300 Hz is at 1,900 rad after a
/// second, which are known to 4e-13, and with 0.4 mm moves at 0.75 m/s.
pub(crate) fn rounding(t: f64) -> f64 {
    (3e-13 * t).max(2.5e-14)
}

/// Looks at a motion: a handful will do, unless it grazes a limit.
const MAX_LOOKS: usize = 60;

/// A quantity and two derivatives; bounds of the second and of the third one from now on.
#[derive(Clone, Copy)]
struct Bounded {
    value: f64,
    slope: f64,
    curvature: f64,
    bounds: [f64; 2],
}

impl FreeMotion {
    /// The first of two limits that is met between two instants.
    pub fn first_limit(&self, limits: &[Limit; 2], [from, until]: [f64; 2]) -> Search {
        let resolution = RESOLUTION * (until - from) + f64::EPSILON * until;
        let reach = (self.in_phase * self.in_phase + self.across * self.across).sqrt();
        let (mut t, mut parts) = (from, if from == self.since { self.start } else { self.parts(from) });
        for look in 0..MAX_LOOKS {
            let courses = self.courses(&parts, reach);
            let rooms = limits.map(|limit| courses[limit.of as usize].room_to(&limit));
            let clear = rooms.map(|room| room.clear(until - t));
            let first = usize::from(clear[1] < clear[0]);
            let (step, room) = (clear[first], &rooms[first]);
            if step >= until - t {
                return Search::Clear;
            }
            let beyond = rooms.iter().any(|room| room.value < -rounding(t));
            let at_one = step <= DEPARTURE * (until - from) || beyond;
            if look == 0 && at_one {
                return Search::Undecided;
            }
            t += step;
            if step <= resolution || room.ends_at(step, resolution) {
                return Search::Found(limits[first].met, t);
            }
            parts = self.parts(t);
        }
        Search::Undecided
    }

    /// Position and velocity, by the amplitude of the swing, m.
    #[inline(always)]
    fn courses(&self, Parts { swing, free }: &Parts, amplitude: f64) -> [Bounded; 2] {
        let next = |position: f64, velocity: f64| -2.0 * self.decay * velocity - self.stiffness * position;
        let second = next(free.position, free.velocity);
        let third = next(free.velocity, second);
        let fourth = next(second, third);
        let square = self.angular * self.angular;
        let bounds = |one: f64, next: f64, swing: f64| {
            let free = (one * one + next * next / self.stiffness).sqrt();
            [free + swing, free * self.stiffness.sqrt() + swing * self.angular]
        };
        let (slope, curvature) = (swing.velocity + free.velocity, second - square * swing.position);
        let position = Bounded {
            value: (self.rest + swing.position) + free.position,
            slope,
            curvature,
            bounds: bounds(second, third, square * amplitude),
        };
        let velocity = Bounded {
            value: slope,
            slope: curvature,
            curvature: third - square * swing.velocity,
            bounds: bounds(third, fourth, square * self.angular * amplitude),
        };
        [position, velocity]
    }
}

impl Bounded {
    /// The room that it has to a limit.
    #[inline(always)]
    fn room_to(&self, limit: &Limit) -> Bounded {
        let sign = if limit.upper { -1.0 } else { 1.0 };
        Bounded {
            value: sign * (self.value - limit.level),
            slope: sign * self.slope,
            curvature: sign * self.curvature,
            bounds: self.bounds,
        }
    }

    /// For how long it is above zero at least; `rest` is long enough.
    #[inline(always)]
    fn clear(&self, rest: f64) -> f64 {
        let near = self.above_zero(self.bounds[0]);
        if near >= rest {
            return near;
        }
        // Taylor's remainder tells more of a short time.
        let far = rest.min(2.0 * near);
        let bend = self.bounds[0].min(self.bounds[1] * far / 3.0 - self.curvature);
        far.min(near.max(self.above_zero(bend)))
    }

    /// The first root of the parabola that bends down by `bend`.
    #[inline(always)]
    fn above_zero(&self, bend: f64) -> f64 {
        let value = self.value.max(0.0);
        let square = self.slope * self.slope + 2.0 * bend * value;
        match self.slope > 0.0 {
            _ if square < 0.0 => f64::INFINITY,
            false if value == 0.0 => 0.0,
            true if bend <= 0.0 => f64::INFINITY,
            true => (self.slope + square.sqrt()) / bend,
            false => 2.0 * value / (square.sqrt() - self.slope),
        }
    }

    /// Whether it is zero after `step`, to a resolution in time.
    #[inline(always)]
    fn ends_at(&self, step: f64, resolution: f64) -> bool {
        let slope = self.slope + self.curvature * step;
        self.bounds[1] * step * step * step <= -slope * resolution
    }
}
