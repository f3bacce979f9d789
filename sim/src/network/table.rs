//! The flows of both nodes from a table, for a given valve, gas, supply and exhaust.
//!
//! m and s of a node depend on the spool x, on w_c and T_c of its chamber and, through the supply tube, on what the
//! other node takes, s_o. The table holds
//!
//! ```text
//! (m', s) = f(x, u, s_o)     m' = m sqrt(T_c/T_s) out of the chamber, m into it
//! w_0 - w_c = u (alpha + |u|),   w_0(x, s_o): the port does not flow;   alpha(x, s_o)
//! ```
//!
//! in polynomials, cubic in x, u and s_o, with continuous slopes over x and u. In u the flows have no root at u = 0.
//! The spool's coordinate is that of `table/knots.rs`.
//!
//! Temperature. Air of the chamber alone flows with 1/sqrt(T_c), and m' does not feel T_c but for two things. The
//! cylinder's tube loses by m, not m': that is the same as a chamber of another pressure,
//!
//! ```text
//! w_c* = w_c exp(k (m - m')),   k = -d ln w/dm of the tube
//! ```
//!
//! And the air that leaks in from the supply is not the chamber's; with T_n of the mixture the flow out of the node is
//!
//! ```text
//! (s + b)^2 + eta s b = K_e/T_s psi,   b = -m',   eta = sqrt(T_c/T_s) + sqrt(T_s/T_c) - 2
//! ```
//!
//! of which m' takes the first order where the lands let less pass than the bore: eta/2 s b/(s + b).
//!
//! Both nodes and s_o. w_c* needs m', and s_o the other node's s: Newton's method from where the solution is going,
//! by the slopes of the table. The second-order error of a correction is so small that one look is enough as a rule.
//!
//! Its error is measured when it is built, in each cell, against the network's own solution. Cells that may be off by
//! more than [`MOST_ERROR`] are left out, and so is what lies beyond the table: there the network solves. These are
//! the cells where one land's flow vanishes while the other one's is as small: flows of a hundredth of the largest.

mod axis;
mod fill;
mod grid;
mod knots;
mod measure;
mod node;

use std::fmt;

use super::{FLOW_ERROR, Network, Surroundings};
use crate::network::nodes::{Nodes, pair};
use crate::number::{Number, Pair};
use crate::valve::Valve;
use fill::Filling;
use grid::Grid;
use knots::Grading;
use node::LoneNode;

/// Of a flow, over the larger of it and [`FLOOR`] of the largest in the table.
pub const MOST_ERROR: f64 = 1e-3;

/// Part of that which a cell's measured error may be: between the places of the measurement it is larger, and what
/// one node is off by the other one feels.
const RESERVE: f64 = 0.5;

/// Part of the largest flow below which a flow's error counts in its parts.
pub const FLOOR: f64 = 0.01;

/// Part of the cells that may be left out.
const MOST_LEFT_OUT: f64 = 0.5;

/// T_c/T_s that the table is measured for.
const TEMPERATURES: [f64; 2] = [0.75, 1.25];

/// How fine a table is.
#[derive(Clone, Copy, Debug)]
struct Fineness {
    grading: Grading,
    columns: usize,
}

/// Of servo-b's cells 30 % are left out at this.
const FINENESS: Fineness = Fineness { grading: Grading { part: 0.06, knee: 2.0, widest: 0.3 }, columns: 56 };

/// A table of a rig's flow nodes.
pub(crate) struct Table {
    grid: Kind,
    frame: Frame,
    quality: Quality,
}

enum Kind {
    /// No supply tube: the nodes know nothing of each other.
    Apart(Grid<1>),
    Joined(Grid<4>),
}

/// Not its cells.
impl fmt::Debug for Table {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Table").field(&self.quality).finish()
    }
}

/// What a table is for.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// 1/sqrt(K_p).
    per_port: f64,
    supply_temperature: f64,
    /// k, s/kg.
    decay: f64,
    /// w of a chamber, least and most.
    exners: [f64; 2],
}

/// How good a table is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Largest error of a flow that was measured, over the larger of the flow and a hundredth of the largest one.
    pub error: f64,
    /// Part of the cells that are left to the network.
    pub left_out: f64,
    /// Cells in use.
    pub cells: usize,
    /// The largest flow, kg/s.
    pub largest: f64,
}

