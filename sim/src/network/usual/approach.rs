//! The effect of the speed of approach, as [`crate::network`] defines it. For air P^2 is w^7, and behind a tube w
//! goes with exp(decay mdot).
//!
//! ```text
//! f = 1 + (n-1)/2 min(1, R T mdot^2/(n A_p^2 P^2))
//! ```

use super::Known;
use crate::network::nodes::pair;
use crate::number::{Number, Pair};

/// f, its slope over the flow that approaches, and its slope over the flow in the tube through the pressure.
#[derive(Clone, Copy)]
pub(super) struct Approach {
    pub factor: Pair,
    pub by_flow: Pair,
    pub by_tube: Pair,
}

impl Known<'_> {
    /// For the air in front of the lands, at w = `ahead`.
    #[inline(always)]
    pub fn approach_to_lands(&self, ahead: Pair, flow: Pair) -> Approach {
        self.approach(self.speeds[0], ahead, flow, self.decays[0])
    }

    /// For the air that a chamber gives back, at w = `behind`.
    #[inline(always)]
    pub fn approach_to_port(&self, behind: Pair, back: Pair) -> Approach {
        self.approach(self.speeds[1], behind, back, self.decays[1]).only(back.above(pair(0.0)))
    }

    #[inline(always)]
    fn approach(&self, speed: Pair, exner: Pair, flow: Pair, decay: f64) -> Approach {
        let square = exner * exner;
        let per_square = speed / (square * square * (square * exner));
        let rise = per_square * (flow * flow);
        let bends = |slope: Pair| Pair::choose(self.at_sound.above(rise), slope, pair(0.0));
        Approach {
            factor: pair(1.0) + rise.smaller(self.at_sound),
            by_flow: bends(pair(2.0) * per_square * flow),
            by_tube: bends(pair(-7.0 * decay) * rise),
        }
    }
}

impl Approach {
    /// For air at rest.
    pub const NONE: Approach = Approach { factor: Pair::ONE, by_flow: Pair::ZERO, by_tube: Pair::ZERO };

    /// The same where `truth` holds; air at rest elsewhere.
    #[inline(always)]
    pub fn only(self, truth: <Pair as Number>::Truth) -> Approach {
        Approach {
            factor: Pair::choose(truth, self.factor, pair(1.0)),
            by_flow: Pair::choose(truth, self.by_flow, pair(0.0)),
            by_tube: Pair::choose(truth, self.by_tube, pair(0.0)),
        }
    }

    /// f after changes of the flow that approaches and of the flow in the tube.
    #[inline(always)]
    pub fn after(&self, flow: Pair, tube: Pair) -> Pair {
        self.factor + self.by_flow * flow + self.by_tube * tube
    }
}
