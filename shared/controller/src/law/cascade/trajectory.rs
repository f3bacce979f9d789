//! The trajectory: from any motion to rest at a target, or from a deviation to a profile.
//!
//! ```text
//! x = c0 + c1 s + ... + c7 s^7,   s = k/T               c0 to c2 by the motion it begins with, c4 to c7 by the rest it ends in
//! T = max(2.19 D/v, sqrt(7.5 D/a), (52.5 D/j)^(1/3), 6, 2 tau)       samples: of rest to rest, its largest speed is v, and so on
//! T = max(.., 5.05 v0/a, sqrt(26 v0/j))                 of a deviation from a profile, whose speed is v0, to none
//! T = max(0.94 v0/a, sqrt(2.89 v0/j), 6, 2 tau)         to a stop, D = v0 T/2: twice as hard as from rest to rest
//! ```
//!
//! To a stop it is v0 T (s - 5/2 s^4 + 3 s^5 - s^6) + x0, whose acceleration is -30 v0/T s^2 (1 - s)^2: it never turns. A load that is
//! too fast to end at its target without passing it is stopped first, and goes to it from there. It stops sooner than the trajectory that it was
//! on, which was for half of the deceleration, and so never goes beyond the target of that.
//!
//! From rest to rest it is D (35 s^4 - 84 s^5 + 70 s^6 - 20 s^7). An acceleration that it begins with counts up to 2 D/T^2; its jerk
//! does not.
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | c, x | Q16 counts, 64 bits | 2^48 | 4e-5 D |
//! | s | Q32 | 0 to 1 | T 2^-32 |
//! | T | samples | 6 to 2^17 | 1 |
//! | v, a | Q16 counts a sample | 2^15 | 2e-3 D/T, 2e-3 D/T^2 |
//! | j | Q24 counts | 2^7 | 4e-4 D/T^3 |

use super::number::{cube_root, part, ratio, root, within};
use crate::fixed::saturate;
use crate::profile::Point;

/// The longest travel, Q16 counts: two strokes.
const FARTHEST: i64 = 1 << 41;
/// The same, samples.
const LONGEST: u32 = 1 << 17;

/// Speed, acceleration (Q16) and jerk (Q24) of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Limits {
    pub speed: i32,
    pub acceleration: i32,
    pub jerk: i32,
    /// Samples.
    pub shortest: u32,
}

impl Limits {
    /// Whether a motion (Q16) goes farther than so many counts until it is stopped. Without a quotient: most do not.
    fn pass(&self, speed: i32, left: u32) -> bool {
        let (speed, left) = (u64::from(speed.unsigned_abs()), u64::from(left));
        let [a, j] = [self.acceleration, self.jerk].map(|limit| u64::from(limit.unsigned_abs()));
        // In Q8 and Q4: 15/16 v^2 > 2 D a, 2.887 v^3 > 4 D^2 j.
        let (fine, coarse) = (speed >> 8, speed >> 12);
        (speed * u64::from(self.shortest)) >> 17 > left
            || (fine * fine * 15) >> 5 > left * a
            || (coarse * coarse * coarse).saturating_mul(2956) > (left * left).saturating_mul(j)
    }
}

/// A trajectory, and how far along it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Trajectory {
    c: [i64; 8],
    /// s of the present sample, and of a sample, Q32.
    s: u32,
    step: u32,
    /// Samples since it began, and T.
    samples: u32,
    length: u32,
}

/// T.
fn length(distance: u32, limits: &Limits) -> u32 {
    let of = |factor: u64, bits: u32, limit: i32| {
        ratio((factor * u64::from(distance)) << bits, u64::from(limit.unsigned_abs()))
    };
    let by_speed = of(143_524, 0, limits.speed).min(LONGEST.into()) as u32;
    let by_force = root(of(491_520, 0, limits.acceleration).min(u32::MAX.into()) as u32);
    let by_flow = cube_root(of(3_440_640, 8, limits.jerk));
    by_speed.max(by_force).max(by_flow).saturating_add(1).max(limits.shortest).min(LONGEST)
}

/// Counts between two places (Q16).
fn distance(target: i64, from: i64) -> u32 {
    (target.wrapping_sub(from).clamp(-FARTHEST, FARTHEST).unsigned_abs() >> 16) as u32
}

