//! Tubes between supply, valve and cylinder: what they leave of the flow.
//!
//! ```text
//! a path        m^2/x^2 + m/M = 1,   1/M = (a + b/(y - 1))/c             x: its flow without tubes, M: that of the tubes alone
//! so            m = x/(sqrt(1 + u^2) + u),   u = x/(2 M) = phi (a + b/(y - 1))/2
//! y             1/P of a chamber that fills, P/Pe of one that empties: y - 1 = drop/low
//! so            m = x drop/(n + sqrt(n^2 + drop^2)),   n = phi (a drop + b low)/2
//! narrow        w = (sum of x)/(sum of m),   k = (w - 1/w)/2                  of both paths that the open valve opens
//! less open     m(C) = X C/(k C + sqrt((k C)^2 + 1)),   X = sum of x                C: part of the conductance that is open
//! so            1/C^2 = v (v - 2 k),   v = X/m
//! ```
//!
//! A restriction loses pressure with the square of its flow, a tube here in proportion to it. The quadratic has both limits, and the
//! curves of a tube that chokes nothing in between: a and b are those that fit the open valve.
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | x, m | Q24 force a sample | 0 to 16 | 4e-3 of it |
//! | a, b | Q16 | 0 to 256 | |
//! | n, drop | Q21, and the leading 15 bits of the larger | 0 to 1024 | |
//! | m/x | Q17 | 0 to 1 | 2e-4 |
//! | w, 2 k | Q16 | 1 to 16, 0 to 16 | 3e-4 of it |
//! | C | Q16 | 0 to 1 | 2e-3 |

use super::number::{ONE, bend, high};
use crate::parameters::{Parameters, id};

/// 1 of a part that is left, Q17.
pub(super) const ALL: u32 = 1 << 17;
/// 1 of a conductance, and of w, Q16.
const WIDE: u32 = 1 << 16;
/// The largest w, Q16.
const NARROWEST: u32 = 16 << 16;
/// The largest a and b, Q16.
const MOST: u32 = 256 << 16;

/// The tubes on the way from the supply, and on that to the exhaust.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Tubes {
    supply: Tube,
    exhaust: Tube,
}

/// a and b, Q16.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Tube {
    choked: u32,
    slight: u32,
}

/// Both paths that the valve opens to one side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Side {
    /// X, Q24 force a sample.
    pub without: u32,
    /// 2 k, Q16.
    pub twice: u32,
    /// m of the shut valve, Q24.
    pub leak: i32,
}

impl Tubes {
    /// Those of a drive that has some.
    pub(super) fn of(parameters: &Parameters) -> Option<Tubes> {
        let get = |id| parameters.scalar(id).unsigned_abs().min(MOST);
        let tube = |choked, slight| Tube { choked: get(choked), slight: get(slight) };
        let tubes = Tubes {
            supply: tube(id::CASCADE_TUBE_SUPPLY_CHOKED, id::CASCADE_TUBE_SUPPLY_SLIGHT),
            exhaust: tube(id::CASCADE_TUBE_EXHAUST_CHOKED, id::CASCADE_TUBE_EXHAUST_SLIGHT),
        };
        (tubes.supply.slight > 0 || tubes.exhaust.slight > 0).then_some(tubes)
    }

    /// m/x of a path with this phi into a chamber at a pressure, both Q24.
    pub(super) fn fill(&self, up: i32, pressure: i32) -> u32 {
        self.supply.left(up, pressure, ONE - pressure)
    }

    /// The same out of it.
    pub(super) fn vent(&self, up: i32, pressure: i32, exhaust: i32) -> u32 {
        self.exhaust.left(up, exhaust, pressure - exhaust)
    }
}

