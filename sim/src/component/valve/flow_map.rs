//! Flow by a measured map: over the spool and over both pressures.
//!
//! ```text
//! mdot = rho_0 P_u sqrt(T_0/T_u) q(x, r),   r = P_d/P_u       q = Q/P_u of each measured point, m^3/(s Pa)
//! mdot^2 = K/T_u psi(w_u, w_d),   K = rho_0^2 T_0,   psi = P_u^2 s(r),   s = q^2
//! ```
//!
//! The points make a grid: each place of the spool with each pressure ratio. Between places of the spool q follows the curve of
//! [`crate::monotone`], at each ratio; between ratios s does, as s of a component by its conductance is a parabola. It ends in
//! s = 0 at r = 1, and below the lowest ratio it keeps its value, as choked flow does. A flow that rises with the
//! pressure behind the valve is the scatter of the measurement: such points are levelled (pool adjacent violators), and refused
//! if one has to move by more than two of its standard deviations. A tight path keeps 1e-4 of the largest flow, less than a flow
//! meter tells.
//!
//! The map is that of the path from the supply to port 1, x positive where it opens; that to port 2 is its mirror image, and air
//! goes to the exhaust through lands like these. `flow_map_shift` moves all points by so many of their standard deviations: it
//! carries the spread of the measurement into whatever is computed.

use crate::component::gas::{FlowFunction, Gas};
use crate::monotone::{Monotone, slopes_into};

/// Most pressure ratios of a map.
pub const MAX_RATIOS: usize = 16;
/// Knots of a curve over the ratio: those, and r = 1.
const KNOTS: usize = MAX_RATIOS + 1;
/// Ratios that are nearer to each other are one.
const SAME_RATIO: f64 = 2e-3;
/// The smallest flow of a path, as a part of the largest: a flow meter tells no less.
const TIGHT: f64 = 1e-4;
/// m^3/(s Pa) in l/min per kPa.
const LITRES_PER_MINUTE_KPA: f64 = 1e-3 / 60.0 / 1e3;

/// A measured map.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowMap {
    ratios: Vec<f64>,
    /// q over the place of the spool (of its travel), for each ratio.
    over_spool: Vec<Monotone>,
}

/// What of a map holds at a place of the spool: s over the pressure ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    knots: usize,
    ratios: [f64; KNOTS],
    squares: [f64; KNOTS],
    slopes: [f64; KNOTS],
}

/// A measured point.
#[derive(Clone, Copy, Debug)]
struct Point {
    spool: f64,
    ratio: f64,
    conductance: f64,
    deviation: f64,
}

impl Point {
    fn of(row: &[f64]) -> Point {
        let per_pressure = LITRES_PER_MINUTE_KPA / row[1];
        Point {
            spool: 1e-2 * row[0],
            ratio: row[2] / row[1],
            conductance: per_pressure * row[3],
            deviation: per_pressure * row[4],
        }
    }
}

impl FlowMap {
    /// The map through these rows, each flow higher by `shift` standard deviations.
    ///
    /// # Errors
    /// The reason why the rows do not make a map.
    pub fn through(rows: &[Vec<f64>], shift: f64) -> Result<FlowMap, String> {
        check_rows(rows)?;
        let points: Vec<Point> = rows.iter().map(|row| Point::of(row)).collect();
        let spools = distinct(points.iter().map(|point| point.spool), 1e-6);
        let ratios = distinct(points.iter().map(|point| point.ratio), SAME_RATIO);
        if spools.len() < 2 || ratios.len() > MAX_RATIOS {
            return Err(format!(
                "needs two places of the spool at least, and {MAX_RATIOS} pressure ratios at most"
            ));
        }
        let grid = grid(&points, &spools, &ratios)?;
        let largest = points.iter().map(|point| point.conductance).fold(0.0, f64::max);
        let levelled = grid.iter().map(|row| levelled(row, shift)).collect::<Result<Vec<_>, _>>()?;
        let column = |j: usize| levelled.iter().map(|row| row[j].max(TIGHT * largest)).collect();
        let over_spool = (0..ratios.len()).map(|j| Monotone::through(spools.clone(), column(j))).collect();
        Ok(FlowMap { ratios, over_spool })
    }

    /// The map with the spool at this part of its travel, positive where the path opens.
    #[must_use]
    pub fn at(&self, spool: f64) -> Slice {
        let mut slice = Slice {
            knots: self.ratios.len() + 1,
            ratios: [1.0; KNOTS],
            squares: [0.0; KNOTS],
            slopes: [0.0; KNOTS],
        };
        let mut above = f64::INFINITY;
        for (j, (ratio, curve)) in self.ratios.iter().zip(&self.over_spool).enumerate() {
            // Curves that do not cross at the points might between them.
            above = curve.at(spool).0.min(above);
            (slice.ratios[j], slice.squares[j]) = (*ratio, above * above);
        }
        let knots = slice.knots;
        slopes_into(&slice.ratios[..knots], &slice.squares[..knots], &mut slice.slopes[..knots]);
        // It is level in front of the first knot.
        slice.slopes[0] = 0.0;
        slice
    }
}

