//! Newton's method on (w_n, s, e) a node, bordered by the flow in the supply tube.
//!
//! The slopes are complete, those of the node's temperature included, so that the error after a correction
//! goes with its square: about d^2/(2|f|) for a flow f whose last correction is d. The last one is applied
//! and not looked at again.

use super::rest::{Slopes, is_rounding, land_line, square_slope};
use super::restriction::{Approach, SquareFlow};
use super::{FLOW_ERROR, Network, PortFlow};
use crate::air::Station;
use crate::tubing::FarEnd;
use crate::valve::Conductances;

/// Residual of a port without a bore, per unit of Exner pressure: of the size of the others, kg^2/s^2.
const OPEN_PORT: f64 = 1e-6;

/// kg/s: a flow whose correction is smaller is found.
const SMALLEST: f64 = 1e-12;

/// kg/s: less than this is no flow at all.
const NO_FLOW: f64 = 1e-20;

/// What surrounds one node.
struct Surroundings<'a> {
    valve: &'a Conductances,
    chamber: &'a Station,
    port: PortFlow,
    /// Behind the supply's tube.
    at_valve: FarEnd,
}

/// T_n with its slopes over s, e and the flow in the supply tube.
#[derive(Clone, Copy)]
struct Mixture {
    temperature: f64,
    slopes: [f64; 3],
}

/// A node's balance: residuals of supply land, exhaust land and port, their slopes over (w_n, s, e), and
/// those over the flow in the supply tube.
struct Balance {
    residual: [f64; 3],
    rows: [[f64; 3]; 3],
    by_total: [f64; 3],
    mixture: Mixture,
}

/// A correction of one node's w_n, s and e.
type Correction = [f64; 3];

impl Network {
    /// Newton's method from the present nodes; false where it does not converge.
    pub(super) fn newton(
        &mut self,
        valve: &[Conductances; 2],
        chambers: &[Station; 2],
        ports: &[PortFlow; 2],
        slopes: Slopes,
    ) -> bool {
        self.begin_flows(valve);
        for _ in 0..slopes.most_iterations() {
            self.work.iterations += 1;
            let total = self.nodes[0].supply_flow + self.nodes[1].supply_flow;
            let at_valve = self.supply_tube.far_end(&self.supply, total);
            let mut corrections = [[[0.0; 3]; 2]; 2];
            let mut mixtures = [Mixture { temperature: 0.0, slopes: [0.0; 3] }; 2];
            for i in 0..2 {
                let around =
                    Surroundings { valve: &valve[i], chamber: &chambers[i], port: ports[i], at_valve };
                let balance = self.balance(i, &around, slopes);
                (corrections[i], mixtures[i]) = (balance.corrections(), balance.mixture);
            }
            let fixed = corrections[0][0][1] + corrections[1][0][1];
            let per_total = corrections[0][1][1] + corrections[1][1][1];
            // The change of the total is the sum of its parts, which depend on it.
            let change = fixed / (1.0 - per_total);
            if !change.is_finite() {
                return false;
            }
            let one = self.apply(0, &mixtures[0], &corrections[0], change, slopes);
            let two = self.apply(1, &mixtures[1], &corrections[1], change, slopes);
            if one && two {
                return true;
            }
        }
        false
    }

    /// A land that was shut and has opened begins with what its pressures drive through it: from no flow
    /// at all a square has no slope to follow.
    fn begin_flows(&mut self, valve: &[Conductances; 2]) {
        let signed_root = |square: f64| square.abs().sqrt().copysign(square);
        for (i, lands) in valve.iter().enumerate() {
            let (node, here) = (self.nodes[i], self.nodes[i].station());
            if node.supply_flow.abs() < NO_FLOW && lands.supply > 0.0 {
                let square = self.land(lands.supply, &self.supply, Approach::NONE, &here).value;
                self.nodes[i].supply_flow = signed_root(square);
            }
            if node.exhaust_flow.abs() < NO_FLOW && lands.exhaust > 0.0 {
                let square = self.land(lands.exhaust, &self.exhaust, Approach::NONE, &here).value;
                self.nodes[i].exhaust_flow = signed_root(square);
            }
        }
    }

