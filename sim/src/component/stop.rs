//! Mechanical stops at both ends of a travel (thesis 6.2.2, C(89), C(90), C(91)).
//!
//! ```text
//! L_e = max(0, K p + c p' min(p / d, 1)),   c = 2 zeta sqrt(K M)
//! ```
//!
//! p is the penetration, and d the region over which the damping sets in: the force is continuous at contact and
//! never adhesive (the thesis's text is lost; EQUATIONS section 6). Load and spool share this file.

use crate::key::keys;
use crate::values::Rig;

keys! {
    STOP_STIFFNESS_N_PER_M: f64 = number("load.stop_stiffness_n_per_m", 1e6, 1.0, 1e12, "C(90)", "Stiffness of the end stops.");
    STOP_REGION_M: f64 = number("load.stop_region_m", 0.001, 1e-9, 1.0, "C(89)", "Penetration at which the stops' damping is full.");
    STOP_DAMPING_RATIO: f64 = number("load.stop_damping_ratio", 0.5, 0.0, 10.0, "", "Damping ratio of the end stops.");
}

impl Stops {
    /// The end stops of a rig's load of this mass (kg) along a stroke (m).
    #[must_use]
    pub fn of_load(rig: &Rig, stroke: f64, mass: f64) -> Stops {
        Stops::new(
            0.0,
            stroke,
            rig.get(&keys::STOP_STIFFNESS_N_PER_M),
            rig.get(&keys::STOP_REGION_M),
            rig.get(&keys::STOP_DAMPING_RATIO),
            mass,
        )
    }
}

/// Two stops on a body of mass M.
#[derive(Clone, Copy, Debug)]
pub struct Stops {
    /// Position of the stop at the retracted end, m.
    pub low: f64,
    /// Position of the stop at the extended end, m.
    pub high: f64,
    /// K, N/m.
    pub stiffness: f64,
    /// d, m.
    pub region: f64,
    /// c, N s/m.
    pub damping: f64,
}

/// Which stop a body is in contact with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Between the stops.
    Free,
    /// In the retracted stop.
    Low,
    /// In the extended stop.
    High,
}

impl Stops {
    /// Stops at `low` and `high` (m) with a damping ratio for the body's mass (kg).
    #[must_use]
    pub fn new(low: f64, high: f64, stiffness: f64, region: f64, damping_ratio: f64, mass_kg: f64) -> Stops {
        Stops { low, high, stiffness, region, damping: 2.0 * damping_ratio * (stiffness * mass_kg).sqrt() }
    }

    /// Which side a body at `position` is on.
    #[must_use]
    pub fn side(&self, position: f64) -> Side {
        if position < self.low {
            Side::Low
        } else if position > self.high {
            Side::High
        } else {
            Side::Free
        }
    }

    /// The force on the body, N, positive in the positive direction.
    #[must_use]
    pub fn force(&self, side: Side, position: f64, velocity: f64) -> f64 {
        match side {
            Side::Free => 0.0,
            Side::Low => self.push(self.low - position, -velocity),
            Side::High => -self.push(position - self.high, velocity),
        }
    }

    fn push(&self, penetration: f64, rate: f64) -> f64 {
        let damping = self.damping * rate * (penetration / self.region).min(1.0);
        (self.stiffness * penetration + damping).max(0.0)
    }

    /// The rate of the force, N/s; just after a contact begins, the rate in contact.
    #[must_use]
    pub(crate) fn force_rate(&self, side: Side, position: f64, velocity: f64, acceleration: f64) -> f64 {
        match side {
            Side::Free => 0.0,
            Side::Low => self.push_rate(self.low - position, -velocity, -acceleration),
            Side::High => -self.push_rate(position - self.high, velocity, acceleration),
        }
    }

    fn push_rate(&self, penetration: f64, rate: f64, rate_change: f64) -> f64 {
        let depth = penetration.max(0.0) / self.region;
        if self.stiffness * self.region * depth + self.damping * rate * depth.min(1.0) < 0.0 {
            return 0.0;
        }
        let setting_in = if depth < 1.0 { rate * rate / self.region } else { 0.0 };
        self.stiffness * rate + self.damping * (rate_change * depth.min(1.0) + setting_in)
    }

    /// Not negative as long as the body stays on this side.
    #[must_use]
    pub fn guard(&self, side: Side, position: f64) -> f64 {
        match side {
            Side::Free => (position - self.low).min(self.high - position),
            Side::Low => self.low - position,
            Side::High => position - self.high,
        }
    }

    /// The side after the guard has become negative at `position`.
    #[must_use]
    pub fn after(&self, side: Side, position: f64) -> Side {
        match side {
            Side::Low | Side::High => Side::Free,
            Side::Free if position - self.low < self.high - position => Side::Low,
            Side::Free => Side::High,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stops() -> Stops {
        Stops::new(0.0, 0.3, 1e6, 1e-3, 0.5, 1.6)
    }

    #[test]
    fn a_free_body_feels_nothing_and_a_pressed_one_is_pushed_back() {
        let stops = stops();
        assert_eq!(stops.force(Side::Free, 0.15, 1.0), 0.0);
        assert_eq!(stops.force(Side::Low, -1e-3, 0.0), 1000.0);
        assert_eq!(stops.force(Side::High, 0.301, 0.0).round(), -1000.0);
    }

    #[test]
    fn the_force_is_continuous_at_contact_and_never_pulls() {
        let stops = stops();
        assert!(stops.force(Side::Low, -1e-12, -3.0).abs() < 1e-4);
        assert_eq!(stops.force(Side::Low, -1e-4, 10.0), 0.0, "a body that leaves is not held");
    }

    #[test]
    fn the_rate_of_the_force_is_the_slope_of_the_force_along_a_motion() {
        let stops = stops();
        // Where the damping sets in, where it has set in, and where the body leaves unheld.
        for (side, start, velocity) in [
            (Side::Low, -2e-4, -0.3),
            (Side::Low, -2e-3, 0.1),
            (Side::High, 0.3004, 0.2),
            (Side::High, 0.3004, -5.0),
            (Side::Free, 0.1, 1.0),
        ] {
            let acceleration = 7.0;
            let at = |t: f64| {
                let position = start + velocity * t + 0.5 * acceleration * t * t;
                stops.force(side, position, velocity + acceleration * t)
            };
            let slope = (at(1e-7) - at(-1e-7)) / 2e-7;
            let rate = stops.force_rate(side, start, velocity, acceleration);
            assert!((rate - slope).abs() < 1e-6 * slope.abs() + 1e-3, "{side:?} {start}: {rate} {slope}");
        }
    }

    #[test]
    fn a_force_that_begins_grows_from_the_contact_on() {
        let stops = stops();
        let rate = stops.force_rate(Side::High, 0.3, 2.0, 0.0);
        let soon = stops.force(Side::High, 0.3 + 2e-9, 2.0) / 1e-9;
        assert!((rate / soon - 1.0).abs() < 1e-5, "{rate} {soon}");
    }

    #[test]
    fn contact_begins_and_ends_where_the_guard_says() {
        let stops = stops();
        assert_eq!(stops.side(-1e-9), Side::Low);
        assert_eq!(stops.after(Side::Free, 0.0), Side::Low);
        assert_eq!(stops.after(Side::Free, 0.3), Side::High);
        assert_eq!(stops.after(Side::High, 0.3), Side::Free);
        assert!(stops.guard(Side::High, 0.2999) < 0.0);
    }
}
