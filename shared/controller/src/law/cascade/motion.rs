//! The motion observer: place, speed and the force that stands against them.
//!
//! ```text
//! M v' = F - B v - Fc sgn(v) - d,   d' = 0              three poles at q, corrected by the middle of the count
//! e = n + 1/2 - (x + v + a/2),   x += v + a/2 + (1 - q^3) e,   v += a + 1.5 (1 - q)^2 (1 + q) e,   d -= (1 - q)^3 M/A e
//! ```
//!
//! F is the mean of the last two samples. Below 2 mm/s friction counts in proportion. A load that has not moved a count in 5 ms and
//! is slower than 10 mm/s is stuck: its force may be anything within the stiction, so nothing is learned of d. Its first count
//! says that it has slipped by half of one, v^2 = 2 a/2, and that it is 0.4 counts short of the middle of the new one.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | x | Q16, 64 bits | as the count |
//! | v, a | Q16 | 2^15 counts a sample |
//! | d | Q24 | -1 to 1 |
//! | e | Q16 | 2^15 counts, saturated |

use super::load::{self, Load};
use super::number::{ONE, product, ratio, root, scaled, within};
use crate::fixed::{quotient, saturate};
use crate::parameters::{Parameters, id};

/// Gains and thresholds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// 1 - q^3 and 1.5 (1 - q)^2 (1 + q), Q30; (1 - q)^3/A, Q28.
    place: i32,
    speed: i32,
    force: i32,
    /// 5 ms, samples; 10 mm/s, Q16.
    still: u32,
    slow: i32,
    /// 1/(2 mm/s), Q16 of a count a sample.
    per_creep: i32,
    /// 0.5 m/s^2, Q16.
    least_pull: i32,
}

/// What it knows at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Motion {
    /// x, Q16.
    pub x: i64,
    /// v, Q16.
    pub v: i32,
    /// d, Q24.
    pub d: i32,
    /// Whether the load is stuck.
    pub stuck: bool,
    /// Samples since its last count.
    pub still: u32,
    count: i32,
    last_force: i32,
}

impl Constants {
    /// `speed` is a m/s in counts a sample, Q16.
    pub(super) fn of(
        parameters: &Parameters,
        load: &load::Constants,
        period_us: u32,
        speed: i32,
    ) -> Constants {
        let q = parameters.scalar(id::CASCADE_MOTION_DECAY);
        let left = (1 << 30) - q;
        let cube = product(product(left, left, 30), left, 30);
        // (1 - q)^2 (1 + q), below 1.
        let damped = product(product(left, left, 30), (1 << 30) + q, 30);
        let creep = product(speed, 131, 16).max(1);
        Constants {
            place: (1 << 30) - product(product(q, q, 30), q, 30),
            speed: damped + (damped >> 1),
            force: product(cube, load.inertia, 26),
            still: 5000_u32.checked_div(period_us).unwrap_or(0),
            slow: product(speed, 655, 16),
            per_creep: ratio(1 << 32, u64::from(creep.unsigned_abs())).min(i32::MAX as u64) as i32,
            least_pull: quotient(u64::from(speed.unsigned_abs()) * u64::from(period_us), 2_000_000)
                .min(1 << 30) as i32,
        }
    }
}

impl Motion {
    /// A load at rest at a count, with this force (Q24) on it; d is within the stiction of it.
    pub(super) fn new(count: i32, force: i32, load: &Load, stiction: i32) -> Motion {
        let d = load.standing.min(force.saturating_add(stiction)).max(force.saturating_sub(stiction));
        Motion {
            x: middle(count),
            v: 0,
            d: within(d, ONE),
            stuck: true,
            still: 1000,
            count,
            last_force: force,
        }
    }

    /// A load that has gone this step to a count; d is what is known beforehand.
    pub(super) fn going(count: i32, step: i32, force: i32, load: &Load) -> Motion {
        let before = count.saturating_sub(step);
        Motion {
            x: middle(before),
            v: within(step, 1 << 14) << 16,
            d: within(load.standing, ONE),
            stuck: false,
            still: 0,
            count: before,
            last_force: force,
        }
    }

    /// The count of the last sample.
    pub(super) fn count(&self) -> i32 {
        self.count
    }

    /// Takes a sample; returns the step of the count.
    pub(super) fn observe(
        &mut self,
        constants: &Constants,
        of_load: &load::Constants,
        load: &Load,
        count: i32,
        force: i32,
    ) -> i32 {
        let mean = force.saturating_add(self.last_force) >> 1;
        let step = count.saturating_sub(self.count);
        (self.last_force, self.count) = (force, count);
        self.still = if step == 0 { self.still.saturating_add(1) } else { 0 };
        if self.stuck {
            (self.x, self.v) = (middle(count), 0);
            if step != 0 {
                self.slip(constants, of_load, load, step.signum(), force);
            }
        } else if self.still > constants.still && self.v.saturating_abs() < constants.slow {
            (self.stuck, self.v) = (true, 0);
        } else {
            self.follow(constants, of_load, load, middle(count), mean);
        }
        step
    }

    fn slip(&mut self, constants: &Constants, of_load: &load::Constants, load: &Load, sign: i32, force: i32) {
        self.stuck = false;
        let pull = load.accelerated(
            of_load,
            force.saturating_sub(self.d).saturating_sub(load.slide(of_load, sign)).saturating_mul(sign),
        );
        // Q16 of v^2 is Q8 of v: 2^6 more before the root.
        let pull = pull.max(constants.least_pull) as u32;
        let speed = if pull < 1 << 20 { root(pull << 12) << 2 } else { root(pull) << 8 };
        self.v = sign * speed as i32;
        self.x -= i64::from(sign) * 26_214;
    }

    fn follow(
        &mut self,
        constants: &Constants,
        of_load: &load::Constants,
        load: &Load,
        place: i64,
        force: i32,
    ) {
        // min(|v|/creep, 1) of the friction.
        let share = product(within(self.v, 1 << 24), constants.per_creep, 16);
        let rubbed =
            scaled(load.slide(of_load, self.v.signum()), within(share.saturating_abs(), 1 << 16), 16);
        let pull = force.saturating_sub(load.drag(self.v)).saturating_sub(rubbed).saturating_sub(self.d);
        let a = load.accelerated(of_load, pull);
        let expected = self.x.wrapping_add(i64::from(self.v) + i64::from(a >> 1));
        let error = saturate(place.wrapping_sub(expected));
        self.x = expected.wrapping_add(i64::from(scaled(error, constants.place, 30)));
        self.v = self.v.saturating_add(a).saturating_add(product(error, constants.speed, 30));
        let wrong = product(product(error, constants.force, 20), load.mass, 16);
        self.d = within(self.d.saturating_sub(wrong), ONE);
    }

    /// Whether the force that stands against it is at a bound.
    pub(super) fn is_at_bound(&self) -> bool {
        self.d.saturating_abs() >= ONE
    }

    /// The acceleration that it has, counts a sample squared, Q16.
    pub(super) fn acceleration(&self, of_load: &load::Constants, load: &Load, force: i32) -> i32 {
        if self.stuck {
            return 0;
        }
        let rubbed = load.slide(of_load, self.v.signum());
        let pull = force.saturating_sub(load.drag(self.v)).saturating_sub(rubbed).saturating_sub(self.d);
        load.accelerated(of_load, pull)
    }
}

/// The middle of a count, Q16.
pub(super) fn middle(count: i32) -> i64 {
    (i64::from(count) << 16) + (1 << 15)
}