    /// Applies a correction to node `i`; true where another one would be no more than the allowed error.
    #[inline]
    fn apply(
        &mut self,
        i: usize,
        mixture: &Mixture,
        [fixed, per_total]: &[Correction; 2],
        change: f64,
        slopes: Slopes,
    ) -> bool {
        let [exner, supply, exhaust] = [
            fixed[0] + change * per_total[0],
            fixed[1] + change * per_total[1],
            fixed[2] + change * per_total[2],
        ];
        let node = &mut self.nodes[i];
        node.temperature = mixture.after(supply, exhaust, change);
        // A pressure that is held back has not arrived, whatever the flows say.
        let arrives = exner.abs() <= 0.5 * node.exner;
        node.exner = (node.exner + exner).clamp(0.5 * node.exner, 2.0 * node.exner);
        node.supply_flow += supply;
        node.exhaust_flow += exhaust;
        let error = if self.sharp { FLOW_ERROR } else { self.flow_error };
        let settles = |flow: f64, change: f64| match slopes {
            Slopes::Tangent => change * change <= (error * flow.abs()).max(SMALLEST * SMALLEST),
            Slopes::Secant => change.abs() < SMALLEST || is_rounding(change),
        };
        arrives
            && settles(node.supply_flow, supply)
            && settles(node.exhaust_flow, exhaust)
            && settles(node.supply_flow + node.exhaust_flow, supply + exhaust)
    }

    #[inline]
    fn balance(&self, i: usize, around: &Surroundings, slopes: Slopes) -> Balance {
        let (node, valve, at_valve) = (&self.nodes[i], around.valve, &around.at_valve);
        let (s, e, m) = (node.supply_flow, node.exhaust_flow, node.port_flow());
        let supply = Station { exner: at_valve.exner, temperature: self.supply.temperature };
        let supply_approach = self.supply_approach(&supply, s);
        let far = self.cylinder_tube.far_end(around.chamber, -m);
        let behind = Station { exner: far.exner, temperature: around.chamber.temperature };
        let far_approach = self.approach(&behind, -m);
        let mixture = match valve.port {
            Some(_) => self.mixture(i, around, supply_approach, far_approach, &far),
            // Without a node the exhaust land takes the cylinder's air (6.40).
            None => Mixture { temperature: around.chamber.temperature, slopes: [0.0; 3] },
        };
        let here = Station { exner: node.exner, temperature: mixture.temperature };
        let from_supply = self.land(valve.supply, &supply, supply_approach, &here);
        let from_exhaust = self.land(valve.exhaust, &self.exhaust, Approach::NONE, &here);
        let shut = valve.supply == 0.0 || valve.exhaust == 0.0;
        let least = |conductance, source| if shut { self.creeping(conductance, source) } else { 0.0 };
        let supply_line = land_line(valve.supply, s, from_supply.value, least(valve.supply, &supply), slopes);
        let exhaust_line =
            land_line(valve.exhaust, e, from_exhaust.value, least(valve.exhaust, &self.exhaust), slopes);
        // Over T_n, where the air of the node is the one that flows.
        let cooling = |square: &SquareFlow, of_node: bool| match slopes {
            Slopes::Tangent if of_node => square.value / mixture.temperature,
            _ => 0.0,
        };
        let by_mixture =
            |slope: f64| [slope * mixture.slopes[0], slope * mixture.slopes[1], slope * mixture.slopes[2]];
        let [s_s, s_e, s_t] = by_mixture(cooling(&from_supply, from_supply.value < 0.0));
        let [e_s, e_e, e_t] = by_mixture(cooling(&from_exhaust, from_exhaust.value < 0.0));
        let supply_row = [-from_supply.by_second, supply_line.1 - from_supply.by_flow + s_s, s_e];
        let exhaust_row = [-from_exhaust.by_second, e_s, exhaust_line.1 - from_exhaust.by_flow + e_e];
        let supply_by_total = s_t - from_supply.by_first * at_valve.by_flow;
        let Some(bore) = valve.port else {
            let by_flow = -OPEN_PORT * far.by_flow;
            return Balance {
                residual: [supply_line.0, exhaust_line.0, OPEN_PORT * (far.exner - node.exner)],
                rows: [supply_row, exhaust_row, [-OPEN_PORT, by_flow, by_flow]],
                by_total: [supply_by_total, e_t, 0.0],
                mixture,
            };
        };
        let charging = around.port == PortFlow::Charging;
        let temperature = if charging { mixture.temperature } else { behind.temperature };
        let through = self.port(bore, &here, &Station { temperature, ..behind }, far_approach);
        let [p_s, p_e, p_t] = by_mixture(cooling(&through, charging));
        let by_flow =
            square_slope(slopes, m, through.value) - through.by_flow + through.by_second * far.by_flow;
        Balance {
            residual: [supply_line.0, exhaust_line.0, m * m.abs() - through.value],
            rows: [supply_row, exhaust_row, [-through.by_first, by_flow + p_s, by_flow + p_e]],
            by_total: [supply_by_total, e_t, p_t],
            mixture,
        }
    }

