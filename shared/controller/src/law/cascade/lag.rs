//! The lag of the valve, learned by what the flow observer misses.
//!
//! ```text
//! a spool that lags by L more than believed lets the flow of L before through: its rate r is wrong by -L r'
//! flow observer      of a rate x that it does not know, its error is e(x):   g += (1 - q)^2 e,   e+ = q^2 e + x - g
//! least squares      e = s e(r) + L e(-r')                s, a part of the flow, is there to keep the flow's own error out of L
//! taken over         above 0.1 ms:   pace += L/lag, from 0.5 to 3
//! with it            the spool of the model moves 1/pace as far in a sample;   tau' = tau + (pace - 1) lag/1.5
//! ```
//!
//! The force loop takes its poles and its preview from tau', so that it is as slow as the valve is.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | r, e | Q24 force a sample | saturated |
//! | g | Q40, 64 bits | -16 to 16 |
//! | s, L | Q24 of 0.1 and of 1 ms | -8 to 8, -4 to 4 |
//! | pace, 1/pace, tau/tau' | Q16 | 0.5 to 3, 1/3 to 2, 1/3 to 2 |

use super::kept::Learned;
use super::number::{product, ratio, scaled};
use super::squares::Squares;
use crate::fixed::saturate;
use crate::parameters::{Parameters, id};

/// 1 of a pace.
const ONE: i32 = 1 << 16;
/// The bounds of a pace.
const PACES: [i32; 2] = [ONE / 2, 3 * ONE];
/// The bounds of the unknowns.
const BOUNDS: [[i32; 2]; 2] = [[-8 << 24, 127 << 20], [-4 << 24, 4 << 24]];
/// 0.1 in Q16: the prior deviation of the flow.
const SPREAD: i32 = 6554;
/// A lag that is worth taking over, Q24 of a ms.
const WORTH: u32 = 1_677_722;
/// Largest g, Q40.
const MOST: i64 = 1 << 44;

/// What it knows beforehand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// q^2 and (1 - q)^2, Q30.
    decay: i32,
    rate: i32,
    /// 1/noise, Q16; 0: nothing is learned.
    certainty: i32,
    /// 1 ms in samples and over the lag, Q16.
    millisecond: i32,
    per_lag: i32,
    /// lag/1.5 and tau, samples in Q16.
    boosted: i32,
    dead_time: i32,
}

/// The flow observer's error of a rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Missed {
    error: i32,
    rate: i64,
}

/// What is learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lag {
    squares: Squares<2>,
    of_flow: Missed,
    of_change: Missed,
    /// r of the sample before.
    last: i32,
    /// The lag over that of the rig file, Q16, and one over it.
    pub pace: i32,
    pub(super) by_pace: i32,
    /// tau', samples in Q16, and tau/tau', Q16.
    pub(super) dead_time: i32,
    pub(super) swift: i32,
}

impl Default for Lag {
    fn default() -> Lag {
        Lag {
            squares: Squares::default(),
            of_flow: Missed::default(),
            of_change: Missed::default(),
            last: 0,
            pace: ONE,
            by_pace: ONE,
            dead_time: ONE,
            swift: ONE,
        }
    }
}

impl Constants {
    pub(super) fn of(parameters: &Parameters, certainty: i32) -> Constants {
        let get = |id| parameters.scalar(id);
        let (q, lag) = (get(id::CASCADE_FLOW_DECAY), get(id::CASCADE_SPOOL_LAG));
        let left = (1 << 30) - q;
        let period_us = u64::from(get(id::PERIOD_US).unsigned_abs());
        let millisecond = ratio(1000 << 16, period_us).min(1 << 24);
        Constants {
            decay: product(q, q, 30),
            rate: product(left, left, 30),
            // A spool without a lag has none to be learned.
            certainty: if lag == 0 { 0 } else { certainty },
            millisecond: millisecond as i32,
            per_lag: ratio(millisecond << 16, u64::from(lag.unsigned_abs())).min(1 << 24) as i32,
            boosted: product(lag, 2 * ONE / 3, 16),
            dead_time: get(id::CASCADE_DEAD_TIME),
        }
    }
}

impl Missed {
    /// A sample with this rate.
    #[inline(always)]
    fn take(&mut self, constants: &Constants, rate: i32) {
        let change = (i64::from(self.error) * i64::from(constants.rate)) >> 14;
        self.rate = (self.rate + change).clamp(-MOST, MOST);
        let found = saturate((self.rate + (1 << 15)) >> 16);
        self.error = scaled(self.error, constants.decay, 30).saturating_add(rate).saturating_sub(found);
    }
}

impl Lag {
    /// With what is known of it.
    pub(super) fn new(constants: &Constants, known: &Learned) -> Lag {
        let mut lag = Lag { pace: known.pace.clamp(PACES[0], PACES[1]), ..Lag::default() };
        lag.take_over(constants);
        lag
    }

    /// Whether the pace is at a bound.
    pub(super) fn is_at_bound(&self) -> bool {
        PACES.contains(&self.pace)
    }

    /// A sample with this rate of the model's flow, Q24.
    #[inline(always)]
    pub(super) fn take(&mut self, constants: &Constants, rate: i32) {
        // Nobody asks for an error that nothing is learned by.
        if constants.certainty == 0 {
            return;
        }
        let change = rate.saturating_sub(core::mem::replace(&mut self.last, rate));
        self.of_flow.take(constants, rate);
        self.of_change.take(constants, change.saturating_neg());
    }

    /// Learns by the flow observer's error at that sample, Q24.
    #[inline(never)]
    pub(super) fn learn(&mut self, constants: &Constants, error: i32) {
        if constants.certainty == 0 {
            return;
        }
        let [of_flow, of_change] = [self.of_flow.error, self.of_change.error];
        let weighed = |force: i32| product(force, constants.certainty, 24);
        let h =
            [scaled(weighed(of_flow), SPREAD, 16), product(weighed(of_change), constants.millisecond, 16)];
        self.squares.fit(h, weighed(error), 0, &BOUNDS);
        let [_, lag] = self.squares.unknown;
        if lag.unsigned_abs() > WORTH {
            self.squares.unknown[1] = 0;
            let pace = self.pace.saturating_add(product(lag, constants.per_lag, 24));
            self.pace = pace.clamp(PACES[0], PACES[1]);
            self.take_over(constants);
        }
    }

    /// The lag as it is used.
    fn take_over(&mut self, constants: &Constants) {
        self.by_pace = u32::MAX.checked_div(self.pace.unsigned_abs()).map_or(ONE, |by| (by + 1) as i32);
        let more = product(self.pace - ONE, constants.boosted, 16);
        self.dead_time = constants.dead_time.saturating_add(more).max(ONE / 2);
        let tau = u64::from(constants.dead_time.unsigned_abs());
        self.swift = ratio(tau << 16, u64::from(self.dead_time.unsigned_abs())).min(2 << 16) as i32;
    }
}
