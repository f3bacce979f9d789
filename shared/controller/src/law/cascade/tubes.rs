//! Tubes between supply, valve and cylinder: what they leave of the flow.
//!
//! ```text
//! a path        m^2/x^2 + m/M = 1,   1/M = (a + b/(y - 1))/c             x: its flow without tubes, M: that of the tubes alone
//! so            m = x/(sqrt(1 + u^2) + u),   u = x/(2 M) = phi (a + b/(y - 1))/2
//! y             1/P of a chamber that fills, P/Pe of one that empties
//! narrow        w = (sum of x)/(sum of m),   k = (w - 1/w)/2                  of both paths that the open valve opens
//! less open     m(C) = E w C/(sqrt(1 + (k C)^2) + k C)                        C: part of the conductance that is open
//! so            C = q/sqrt(w^2 - q (w^2 - 1)),   q = m/E
//! ```
//!
//! A restriction loses pressure with the square of its flow, a tube here in proportion to it. The quadratic has both limits, and the
//! curves of a tube that chokes nothing in between: a and b are those that fit the open valve. E: rate of the force with the valve open.
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | x, m | Q24 force a sample | 0 to 16 | 4e-3 of it |
//! | a, b | Q16 | 0 to 256 | |
//! | w | Q16 | 1 to 16 | 1e-3 of it |
//! | C, q | Q16 | 0 to 1 | 2e-3 |

use super::number::{ONE, product, ratio, root, steepened};
use crate::parameters::{Parameters, id};

/// An open path: phi, and the rate of the force by it, Q24.
pub(super) struct Path {
    pub up: i32,
    pub flow: i32,
}

/// w without tubes.
pub(super) const WIDE: i32 = 1 << 16;
/// The largest w, Q16.
const NARROWEST: u64 = 16 << 16;
/// The largest 1/(y - 1), Q16.
const NEAREST: u64 = 1 << 24;

/// The tubes on the way from the supply, and on that to the exhaust.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Tubes {
    supply: Tube,
    exhaust: Tube,
}

/// a and b, Q16.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Tube {
    choked: i32,
    slight: i32,
}

/// Flow without and with tubes, Q24 force a sample.
#[derive(Clone, Copy)]
pub(super) struct Flows {
    without: i32,
    pub with: i32,
}

impl Tubes {
    /// Those of a drive that has some.
    pub(super) fn of(parameters: &Parameters) -> Option<Tubes> {
        let get = |id| parameters.scalar(id);
        let tube = |choked, slight| Tube { choked: get(choked), slight: get(slight) };
        let tubes = Tubes {
            supply: tube(id::CASCADE_TUBE_SUPPLY_CHOKED, id::CASCADE_TUBE_SUPPLY_SLIGHT),
            exhaust: tube(id::CASCADE_TUBE_EXHAUST_CHOKED, id::CASCADE_TUBE_EXHAUST_SLIGHT),
        };
        (tubes.supply.slight > 0 || tubes.exhaust.slight > 0).then_some(tubes)
    }

    /// Into a chamber at a pressure, Q24.
    pub(super) fn fill(&self, path: &Path, pressure: i32) -> Flows {
        self.supply.left(path, pressure, ONE - pressure)
    }

    /// Out of it.
    pub(super) fn vent(&self, path: &Path, pressure: i32, exhaust: i32) -> Flows {
        self.exhaust.left(path, exhaust, pressure - exhaust)
    }
}

impl Tube {
    /// What it leaves of a path from a pressure that is `drop` above `low`.
    fn left(&self, path: &Path, low: i32, drop: i32) -> Flows {
        let (low, drop) = (u64::from(low.unsigned_abs()), drop.max(0));
        let near = ratio(low << 16, u64::from(drop.unsigned_abs())).min(NEAREST) as i32;
        let lost = self.choked.saturating_add(product(self.slight, near, 16));
        let bend = steepened(product(path.up, lost, 25));
        let with = ratio(u64::from(path.flow.unsigned_abs()) << 16, u64::from(bend.unsigned_abs()));
        Flows { without: path.flow, with: with.min(i32::MAX as u64) as i32 }
    }
}

