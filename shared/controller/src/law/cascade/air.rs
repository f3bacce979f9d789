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

use super::number::{ONE, product, root};
use super::tubes::{self, Path, Tubes};
use crate::fixed::saturate;
use crate::parameters::{Parameters, id};

/// What it knows of cylinder and valve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    offset: i32,
    gain: i32,
    /// Pe.
    pub(super) exhaust: i32,
    /// r.
    pub(super) ratio: i32,
    dead: [i32; 2],
    pub(super) stroke: i32,
    /// n, Q16.
    exponent: i32,
    /// c and k of the path from the supply and of that to the exhaust, Q16.
    flow: [i32; 2],
    steepness: [i32; 2],
    tubes: Option<Tubes>,
}

/// The air at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Air {
    /// K, Q30.
    pub stiffness: i32,
    /// E, Q24.
    pub extend: i32,
    /// R, Q24.
    pub retract: i32,
    /// What E and R would be without tubes, over what they are, Q16.
    pub(super) narrow: [i32; 2],
}

impl Default for Air {
    fn default() -> Air {
        Air { stiffness: 0, extend: 0, retract: 0, narrow: [tubes::WIDE; 2] }
    }
}

impl Constants {
    pub(super) fn of(parameters: &Parameters) -> Constants {
        let get = |id| parameters.scalar(id);
        Constants {
            offset: get(id::CASCADE_PRESSURE_OFFSET),
            gain: get(id::CASCADE_PRESSURE_GAIN),
            exhaust: get(id::CASCADE_EXHAUST_PRESSURE),
            ratio: get(id::CASCADE_AREA_RATIO),
            dead: [get(id::CASCADE_DEAD_LENGTH_1), get(id::CASCADE_DEAD_LENGTH_2)],
            stroke: get(id::CASCADE_STROKE),
            exponent: get(id::CASCADE_EXPONENT),
            flow: [get(id::CASCADE_FLOW_SUPPLY), get(id::CASCADE_FLOW_EXHAUST)],
            steepness: [get(id::CASCADE_STEEPNESS_SUPPLY), get(id::CASCADE_STEEPNESS_EXHAUST)],
            tubes: Tubes::of(parameters),
        }
    }

    /// P of a raw pressure; no less than half of Pe.
    pub(super) fn pressure(&self, raw: i16) -> i32 {
        let pressure = self.offset.saturating_add(product(self.gain, raw.into(), 6));
        pressure.min(2 * ONE - 1).max(self.exhaust / 2)
    }

    /// F.
    pub(super) fn force(&self, [one, two]: [i32; 2]) -> i32 {
        one - product(self.ratio, two, 24) - product(self.exhaust, ONE - self.ratio, 24)
    }

    /// The air with the piston at x (counts) and these pressures.
    pub(super) fn at(&self, x: i32, pressures: [i32; 2]) -> Air {
        let x = x.min(self.stroke).max(0);
        let lengths = [self.dead[0] + x, self.dead[1] + self.stroke - x];
        // 2^32/L; a length is at least 16.
        let [one, two] = lengths.map(|length| u32::MAX.checked_div(length as u32).unwrap_or(0) as i32);
        let [p1, p2] = pressures;
        let springs = product(p1, one, 26) + product(product(self.ratio, p2, 24), two, 26);
        let stiffness = product(springs, self.exponent, 16);
        let [fill_1, fill_2] = [(p1, one), (p2, two)].map(|(p, by_length)| self.fill(p, by_length));
        let [vent_1, vent_2] = [(p1, one), (p2, two)].map(|(p, by_length)| self.vent(p, by_length));
        match &self.tubes {
            None => Air {
                stiffness,
                extend: fill_1.flow.saturating_add(vent_2.flow),
                retract: vent_1.flow.saturating_add(fill_2.flow),
                narrow: [tubes::WIDE; 2],
            },
            Some(tubes) => {
                let filled = [tubes.fill(&fill_1, p1), tubes.fill(&fill_2, p2)];
                let vented =
                    [(&vent_1, p1), (&vent_2, p2)].map(|(path, p)| tubes.vent(path, p, self.exhaust));
                let ([fill_1, fill_2], [vent_1, vent_2]) = (filled, vented);
                let [extend, retract] = [fill_1.and(vent_2), vent_1.and(fill_2)];
                Air {
                    stiffness,
                    extend: extend.with,
                    retract: retract.with,
                    narrow: [extend.narrow(), retract.narrow()],
                }
            }
        }
    }

    #[inline(always)]
    fn fill(&self, pressure: i32, by_length: i32) -> Path {
        self.path(ONE, product(ONE - pressure, self.steepness[0], 16), by_length, self.flow[0])
    }

    #[inline(always)]
    fn vent(&self, pressure: i32, by_length: i32) -> Path {
        // (P - Pe)/P in Q16: P is below 2^25, and not 0.
        let drop = (pressure - self.exhaust).max(0) as u32;
        let part = (drop << 7).checked_div(pressure as u32 >> 9).unwrap_or(0);
        self.path(pressure, product(part.min(1 << 16) as i32, self.steepness[1], 8), by_length, self.flow[1])
    }

    /// c phi(P, y)/L; y in Q24.
    #[inline(always)]
    fn path(&self, pressure: i32, y: i32, by_length: i32, flow: i32) -> Path {
        let y = y.clamp(0, ONE);
        let share = root(product(y, 2 * ONE - y, 18) as u32) as i32;
        let up = product(pressure, share, 15);
        let flow = saturate((i64::from(product(up, by_length, 24)) * i64::from(flow)) >> 24).min(16 * ONE);
        Path { up, flow }
    }
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
