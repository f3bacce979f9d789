//! A land of a spool before the bore of its port: how far it opens over the spool.
//!
//! ```text
//! height        h = sqrt(z^2 + d^2),   d for z < 0               z: spool beyond the lap, d: clearance of spool and sleeve
//! conductance   t/sqrt(1 + t^2),   t = h/p                       in series with the port, which h = p is as wide as
//! so            C = that over what it is with the spool at its end,   z = sqrt((p r/sqrt(1 - r^2))^2 - d^2),   r = C r_end
//! ```
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | z | Q16 counts of command | 0 to 2^11 | 2^-4 count |
//! | h, d | Q4 | 0 to 2^11 | 2^-4 count |
//! | p | Q16 | 1 to 2^11 | |
//! | C, r | Q16 | 0 to 1 | 1e-3 |

use super::number::{product, ratio, root, steepened};
use crate::parameters::{Parameters, id};

/// 1 of a conductance.
const ONE: i32 = 1 << 16;
/// The largest place, and the largest height, Q4.
const FARTHEST: u32 = 1 << 15;
const WIDEST: u32 = 46_340;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Land {
    /// d, Q4.
    clearance: u32,
    /// p, Q16, and 1/p, Q28.
    port: i32,
    by_port: i32,
    /// r with the spool at its end, Q16, and 1/r.
    end: i32,
    by_end: i32,
    /// C with the spool beyond the other end.
    pub shut: i32,
}

/// Of a place in Q16, Q4.
fn coarse(z: i32) -> u32 {
    ((z.max(0) as u32) >> 12).min(FARTHEST)
}

impl Land {
    /// That of a valve which has one.
    pub(super) fn of(parameters: &Parameters) -> Option<Land> {
        let get = |id| parameters.scalar(id);
        let port = get(id::CASCADE_PORT);
        if port == 0 {
            return None;
        }
        let by_port = ratio(1 << 44, u64::from(port.unsigned_abs())).min(1 << 28) as i32;
        let clearance = coarse(get(id::CASCADE_CLEARANCE));
        let mut land = Land { clearance, port, by_port, end: ONE, by_end: ONE, shut: 0 };
        land.end = land.in_series(land.height(get(id::CASCADE_SPAN))).max(1 << 8);
        land.by_end = ratio(1 << 32, u64::from(land.end.unsigned_abs())) as i32;
        land.shut = land.conductance(0);
        Some(land)
    }

    /// h, Q4.
    fn height(&self, z: i32) -> u32 {
        let z = coarse(z);
        root(z * z + self.clearance * self.clearance)
    }

    /// r of a height, Q16.
    fn in_series(&self, height: u32) -> i32 {
        let t = product(height as i32, self.by_port, 16).min(1 << 24);
        let hypotenuse = steepened(t) - t;
        ratio(u64::from(t.unsigned_abs()) << 16, u64::from(hypotenuse.unsigned_abs())).min(1 << 16) as i32
    }

    /// C with the spool so far beyond the lap.
    pub(super) fn conductance(&self, z: i32) -> i32 {
        product(self.in_series(self.height(z)), self.by_end, 16).min(ONE)
    }

    /// How far beyond the lap the spool has to be for a conductance.
    pub(super) fn opening(&self, conductance: i32) -> i32 {
        let r = u64::from(product(conductance.clamp(0, ONE), self.end, 16).unsigned_abs());
        let left = root(((1_u64 << 32) - (r * r).min(1 << 32)).min(u32::MAX.into()) as u32).max(1);
        let t = ratio(r << 16, left.into()).min(1 << 24) as i32;
        let height = ((product(t, self.port, 16) >> 12) as u32).min(WIDEST);
        let square = (height * height).saturating_sub(self.clearance * self.clearance);
        (root(square) << 12) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A port of 560 counts, narrow and wide ones, clearances of none to a tenth of the travel.
    #[test]
    fn conductance_and_opening_are_their_equations_and_each_others_inverse() {
        for (port, clearance) in [(560, 20), (100, 0), (2000, 200), (40, 5)] {
            let mut parameters = Parameters::default();
            for (id, counts) in
                [(id::CASCADE_PORT, port), (id::CASCADE_CLEARANCE, clearance), (id::CASCADE_SPAN, 2048)]
            {
                parameters.set(id, counts << 16).expect("in range");
            }
            let land = Land::of(&parameters).expect("a port");
            let (p, d) = (f64::from(port), f64::from(clearance));
            let series = |z: f64| {
                let t = z.max(0.0).hypot(d) / p;
                t / t.hypot(1.0)
            };
            for z in [-300, 0, 3, 10, 50, 200, 700, 1500, 2048] {
                let exact = series(f64::from(z)) / series(2048.0);
                let found = land.conductance(z << 16);
                assert!((f64::from(found) / 65_536.0 - exact).abs() < 2e-3, "port {port}, {z}: {found}");
                let again = land.conductance(land.opening(found));
                // 2^-4 count of a land that opens by port and counts.
                let step = 130 + 65_536 / (8 * port) as u32;
                assert!(found.abs_diff(again) < step, "port {port}, {z}: {again}, not {found}");
            }
        }
        assert_eq!(Land::of(&Parameters::default()), None);
    }
}
