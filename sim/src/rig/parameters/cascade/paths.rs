//! The paths through a valve and its tubes, as the law "cascade" knows them: a conductance, a critical ratio, a land and tubes.
//!
//! ```text
//! a path     m^2/x^2 + m/M = 1,   x = C g phi,   1/M = a + b/(y - 1)              y: ratio of the pressures at its ends
//! land       g = t/sqrt(1 + t^2),   t = h/p,   h = sqrt(z^2 + d^2)                d: clearance (D_v - D_s)/2
//! fit        1/C^2 (1 + (p/h)^2) (m/phi)^2 + a m + b m/(y - 1) = 1                least squares of 1/C^2, a and b, for the critical
//!            ratio of phi that leaves least, and the p that leaves least of both paths
//! ```
//!
//! m are the flows of the simulated valve with its tubes ([`crate::network`]), over chambers from the exhaust to the supply and from a
//! nearly shut to an open land. Lands and ports are orifices: an orifice has C = Cd A sqrt(n/(R T_0)) (2/(n+1))^((n+1)/(2(n-1)))/rho_0 and
//! b = (2/(n+1))^(n/(n-1)), its ellipse within 0.4 % of it. Two in series, which air enters with a speed, have another critical ratio; a tube
//! loses pressure with its flow, not with the square of it. What the law makes of the fit is within 6 % of m where no more than 15 % of it leaks (tested).

use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::component::supply;
use crate::component::valve::Valve;
use crate::component::valve::flow_law::FlowLaw;
use crate::component::valve::iso6358::{Iso6358, REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use crate::keys;
use crate::network::{Network, PortFlow};
use crate::values::Rig;

/// Pressures of the fit: from the first factor times the exhaust to the second times the supply, and how many.
const EMPTY: f64 = 1.05;
const FULL: f64 = 0.98;
const PRESSURES: u32 = 13;
/// Places of the spool, parts of how far it goes.
const PLACES: [f64; 7] = [0.01, 0.03, 0.07, 0.15, 0.3, 0.6, 1.0];
/// The part of a flow that leaks by the other land of its port, above which nothing is learned of it.
const LEAK: f64 = 0.15;
/// Critical ratios that are tried: this many, from 0 on, in steps of [`RATIO`].
const RATIOS: u32 = 17;
const RATIO: f64 = 0.05;
/// The middle of the pressures, a part of the supply.
const MIDDLE: f64 = 0.6;
/// Widths of the port that are tried: this many, from its bore on, each [`PORT`] times the one before.
const PORTS: u32 = 12;
const PORT: f64 = 1.15;

/// Both paths of a valve.
pub(super) struct Paths {
    /// Fully open: from the supply and to the exhaust.
    pub open: [Iso6358; 2],
    /// The part of it that a shut path without lands lets through.
    pub leakage: f64,
    pub land: Option<Land>,
    /// From the supply and to the exhaust.
    pub tubes: Option<[Tubes; 2]>,
    /// What the tubes leave of the flow out of a chamber at three fifths of the supply.
    pub kept: f64,
    /// By which that of lands is known.
    fits: Option<[Fit; 2]>,
}

/// A land before a port, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Land {
    /// p and d.
    pub port: f64,
    pub clearance: f64,
}

/// a and b, times the choked flow of the open path at the pressure of the supply.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tubes {
    pub choked: f64,
    pub slight: f64,
}

/// The direction of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Direction {
    In,
    Out,
}

/// A flow of the simulated valve.
#[derive(Clone, Copy, Debug)]
struct Flow {
    /// h, m, and the pressure of the chamber, Pa.
    height: f64,
    pressure: f64,
    /// m, kg/s.
    flow: f64,
}

/// A path with all that is fitted to it.
#[derive(Clone, Copy, Debug)]
struct Fit {
    direction: Direction,
    /// Supply and exhaust, Pa.
    ends: [f64; 2],
    critical_ratio: f64,
    /// 1/C^2, (Pa s/kg)^2.
    by_square: f64,
    /// p, m.
    port: f64,
    /// a and b, s/kg.
    choked: f64,
    slight: f64,
    /// Sum of the squares that it leaves.
    left: f64,
}

