//! Filling a table, and measuring how far it is from what fills it.

use super::axis::Axis;
use super::grid::{Grid, PARTS, powers_of_other};
use super::knots::{Piece, pieces};
use super::node::{Blocked, LoneNode};
use super::{Fineness, Refusal};
use crate::air::Station;
use crate::network::PortFlow;
use crate::number::Pair;
use crate::valve::Conductances;

/// Part of the supply's pressure that a chamber's may be at most.
const HIGHEST: f64 = 1.1;

/// Part of the lowest pressure below which nothing is looked for.
const LOWEST_EXNER: f64 = 0.5;

/// Everything that a table is filled with.
pub(super) struct Filling<const O: usize> {
    pub lone: LoneNode,
    pub pieces: Vec<Piece>,
    pub columns: Axis,
    /// Parts of the other node's flow at which the table is exact.
    places: [f64; O],
    /// Least and most w of a chamber.
    pub exners: [f64; 2],
}

/// What the network says at a knot of the spool, by the powers of the other node's flow.
struct Sample<const O: usize> {
    /// w_0 and alpha.
    blocked: [Pair; O],
    /// m and s at each column.
    flows: Vec<[Pair; O]>,
}

impl<const O: usize> Filling<O> {
    pub fn new(mut lone: LoneNode, fineness: &Fineness) -> Result<Filling<O>, Refusal> {
        let mut pieces = pieces(&lone.valve, &lone.gas, &fineness.grading);
        let highest = HIGHEST * lone.gas.pressure(lone.supply.exner);
        let exners = [lone.exhaust.exner, lone.gas.exner(highest)];
        set_others(&mut lone, &mut pieces, exners[0])?;
        let columns = columns(&lone, &pieces, exners, fineness.columns);
        let place = |o: usize| {
            let across = 0.5 - 0.5 * libm::cos(core::f64::consts::PI * (2 * o + 1) as f64 / (2 * O) as f64);
            PARTS[0] + (PARTS[1] - PARTS[0]) * across
        };
        Ok(Filling { lone, pieces, columns, places: std::array::from_fn(place), exners })
    }

    pub fn grid(&mut self) -> Result<Grid<O>, Refusal> {
        let knots = &self.columns.knots;
        let cells = self.columns.cells();
        let mut grid = Grid::new(&self.pieces, cells, knots[0], knots[cells]);
        let mut row = 0;
        for p in 0..self.pieces.len() {
            self.fill_piece(p, row, &mut grid)?;
            row += self.pieces[p].axis.cells();
        }
        Ok(grid)
    }

    fn fill_piece(&mut self, p: usize, first_row: usize, grid: &mut Grid<O>) -> Result<(), Refusal> {
        let samples = self.samples(p)?;
        let piece = &self.pieces[p].axis;
        for o in 0..O {
            for (i, cubic) in piece.cubics(|i| samples[i].blocked[o]).enumerate() {
                grid.blocked[first_row + i + 1][o] = cubic;
            }
            // Along the columns first, then along the spool.
            let columns = |sample: &Sample<O>| self.columns.cubics(|j| sample.flows[j][o]).collect();
            let along: Vec<Vec<_>> = samples.iter().map(columns).collect();
            for (j, k) in (0..self.columns.cells()).flat_map(|j| (0..4).map(move |k| (j, k))) {
                for (i, cubic) in piece.cubics(|i| along[i][j][k]).enumerate() {
                    let cell = grid.cell(first_row + i, j);
                    grid.cells[cell][o][k] = cubic;
                }
            }
        }
        Ok(())
    }

    /// What the network says at each knot of a piece.
    fn samples(&mut self, p: usize) -> Result<Vec<Sample<O>>, Refusal> {
        let Filling { lone, pieces, columns, places, exners } = self;
        let knots = pieces[p].lands.iter().zip(&pieces[p].per_other);
        let sample = |(lands, per_other): (&Conductances, &f64)| {
            let others = places.map(|part| part / per_other);
            let blocked = others.map(|other| lone.blocked(lands, other));
            let mut lines = [const { Vec::new() }; O];
            for (o, line) in lines.iter_mut().enumerate() {
                *line = line_of(lone, lands, &blocked[o], others[o], columns, *exners)?;
            }
            let powers = |j: usize| powers_of_other(places, &std::array::from_fn(|o| lines[o][j]));
            Ok(Sample {
                blocked: powers_of_other(places, &blocked.map(|at| Pair::new([at.exner, at.softness]))),
                flows: (0..columns.knots.len()).map(powers).collect(),
            })
        };
        knots.map(sample).collect()
    }
}

/// So many columns beyond the chambers' pressures have a part in the slopes inside.
const MARGIN: usize = 3;

/// (m, s) at each column, from where the port does not flow outwards; what is farther than that from any chamber
/// goes on as it was.
fn line_of(
    lone: &mut LoneNode,
    lands: &Conductances,
    blocked: &Blocked,
    other: f64,
    columns: &Axis,
    exners: [f64; 2],
) -> Result<Vec<Pair>, Refusal> {
    let knots = &columns.knots;
    let rest = knots.partition_point(|&u| u < 0.0);
    let last = (knots.partition_point(|&u| u < blocked.coordinate(exners[0])) + MARGIN).min(knots.len());
    let first = knots.partition_point(|&u| u < blocked.coordinate(exners[1])).saturating_sub(MARGIN);
    let mut line = vec![Pair::ZERO; knots.len()];
    let mut at = |j: usize, line: &mut Vec<Pair>| {
        let chamber = Station {
            exner: blocked.exner_at(knots[j]).max(LOWEST_EXNER * exners[0]),
            temperature: lone.supply.temperature,
        };
        let port = if knots[j] >= 0.0 { PortFlow::Charging } else { PortFlow::Discharging };
        let flows = lone.flows(*lands, &chamber, other, port).ok_or(Refusal::NoFlows)?;
        line[j] = Pair::new([flows.port, flows.supply]);
        Ok(())
    };
    (rest..last).try_for_each(|j| at(j, &mut line))?;
    at(rest, &mut line)?;
    (first..rest).rev().try_for_each(|j| at(j, &mut line))?;
    let (begin, end) = (line[first], line[last - 1]);
    line[..first].fill(begin);
    line[last..].fill(end);
    Ok(line)
}

/// What the other node may take at each knot: it has the spool's mirror image.
fn set_others(lone: &mut LoneNode, pieces: &mut [Piece], lowest: f64) -> Result<(), Refusal> {
    let chamber = Station { exner: lowest, temperature: lone.supply.temperature };
    for piece in pieces {
        for lands in &piece.lands {
            let mirrored = lone.mirrored(lands);
            let flows = lone.flows(mirrored, &chamber, 0.0, PortFlow::Charging).ok_or(Refusal::NoFlows)?;
            piece.per_other.push(1.0 / flows.supply);
        }
    }
    Ok(())
}

/// Even columns over every pressure of a chamber at every spool, one of them beginning where no air flows.
fn columns(lone: &LoneNode, pieces: &[Piece], exners: [f64; 2], cells: usize) -> Axis {
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for piece in pieces {
        for (lands, per_other) in piece.lands.iter().zip(&piece.per_other) {
            for other in [0.0, 1.0 / per_other] {
                let blocked = lone.blocked(lands, other);
                low = low.min(blocked.coordinate(exners[1]));
                high = high.max(blocked.coordinate(exners[0]));
            }
        }
    }
    let width = (high - low) / (cells - 1) as f64;
    let below = (-low / width).ceil();
    Axis::even(-below * width, (cells as f64 - below) * width, cells)
}