/// Why there is no table.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Refusal {
    #[error("a tube of this kind")]
    Tube,
    #[error("the network finds no flows")]
    NoFlows,
    #[error("{:.1} % of its cells are off by more than {:.1} % of the flow", 100.0 * .left_out, 100.0 * MOST_ERROR)]
    TooCoarse { left_out: f64 },
}

impl Table {
    /// The table of a network and a valve.
    ///
    /// # Errors
    /// When its error leaves too little of it, or the network cannot fill it.
    pub fn build(network: &Network, valve: &Valve) -> Result<Table, Refusal> {
        let lone = LoneNode::of(network, valve).ok_or(Refusal::Tube)?;
        let lands = lone.lands(valve.null_offset);
        let frame = Frame {
            per_port: 1.0 / lands.port.unwrap_or(f64::NAN).sqrt(),
            supply_temperature: network.supply.temperature,
            decay: lone.decay(),
            exners: [0.0; 2],
        };
        if network.supply_tube.is_none() {
            let (grid, frame, quality) = filled::<1>(lone, &FINENESS, frame)?;
            Ok(Table { grid: Kind::Apart(grid), frame, quality })
        } else {
            let (grid, frame, quality) = filled::<4>(lone, &FINENESS, frame)?;
            Ok(Table { grid: Kind::Joined(grid), frame, quality })
        }
    }

    pub fn quality(&self) -> Quality {
        self.quality
    }
}

fn filled<const O: usize>(
    lone: LoneNode,
    fineness: &Fineness,
    frame: Frame,
) -> Result<(Grid<O>, Frame, Quality), Refusal> {
    let mut filling = Filling::<O>::new(lone, fineness)?;
    let frame = Frame { exners: filling.exners, ..frame };
    let mut grid = filling.grid()?;
    let quality = measure::measure(&mut filling, &frame, &mut grid)?;
    if quality.left_out > MOST_LEFT_OUT {
        return Err(Refusal::TooCoarse { left_out: quality.left_out });
    }
    Ok((grid, frame, quality))
}

/// What the temperature of the chambers makes of the flows.
#[derive(Clone, Copy, Debug)]
struct Warmth {
    /// sqrt(T_s/T_c) where the chamber's air flows, else 1.
    per_root: Pair,
    root: Pair,
    /// eta/2, times what of the loss of pressure is the land's.
    mixes: Pair,
    /// d ln w_c* / d m'.
    slack: Pair,
}

impl Warmth {
    #[inline(always)]
    fn of(frame: &Frame, temperature: Pair, charging: Pair, exhaust_land: Pair) -> Warmth {
        let ratio = temperature * pair(1.0 / frame.supply_temperature);
        let measured = ratio.at_least(pair(TEMPERATURES[0])) & pair(TEMPERATURES[1]).at_least(ratio);
        let root = Pair::choose(measured, ratio, pair(f64::NAN)).sqrt();
        let root = Pair::choose(charging, pair(1.0), root);
        let per_root = pair(1.0) / root;
        let port = pair(1.0 / (frame.per_port * frame.per_port));
        let lands = port / (port + exhaust_land);
        Warmth {
            per_root,
            root,
            mixes: (pair(0.5) * (root + per_root) - pair(1.0)) * lands,
            slack: pair(frame.decay) * (per_root - pair(1.0)),
        }
    }

    /// m of m' and s.
    #[inline(always)]
    fn port_flow(&self, port: Pair, supply: Pair) -> Pair {
        let back = (-port).fast_max(Pair::ZERO);
        let enters = supply.fast_max(Pair::ZERO);
        let sum = (enters + back).fast_max(pair(f64::MIN_POSITIVE));
        (port + self.mixes * enters * back / sum) * self.per_root
    }
}

/// What a table is asked for.
#[derive(Clone, Copy, Debug)]
struct Asked {
    spool: Pair,
    exner: Pair,
    /// What the other node takes, where that is given.
    other: Pair,
    warmth: Warmth,
}

/// What a correction was.
#[derive(Clone, Copy, Debug)]
struct Change {
    port: Pair,
    /// Of what the other node takes.
    other: Pair,
    /// How far that was outside of the table.
    beyond: Pair,
}

/// m' and s.
#[derive(Clone, Copy, Debug)]
struct Guess {
    port: Pair,
    supply: Pair,
}

