//! A land of a spool before the bore of its port: how far it opens over the spool.
//!
//! ```text
//! height        h^2 = z^2 + d^2,   d^2 for z < 0                 z: spool beyond the lap, d: clearance of spool and sleeve
//! conductance   r^2 = h^2/(h^2 + p^2)                            in series with the port, which h = p is as wide as
//! so            C = r over what it is with the spool at its end, r_end
//! opening       of the part g = m/X of a side (`tubes`):   C^2 = g^2/(1 - 2 k g)
//! so            h^2 = p^2 (r_end g)^2/(1 - 2 k g - (r_end g)^2),   z = sqrt(h^2 - d^2)
//! ```
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | z | Q16 counts of command | 0 to 2^11 | 2^-4 count |
//! | h^2, d^2, p^2 | Q8 | 0 to 2^22 | |
//! | r^2 | Q30 | 0 to 1 | 6e-5 of it |
//! | C | Q16 | 0 to 1 | 5e-4 |
//! | g | Q31 | 0 to 1 | 6e-5 of it |

use super::number::{high, over, root};
use crate::parameters::{Parameters, id};

/// 1 of a conductance.
const ONE: u32 = 1 << 16;
/// The largest place, Q4.
const FARTHEST: u32 = (1 << 15) - 1;
/// The smallest r_end^2, Q30.
const LEAST: u32 = 1 << 14;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Land {
    /// d^2 and p^2, Q8.
    clearance: u32,
    port: u32,
    /// r_end^2, Q30, and 1/r_end, Q16.
    end: u32,
    by_end: u32,
    /// z with the spool at its end, Q16.
    pub span: i32,
    /// C with the spool beyond the other end.
    pub shut: u32,
}

/// Of a place in Q16, the square in Q8.
fn square(z: i32) -> u32 {
    let z = ((z.max(0) as u32) >> 12).min(FARTHEST);
    z * z
}

impl Land {
    /// That of a valve which has one.
    pub(super) fn of(parameters: &Parameters) -> Option<Land> {
        let get = |id| parameters.scalar(id);
        let port = get(id::CASCADE_PORT);
        if port == 0 {
            return None;
        }
        let (clearance, port) = (square(get(id::CASCADE_CLEARANCE)), square(port).max(1));
        let span = get(id::CASCADE_SPAN);
        let mut land = Land { clearance, port, end: LEAST, by_end: ONE, span, shut: 0 };
        land.end = land.in_series(span).max(LEAST);
        land.by_end = over(1 << 16, root(land.end << 2), 16);
        land.shut = land.conductance(0);
        Some(land)
    }

    /// r^2 of a place, Q30.
    #[inline(always)]
    fn in_series(&self, z: i32) -> u32 {
        let height = square(z) + self.clearance;
        over(height, height + self.port, 30).min((1 << 30) - 1)
    }

    /// C with the spool so far beyond the lap.
    #[inline(always)]
    pub(super) fn conductance(&self, z: i32) -> u32 {
        high(root(self.in_series(z) << 2).min(ONE - 1) << 16, self.by_end).min(ONE)
    }

    /// How far beyond the lap the spool has to be for a part (Q31) of the flow without tubes; `twice`: 2 k of that, Q16.
    #[inline(always)]
    pub(super) fn opening(&self, part: u32, twice: u32) -> i32 {
        let part = part.min(1 << 31);
        // Both Q30.
        let r = high(self.end << 2, high(part, part));
        let shut = r + (high(twice << 11, part) << 4);
        let height = over(high(self.port << 2, r << 2), (1_u32 << 30).saturating_sub(shut), 28);
        (root(height.saturating_sub(self.clearance)) << 12) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::cascade::tubes::Side;

    fn land(port: i32, clearance: i32) -> Land {
        let mut parameters = Parameters::default();
        for (id, counts) in
            [(id::CASCADE_PORT, port), (id::CASCADE_CLEARANCE, clearance), (id::CASCADE_SPAN, 2048)]
        {
            parameters.set(id, counts << 16).expect("in range");
        }
        Land::of(&parameters).expect("a port")
    }

    /// A port of 560 counts, narrow and wide ones, clearances of none to a tenth of the travel.
    const LANDS: [(i32, i32); 4] = [(560, 20), (100, 0), (2000, 200), (40, 5)];

    #[test]
    fn conductance_is_its_equation() {
        for (port, clearance) in LANDS {
            let land = land(port, clearance);
            let (p, d) = (f64::from(port), f64::from(clearance));
            let series = |z: f64| {
                let t = z.max(0.0).hypot(d) / p;
                t / t.hypot(1.0)
            };
            for z in [-300, 0, 3, 10, 50, 200, 700, 1500, 2047] {
                let exact = series(f64::from(z)) / series(2048.0);
                let found = f64::from(land.conductance(z << 16)) / 65_536.0;
                assert!((found - exact).abs() < 5e-4, "port {port}, {z}: {found}, not {exact}");
            }
        }
        assert_eq!(Land::of(&Parameters::default()), None);
    }

    /// With tubes from none to narrow ones.
    #[test]
    fn an_opening_lets_through_what_it_is_for() {
        const FLOW: i32 = 1 << 22;
        for ((port, clearance), narrow) in
            LANDS.into_iter().flat_map(|land| [1.0, 1.2, 2.5, 6.0].map(|narrow| (land, narrow)))
        {
            let land = land(port, clearance);
            let side = Side::new(FLOW, (f64::from(FLOW) / narrow) as i32, land.shut);
            for z in [3, 10, 50, 200, 700, 1500] {
                let flow = side.through(land.conductance(z << 16));
                let again = side.through(land.conductance(land.opening((flow as u32) << 9, side.twice)));
                // 2^-4 count of a land that opens by port and counts.
                let step = FLOW as u32 / 500 + FLOW as u32 / (8 * port) as u32;
                assert!(flow.abs_diff(again) < step, "port {port}, w {narrow}, {z}: {again}, not {flow}");
            }
        }
    }
}