impl Slice {
    /// psi from `upstream` to `downstream`, Exner pressures of which the first is not the lower.
    pub(crate) fn flow_function(&self, gas: &Gas, upstream: f64, downstream: f64) -> FlowFunction {
        let (up, down) = (gas.pressure(upstream), gas.pressure(downstream));
        let by_exner = 1.0 / gas.exner_exponent();
        let (square, slope) = self.square(down / up);
        FlowFunction {
            value: up * up * square,
            by_upstream: by_exner * up * up / upstream * (2.0 * square - down / up * slope),
            by_downstream: if slope == 0.0 { 0.0 } else { by_exner * up * down / downstream * slope },
        }
    }

    /// s at a pressure ratio, and its slope.
    fn square(&self, ratio: f64) -> (f64, f64) {
        let knots = self.knots;
        crate::monotone::between(&self.ratios[..knots], &self.squares[..knots], &self.slopes[..knots], ratio)
    }
}

fn check_rows(rows: &[Vec<f64>]) -> Result<(), String> {
    for row in rows {
        let &[spool, up, down, flow, deviation] = &row[..] else {
            return Err("has rows of five numbers".to_owned());
        };
        if !(up > 0.0 && (0.0..up).contains(&down)) {
            return Err(format!(
                "{row:?}: absolute pressures that fall are needed; at equal ones nothing flows"
            ));
        }
        if !((-100.0..=100.0).contains(&spool) && flow >= 0.0 && deviation >= 0.0) {
            return Err(format!(
                "{row:?}: the spool lies from -100 to 100 %, flow and deviation are not negative"
            ));
        }
    }
    Ok(())
}

/// Values in rising order, those that are next to each other once.
fn distinct(values: impl Iterator<Item = f64>, same: f64) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|next, kept| *next - *kept < same);
    all
}

/// The points by their places of the spool, then by their ratios.
fn grid(points: &[Point], spools: &[f64], ratios: &[f64]) -> Result<Vec<Vec<Point>>, String> {
    let at = |spool: f64, ratio: f64| {
        let here = |point: &&Point| {
            (point.spool - spool).abs() < 1e-6 && (0.0..SAME_RATIO).contains(&(point.ratio - ratio))
        };
        let mut found = points.iter().filter(here);
        match (found.next(), found.next()) {
            (Some(point), None) => Ok(*point),
            (one, _) => Err(format!(
                "{} point at {:.1} % of the spool and a pressure ratio of {ratio:.3}: each place of the spool needs each ratio once",
                if one.is_none() { "no" } else { "more than one" },
                100.0 * spool
            )),
        }
    };
    let row = |spool: &f64| ratios.iter().map(|ratio| at(*spool, *ratio)).collect();
    spools.iter().map(row).collect()
}

