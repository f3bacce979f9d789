//! The coefficients of a table, and one look into it for both nodes.
//!
//! Rows go along the spool, cells of a row along the flow coordinate. In each cell the flows (m', s) are a polynomial
//! of degree 3 by 3 by O - 1, in its places from 0 to 1; a row has w_0 and alpha as well, of degree 3 by O - 1.

use super::axis::{Cubic, polynomial};
use super::knots::Piece;
use crate::number::{Number, Pair};

/// Of both m' and s (or of w_0 and alpha), along the spool and the other node's flow.
pub(super) type Sheet<const O: usize> = [[Pair; 4]; O];
/// The same, along the flow coordinate as well: the coefficients of each power of the other node's flow together.
pub(super) type Cell<const O: usize> = [[[Pair; 4]; 4]; O];

/// A row of cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Where it begins along the spool.
    pub begin: f64,
    pub per_width: f64,
    /// One over the most that the other node takes, s/kg: a cubic.
    pub per_other: Cubic,
}

/// A table of polynomials.
#[derive(Clone, Debug)]
pub(super) struct Grid<const O: usize> {
    /// The first and the last are beyond the table.
    pub rows: Vec<Row>,
    pub blocked: Vec<Sheet<O>>,
    /// Row by row; the first and the last of each are beyond the table.
    pub cells: Vec<Cell<O>>,
    pub columns: usize,
    /// Of the flow coordinate.
    low: Pair,
    per_column: Pair,
    /// The row in which each even part of the spool's way begins.
    bins: Vec<u16>,
    first: Pair,
    per_bin: Pair,
}

/// Flows with their slopes over w of the chamber and the other node's flow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// How far what the other node takes lies outside of the table.
    pub beyond: Pair,
    pub port: Slopes,
    pub supply: Slopes,
}

/// A value with its slopes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    pub value: Pair,
    pub by_exner: Pair,
    pub by_other: Pair,
}

/// 1.5 * 2^52: added to a number it leaves its whole part in the lowest bits.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// What the other node takes, over the most that it takes at rest.
pub(super) const PARTS: [f64; 2] = [-0.1, 1.02];

const BINS: usize = 2048;

const NOWHERE: Pair = Pair::new([f64::NAN; 2]);

impl<const O: usize> Grid<O> {
    /// A table without contents: what is beyond it is no number.
    pub fn new(pieces: &[Piece], columns: usize, low: f64, high: f64) -> Grid<O> {
        let beyond = |begin| Row { begin, per_width: 0.0, per_other: [0.0; 4] };
        let inside = pieces.iter().flat_map(|piece| {
            let per_other = piece.axis.cubics(|i| piece.per_other[i]);
            per_other.enumerate().map(|(i, per_other)| Row {
                begin: piece.axis.knots[i],
                per_width: 1.0 / piece.axis.width(i),
                per_other,
            })
        });
        let first = pieces[0].axis.knots[0];
        let last = *pieces[pieces.len() - 1].axis.knots.last().unwrap_or(&first);
        let mut rows = vec![beyond(f64::NEG_INFINITY)];
        rows.extend(inside);
        rows.push(beyond(last));
        let per_bin = (BINS - 2) as f64 / (last - first);
        let begins = |bin: usize| first + (bin as f64 - 1.0) / per_bin;
        let row_at = |x: f64| rows.iter().rposition(|row| row.begin <= x).unwrap_or(0) as u16;
        Grid {
            bins: (0..BINS).map(|bin| row_at(begins(bin))).collect(),
            blocked: vec![[[NOWHERE; 4]; O]; rows.len()],
            cells: vec![[[[NOWHERE; 4]; 4]; O]; rows.len() * (columns + 2)],
            rows,
            columns,
            low: Pair::splat(low),
            per_column: Pair::splat(columns as f64 / (high - low)),
            first: Pair::splat(first),
            per_bin: Pair::splat(per_bin),
        }
    }

    /// Number of a cell, counted from the first inside the table.
    pub fn cell(&self, row: usize, column: usize) -> usize {
        (row + 1) * (self.columns + 2) + column + 1
    }