impl Paths {
    /// `reach`: how far the spool goes to either side, m.
    pub(super) fn of(rig: &Rig, reach: f64) -> Paths {
        let model = rig.get(&keys::valve::MODEL);
        if !model.facts().has_areas() {
            let share = share(rig, reach);
            let open = model.laws(rig).map(|law| match law {
                FlowLaw::Iso6358(path) => {
                    Iso6358 { sonic_conductance: share * path.sonic_conductance, ..path }
                }
                _ => Iso6358 { sonic_conductance: 0.0, critical_ratio: 0.0, subsonic_index: 0.5 },
            });
            return Paths {
                open,
                leakage: leakage(rig) / share,
                land: None,
                tubes: None,
                kept: 1.0,
                fits: None,
            };
        }
        let fits = fits(rig, reach);
        let valve = Valve::of(rig);
        let land = Land { port: fits[0].port, clearance: clearance(&valve) };
        let height = (reach - valve.lap).hypot(land.clearance);
        let temperature = rig.get(&keys::supply::TEMPERATURE_K);
        let at_reference = REFERENCE_DENSITY * (REFERENCE_TEMPERATURE / temperature).sqrt();
        let [_, out] = &fits;
        let middle = MIDDLE * out.ends[0];
        Paths {
            open: fits.map(|fit| Iso6358 {
                sonic_conductance: fit.open(height) / at_reference,
                critical_ratio: fit.critical_ratio,
                subsonic_index: 0.5,
            }),
            leakage: leakage(rig),
            land: Some(land),
            tubes: Some(fits.map(|fit| fit.tubes(height))),
            kept: out.flow(height, middle) / (out.open(height) * out.phi(middle)),
            fits: Some(fits),
        }
    }

    /// What a spool at z (m) lets through more than at its null, from the supply and to the exhaust, kg/s: chambers at three fifths of
    /// the supply. Nothing of a valve without lands.
    pub(super) fn more(&self, z: f64) -> [f64; 2] {
        let Some((fits, land)) = self.fits.zip(self.land) else { return [0.0; 2] };
        fits.map(|fit| {
            let at = |height: f64| fit.flow(height, MIDDLE * fit.ends[0]);
            at(z.hypot(land.clearance)) - at(land.clearance)
        })
    }
}

fn clearance(valve: &Valve) -> f64 {
    0.5 * (valve.sleeve_diameter - valve.spool_diameter)
}

/// The part of its conductance that a shut path without lands lets through.
fn leakage(rig: &Rig) -> f64 {
    1e-2 * rig.get(&keys::lands::LEAKAGE_PERCENT)
}

/// The part of its conductance to which a linear valve opens.
fn share(rig: &Rig, reach: f64) -> f64 {
    let valve = Valve::of(rig);
    1.0 - (1.0 - leakage(rig)) * (valve.travel - reach) / (valve.travel - valve.lap)
}

/// Both paths, with the port that they share.
fn fits(rig: &Rig, reach: f64) -> [Fit; 2] {
    let [into, out] = flows(rig, reach);
    let ends = [rig.get(&keys::supply::PRESSURE_PA), rig.get(&keys::exhaust::PRESSURE_PA)];
    let with = |port: f64| {
        [(Direction::In, &into), (Direction::Out, &out)]
            .map(|(direction, flows)| Fit::best(direction, ends, flows, port))
    };
    let valve = Valve::of(rig);
    let bore =
        valve.port_diameter * valve.port_diameter / (2.0 * (valve.sleeve_diameter + valve.spool_diameter));
    let left = |fits: &[Fit; 2]| fits[0].left + fits[1].left;
    let tried = (0..PORTS).map(|i| with(bore * libm::pow(PORT, f64::from(i))));
    tried.min_by(|one, other| left(one).total_cmp(&left(other))).expect("some are tried")
}

/// Flows of the simulated valve into and out of chambers.
fn flows(rig: &Rig, reach: f64) -> [Vec<Flow>; 2] {
    let (gas, valve) = (Gas::of(rig), Valve::of(rig));
    let temperature = supply::station(rig, &gas).temperature;
    let [supply, exhaust] = [&keys::supply::PRESSURE_PA, &keys::exhaust::PRESSURE_PA].map(|key| rig.get(key));
    let mut flows = [Vec::new(), Vec::new()];
    for part in PLACES {
        let z = part * (reach - valve.lap);
        let height = z.hypot(clearance(&valve));
        for i in 0..PRESSURES {
            let along = f64::from(i) / f64::from(PRESSURES - 1);
            let pressure = EMPTY * exhaust + along * (FULL * supply - EMPTY * exhaust);
            let chamber = GasState { exner: gas.exner(pressure), temperature };
            let ports = [PortFlow::Charging, PortFlow::Discharging];
            let spool = valve.null_offset + valve.lap + z;
            let [into, out] = Network::of(rig, gas).flows(&valve, spool, &[chamber; 2], &ports);
            let both = [(into.supply_flow, -into.exhaust_flow), (-out.exhaust_flow, out.supply_flow)];
            for (list, (flow, leak)) in flows.iter_mut().zip(both) {
                if leak < LEAK * flow {
                    list.push(Flow { height, pressure, flow });
                }
            }
        }
    }
    flows
}

impl Fit {
    /// With the critical ratio that leaves least.
    fn best(direction: Direction, ends: [f64; 2], flows: &[Flow], port: f64) -> Fit {
        let tried = (0..RATIOS).map(|i| Fit::of(direction, ends, RATIO * f64::from(i), flows, port));
        tried.min_by(|one, other| one.left.total_cmp(&other.left)).expect("some are tried")
    }