    /// What flows into node `i`, mixed. A node that nothing flows into keeps its temperature.
    #[inline]
    fn mixture(
        &self,
        i: usize,
        around: &Surroundings,
        supply: Approach,
        behind: Approach,
        far: &FarEnd,
    ) -> Mixture {
        let node = &self.nodes[i];
        let (s, e, back) = (node.supply_flow, node.exhaust_flow, -node.port_flow());
        let (mut mass, mut heat, mut slopes) = (0.0, 0.0, [0.0; 3]);
        let [mut s_mass, mut e_mass] = [0.0; 2];
        if s > 0.0 {
            let temperature = self.supply.temperature;
            (mass, heat, s_mass) = (s, s * temperature * supply.factor, 1.0);
            slopes[0] = temperature * (supply.factor + s * supply.by_flow);
            slopes[2] = s * temperature * supply.by_exner * around.at_valve.by_flow;
        }
        if e > 0.0 {
            let temperature = self.exhaust.temperature;
            (mass, heat, e_mass) = (mass + e, heat + e * temperature, 1.0);
            slopes[1] = temperature;
        }
        if back > 0.0 && around.port == PortFlow::Discharging {
            let temperature = around.chamber.temperature;
            (mass, heat) = (mass + back, heat + back * temperature * behind.factor);
            (s_mass, e_mass) = (s_mass - 1.0, e_mass - 1.0);
            let by_flow = behind.by_flow + behind.by_exner * far.by_flow;
            let by_back = temperature * (behind.factor + back * by_flow);
            slopes = [slopes[0] - by_back, slopes[1] - by_back, slopes[2]];
        }
        if mass <= 0.0 {
            return Mixture { temperature: node.temperature, slopes: [0.0; 3] };
        }
        let per_mass = 1.0 / mass;
        let temperature = per_mass * heat;
        let [by_supply, by_exhaust, by_total] = slopes;
        let slopes = [
            per_mass * (by_supply - temperature * s_mass),
            per_mass * (by_exhaust - temperature * e_mass),
            per_mass * by_total,
        ];
        Mixture { temperature, slopes }
    }
}

impl Mixture {
    /// T_n after changes of s, e and the flow in the supply tube.
    fn after(&self, supply: f64, exhaust: f64, total: f64) -> f64 {
        let [by_supply, by_exhaust, by_total] = self.slopes;
        self.temperature + by_supply * supply + by_exhaust * exhaust + by_total * total
    }
}

impl Balance {
    /// The correction at a fixed flow in the supply tube, and that per unit of its change. The
    /// determinant vanishes only where no air flows at all.
    #[inline]
    fn corrections(&self) -> [Correction; 2] {
        let [a, b, c] = &self.rows;
        let columns = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = a[0] * columns[0][0] + a[1] * columns[0][1] + a[2] * columns[0][2];
        let scale = -1.0 / determinant;
        let solved = |right: &[f64; 3]| {
            let [x, y, z] = [scale * right[0], scale * right[1], scale * right[2]];
            let at = |k: usize| x * columns[0][k] + y * columns[1][k] + z * columns[2][k];
            [at(0), at(1), at(2)]
        };
        [solved(&self.residual), solved(&self.by_total)]
    }
}

#[inline]
fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
