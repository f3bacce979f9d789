//! The force loop: the rate of the force that keeps the load on its trajectory, or holds it.
//!
//! ```text
//! wanted      Fw = M/A (a_r + 2 p e' + p^2 e) + B v_r + Ff + d                 within 0.8 (1 - Pe) of the smaller area
//! rate        g  = M/A j_s + B a_s + f (Fw - F) + K (v + v_s - v_r) - g_unknown
//! ```
//!
//! Ff: friction, Fc sgn(v_s). Along a profile its sign is that of another dead time later: the valve takes one to answer, the force another
//! to follow. A load that a profile leaves behind is pushed with 3/4 of the stiction, since all of it makes a load jump whose friction is
//! low; what that lacks, the error adds. One that is moved once more to its target is pushed with all of it.
//!
//! r: the reference now; s: the reference a dead time later, when the valve will have answered. M, B, Fc, K: [`super::load`] and
//! [`super::air`]. The unit of g is force a sample (Q24); poles f and p are Q16 a sample, by the
//! dead time that [`super::lag`] has learned. [`super::rest`] has what holds a load at rest.

use super::air::{self, Air};
use super::load::{self, Load};
use super::motion::Motion;
use super::number::{ONE, product, within};
use crate::fixed::saturate;
use crate::parameters::{Parameters, id};
use crate::profile::Point;

/// Poles and limits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// f, p in Q16.
    force_pole: i32,
    position_pole: i32,
    /// Largest wanted force.
    most: i32,
}

/// A sample as the loop sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    pub load: &'a Load,
    pub of_load: &'a load::Constants,
    pub motion: &'a Motion,
    pub air: &'a Air,
    /// F, Q24.
    pub force: i32,
    /// The poles over those by the rig file, Q16.
    pub swift: i32,
}

impl Constants {
    pub(super) fn of(parameters: &Parameters, air: &air::Constants) -> Constants {
        let get = |id| parameters.scalar(id);
        let pull = product(ONE - air.exhaust, air.ratio, 24);
        Constants {
            force_pole: get(id::CASCADE_FORCE_POLE),
            position_pole: get(id::CASCADE_POSITION_POLE),
            most: product(pull, 52_429, 16),
        }
    }

    /// Fw on a trajectory, with this friction.
    pub(super) fn wanted(&self, seen: &Seen, now: &Point, friction: i32) -> i32 {
        let Seen { load, of_load, motion, .. } = seen;
        let late = now.v.saturating_sub(motion.v);
        let short = saturate(now.x.wrapping_sub(motion.x));
        let pole = product(self.position_pole, seen.swift, 16);
        let fed_back = product(late, pole, 15).saturating_add(product(short, product(pole, pole, 2), 30));
        let inertia = product(load.inertia(of_load), now.a.saturating_add(fed_back), 16);
        let sum = inertia.saturating_add(load.drag(now.v)).saturating_add(friction).saturating_add(motion.d);
        within(sum, self.most)
    }

    /// g on a trajectory, without what is unknown.
    pub(super) fn rate(&self, seen: &Seen, now: &Point, soon: &Point, wanted: i32) -> i32 {
        let Seen { load, of_load, motion, air, force, .. } = seen;
        let speed = motion.v.saturating_add(soon.v).saturating_sub(now.v);
        product(load.inertia(of_load), soon.j, 24)
            .saturating_add(load.drag(soon.a))
            .saturating_add(self.approach(wanted, *force, seen.swift))
            .saturating_add(product(air.stiffness, speed, 22))
    }

    /// f (Fw - F).
    pub(super) fn approach(&self, wanted: i32, force: i32, swift: i32) -> i32 {
        product(wanted.saturating_sub(force), product(self.force_pole, swift, 16), 16)
    }
}
