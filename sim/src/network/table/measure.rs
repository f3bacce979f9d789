//! How far a table is from the network.
//!
//! Each cell is looked at in eight places, at four temperatures of the chamber where that counts. The error of a
//! place is that of m or s, the larger one, over the larger of the flow there and [`FLOOR`] of the largest flow of all.

use super::fill::Filling;
use super::grid::{Grid, PARTS};
use super::node::{Blocked, Flows};
use super::{Asked, FLOOR, Frame, Guess, MOST_ERROR, Quality, RESERVE, Refusal, TEMPERATURES, Warmth};
use crate::air::Station;
use crate::network::PortFlow;
use crate::network::nodes::pair;
use crate::number::{Number, Pair};
use crate::valve::Conductances;

/// Places in a cell: along the spool, the columns and the other node's flow, and T_c/T_s.
const POINTS: [[f64; 4]; 8] = [
    [0.25, 0.75, 0.25, TEMPERATURES[0]],
    [0.75, 0.25, 0.75, TEMPERATURES[1]],
    [0.5, 0.15, PARTS[1], 0.85],
    [0.5, 0.85, PARTS[1], 0.85],
    [0.5, 0.5, PARTS[0], 1.0],
    [0.85, 0.05, 0.15, 1.0],
    [0.85, 0.15, 0.85, 1.15],
    [0.15, 0.95, 0.75, 1.0],
];

/// A cell that is off by less than [`CLEAR`] of its flow in so many places is not looked at in the others.
const SURVEY: usize = 4;
const CLEAR: f64 = 3e-5;

/// A place in every cell of a row.
struct Place {
    spool: f64,
    lands: Conductances,
    other: f64,
    blocked: Blocked,
    /// Part of a column.
    across: f64,
    warmth: f64,
}

/// What was found at a place.
#[derive(Clone, Copy, Debug)]
struct Found {
    cell: usize,
    /// kg/s.
    error: f64,
    flow: f64,
}

/// Measures every cell, leaves out those that are off by too much with their neighbours along the columns (what makes
/// a cell bad may end between two places of the next one), and tells how good the rest is.
pub(super) fn measure<const O: usize>(
    filling: &mut Filling<O>,
    frame: &Frame,
    grid: &mut Grid<O>,
) -> Result<Quality, Refusal> {
    let mut found = Vec::new();
    let mut row = 0;
    for piece in 0..filling.pieces.len() {
        for cell in 0..filling.pieces[piece].axis.cells() {
            let mut worst = vec![0.0_f64; grid.columns];
            for (i, point) in POINTS.into_iter().enumerate() {
                let place = filling.place(piece, cell, point);
                for (column, worst) in worst.iter_mut().enumerate() {
                    if i >= SURVEY && *worst < CLEAR {
                        continue;
                    }
                    if let Some((error, flow)) = filling.error(frame, grid, &place, column)? {
                        *worst = worst.max(error / flow);
                        found.push(Found { cell: grid.cell(row, column), error, flow });
                    }
                }
            }
            row += 1;
        }
    }
    Ok(leave_out(grid, &found))
}

fn leave_out<const O: usize>(grid: &mut Grid<O>, found: &[Found]) -> Quality {
    let largest = found.iter().fold(0.0, |most: f64, found| most.max(found.flow));
    let floor = FLOOR * largest;
    let mut errors = vec![None; grid.cells.len()];
    for Found { cell, error, flow } in found {
        let most = errors[*cell].get_or_insert(0.0_f64);
        *most = most.max(error / flow.max(floor));
    }
    let fits = |error: &Option<f64>| error.is_none_or(|error| error <= RESERVE * MOST_ERROR);
    let (mut cells, mut left, mut worst) = (0, 0, 0.0_f64);
    for (i, cell) in grid.cells.iter_mut().enumerate() {
        let beside = &errors[i.saturating_sub(1)..errors.len().min(i + 2)];
        match errors[i] {
            Some(error) if beside.iter().all(fits) => worst = worst.max(error),
            error => {
                left += usize::from(error.is_some());
                *cell = [[[pair(f64::NAN); 4]; 4]; O];
            }
        }
        cells += usize::from(errors[i].is_some());
    }
    Quality { error: worst, left_out: left as f64 / cells as f64, cells: cells - left, largest }
}

impl<const O: usize> Filling<O> {
    fn place(&self, piece: usize, cell: usize, [along, across, part, warmth]: [f64; 4]) -> Place {
        let piece = &self.pieces[piece];
        let spool = piece.axis.knots[cell] + along * piece.axis.width(cell);
        let [a, b, c, d] = piece.axis.cubics(|i| piece.per_other[i]).nth(cell).unwrap_or_default();
        let other = part / (a + along * (b + along * (c + along * d)));
        let lands = piece.lands_at(&self.lone, spool);
        Place { spool, lands, other, blocked: self.lone.blocked(&lands, other), across, warmth }
    }

    /// Error of the flows at a place of a column, and the flow, kg/s; None where no chamber is.
    fn error(
        &mut self,
        frame: &Frame,
        grid: &Grid<O>,
        place: &Place,
        column: usize,
    ) -> Result<Option<(f64, f64)>, Refusal> {
        let u = self.columns.knots[column] + place.across * self.columns.width(column);
        let exner = place.blocked.exner_at(u);
        if !(frame.exners[0] <= exner && exner <= frame.exners[1]) {
            return Ok(None);
        }
        let charging = u >= 0.0;
        let temperature = frame.supply_temperature * place.warmth;
        let port = if charging { PortFlow::Charging } else { PortFlow::Discharging };
        let chamber = Station { exner, temperature };
        let exact = self.lone.flows(place.lands, &chamber, place.other, port).ok_or(Refusal::NoFlows)?;
        let exhaust_land = pair(place.lands.exhaust);
        let charging = pair(f64::from(u8::from(charging))).above(Pair::ZERO);
        let asked = Asked {
            spool: pair(place.spool),
            exner: pair(exner),
            other: pair(place.other),
            warmth: Warmth::of(frame, pair(temperature), charging, exhaust_land),
        };
        let found = asked.answer(grid, &exact);
        let error = (found.port - exact.port).abs().max((found.supply - exact.supply).abs());
        Ok(Some((error, exact.port.abs().max(exact.supply.abs()))))
    }
}

impl Asked {
    /// What the table makes of it for a node by itself.
    fn answer<const O: usize>(&self, grid: &Grid<O>, near: &Flows) -> Flows {
        let guess = Guess { port: pair(near.port) * self.warmth.root, supply: pair(near.supply) };
        // From the network's flows one correction leaves no more than the square of their error.
        let guess = grid.corrected(self, &guess, false).0;
        let port = self.warmth.port_flow(guess.port, guess.supply);
        Flows { port: port.lane(0), supply: guess.supply.lane(0) }
    }
}