impl Tube {
    /// m/x of a path from a pressure that is `drop` above `low`; all below 2^25.
    #[inline]
    fn left(&self, up: i32, low: i32, drop: i32) -> u32 {
        let [up, low, drop] = [up, low, drop].map(|part| part.max(0) as u32);
        let lost = u64::from(self.choked) * u64::from(drop) + u64::from(self.slight) * u64::from(low);
        // At most 2^31.
        let (n, drop) = (high(up << 7, (lost >> 19) as u32), drop >> 3);
        let zeros = (n | drop | 1).leading_zeros();
        let (n, drop) = (n << zeros, drop << zeros);
        (drop / (bend(n >> 17, drop >> 17) | 1)).min(ALL)
    }
}

/// m of x, both Q24 and at most 2^28.
#[inline(always)]
pub(super) fn part(x: i32, left: u32) -> i32 {
    high((x as u32) << 3, left << 12) as i32
}

impl Side {
    /// That of these sums of x and of m, with a valve whose lands have the conductance `shut` at their other end.
    #[inline]
    pub(super) fn new(without: i32, with: i32, shut: u32) -> Side {
        let (without, with) = (without as u32, with as u32);
        let zeros = (without | 1).leading_zeros();
        let w = ((without << zeros) / (((with << zeros) >> 16) | 1)).clamp(WIDE, NARROWEST);
        let mut side = Side { without, twice: w.saturating_sub(u32::MAX / w), leak: 0 };
        side.leak = side.through(shut);
        side
    }

    /// m(C), Q24; C in Q16.
    #[inline]
    pub(super) fn through(&self, part: u32) -> i32 {
        // k C and 1 in Q15, and as far below as both are within 2^15.
        let n = high(self.twice << 11, part << 3);
        let bits = 17_u32.saturating_sub(n.leading_zeros());
        let left = (u32::MAX >> bits) / (bend(n >> bits, (1 << 15) >> bits) | 1);
        high(high(self.without << 2, part << 15), left << 14) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half open and fully open valves before tubes from wide to narrow.
    #[test]
    fn what_a_part_of_the_conductance_lets_through_is_its_equation() {
        for narrow in [1.0_f64, 1.01, 1.5, 2.5, 6.0, 16.0] {
            let flow = f64::from(ONE / 30);
            let side = Side::new(ONE / 30, (flow / narrow) as i32, 0);
            for open in [0.0, 0.01, 0.1, 0.3, 0.7, 1.0] {
                let k: f64 = 0.5 * (narrow - 1.0 / narrow) * open;
                let exact = open / (k.hypot(1.0) + k);
                let found = f64::from(side.through((open * 65_536.0) as u32)) / flow;
                assert!(
                    (found - exact).abs() < 6e-4 * exact + 1e-5,
                    "w {narrow}, {open}: {found}, not {exact}"
                );
            }
        }
        assert_eq!(Side::new(0, 0, 300), Side { twice: 1, ..Side::default() }, "nothing flows");
    }

    /// The quadratic at any pressure, its limits among them: no drop, and a chamber that is empty.
    #[test]
    fn what_a_tube_leaves_is_the_root_of_its_quadratic() {
        for (choked, slight) in [(1.0, 2.0), (0.0, 0.05), (0.3, 0.0), (20.0, 7.0), (256.0, 256.0)] {
            let [a, b] = [choked, slight].map(|part| (part * 65_536.0) as u32);
            let tube = Tube { choked: a, slight: b };
            let tubes = Tubes { supply: tube.clone(), exhaust: tube };
            for pressure in [1, ONE / 20, ONE / 3, ONE / 2, ONE - ONE / 50, ONE, ONE + ONE / 9] {
                for up in [ONE / 100, ONE / 2, ONE] {
                    let p = f64::from(pressure) / f64::from(ONE);
                    let n = 0.5 * f64::from(up) / f64::from(ONE) * (choked * (1.0 - p) + slight * p);
                    let drop = (1.0 - p).max(0.0);
                    let exact = drop / (n.hypot(drop) + n).max(1e-9);
                    let found = f64::from(tubes.fill(up, pressure)) / f64::from(ALL);
                    assert!((found - exact).abs() < 2e-4 * exact + 1e-5, "{p}: {found}, not {exact}");
                }
            }
        }
    }
}