    /// The flows for two nodes: each has its place along the spool, w of its chamber and what the other one takes.
    #[inline(always)]
    pub fn look(&self, spool: Pair, exner: Pair, other: Pair) -> Look {
        let rows = self.rows_at(spool);
        let (one, two) = (&self.rows[rows[0]], &self.rows[rows[1]]);
        let along = (spool - Pair::new([one.begin, two.begin])) * Pair::new([one.per_width, two.per_width]);
        let (t, t_two) = (Pair::splat(along.lane(0)), Pair::splat(along.lane(1)));
        let per_other =
            Pair::new([cubic(&one.per_other, along.lane(0)), cubic(&two.per_other, along.lane(1))]);
        let part = other * per_other;
        let known = part.fast_max(Pair::splat(PARTS[0])).fast_min(Pair::splat(PARTS[1]));
        let beyond = part - known;
        let part = known;
        let (p, p_two) = (Pair::splat(part.lane(0)), Pair::splat(part.lane(1)));
        let (rests, rests_move) = on_sheet(&self.blocked[rows[0]], t, p);
        let (rests_two, rests_move_two) = on_sheet(&self.blocked[rows[1]], t_two, p_two);
        let (rest, softness) = transposed(rests, rests_two);
        let (rest_moves, softness_moves) = transposed(rests_move, rests_move_two);
        let drop = rest - exner;
        let soft = softness + (softness * softness + Pair::splat(4.0) * drop.abs()).sqrt();
        let u = (drop + drop) / soft;
        let column = (u - self.low) * self.per_column + Pair::splat(1.0);
        let column = within(column, self.columns + 1);
        let [first, second] = whole(column);
        let stride = self.columns + 2;
        let place = column - Pair::new([first as f64, second as f64]);
        let cell = inside(&self.cells[rows[0] * stride + first], t, Pair::splat(place.lane(0)), p);
        let cell_two =
            inside(&self.cells[rows[1] * stride + second], t_two, Pair::splat(place.lane(1)), p_two);
        let value = transposed(cell[0], cell_two[0]);
        let by_u = transposed(cell[1], cell_two[1]);
        let by_part = transposed(cell[2], cell_two[2]);
        let per_slope = Pair::splat(1.0) / (softness + Pair::splat(2.0) * u.abs());
        let u_by_part = (rest_moves - u * softness_moves) * per_slope;
        let (port_by_u, supply_by_u) = (by_u.0 * self.per_column, by_u.1 * self.per_column);
        Look {
            beyond,
            port: Slopes {
                value: value.0,
                by_exner: -port_by_u * per_slope,
                by_other: (by_part.0 + port_by_u * u_by_part) * per_other,
            },
            supply: Slopes {
                value: value.1,
                by_exner: -supply_by_u * per_slope,
                by_other: (by_part.1 + supply_by_u * u_by_part) * per_other,
            },
        }
    }

    /// The rows that have places along the spool.
    #[inline(always)]
    fn rows_at(&self, spool: Pair) -> [usize; 2] {
        let bin = (spool - self.first) * self.per_bin + Pair::splat(1.0);
        let [one, two] = whole(within(bin, BINS - 1));
        [self.row_from(self.bins[one], spool.lane(0)), self.row_from(self.bins[two], spool.lane(1))]
    }

    #[inline(always)]
    fn row_from(&self, first: u16, spool: f64) -> usize {
        let mut row = usize::from(first);
        while self.rows.get(row + 1).is_some_and(|next| spool >= next.begin) {
            row += 1;
        }
        row
    }
}

/// From 0 to `most`; 0 of what is no number.
#[inline(always)]
fn within(numbers: Pair, most: usize) -> Pair {
    let positive = Pair::choose(numbers.above(Pair::ZERO), numbers, Pair::ZERO);
    positive.fast_min(Pair::splat(most as f64))
}

/// The whole parts of two positive numbers below 2^31.
#[inline(always)]
fn whole(numbers: Pair) -> [usize; 2] {
    let [one, two] = (numbers - Pair::splat(0.5) + Pair::splat(WHOLE)).to_array();
    [(one.to_bits() & 0x7fff) as usize, (two.to_bits() & 0x7fff) as usize]
}

#[inline(always)]
fn transposed(one: Pair, two: Pair) -> (Pair, Pair) {
    let [first, second] = Pair::transpose([one, two]);
    (first, second)
}

#[inline(always)]
fn cubic<N: Number>([a, b, c, d]: &[N; 4], t: N) -> N {
    *a + t * (*b + t * (*c + t * *d))
}

/// A sheet at a place, and its slope over the other node's flow.
#[inline(always)]
fn on_sheet<const O: usize>(sheet: &Sheet<O>, along: Pair, part: Pair) -> (Pair, Pair) {
    let (mut value, mut by_part) = (cubic(&sheet[O - 1], along), Pair::ZERO);
    for power in sheet[..O - 1].iter().rev() {
        by_part = by_part * part + value;
        value = value * part + cubic(power, along);
    }
    (value, by_part)
}

/// The polynomial of a cell, and its slopes along the columns and over the other node's flow.
#[inline(always)]
fn inside<const O: usize>(cell: &Cell<O>, along: Pair, t: Pair, part: Pair) -> [Pair; 3] {
    let ((mut value, mut by_t), mut by_part) = (across(&cell[O - 1], along, t), Pair::ZERO);
    for power in cell[..O - 1].iter().rev() {
        let (next, next_by_t) = across(power, along, t);
        by_part = by_part * part + value;
        value = value * part + next;
        by_t = by_t * part + next_by_t;
    }
    [value, by_t, by_part]
}

/// What goes with one power of the other node's flow, and its slope along the columns.
#[inline(always)]
fn across([a, b, c, d]: &[[Pair; 4]; 4], along: Pair, t: Pair) -> (Pair, Pair) {
    let d = cubic(d, along);
    let bent = cubic(c, along) + t * d;
    let slope = cubic(b, along) + t * bent;
    (cubic(a, along) + t * slope, slope + t * (bent + t * d))
}

/// The coefficients of the powers of a part of the other node's flow, of pairs known at some of its parts.
pub(super) fn powers_of_other<const O: usize>(places: &[f64; O], values: &[Pair; O]) -> [Pair; O] {
    let lane = |i: usize| polynomial(places, std::array::from_fn(|o| values[o].lane(i)));
    let (one, two) = (lane(0), lane(1));
    std::array::from_fn(|o| Pair::new([one[o], two[o]]))
}
