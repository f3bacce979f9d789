//! Pressure gain (7.1.1.2, Fig. 7.3): the pressures of blocked ports over the spool, and the null of the
//! valve by least squares (7.1.1.3, Tab. 7.1).
//!
//! The method is the thesis's: the pressures of the valve on the bench are read at micrometer positions. The curves
//! of the same valve with its null at zero are shifted along them until the sum of the squared differences of both
//! pressures is smallest:
//!
//! ```text
//! x_0 = argmin  sum_j sum_i (P_i(x_j) - P_i,null=0(x_j - x_0))^2
//! ```
//!
//! Its uncertainty is twice its standard error: the misfit over the root of the sum of the squared slopes.

use super::bench::ValveBench;
use super::points::{evenly, supplies};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "pressures of blocked ports over the spool, by supply pressure, and the null (7.1.1.2, Fig. 7.3, Tab. 7.1)";

/// How far to either side of the crossing the curves are read, as a part of the travel, and how often.
const HALF_WIDTH: f64 = 0.1;
const INTERVALS: usize = 20;

/// Slopes are taken over this part of the travel to either side.
const SLOPE_OVER: f64 = 1e-3;

/// Resolution of the gauges, Pa.
const READING_PA: f64 = 1e3;

/// A blocked-port test: spool positions (m) and the pressures (Pa) read there.
#[derive(Clone, Debug, PartialEq)]
pub struct Readings {
    /// Spool positions, m.
    pub spool: Vec<f64>,
    /// Pressures of ports 1 and 2, Pa.
    pub pressures: Vec<[f64; 2]>,
}

/// A null found by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Null {
    /// Spool position, m.
    pub position: f64,
    /// Standard error of the position, m.
    pub deviation: f64,
    /// Root of the mean squared difference of the pressures that is left, Pa.
    pub misfit_pa: f64,
}

/// Reads the blocked ports of a rig's valve about their crossing, under a supply pressure (Pa), to whole
/// `reading_pa` (0: exactly). None where the pressures do not cross within the travel.
#[must_use]
pub(crate) fn read_blocked_ports(rig: &Rig, supply_pa: f64, reading_pa: f64) -> Option<Readings> {
    let mut bench = ValveBench::new(rig, supply_pa);
    let middle = crossing(&mut bench)?;
    let rounded = |pressure: f64| {
        if reading_pa > 0.0 { (pressure / reading_pa).round() * reading_pa } else { pressure }
    };
    let half_width = HALF_WIDTH * bench.valve.travel;
    let spool = evenly(middle - half_width, middle + half_width, INTERVALS);
    let pressures = spool.iter().map(|&x| bench.blocked(x).map(rounded)).collect();
    Some(Readings { spool, pressures })
}

/// The first guess: where P1 overtakes P2, m, on a grid of a hundredth of the travel.
fn crossing(bench: &mut ValveBench) -> Option<f64> {
    let travel = bench.valve.travel;
    let difference = |bench: &mut ValveBench, x: f64| {
        let [p1, p2] = bench.blocked(x);
        p1 - p2
    };
    let places = evenly(-travel, travel, 200);
    let differences: Vec<f64> = places.iter().map(|&x| difference(bench, x)).collect();
    let after = differences.windows(2).position(|pair| pair[0] < 0.0 && pair[1] >= 0.0)?;
    let (a, b) = (-differences[after], differences[after + 1]);
    Some(places[after] + (places[after + 1] - places[after]) * a / (a + b))
}

/// The null of readings, by least squares against the rig's own curves with their null at zero.
#[must_use]
pub(crate) fn null_by_least_squares(rig: &Rig, supply_pa: f64, readings: &Readings) -> Null {
    let mut bench = ValveBench::new(rig, supply_pa);
    bench.valve.null_offset = 0.0;
    let middle = readings.spool.iter().sum::<f64>() / readings.spool.len().max(1) as f64;
    let mut squares = |null: f64| -> f64 {
        let terms = readings.spool.iter().zip(&readings.pressures).map(|(x, read)| {
            let theory = bench.blocked(x - null);
            (0..2).map(|port| (read[port] - theory[port]).powi(2)).sum::<f64>()
        });
        terms.sum()
    };
    let travel = rig.get(&keys::valve::SPOOL_TRAVEL_MM) * 1e-3;
    let position =
        least(&mut squares, middle - HALF_WIDTH * travel / 2.0, middle + HALF_WIDTH * travel / 2.0);
    let misfit_pa = (squares(position) / (2 * readings.spool.len()) as f64).sqrt();
    let slopes = readings.spool.iter().flat_map(|x| slopes(&mut bench, x - position));
    let deviation = misfit_pa / slopes.map(|slope| slope * slope).sum::<f64>().sqrt();
    Null { position, deviation, misfit_pa }
}

/// Slope of the pressures of blocked ports at a place of the spool, Pa/m.
fn slopes(bench: &mut ValveBench, spool: f64) -> [f64; 2] {
    let beside = SLOPE_OVER * bench.valve.travel;
    let [before, after] = [-beside, beside].map(|by| bench.blocked(spool + by));
    [0, 1].map(|port| (after[port] - before[port]) / (2.0 * beside))
}

