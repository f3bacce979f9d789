//! What the law knows of its drive, by its parameters.

use super::kept::Kept;
use super::number::{product, samples};
use super::trajectory::Limits;
use super::{air, doubt, flow, force, lag, load, motion, rest, sensor, valve};
use crate::choice::Adapt;
use crate::fixed::quotient;
use crate::parameters::{Parameters, id};

/// What it knows of its drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    pub(super) air: air::Constants,
    pub(super) motion: motion::Constants,
    pub(super) flow: flow::Constants,
    pub(super) load: load::Constants,
    pub(super) lag: lag::Constants,
    pub(super) force: force::Constants,
    pub(super) rest: rest::Constants,
    pub(super) sensor: sensor::Constants,
    pub(super) valve: valve::Constants,
    pub(super) doubt: doubt::Constants,
    /// Speed and acceleration of its own trajectories, Q16; the part of the flow for their jerk, Q16; their shortest time, samples.
    pub(super) trajectory: [i32; 3],
    pub(super) shortest: u32,
    /// 8 ms, samples, and 20 mm/s, Q16: a trajectory is late.
    pub(super) late: u32,
    pub(super) moving: i32,
    /// 100 mm/s, Q16: a load that is too fast for its target is stopped first.
    pub(super) fast: i32,
    /// 0.5 mm, counts: a load that is so near to an end of the stroke may press on it.
    pub(super) near_end: i32,
    /// Whether a run begins with what the last one learned, and that; otherwise what the rig file says.
    pub(super) keeps: bool,
    pub(super) kept: Kept,
}

impl Settings {
    pub(crate) fn of(parameters: &Parameters) -> Settings {
        let get = |id| parameters.scalar(id);
        let period_us = get(id::PERIOD_US).unsigned_abs();
        let count_pm = u64::from(get(id::ENCODER_PM_PER_COUNT).unsigned_abs());
        // A m/s, counts a sample in Q16: up to 10^5 us times 10^6.
        let speed = quotient((u64::from(period_us) * 1_000_000) << 16, count_pm).clamp(1, 1 << 30) as i32;
        let air = air::Constants::of(parameters);
        let load = load::Constants::of(parameters, period_us, speed);
        let dead_time = get(id::CASCADE_DEAD_TIME).unsigned_abs();
        let keeps = Adapt::of(get(id::ADAPT)) == Adapt::Kept;
        Settings {
            motion: motion::Constants::of(parameters, &load, period_us, speed),
            flow: flow::Constants::of(parameters),
            lag: lag::Constants::of(parameters, load.certainty),
            force: force::Constants::of(parameters, &air),
            sensor: sensor::Constants::of(parameters),
            valve: valve::Constants::of(parameters),
            doubt: doubt::Constants::of(parameters, period_us, count_pm),
            rest: rest::Constants::of(parameters, period_us, count_pm, speed),
            trajectory: [
                get(id::CASCADE_WAY_SPEED),
                get(id::CASCADE_WAY_ACCELERATION),
                get(id::CASCADE_WAY_FLOW),
            ],
            shortest: ((2 * dead_time) >> 16).saturating_add(1).max(6),
            late: samples(8000, period_us),
            moving: product(speed, 1311, 16),
            fast: product(speed, 6554, 16),
            near_end: quotient(500_000_000, count_pm) as i32,
            keeps,
            kept: if keeps { Kept::of(parameters) } else { Kept::default() },
            air,
            load,
        }
    }

    /// Takes over what is kept.
    pub(crate) fn learn(&mut self, learned: &Settings) {
        self.kept = learned.kept;
    }

    /// Whether these are of another drive, or keep other things: what the other ones have learned is no part of them.
    pub(crate) fn differ_but_for_what_is_kept(&self, other: &Settings) -> bool {
        Settings { kept: self.kept, ..other.clone() } != *self
    }

    /// The limits of a trajectory about a place (counts) with a mass (1/M, Q16): the jerk is that of the flow at three fifths of the supply.
    pub(super) fn limits(&self, x: i32, by_mass: i32) -> Limits {
        let rate = product(self.air.slower(x), self.trajectory[2], 16);
        let [speed, acceleration, _] = self.trajectory;
        Limits {
            speed,
            acceleration: product(acceleration, by_mass, 16).max(1),
            jerk: product(product(rate, self.load.acceleration, 16), by_mass, 16).max(1),
            shortest: self.shortest,
        }
    }
}