impl Flows {
    /// Both paths that a valve opens.
    pub(super) fn and(self, other: Flows) -> Flows {
        Flows {
            without: self.without.saturating_add(other.without),
            with: self.with.saturating_add(other.with),
        }
    }

    /// w, Q16.
    pub(super) fn narrow(self) -> i32 {
        let w = ratio(u64::from(self.without.unsigned_abs()) << 16, u64::from(self.with.unsigned_abs()));
        w.clamp(WIDE as u64, NARROWEST) as i32
    }
}

/// m(C) of a rate with the valve open, Q24; C in Q16.
pub(super) fn rate(open: i32, narrow: i32, part: i32) -> i32 {
    if narrow <= WIDE {
        return product(open, part, 16);
    }
    let by_narrow = ratio(1 << 32, u64::from(narrow.unsigned_abs())) as i32;
    let bend = steepened(product((narrow - by_narrow) / 2, part, 16));
    // w C/(sqrt(..) + k C), Q16.
    let part =
        ratio(u64::from(product(narrow, part, 16).unsigned_abs()) << 16, u64::from(bend.unsigned_abs()));
    product(open, part.min(1 << 16) as i32, 16)
}

/// C of a part of the rate with the valve open, both Q16.
pub(super) fn part(narrow: i32, of_rate: i32) -> i32 {
    if narrow <= WIDE {
        return of_rate;
    }
    // w^2 in Q22: at most 2^30.
    let square = product(narrow, narrow, 10);
    let left = square - product(of_rate, square - (1 << 22), 16);
    let root = u64::from(root(left.unsigned_abs()).max(1));
    ratio(u64::from(of_rate.unsigned_abs()) << 11, root).min(1 << 16) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn q16(value: i32) -> f64 {
        f64::from(value) / 65_536.0
    }

    /// Half open and fully open valves before tubes from wide to narrow, and back again.
    #[test]
    fn a_part_of_the_rate_is_that_of_its_conductance() {
        for narrow in [1.0_f64, 1.01, 1.5, 2.5, 6.0, 16.0] {
            let w = (narrow * 65_536.0) as i32;
            for open in [0.0, 0.01, 0.1, 0.3, 0.7, 1.0] {
                let k: f64 = 0.5 * (narrow - 1.0 / narrow) * open;
                let exact = narrow * open / (k.hypot(1.0) + k);
                let found = f64::from(rate(ONE, w, (open * 65_536.0) as i32)) / f64::from(ONE);
                assert!((found - exact).abs() < 2e-3, "w {narrow}, {open}: {found}, not {exact}");
                let back = q16(part(w, (exact * 65_536.0) as i32));
                assert!((back - open).abs() < 3e-3, "w {narrow}: {back}, not {open}");
            }
        }
    }

    /// The quadratic at any pressure, its limits among them: no drop, and a chamber that is empty.
    #[test]
    fn what_a_tube_leaves_is_the_root_of_its_quadratic() {
        let tube = Tube { choked: 65_536, slight: 2 << 16 };
        let tubes = Tubes { supply: tube.clone(), exhaust: tube };
        for pressure in [1, ONE / 20, ONE / 3, ONE / 2, ONE - ONE / 50, ONE, ONE + ONE / 9] {
            let path = Path { up: ONE / 2, flow: ONE / 40 };
            let p = f64::from(pressure) / f64::from(ONE);
            let near = (p / (1.0 - p).max(1e-9)).min(256.0);
            let u = 0.25 * (1.0 + 2.0 * near);
            let exact = f64::from(path.flow) / (u.hypot(1.0) + u);
            let found = f64::from(tubes.fill(&path, pressure).with);
            assert!((found / exact - 1.0).abs() < 6e-3, "{p}: {found}, not {exact}");
        }
    }
}