/// The q of a place of the spool, shifted and not rising with the ratio: means of what would.
fn levelled(row: &[Point], shift: f64) -> Result<Vec<f64>, String> {
    let shifted = |point: &Point| (point.conductance + shift * point.deviation).max(0.0);
    let mut blocks: Vec<(f64, usize)> = Vec::new();
    for point in row {
        blocks.push((shifted(point), 1));
        while let [.., (before, m), (after, n)] = blocks[..]
            && after > before
        {
            blocks.truncate(blocks.len() - 2);
            blocks.push(((before * m as f64 + after * n as f64) / (m + n) as f64, m + n));
        }
    }
    let level: Vec<f64> =
        blocks.iter().flat_map(|(value, count)| std::iter::repeat_n(*value, *count)).collect();
    for (point, value) in row.iter().zip(&level) {
        if (shifted(point) - value).abs() > 2.0 * point.deviation + 1e-12 * value {
            return Err(format!(
                "at {:.1} % of the spool the flow rises with the pressure downstream about a ratio of {:.3}, by more than two standard deviations",
                100.0 * point.spool,
                point.ratio
            ));
        }
    }
    Ok(level)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::valve::iso6358::Iso6358;

    const RATIOS: [f64; 9] = [0.15, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97];

    /// A linear valve of 2 dm3/(s bar) and b = 0.3, from 7 bar, with 1 % of leakage.
    fn rows(off: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
        let shares = [(-100.0, 0.01), (0.0, 0.01), (25.0, 0.26), (50.0, 0.505), (75.0, 0.75), (100.0, 1.0)];
        let point = |(spool, share): (f64, f64), ratio: f64, i: usize| {
            let beyond = ((ratio - 0.3) / 0.7_f64).max(0.0);
            let flow = 840.0 * share * (1.0 - beyond * beyond).sqrt();
            vec![spool, 700.0, 700.0 * ratio, (flow + off(i)).max(0.0), 2.0]
        };
        let all = shares.iter().flat_map(|share| RATIOS.iter().map(move |ratio| (*share, *ratio)));
        all.enumerate().map(|(i, (share, ratio))| point(share, ratio, i)).collect()
    }

    fn gas() -> Gas {
        Gas::new(1.4, 286.76)
    }

    fn flow(slice: &Slice, ratio: f64) -> f64 {
        let psi = slice.flow_function(&gas(), gas().exner(7e5), gas().exner(7e5 * ratio));
        1.185 * psi.value.sqrt()
    }

    #[test]
    fn a_map_of_a_component_by_its_conductance_passes_what_that_passes() {
        let map = FlowMap::through(&rows(|_| 0.0), 0.0).expect("a map");
        for (spool, share) in [(1.0, 1.0), (0.5, 0.505), (0.6, 0.603), (-0.4, 0.01)] {
            let iso = Iso6358 { sonic_conductance: share * 2e-8, critical_ratio: 0.3, subsonic_index: 0.5 };
            for ratio in [0.0, 0.2, 0.35, 0.45, 0.65, 0.85, 0.95, 0.99] {
                let expected = iso.flow(&gas(), 7e5, 293.15, 7e5 * ratio);
                let got = flow(&map.at(spool), ratio);
                assert!(
                    (got - expected).abs() < 0.012 * share * 16.59e-3,
                    "{spool} {ratio}: {got} {expected}"
                );
            }
        }
    }

    #[test]
    fn it_goes_through_its_points() {
        let map = FlowMap::through(&rows(|_| 0.0), 0.0).expect("a map");
        for row in rows(|_| 0.0) {
            let got = flow(&map.at(1e-2 * row[0]), row[2] / row[1]) / 1.185 * 6e4;
            assert!((got - row[3]).abs() < 1e-6 * 840.0, "{row:?}: {got}");
        }
    }

    #[test]
    fn it_falls_with_the_pressure_behind_it_and_rises_with_the_spool_without_a_jump() {
        let map = FlowMap::through(&rows(|i| if i % 2 == 0 { 1.5 } else { -1.5 }), 0.0).expect("a map");
        for i in 0..=50 {
            let slice = map.at(0.02 * f64::from(i));
            let flows: Vec<f64> = (0..=500).map(|j| flow(&slice, 0.002 * f64::from(j))).collect();
            assert!(flows.windows(2).all(|pair| pair[1] <= pair[0] + 1e-15), "{i}");
            assert!(flows[..490].windows(2).all(|pair| pair[0] - pair[1] < 4e-4), "{i}: no jump");
        }
    }

    #[test]
    fn its_slopes_are_those_of_its_value() {
        let slice = FlowMap::through(&rows(|_| 0.0), 0.0).expect("a map").at(0.63);
        let up = gas().exner(589e3);
        for ratio in [0.1, 0.35, 0.52, 0.77, 0.93, 0.985] {
            let (down, d) = (gas().exner(589e3 * ratio), 1e-6 * up);
            let at = |u: f64, v: f64| slice.flow_function(&gas(), u, v).value;
            let f = slice.flow_function(&gas(), up, down);
            let by_up = (at(up + d, down) - at(up - d, down)) / (2.0 * d);
            let by_down = (at(up, down + d) - at(up, down - d)) / (2.0 * d);
            assert!((f.by_upstream - by_up).abs() < 1e-6 * f.value / up, "{ratio}");
            assert!((f.by_downstream - by_down).abs() < 1e-6 * f.value / up, "{ratio}");
        }
    }

    #[test]
    fn the_spread_of_the_measurement_moves_its_flow() {
        let flows = [-2.0, 0.0, 2.0]
            .map(|shift| flow(&FlowMap::through(&rows(|_| 0.0), shift).expect("a map").at(1.0), 0.1));
        let [low, middle, high] = flows.map(|flow| flow / 1.185 * 6e4);
        assert!((middle - 840.0).abs() < 1e-6 && (low - 836.0).abs() < 1e-6 && (high - 844.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_map_is_refused_with_the_reason() {
        let refused = |rows: &[Vec<f64>]| FlowMap::through(rows, 0.0).expect_err("refused");
        assert!(
            refused(&rows(|_| 0.0)[1..])
                .contains("no point at -100.0 % of the spool and a pressure ratio of 0.150")
        );
        assert!(refused(&[vec![0.0, 600.0, 700.0, 1.0, 1.0]]).contains("absolute pressures that fall"));
        assert!(
            refused(&rows(|i| if i == 50 { 90.0 } else { 0.0 }))
                .contains("more than two standard deviations")
        );
        assert!(refused(&rows(|_| 0.0)[..9]).contains("two places of the spool"));
    }
}
