//! Where the table has its knots along the spool.
//!
//! Its coordinate is sqrt(K_s/K_p) - sqrt(K_e/K_p), the difference of the lands' open areas over that of the bore,
//! which grows with the spool. In it the areas are straight lines between the edges of the lands, which break the
//! table into pieces; from an edge on the knots are graded, as the flows first change by a clearance.

use super::axis::Axis;
use super::node::LoneNode;
use crate::gas::Gas;
use crate::root::bracketed_root;
use crate::valve::{Conductances, Valve};

/// A stretch of the spool between edges of the lands.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Along the spool's coordinate.
    pub axis: Axis,
    /// Node 1's surroundings at each knot.
    pub lands: Vec<Conductances>,
    /// Places of the spool at its ends, m.
    pub ends: [f64; 2],
    /// One over the most that the other node may take from the supply at each knot, s/kg.
    pub per_other: Vec<f64>,
}

impl Piece {
    /// Node 1's surroundings at a place along the spool's coordinate.
    pub fn lands_at(&self, lone: &LoneNode, x: f64) -> Conductances {
        let over = |spool: f64| coordinate(&lone.lands(spool)) - x;
        let [low, high] = self.ends;
        lone.lands(bracketed_root(over, [(low, over(low)), (high, over(high))], 0.0))
    }
}

/// How knots are set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grading {
    /// Width of a cell over the area that is open in it.
    pub part: f64,
    /// Over the area of the bore: where a cell is twice as wide as that.
    pub knee: f64,
    /// The widest, over the area of the bore; or [`FEWEST`] of them reach over all.
    pub widest: f64,
}

/// Cells of a piece whose lands are far wider than the bore.
const FEWEST: f64 = 20.0;

/// Part of the travel that a spool may go beyond it, in its stops.
const BEYOND: f64 = 0.3;

/// The spool's coordinate for what surrounds a node.
pub(super) fn coordinate(lands: &Conductances) -> f64 {
    let port = lands.port.unwrap_or(f64::NAN);
    (lands.supply / port).sqrt() - (lands.exhaust / port).sqrt()
}

/// The pieces of a valve's travel.
pub(super) fn pieces(valve: &Valve, gas: &Gas, grading: &Grading) -> Vec<Piece> {
    let reach = (1.0 + BEYOND) * valve.travel + valve.null_offset.abs();
    let null = valve.null_offset;
    let (low, high) = (null - reach, null + reach);
    let edges = [null - valve.lap.abs(), null + valve.lap.abs()];
    let mut pieces = vec![([low, edges[0]], [false, true])];
    // Between edges both lands are open with underlap; with overlap nothing changes.
    if valve.lap < 0.0 {
        pieces.push((edges, [true, true]));
    }
    pieces.push(([edges[1], high], [true, false]));
    pieces.into_iter().map(|(ends, graded)| piece(valve, gas, grading, ends, graded)).collect()
}

fn piece(valve: &Valve, gas: &Gas, grading: &Grading, ends: [f64; 2], graded: [bool; 2]) -> Piece {
    let lands = |spool: f64| valve.conductances(gas, spool).lane(0);
    let at = |spool: f64| coordinate(&lands(spool));
    let clearance = (valve.edge_area(-1.0) / valve.port_area()).min(1.0);
    let [low, high] = ends.map(at);
    let knots = knots(low, high, clearance, grading, graded);
    let place = |x: &f64| {
        let over = |spool: f64| at(spool) - x;
        bracketed_root(over, [(ends[0], low - x), (ends[1], high - x)], 0.0)
    };
    let last = knots.len() - 1;
    let inside = knots[1..last].iter().map(place);
    let lands = std::iter::once(ends[0]).chain(inside).chain([ends[1]]).map(lands).collect();
    Piece { axis: Axis::new(knots), lands, ends, per_other: Vec::new() }
}

/// Graded from the ends that are edges; four at least.
fn knots(low: f64, high: f64, clearance: f64, grading: &Grading, graded: [bool; 2]) -> Vec<f64> {
    let span = high - low;
    let part = if graded == [true, true] { 0.5 } else { 1.0 };
    let widest = grading.widest.max(span / FEWEST);
    let mut way = vec![0.0];
    let mut at = 0.0;
    while at < part * span {
        at += (grading.part * (clearance + at) * (1.0 + at / grading.knee)).min(widest);
        way.push(at);
    }
    while way.len() < 4 {
        way = way.windows(2).flat_map(|two| [two[0], 0.5 * (two[0] + two[1])]).chain([at]).collect();
    }
    let stretched = part * span / way[way.len() - 1];
    let mut knots: Vec<f64> = Vec::new();
    if graded[1] {
        knots = way.iter().rev().map(|x| high - x * stretched).collect();
    }
    if graded[0] {
        let rising = way.iter().map(|x| low + x * stretched);
        let mut both: Vec<f64> = rising.collect();
        both.extend(knots.into_iter().skip(1));
        knots = both;
    }
    knots
}