impl Trajectory {
    /// Over before it began, at a place (Q16).
    pub(super) fn at_rest(x: i64) -> Trajectory {
        Trajectory { c: [x, 0, 0, 0, 0, 0, 0, 0], s: 0, step: 0, samples: 0, length: 0 }
    }

    /// From a motion to rest at a target (Q16).
    pub(super) fn to(target: i64, from: Point, limits: &Limits) -> Trajectory {
        Trajectory::after(target, from, length(distance(target, from.x), limits))
    }

    /// The same, as long as its place and its speed need: of a deviation from a profile, or from one that ends in motion.
    pub(super) fn slowing(target: i64, from: Point, limits: &Limits) -> Trajectory {
        let speed = u64::from(from.v.unsigned_abs());
        let of = |speed: u64, limit: i32| ratio(speed, u64::from(limit.unsigned_abs()));
        let by_force = of((speed * 331_000) >> 16, limits.acceleration).min(LONGEST.into()) as u32;
        let by_flow = root(of(speed * 6656, limits.jerk).min(u32::MAX.into()) as u32);
        let slowed = by_force.max(by_flow).saturating_add(1).min(LONGEST);
        Trajectory::after(target, from, length(distance(target, from.x), limits).max(slowed))
    }

    /// To the place where a motion can be stopped, if that lies beyond the target.
    pub(super) fn braking(target: i64, from: Point, limits: &Limits) -> Option<Trajectory> {
        let left = target.wrapping_sub(from.x);
        let is_behind = if from.v > 0 { left < 0 } else { left > 0 };
        (is_behind || limits.pass(from.v, distance(target, from.x)))
            .then(|| Trajectory::stopping(from, limits))
    }

    fn stopping(from: Point, limits: &Limits) -> Trajectory {
        let speed = u64::from(from.v.unsigned_abs());
        let of = |speed: u64, limit: i32| ratio(speed, u64::from(limit.unsigned_abs()));
        let by_force = of((speed * 61_440) >> 16, limits.acceleration).min(LONGEST.into()) as u32;
        let by_flow = root(of(speed * 739, limits.jerk).min(u32::MAX.into()) as u32);
        let length = by_force.max(by_flow).saturating_add(1).max(limits.shortest).min(LONGEST);
        let travel = (i64::from(from.v) * i64::from(length)) >> 1;
        Trajectory::after(from.x.wrapping_add(travel), from, length)
    }

    /// The same within so many samples.
    #[inline(never)]
    fn after(target: i64, from: Point, length: u32) -> Trajectory {
        let travel = target.wrapping_sub(from.x).clamp(-FARTHEST, FARTHEST);
        let distance = distance(target, from.x);
        let step = u32::MAX.checked_div(length).unwrap_or(0);
        let most = saturate(part(part((i64::from(distance) << 17) + (1 << 16), step), step));
        let t = i64::from(length);
        let c1 = i64::from(from.v) * t;
        let c2 = (i64::from(within(from.a, most)) * t * t) >> 1;
        let rest = [travel - c1 - c2, -c1 - 2 * c2, -2 * c2];
        // In halves.
        let sum = |factors: [i64; 3]| factors.iter().zip(&rest).map(|(f, r)| f * r).sum::<i64>() >> 1;
        let c4 = [[70, -30, 5], [-168, 78, -14], [140, -68, 13], [-40, 20, -4]].map(sum);
        let c = [from.x, c1, c2, 0, c4[0], c4[1], c4[2], c4[3]];
        Trajectory { c, s: 0, step, samples: 0, length }
    }

    /// Goes on by a sample.
    pub(super) fn advance(&mut self) {
        self.samples = self.samples.saturating_add(1);
        self.s = self.s.saturating_add(self.step);
    }

    /// Samples since it was over; none before.
    #[must_use]
    pub fn over(&self) -> Option<u32> {
        self.samples.checked_sub(self.length)
    }

    /// The point at this sample, without its jerk: the force loop needs that of a later one alone.
    #[must_use]
    pub fn now(&self) -> Point {
        if self.over().is_some() { self.end() } else { self.at::<false>(self.s) }
    }

