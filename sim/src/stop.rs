//! Mechanical stops at both ends of a travel (thesis 6.2.2, C(89), C(90), C(91)).
//!
//! ```text
//! L_e = max(0, K p + c p' min(p / d, 1)),   c = 2 zeta sqrt(K M)
//! ```
//!
//! p is the penetration, d the region over which the damping sets in: the force is continuous at
//! contact, and never adhesive (the thesis's text is lost; EQUATIONS section 6). Load and spool
//! share this file.

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
    fn contact_begins_and_ends_where_the_guard_says() {
        let stops = stops();
        assert_eq!(stops.side(-1e-9), Side::Low);
        assert_eq!(stops.after(Side::Free, 0.0), Side::Low);
        assert_eq!(stops.after(Side::Free, 0.3), Side::High);
        assert_eq!(stops.after(Side::High, 0.3), Side::Free);
        assert!(stops.guard(Side::High, 0.2999) < 0.0);
    }
}
