//! The air: what the chambers make of motion and flow, by their measured pressures.
//!
//! ```text
//! force       F = P1 - r P2 - Pe (1 - r)                              r = A_2/A_1
//! lengths     L1 = l1 + x,   L2 = l2 + stroke - x                     V_i/A_i, dead volumes in them
//! stiffness   K = n (P1/L1 + r P2/L2)                                 force a count
//! a path      phi(P, y) = P sqrt(y (2 - y)),  0 <= y <= 1             ISO 6358: P_u times the share of the choked flow
//! extending   E = c_s phi(1, k_s (1 - P1))/L1 + c_e phi(P2, k_e (1 - Pe/P2))/L2      force a sample, valve open
//! retracting  R = c_e phi(P1, k_e (1 - Pe/P1))/L1 + c_s phi(1, k_s (1 - P2))/L2
//! ```
//!
//! Pressures are parts of the supply's, forces parts of what that does on area 1. k = 1/(1 - b). `tubes` has what tubes leave of E
//! and R.
//!
//! | quantity | format | range | largest error |
//! |---|---|---|---|
//! | P, F | Q24 | 0 to 2, -2 to 2 | 2^-23 |
//! | L | counts | 16 to 2^25 | 1 |
//! | 1/L | Q32 | | 2^-32 |
//! | K | Q30 | 0 to 0.7 | 2e-3 of it, at a stroke of 10^6 counts |
//! | E, R | Q24 | 0 to 32 | 1e-4 of the largest |

use super::land::Land;
use super::number::{ONE, fitting, product, root, scaled};
use super::tubes::{self, Side, Tubes};
use crate::parameters::{Parameters, id};

/// Pressure of both chambers of a load in motion, Q24: three fifths of the supply's.
const MIDDLE: i32 = ONE / 5 * 3;

/// What it knows of cylinder and valve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    offset: i32,
    gain: i32,
    /// Pe.
    pub(super) exhaust: i32,
    /// r.
    pub(super) ratio: i32,
    /// Pe (1 - r).
    outside: i32,
    dead: [i32; 2],
    pub(super) stroke: i32,
    /// n, Q16.
    exponent: i32,
    /// c and k of the path from the supply and of that to the exhaust, Q16.
    flow: [i32; 2],
    steepness: [i32; 2],
    tubes: Option<Tubes>,
    /// C of the land at its other end, Q16.
    shut: u32,
    /// The paths of a chamber at the middle pressure.
    middle: [Path; 2],
}

/// An open path, whatever the length of its chamber.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Path {
    /// phi, Q24.
    up: i32,
    /// What tubes leave of its flow, Q17.
    left: u32,
}

/// The air at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Air {
    /// K, Q30.
    pub stiffness: i32,
    /// E, Q24.
    pub extend: i32,
    /// R, Q24.
    pub retract: i32,
    /// Both of a valve with a land before a port.
    pub(super) sides: [Side; 2],
}

impl Constants {
    pub(super) fn of(parameters: &Parameters) -> Constants {
        let get = |id| parameters.scalar(id);
        let (exhaust, ratio) = (get(id::CASCADE_EXHAUST_PRESSURE), get(id::CASCADE_AREA_RATIO));
        let mut constants = Constants {
            offset: get(id::CASCADE_PRESSURE_OFFSET),
            gain: get(id::CASCADE_PRESSURE_GAIN),
            exhaust,
            ratio,
            outside: product(exhaust, ONE - ratio, 24),
            dead: [get(id::CASCADE_DEAD_LENGTH_1), get(id::CASCADE_DEAD_LENGTH_2)],
            stroke: get(id::CASCADE_STROKE),
            exponent: get(id::CASCADE_EXPONENT),
            flow: [get(id::CASCADE_FLOW_SUPPLY), get(id::CASCADE_FLOW_EXHAUST)],
            steepness: [get(id::CASCADE_STEEPNESS_SUPPLY), get(id::CASCADE_STEEPNESS_EXHAUST)],
            tubes: Tubes::of(parameters),
            shut: Land::of(parameters).map_or(0, |land| land.shut),
            middle: [Path::default(); 2],
        };
        constants.middle = [constants.fill(MIDDLE), constants.vent(MIDDLE)];
        constants
    }