    fn of(direction: Direction, ends: [f64; 2], critical_ratio: f64, flows: &[Flow], port: f64) -> Fit {
        let mut fit = Fit {
            direction,
            ends,
            critical_ratio,
            by_square: 0.0,
            port,
            choked: 0.0,
            slight: 0.0,
            left: 0.0,
        };
        let row = |flow: &Flow| {
            let square = (flow.flow / fit.phi(flow.pressure)).powi(2);
            let in_series = 1.0 + (port / flow.height).powi(2);
            [square * in_series, flow.flow, flow.flow * fit.nearness(flow.pressure)]
        };
        let rows: Vec<[f64; 3]> = flows.iter().map(row).collect();
        let found = least_squares(&rows);
        fit.left = rows
            .iter()
            .map(|row| (row.iter().zip(found).map(|(a, x)| a * x).sum::<f64>() - 1.0).powi(2))
            .sum();
        [fit.by_square, fit.choked, fit.slight] = found;
        if found.iter().any(|value| *value <= 0.0) {
            fit.left = f64::INFINITY;
        }
        fit
    }

    /// Pressure upstream by the ellipse.
    fn phi(&self, pressure: f64) -> f64 {
        let [supply, exhaust] = self.ends;
        let (up, down) = match self.direction {
            Direction::In => (supply, pressure),
            Direction::Out => (pressure, exhaust),
        };
        let beyond = ((down / up - self.critical_ratio) / (1.0 - self.critical_ratio)).clamp(0.0, 1.0);
        up * (1.0 - beyond * beyond).sqrt()
    }

    /// 1/(y - 1).
    fn nearness(&self, pressure: f64) -> f64 {
        let [supply, exhaust] = self.ends;
        match self.direction {
            Direction::In => pressure / (supply - pressure),
            Direction::Out => exhaust / (pressure - exhaust),
        }
    }

    /// C g, kg/(s Pa).
    fn open(&self, height: f64) -> f64 {
        let t = height / self.port;
        t / t.hypot(1.0) / self.by_square.sqrt()
    }

    /// m.
    fn flow(&self, height: f64, pressure: f64) -> f64 {
        let x = self.open(height) * self.phi(pressure);
        let u = 0.5 * x * (self.choked + self.slight * self.nearness(pressure));
        x / (u.hypot(1.0) + u)
    }

    fn tubes(&self, height: f64) -> Tubes {
        let open = self.open(height) * self.ends[0];
        Tubes { choked: open * self.choked, slight: open * self.slight }
    }
}

/// x of the least sum of (rows x - 1)^2; a column of zeros has an x of 0.
fn least_squares(rows: &[[f64; 3]]) -> [f64; 3] {
    let scale: [f64; 3] = std::array::from_fn(|i| rows.iter().map(|row| row[i] * row[i]).sum::<f64>().sqrt());
    let scaled = |row: &[f64; 3], i: usize| if scale[i] > 0.0 { row[i] / scale[i] } else { 0.0 };
    let mut m = [[0.0; 4]; 3];
    for row in rows {
        for (i, sums) in m.iter_mut().enumerate() {
            for (j, sum) in sums.iter_mut().enumerate() {
                *sum += scaled(row, i) * if j < 3 { scaled(row, j) } else { 1.0 };
            }
        }
    }
    // Gauss and Jordan: positive definite but for columns of zeros.
    for i in 0..3 {
        let pivot = m[i];
        if pivot[i] > 1e-12 {
            for (k, row) in m.iter_mut().enumerate() {
                let by = if k == i { 1.0 - 1.0 / pivot[i] } else { row[i] / pivot[i] };
                row.iter_mut().zip(pivot).for_each(|(value, pivot)| *value -= by * pivot);
            }
        }
    }
    std::array::from_fn(|i| if scale[i] > 0.0 { m[i][3] / scale[i] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The law's equation beside the flows of the simulated valve.
    #[test]
    fn the_equation_of_a_path_is_the_flow_of_the_thesis_s_valve_with_its_tubes() {
        for (name, reach) in [("servo-a", 0.5e-3), ("servo-b", 1e-3), ("servo-c", 1e-3)] {
            let rig = Rig::builtin(name).expect("there");
            for (fit, flows) in fits(&rig, reach).iter().zip(flows(&rig, reach)) {
                let errors = flows.iter().map(|flow| fit.flow(flow.height, flow.pressure) / flow.flow - 1.0);
                let worst = errors.map(f64::abs).fold(0.0, f64::max);
                assert!(worst < 0.06 && worst > 0.03, "{name}: {worst} of {fit:?}");
            }
        }
    }

    #[test]
    fn least_squares_find_what_made_their_rows() {
        let x = [2.0, -3.0, 0.5];
        let rows: Vec<[f64; 3]> = (1..9)
            .map(|i| {
                let (a, b) = (f64::from(i * i), 1.0 / f64::from(i));
                [a, b, (1.0 - x[0] * a - x[1] * b) / x[2]]
            })
            .collect();
        for (found, exact) in least_squares(&rows).iter().zip(x) {
            assert!((found - exact).abs() < 1e-6, "{found}, not {exact}");
        }
    }
}