impl<const O: usize> Grid<O> {
    /// A guess corrected by the slopes of the table, and by how much; `joined`: each node is the other's other one,
    /// else that takes what is asked for.
    #[inline(always)]
    fn corrected(&self, asked: &Asked, guess: &Guess, joined: bool) -> (Guess, Change) {
        let one = pair(1.0);
        let z = asked.warmth.slack * guess.port;
        let exner = asked.exner * (one + z * (one + z * (pair(0.5) + z * pair(1.0 / 6.0))));
        let moves = exner * asked.warmth.slack;
        let swapped = |both: Pair| Pair::new([both.lane(1), both.lane(0)]);
        let cooler = one - asked.warmth.root;
        let other = if joined { swapped(guess.supply) } else { asked.other };
        let look = self.look(asked.spool, exner, other + guess.supply.fast_min(Pair::ZERO) * cooler);
        // The supply takes the chamber's air at the chamber's temperature.
        let warm = Pair::choose(look.supply.value.above(Pair::ZERO), one, asked.warmth.per_root);
        let per = one / (one - look.port.by_exner * moves);
        let gap = (look.port.value - guess.port) * per;
        let rise = warm * look.supply.by_exner * moves;
        let start = warm * look.supply.value - guess.supply + rise * gap;
        if !joined {
            let change = Change { port: gap, other: Pair::ZERO, beyond: Pair::ZERO };
            return (Guess { port: guess.port + gap, supply: guess.supply + start }, change);
        }
        let push = look.port.by_other * per;
        let bound = warm * look.supply.by_other + rise * push;
        let change = (start + bound * swapped(start)) / (one - bound * swapped(bound));
        let port = gap + push * swapped(change);
        let guess = Guess { port: guess.port + port, supply: guess.supply + change };
        (guess, Change { port, other: change, beyond: look.beyond })
    }
}

/// kg/s: what a further look may still change of a flow.
const SETTLED: f64 = 1e-9;

/// kg/s per (kg/s)^2: what a correction of the other node's flow leaves of a flow, over its square.
const BEND: f64 = 1.0;

/// Looks into the table for one solution; two are enough where nothing is known of it.
const MOST_LOOKS: u32 = 8;

impl Network {
    /// The flows from the table; None where it has none.
    #[inline(never)]
    pub(super) fn by_table(&mut self, table: &Table, around: &Surroundings) -> Option<Nodes> {
        let Surroundings { valve, chambers, charging, .. } = *around;
        let frame = &table.frame;
        let spool = (valve.supply.sqrt() - valve.exhaust.sqrt()) * pair(frame.per_port);
        let exner = chambers.exner;
        let inside = exner.at_least(pair(frame.exners[0])) & pair(frame.exners[1]).at_least(exner);
        let asked = Asked {
            spool: Pair::choose(inside, spool, pair(f64::NAN)),
            exner,
            other: Pair::ZERO,
            warmth: Warmth::of(frame, chambers.temperature, charging, valve.exhaust),
        };
        let begun = self.tabulated;
        let begun = self.table_course.ahead(&begun).unwrap_or(begun);
        let guess = Guess { port: begun.supply + begun.exhaust, supply: begun.supply };
        let found = match &table.grid {
            Kind::Apart(grid) => self.settled(grid, &asked, guess, false),
            Kind::Joined(grid) => self.settled(grid, &asked, guess, true),
        }?;
        self.tabulated = Nodes { supply: found.supply, exhaust: found.port - found.supply, ..begun };
        self.table_course.note(&self.tabulated);
        let port = asked.warmth.port_flow(found.port, found.supply);
        let temperature = pair(frame.supply_temperature);
        Some(Nodes {
            exner,
            temperature,
            carried: temperature,
            supply: found.supply,
            exhaust: port - found.supply,
        })
    }

    #[inline(never)]
    fn settled<const O: usize>(
        &mut self,
        grid: &Grid<O>,
        asked: &Asked,
        mut guess: Guess,
        joined: bool,
    ) -> Option<Guess> {
        let error = pair(if self.sharp { FLOW_ERROR } else { SETTLED } / BEND);
        for _ in 0..MOST_LOOKS {
            self.work.iterations += 1;
            let (next, change) = grid.corrected(asked, &guess, joined);
            let size = change.other * change.other + pair(0.01) * change.port * change.port;
            if !size.is_finite().all() {
                return None;
            }
            guess = next;
            if error.at_least(size).all() {
                return change.beyond.simd_eq(Pair::ZERO).all().then_some(guess);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests;