    /// P of a raw pressure; no less than half of Pe.
    pub(super) fn pressure(&self, raw: i16) -> i32 {
        let pressure = self.offset.saturating_add(product(self.gain, raw.into(), 6));
        pressure.min(2 * ONE - 1).max(self.exhaust / 2)
    }

    /// F.
    pub(super) fn force(&self, [one, two]: [i32; 2]) -> i32 {
        one - scaled(two, self.ratio, 24) - self.outside
    }

    /// 1/L with the piston at x, counts.
    #[inline(always)]
    fn by_lengths(&self, x: i32) -> [i32; 2] {
        let x = x.min(self.stroke).max(0);
        let lengths = [self.dead[0] + x, self.dead[1] + self.stroke - x];
        // 2^32/L; a length is at least 16.
        lengths.map(|length| u32::MAX.checked_div(length as u32).unwrap_or(0) as i32)
    }

    /// The air with the piston at x (counts) and these pressures.
    pub(super) fn at(&self, x: i32, pressures: [i32; 2]) -> Air {
        let [one, two] = self.by_lengths(x);
        let [p1, p2] = pressures;
        // P is at most 2, r 1 and n 2, 1/L 2^28.
        let springs = scaled(p1, one, 26) + scaled(scaled(p2, self.ratio, 24), two, 26);
        let stiffness = scaled(springs, self.exponent, 16);
        let ([fill_1, fill_2], [vent_1, vent_2]) =
            (pressures.map(|p| self.fill(p)), pressures.map(|p| self.vent(p)));
        let of_extend = [self.flow(fill_1, one, 0), self.flow(vent_2, two, 1)];
        let of_retract = [self.flow(vent_1, one, 1), self.flow(fill_2, two, 0)];
        let [extend, retract] = [of_extend, of_retract].map(|[one, two]| one + two);
        if self.shut == 0 {
            return Air { stiffness, extend, retract, sides: [Side::default(); 2] };
        }
        let left = |[one, two]: [i32; 2], [of_one, of_two]: [Path; 2]| {
            tubes::part(one, of_one.left) + tubes::part(two, of_two.left)
        };
        let with = [left(of_extend, [fill_1, vent_2]), left(of_retract, [vent_1, fill_2])];
        let sides = [Side::new(extend, with[0], self.shut), Side::new(retract, with[1], self.shut)];
        Air { stiffness, extend: with[0], retract: with[1], sides }
    }

    /// The smaller of E and R with the piston at x and both pressures in the middle.
    pub(super) fn slower(&self, x: i32) -> i32 {
        let ([one, two], [fill, vent]) = (self.by_lengths(x), self.middle);
        let flow = |path: Path, by_length, which| tubes::part(self.flow(path, by_length, which), path.left);
        let extend = flow(fill, one, 0) + flow(vent, two, 1);
        extend.min(flow(vent, one, 1) + flow(fill, two, 0))
    }

    #[inline(always)]
    fn fill(&self, pressure: i32) -> Path {
        let up = phi(ONE, scaled(ONE - pressure, self.steepness[0], 16));
        Path { up, left: self.tubes.as_ref().map_or(tubes::ALL, |tubes| tubes.fill(up, pressure)) }
    }

    #[inline(always)]
    fn vent(&self, pressure: i32) -> Path {
        // (P - Pe)/P in Q16: P is below 2^25, and not 0.
        let drop = (pressure - self.exhaust).max(0) as u32;
        let part = (drop << 7).checked_div(pressure as u32 >> 9).unwrap_or(0);
        let up = phi(pressure, scaled(part.min(1 << 16) as i32, self.steepness[1], 8));
        let left = self.tubes.as_ref().map_or(tubes::ALL, |tubes| tubes.vent(up, pressure, self.exhaust));
        Path { up, left }
    }