    /// The point so many samples later, Q16.
    #[must_use]
    pub fn later(&self, samples: i32) -> Point {
        let ahead = (u64::from(self.step) * u64::from(samples.unsigned_abs())) >> 16;
        match u32::try_from(u64::from(self.s) + ahead) {
            Ok(s) if self.over().is_none() => self.at::<true>(s),
            _ => self.end(),
        }
    }

    fn end(&self) -> Point {
        Point { x: self.c.iter().sum(), ..Point::default() }
    }

    /// By Horner's rule, with the derivatives along; where it begins, by the motion that it has.
    fn at<const JERK: bool>(&self, s: u32) -> Point {
        if s == 0 {
            let ([c0, c1, c2, ..], t) = (self.c, self.step);
            return Point { x: c0, v: saturate(part(c1, t)), a: saturate(part(part(2 * c2, t), t)), j: 0 };
        }
        let [c0, rest @ .., c7] = self.c;
        let (mut x, mut v, mut a, mut j) = (c7, 0, 0, 0);
        for c in rest.into_iter().rev() {
            if JERK {
                j = part(j, s) + a;
            }
            a = part(a, s) + v;
            v = part(v, s) + x;
            x = part(x, s) + c;
        }
        if JERK {
            j = part(j, s) + a;
        }
        a = part(a, s) + v;
        v = part(v, s) + x;
        x = part(x, s) + c0;
        let t = self.step;
        Point {
            x,
            v: saturate(part(v, t)),
            a: saturate(part(part(2 * a, t), t)),
            j: saturate(part(part(part(6 * j, t), t) << 8, t)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn real(c: &[f64; 8], s: f64, t: f64) -> [f64; 4] {
        let mut p = [0.0; 4];
        for c in c.iter().rev() {
            p = [p[0] * s + c, p[1] * s + p[0], p[2] * s + p[1], p[3] * s + p[2]];
        }
        [p[0], p[1] / t, 2.0 * p[2] / (t * t), 6.0 * p[3] / (t * t * t)]
    }

    fn limits(shortest: u32) -> Limits {
        Limits { speed: 100 << 16, acceleration: 2 << 16, jerk: 1 << 21, shortest }
    }

    /// From rest and in motion, to both sides, over all of its samples.
    #[test]
    fn a_trajectory_is_its_polynomial_and_ends_at_its_target() {
        let mut worst = [0.0_f64; 4];
        for target in [6000, -6000, 1, -30, 200_000] {
            for (v, a) in [(0.0_f64, 0.0_f64), (40.0, 0.5), (-12.5, -1.0)] {
                for shortest in [6, 130, 4000] {
                    let from =
                        Point { x: 777 << 16, v: (v * 65_536.0) as i32, a: (a * 65_536.0) as i32, j: 0 };
                    let mut trajectory = Trajectory::to((777 + target) << 16, from, &limits(shortest));
                    let t = f64::from(trajectory.length);
                    let d = target as f64;
                    let most = (2.0 * d.abs() + 1.0) / t / t;
                    let (c1, c2) = (v * t, a.clamp(-most, most) * t * t / 2.0);
                    let r = [d - c1 - c2, -c1 - 2.0 * c2, -2.0 * c2];
                    let sum = |k: [f64; 3]| (0..3).map(|i| k[i] * r[i]).sum::<f64>();
                    let c4 =
                        [[35.0, -15.0, 2.5], [-84.0, 39.0, -7.0], [70.0, -34.0, 6.5], [-20.0, 10.0, -2.0]]
                            .map(sum);
                    let c = [777.0, c1, c2, 0.0, c4[0], c4[1], c4[2], c4[3]];
                    while trajectory.over().is_none() {
                        let expected = real(&c, f64::from(trajectory.samples) / t, t);
                        let p = trajectory.now();
                        let seen = [
                            p.x as f64 / 65_536.0,
                            f64::from(p.v) / 65_536.0,
                            f64::from(p.a) / 65_536.0,
                            f64::from(trajectory.later(0).j) / 16_777_216.0,
                        ];
                        for i in 0..4 {
                            // Of the largest there is: a trajectory of 200,000 counts in 4000 samples has 1e-3 counts.
                            let scale = (d.abs() + c1.abs() + 1.0) / t.powi(i as i32);
                            worst[i] = worst[i].max((seen[i] - expected[i]).abs() / scale.max(1e-2));
                        }
                        trajectory.advance();
                    }
                    assert_eq!(
                        trajectory.now(),
                        Point { x: (777 + target) << 16, ..Point::default() }.rounded(trajectory.now().x)
                    );
                }
            }
        }
        assert!(worst[0] < 4e-5 && worst[1] < 2e-3 && worst[2] < 2e-3 && worst[3] < 4e-4, "{worst:?}");
    }

    impl Point {
        /// Within 2^-14 counts of where it ends: halves are rounded down.
        fn rounded(self, x: i64) -> Point {
            if (self.x - x).abs() <= 4 { Point { x, ..self } } else { self }
        }
    }

    /// 5.05 v0/a where the force is the limit, sqrt(26 v0/j) where the flow is.
    #[test]
    fn a_deviation_at_speed_gets_the_time_that_its_speed_needs() {
        for (speed, acceleration, jerk) in
            [(100, 2.0, 128.0), (100, 2.0, 0.02), (3, 0.5, 1.0), (20_000, 0.1, 1.0)]
        {
            let limits = Limits {
                acceleration: (acceleration * 65_536.0) as i32,
                jerk: (jerk * 16_777_216.0) as i32,
                ..limits(6)
            };
            for sign in [1, -1] {
                let from = Point { v: (sign * speed) << 16, ..Point::default() };
                let speed = f64::from(speed);
                let exact =
                    (5.05 * speed / acceleration).max((26.0 * speed / jerk).sqrt()).clamp(6.0, 131_072.0);
                let length = f64::from(Trajectory::slowing(0, from, &limits).length);
                assert!((length - exact).abs() <= 2.0 + 1e-3 * exact, "{speed}: {length} instead of {exact}");
            }
        }
    }

    /// Stopped, a motion slows down all the way, within twice the limits; where it can end at its target it is not stopped.
    #[test]
    fn a_stop_is_as_short_as_it_can_be_and_only_where_the_target_is_passed() {
        let limits = limits(6);
        for v in [90, -90, 40, -12] {
            let from = Point { x: 777 << 16, v: v << 16, a: 0, j: 0 };
            let sign = i64::from(v.signum());
            let mut trajectory =
                Trajectory::braking(from.x, from, &limits).expect("the target is where it is");
            let distance = (trajectory.end().x - from.x) * sign;
            let by_force = 0.94 * f64::from(v.abs()) / 2.0;
            assert!(
                f64::from(trajectory.length) >= by_force
                    && f64::from(trajectory.length) < 2.5 * by_force + 8.0
            );
            let mut last = from;
            while trajectory.over().is_none() {
                let p = trajectory.now();
                assert!(
                    (p.x - last.x) * sign >= -8 && p.v * (sign as i32) <= last.v * (sign as i32) + 64,
                    "{p:?}"
                );
                assert!(p.a.abs() <= 2 * limits.acceleration + limits.acceleration / 20, "{p:?}");
                last = p;
                trajectory.advance();
            }
            let beyond = |more: i64| from.x + sign * (distance + more);
            assert!(Trajectory::braking(beyond(-distance / 8), from, &limits).is_some());
            assert!(Trajectory::braking(beyond(distance / 8), from, &limits).is_none());
            assert!(Trajectory::braking(beyond(1 << 30), from, &limits).is_none());
            assert!(Trajectory::braking(from.x - sign * (1 << 30), from, &limits).is_some(), "it is behind");
        }
    }

    #[test]
    fn a_trajectory_keeps_its_limits() {
        for distance in [1, 30, 6000, 60_000, 1 << 24] {
            let limits = limits(6);
            let mut trajectory = Trajectory::to(i64::from(distance) << 16, Point::default(), &limits);
            while trajectory.over().is_none() && trajectory.length < 20_000 {
                let p = trajectory.now();
                assert!(
                    p.v <= limits.speed + limits.speed / 500
                        && p.a.abs() <= limits.acceleration + limits.acceleration / 100
                );
                let jerk = trajectory.later(0).j.abs();
                assert!(
                    jerk <= limits.jerk + limits.jerk / 50 || trajectory.length == 6,
                    "{distance}: {jerk}"
                );
                trajectory.advance();
            }
        }
    }
}