/// Where `f` is least between `a` and `b`, by the golden section, to 0.1 nm.
fn least(f: &mut impl FnMut(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let section = (5.0_f64.sqrt() - 1.0) / 2.0;
    let inner = |a: f64, b: f64| [b - section * (b - a), a + section * (b - a)];
    let [mut c, mut d] = inner(a, b);
    let (mut fc, mut fd) = (f(c), f(d));
    while b - a > 1e-10 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = inner(a, b)[0];
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = inner(a, b)[1];
            fd = f(d);
        }
    }
    (a + b) / 2.0
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let mut found = Characteristic {
        notes: vec![format!(
            "Both ports are blocked. The rig's own supply pressure comes first, then those of the thesis. The null is where the curves of the same valve with its null at zero fit best, in least squares, as in 7.1.1.3; gauges are read to {} kPa.",
            READING_PA / 1e3
        )],
        across: "spool, mm",
        ..Characteristic::default()
    };
    let mut series = Vec::new();
    for supply in supplies(rig) {
        let label = format!("Ps = {:.1} kPa", supply / 1e3);
        let readings = read_blocked_ports(rig, supply, READING_PA)
            .ok_or(Unfit::NoPart("the pressures of its blocked ports do not cross: nothing leaks from its lands, or its null is beyond the travel"))?;
        let null = null_by_least_squares(rig, supply, &readings);
        let name = |what: &str| format!("{what}, {label}");
        found.figures.extend([
            Figure::read(name("null"), null.position * 1e3, 2e3 * null.deviation, "mm"),
            Figure::computed(name("misfit"), null.misfit_pa / 1e3, "kPa"),
        ]);
        series.extend(curves(rig, supply, null.position, &label));
    }
    found.graphs.push(Graph { title: "blocked port, kPa", series });
    Ok(found)
}

/// P1 and P2 about the null.
fn curves(rig: &Rig, supply_pa: f64, null: f64, label: &str) -> [Curve; 2] {
    let mut bench = ValveBench::new(rig, supply_pa);
    let half_width = HALF_WIDTH * bench.valve.travel;
    let spool = evenly(null - 3.0 * half_width, null + 3.0 * half_width, 120);
    let pressures: Vec<[f64; 2]> = spool.iter().map(|&x| bench.blocked(x)).collect();
    let x: Vec<f64> = spool.iter().map(|x| x * 1e3).collect();
    [0, 1].map(|port| {
        Curve::new(
            &format!("P{}, {label}", port + 1),
            x.clone(),
            pressures.iter().map(|pressures| pressures[port] / 1e3).collect(),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    /// Tab. 7.1 names its nulls to a micrometre.
    #[test]
    fn a_given_null_is_found_to_0_2_micrometres_with_gauges_read_to_a_kilopascal() {
        for (offset, reading, within) in
            [(0.0, 0.0, 1e-9), (0.037, 0.0, 1e-9), (0.037, 1e3, 0.2e-6), (-0.41, 1e3, 0.2e-6)]
        {
            let rig = rig(&[&format!("valve.null_offset_mm={offset}")]);
            for supply in [607.8e3, 202.6e3] {
                let readings = read_blocked_ports(&rig, supply, reading).expect("a crossing");
                let null = null_by_least_squares(&rig, supply, &readings);
                let off = null.position - offset * 1e-3;
                assert!(off.abs() < within, "{offset} mm read to {reading} Pa: off by {off} m");
                let known = 3.0 * null.deviation + 1e-10;
                assert!(off.abs() < known && null.deviation < within, "{offset} mm, {reading} Pa: {null:?}");
            }
        }
    }

    /// EQUATIONS section 2: all four edges leak alike at null, 475.6 kPa of 589.
    #[test]
    fn at_null_both_blocked_ports_stand_at_0_81_of_the_supply() {
        let mut bench = ValveBench::new(&rig(&["valve.upstream_mach=false"]), 589e3);
        for pressure in bench.blocked(0.0) {
            assert!((pressure - 475.6e3).abs() < 50.0, "{pressure}");
        }
    }

    #[test]
    fn the_curves_of_a_valve_of_short_travel_are_read_within_it() {
        let short = rig(&["valve.spool_travel_mm=0.3"]);
        let readings = read_blocked_ports(&short, 589e3, 0.0).expect("a crossing");
        assert!((readings.spool[0] + 0.03e-3).abs() < 1e-9, "{:?}", readings.spool);
    }

    #[test]
    fn far_from_null_a_blocked_port_stands_at_supply_or_exhaust() {
        let mut bench = ValveBench::new(&rig(&[]), 589e3);
        let [p1, p2] = bench.blocked(1e-3);
        assert!(p1 > 0.995 * 589e3 && p2 < 1.005 * 101.3e3, "{p1} {p2}");
        let [q1, q2] = bench.blocked(-1e-3);
        assert!((q1 - p2).abs() < 1.0 && (q2 - p1).abs() < 1.0, "{q1} {q2}");
    }

    #[test]
    fn a_valve_that_shuts_off_has_no_blocked_port_pressures() {
        let tight = rig(&["valve.spool_diameter_mm=10.0"]);
        assert!(matches!(measure(&tight), Err(Unfit::NoPart(_))));
    }
}