    /// c phi/L.
    #[inline(always)]
    fn flow(&self, path: Path, by_length: i32, which: usize) -> i32 {
        let [supply, exhaust] = self.flow;
        let flow = if which == 0 { supply } else { exhaust };
        // At most 2^29.
        let open = fitting(path.up as u32, by_length as u32, 24);
        ((u64::from(open) * u64::from(flow.unsigned_abs())) >> 24).min(16 << 24) as i32
    }
}

/// phi(P, y); y in Q24.
#[inline(always)]
fn phi(pressure: i32, y: i32) -> i32 {
    let y = y.clamp(0, ONE) as u32;
    // Choked: the share is 1.
    if y == ONE as u32 {
        return pressure;
    }
    let share = root(fitting(y, (2 << 24) - y, 18));
    fitting(pressure as u32, share, 15) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The equations in real numbers, for constants as the law has them.
    fn real(c: &Constants, x: i32, p: [f64; 2]) -> [f64; 3] {
        let q16 = |value: i32| f64::from(value) / 65_536.0;
        let (exhaust, r) = (f64::from(c.exhaust) / f64::from(ONE), f64::from(c.ratio) / f64::from(ONE));
        let x = x.clamp(0, c.stroke);
        let l = [f64::from(c.dead[0] + x), f64::from(c.dead[1] + c.stroke - x)];
        let path = |up: f64, y: f64| {
            let y = y.clamp(0.0, 1.0);
            up * (y * (2.0 - y)).sqrt()
        };
        let fill = |i: usize| q16(c.flow[0]) * path(1.0, q16(c.steepness[0]) * (1.0 - p[i])) / l[i];
        let vent =
            |i: usize| q16(c.flow[1]) * path(p[i], q16(c.steepness[1]) * (1.0 - exhaust / p[i])) / l[i];
        [q16(c.exponent) * (p[0] / l[0] + r * p[1] / l[1]), fill(0) + vent(1), vent(0) + fill(1)]
    }

    /// Short and long strokes in coarse and fine counts, both ends and beyond, pressures from below the exhaust to above the supply.
    #[test]
    fn stiffness_and_flows_are_their_equations() {
        let mut worst = [0.0_f64; 3];
        for (stroke, dead, flow) in
            [(25_000, [840, 840], 239), (3000, [170, 200], 40), (1_000_000, [8000, 9000], 2400)]
        {
            let mut parameters = Parameters::default();
            let values = [
                (id::CASCADE_STROKE, stroke),
                (id::CASCADE_DEAD_LENGTH_1, dead[0]),
                (id::CASCADE_DEAD_LENGTH_2, dead[1]),
                (id::CASCADE_EXHAUST_PRESSURE, 2_423_970),
                (id::CASCADE_AREA_RATIO, 14_417_920),
                (id::CASCADE_FLOW_SUPPLY, flow << 16),
                (id::CASCADE_FLOW_EXHAUST, (flow << 16) + 12_345),
            ];
            for (id, value) in values {
                parameters.set(id, value).expect("in range");
            }
            let constants = Constants::of(&parameters);
            for x in [-100, 0, 1, stroke / 7, stroke / 2, stroke - 1, stroke, stroke + 100] {
                for one in (0..23).map(|i| ONE / 20 * (i + 1)) {
                    for two in [ONE / 8, ONE / 3, ONE / 2, ONE - 1, ONE] {
                        let p = [one, two].map(|p| f64::from(p) / f64::from(ONE));
                        let exact = real(&constants, x, p);
                        let air = constants.at(x, [one, two]);
                        let seen = [
                            f64::from(air.stiffness) / f64::from(1 << 30),
                            f64::from(air.extend),
                            f64::from(air.retract),
                        ];
                        let largest = f64::from(flow) / f64::from(dead[0].min(dead[1]));
                        worst[0] = worst[0].max((seen[0] / exact[0] - 1.0).abs());
                        for i in [1, 2] {
                            worst[i] = worst[i].max((seen[i] / f64::from(ONE) - exact[i]).abs() / largest);
                        }
                    }
                }
            }
        }
        assert!(worst[0] < 2e-3 && worst[1] < 1e-4 && worst[2] < 1e-4, "{worst:?}");
    }
}
