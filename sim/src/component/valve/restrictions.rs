//! The restrictions around the nodes of a valve, over its spool.

use crate::component::valve::characteristic::Characteristic;
use crate::number::{Number, Pair};

/// (C_d A)^2 2n/((n-1)R) of the restrictions around a node, or around both: a squared mass flow for a flow
/// function over a temperature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conductances<N = f64> {
    pub supply: N,
    pub exhaust: N,
    /// None: the port has no bore of its own (single restriction, 6.39 to 6.46).
    pub port: Option<N>,
}

impl Conductances<Pair> {
    /// Those of node `i`.
    pub fn lane(&self, i: usize) -> Conductances {
        Conductances {
            supply: self.supply.lane(i),
            exhaust: self.exhaust.lane(i),
            port: self.port.map(|port| port.lane(i)),
        }
    }

    /// The same with the port of node `i` plugged: its lands pass nothing.
    pub fn plugged(&self, i: usize) -> Conductances<Pair> {
        let but = |both: Pair| Pair::of(|lane| if lane == i { 0.0 } else { both.lane(lane) });
        Conductances { supply: but(self.supply), exhaust: but(self.exhaust), port: self.port }
    }
}

/// What a valve's conductances have in common for all places of its spool.
#[derive(Clone, Debug)]
pub(crate) struct Restrictions {
    /// Of lands to the supply and to the exhaust over z^2 + c^2, c the clearance; over the square of a share.
    pub(super) per_square: [f64; 2],
    /// c^2, m^2.
    pub(super) clearance_squared: f64,
    /// Of lands that open by shares. Without them lands have areas, or laws that know the spool (a map).
    pub(super) shares: Option<Shares>,
    /// Whether the lands have areas.
    pub(super) are_areas: bool,
    pub(super) port: Option<f64>,
}

/// Lands that open by shares of their conductances.
#[derive(Clone, Debug)]
pub(super) struct Shares {
    pub characteristic: Characteristic,
    /// Travel and lap, m.
    pub spool: [f64; 2],
}

impl Restrictions {
    /// Around nodes 1 and 2, with lands 1 and 2 open by `openings` (m), or counted as shut: smooth a little
    /// beyond the change as well.
    #[inline]
    pub fn at(&self, openings: [f64; 2], open: [bool; 2]) -> Conductances<Pair> {
        let squares = if self.are_areas {
            [0, 1].map(|i| {
                let across = if open[i] { openings[i] * openings[i] } else { 0.0 };
                across + self.clearance_squared
            })
        } else {
            self.squares(openings, open)
        };
        let [supply, exhaust] = self.per_square.map(Pair::splat);
        Conductances {
            supply: supply * Pair::new(squares),
            exhaust: exhaust * Pair::new([squares[1], squares[0]]),
            port: self.port.map(Pair::splat),
        }
    }

    /// The squares of the shares that lands 1 and 2 open; 1 of lands with a map.
    #[cold]
    #[inline(never)]
    fn squares(&self, openings: [f64; 2], open: [bool; 2]) -> [f64; 2] {
        self.shares.as_ref().map_or([1.0; 2], |shares| {
            [0, 1].map(|i| shares.characteristic.share(openings[i], open[i], shares.spool).powi(2))
        })
    }
}
