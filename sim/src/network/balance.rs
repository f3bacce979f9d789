//! The balance of both nodes, linearised: what Newton's method solves.
//!
//! ```text
//! land to the supply    s|s| - K_s/T psi(w_sv, w_n) = 0
//! land to the exhaust   e|e| - K_e/T psi(w_e,  w_n) = 0
//! port                  m|m| + K_p/T psi(w_v,  w_n) = 0,   m = s + e
//! ```
//!
//! The slopes over (w_n, s, e) are complete: they include the node's temperature and the pressures behind the tubes.
//! The slope over the flow in the supply tube is kept apart, because this flow joins the two nodes.
//!
//! Nearly always air flows from the supply into both nodes and out of both into the exhaust. Then [`super::usual`]
//! solves the same equations in half the time.

use super::Network;
use super::mixing::Mixture;
use super::nodes::{BoundaryConditions, Nodes, pair};
use super::rest::{Slope, land_line, square_slope};
use super::restriction::{EndState, Side, SquareFlow};
use crate::component::air::GasState;
use crate::component::tubing::FarEnd;
use crate::component::valve::flow_law::FlowLaw;
use crate::number::{Number, Pair};

/// Residual of a port without a bore, per unit of Exner pressure: as large as the others, kg^2/s^2.
const OPEN_PORT: f64 = 1e-6;

/// One equation of each node: its residual, and its slopes over (w_n, s, e) and over the flow in the supply tube.
struct Line {
    residual: Pair,
    row: [Pair; 3],
    by_total: Pair,
}

/// The three equations of each node: land to the supply, land to the exhaust, port.
pub(super) struct Balance {
    lines: [Line; 3],
    pub mixture: Mixture,
}

/// Corrections of the nodes' w_n, s and e.
pub(super) type Correction = [Pair; 3];

/// Slopes of w behind the ports over s, e and the flow in the supply tube, through the temperature of the air in the
/// tubes.
type ByTemperature = Option<[Pair; 3]>;

impl Network {
    /// The balance at `nodes`. `AT_REST`: no air has a speed in front of a restriction. `PLAIN`: no tube's drop
    /// depends on the temperature of its air, and no part of a lagged tube's drop follows at once.
    #[inline(always)]
    pub(super) fn balance<const AT_REST: bool, const PLAIN: bool>(
        &self,
        nodes: &Nodes,
        boundary: &BoundaryConditions,
        supply: &Side,
        slopes: Slope,
    ) -> Balance {
        let (tubes, by_warmth) = self.cylinder_side::<AT_REST, PLAIN>(nodes, boundary, supply);
        let mixture = match boundary.valve.port {
            Some(_) => self.mixture(nodes, boundary, supply, &tubes),
            // Without a node the exhaust land takes the cylinder's air (6.40).
            None => Mixture::of(boundary.chambers.temperature),
        };
        let lines = [
            self.supply_line::<AT_REST>(nodes, boundary, supply, &mixture, slopes),
            self.exhaust_line(nodes, boundary, &mixture, slopes),
            match boundary.valve.port {
                Some(bore) => self.port_line(bore, nodes, boundary, (&tubes, by_warmth), &mixture, slopes),
                None => open_port_line(nodes, &tubes, by_warmth),
            },
        ];
        Balance { lines, mixture }
    }

    /// Whether no tube's drop depends on the temperature of its air, and no part of a lagged tube's drop follows at once.
    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.following.is_none()
            && !self.supply_tube.feels_temperature()
            && !self.cylinder_tube.feels_temperature()
    }

    /// Whether the usual pattern may be tried: all restrictions are orifices for air, and none is shut.
    #[inline(always)]
    pub(super) fn may_be_usual(&self, boundary: &BoundaryConditions) -> bool {
        self.passes_air && self.is_plain() && !boundary.has_shut_land && boundary.valve.port.is_some()
    }

    /// The air in front of the lands, behind the supply's tube.
    #[inline(always)]
    pub(super) fn supply_side<const AT_REST: bool>(&self, nodes: &Nodes, at_valve: &FarEnd) -> Side {
        let station = GasState { exner: pair(at_valve.exner), temperature: self.supply_temperature() };
        let approach = match &self.given {
            _ if AT_REST || self.mach == 0.0 => None,
            Some([at_lands, _]) => Some(*at_lands),
            None => self.supply_approach(&station, nodes.supply),
        };
        Side { station, approach, by_flow: pair(at_valve.by_flow) }
    }

    #[inline(always)]
    fn cylinder_side<const AT_REST: bool, const PLAIN: bool>(
        &self,
        nodes: &Nodes,
        boundary: &BoundaryConditions,
        supply: &Side,
    ) -> (Side, ByTemperature) {
        let back = -nodes.port_flow();
        let in_tubes = if PLAIN { None } else { self.air_in_tubes(nodes, boundary, supply) };
        let temperature = in_tubes.as_ref().map_or(boundary.chambers.temperature, |air| air.temperature);
        let far_end = self.cylinder_tube.far_end(&GasState { temperature, ..boundary.chambers }, back);
        let by_warmth = in_tubes.map(|air| {
            let by_temperature = far_end.by_temperature(back, air.temperature);
            air.slopes.map(|slope| by_temperature * slope)
        });
        let station = GasState { exner: far_end.exner, ..boundary.chambers };
        let approach = match &self.given {
            _ if AT_REST || self.mach == 0.0 => None,
            Some([_, at_ports]) => Some(*at_ports),
            None => self.port_approach(&station, back),
        };
        (Side { station, approach, by_flow: far_end.by_flow }, by_warmth)
    }

    #[inline(always)]
    fn supply_line<const AT_REST: bool>(
        &self,
        nodes: &Nodes,
        boundary: &BoundaryConditions,
        supply: &Side,
        mixture: &Mixture,
        slopes: Slope,
    ) -> Line {
        let place =
            EndState { exner: supply.station.exner, per_temperature: pair(self.per_supply_temperature) };
        let conductance = boundary.valve.supply;
        let node = mixture.place(nodes);
        let square = self.land(&self.laws.supply, conductance, &place, &supply.approach, &node);
        let at = (nodes.supply, square.value);
        let (residual, by_flow) =
            self.land_lines(boundary, (&self.laws.supply, conductance), &supply.station, at, slopes);
        let pushed = -square.by_end_state * supply.by_flow;
        let [s_s, s_e, s_t] = mixture.cooled(&square, pair(0.0).above(square.value), slopes);
        let row = [-square.by_node, by_flow - square.by_flow + s_s, s_e];
        Line { residual, row, by_total: if AT_REST { pushed } else { s_t + pushed } }
    }

    #[inline(always)]
    fn exhaust_line(
        &self,
        nodes: &Nodes,
        boundary: &BoundaryConditions,
        mixture: &Mixture,
        slopes: Slope,
    ) -> Line {
        let (exhaust, conductance) = (self.exhausts(), boundary.valve.exhaust);
        let (place, node) = (EndState::of(&exhaust), mixture.place(nodes));
        let square = self.land(&self.laws.exhaust, conductance, &place, &None, &node);
        let at = (nodes.exhaust, square.value);
        let (residual, by_flow) =
            self.land_lines(boundary, (&self.laws.exhaust, conductance), &exhaust, at, slopes);
        let [e_s, e_e, e_t] = mixture.cooled(&square, pair(0.0).above(square.value), slopes);
        Line { residual, row: [-square.by_node, e_s, by_flow + e_e], by_total: e_t }
    }

    #[inline(always)]
    fn port_line(
        &self,
        bore: Pair,
        nodes: &Nodes,
        boundary: &BoundaryConditions,
        (tubes, by_warmth): (&Side, ByTemperature),
        mixture: &Mixture,
        slopes: Slope,
    ) -> Line {
        let m = nodes.port_flow();
        let of_chambers = pair(1.0) / boundary.chambers.temperature;
        let per_temperature = Pair::choose(boundary.charging, mixture.per_temperature, of_chambers);
        let behind = EndState { exner: tubes.station.exner, per_temperature };
        let back = self.port(bore, &behind, &tubes.approach, nodes.exner);
        let [p_s, p_e, p_t] = mixture.cooled(&back, boundary.charging, slopes);
        let size = match slopes {
            Slope::Tangent => pair(2.0) * m.abs(),
            Slope::Secant => Pair::of(|i| square_slope(slopes, m.lane(i), -back.value.lane(i))),
        };
        let by_flow = size - back.by_flow - back.by_end_state * tubes.by_flow;
        let mut row = [back.by_node, by_flow - p_s, by_flow - p_e];
        let mut by_total = -p_t;
        if let Some([w_s, w_e, w_t]) = by_warmth {
            row[1] += back.by_end_state * w_s;
            row[2] += back.by_end_state * w_e;
            by_total += back.by_end_state * w_t;
        }
        Line { residual: m * m.abs() + back.value, row, by_total }
    }

    /// Residuals of lands whose pressures give the signed squares `value`, and their slopes over the flow.
    #[inline(always)]
    fn land_lines(
        &self,
        boundary: &BoundaryConditions,
        land: (&FlowLaw, Pair),
        source: &GasState<Pair>,
        (flow, value): (Pair, Pair),
        slopes: Slope,
    ) -> (Pair, Pair) {
        if slopes == Slope::Tangent && !boundary.has_shut_land {
            return (flow * flow.abs() - value, pair(2.0) * flow.abs());
        }
        self.line_by_line(boundary, land, source, (flow, value), slopes)
    }

    /// The same, one land at a time: for air at rest, or beside a land that is shut.
    #[inline(never)]
    fn line_by_line(
        &self,
        boundary: &BoundaryConditions,
        (law, conductance): (&FlowLaw, Pair),
        source: &GasState<Pair>,
        (flow, value): (Pair, Pair),
        slopes: Slope,
    ) -> (Pair, Pair) {
        let line = |i: usize| {
            let shut = boundary.valve.supply.lane(i) == 0.0 || boundary.valve.exhaust.lane(i) == 0.0;
            let source = GasState { exner: source.exner.lane(i), temperature: source.temperature.lane(i) };
            let conductance = conductance.lane(i);
            let creeping = if shut { self.creeping(law, conductance, &source) } else { 0.0 };
            land_line(conductance, flow.lane(i), value.lane(i), creeping, slopes)
        };
        let (one, two) = (line(0), line(1));
        (Pair::new([one.0, two.0]), Pair::new([one.1, two.1]))
    }
}

/// A port without a bore: its pressure equals the node's.
#[inline(always)]
fn open_port_line(nodes: &Nodes, tubes: &Side, by_warmth: ByTemperature) -> Line {
    let by_flow = pair(-OPEN_PORT) * tubes.by_flow;
    let [w_s, w_e, w_t] =
        by_warmth.map_or([pair(0.0); 3], |by_warmth| by_warmth.map(|slope| pair(OPEN_PORT) * slope));
    Line {
        residual: pair(OPEN_PORT) * (tubes.station.exner - nodes.exner),
        row: [pair(-OPEN_PORT), by_flow + w_s, by_flow + w_e],
        by_total: w_t,
    }
}

impl Mixture {
    /// The air of the node in front of a restriction.
    #[inline(always)]
    fn place(&self, nodes: &Nodes) -> EndState<Pair> {
        EndState { exner: nodes.exner, per_temperature: self.per_temperature }
    }

    /// Slopes of a squared flow over s, e and the flow in the supply tube, through T_n, where the air comes from the
    /// node.
    #[inline(always)]
    fn cooled(&self, square: &SquareFlow<Pair>, of_node: Pair, slopes: Slope) -> [Pair; 3] {
        let cooling = match slopes {
            Slope::Tangent => Pair::choose(of_node, square.value * self.per_temperature, pair(0.0)),
            Slope::Secant => pair(0.0),
        };
        self.slopes.map(|slope| cooling * slope)
    }
}

impl Balance {
    /// The correction at a fixed flow in the supply tube, and the correction per unit of that flow. The determinant
    /// vanishes only where no air flows at all.
    #[inline(always)]
    pub fn corrections<const AT_REST: bool>(&self) -> [Correction; 2] {
        let [a, b, c] = self.lines.each_ref().map(|line| &line.row);
        let columns = cofactors(a, b, c);
        let determinant = a[0] * columns[0][0] + a[1] * columns[1][0] + a[2] * columns[2][0];
        let scale = pair(-1.0) / determinant;
        // The inverse of the determinant comes last.
        let solved = |right: [Pair; 3]| {
            columns.map(|column| scale * (right[0] * column[0] + right[1] * column[1] + right[2] * column[2]))
        };
        let fixed = solved(self.lines.each_ref().map(|line| line.residual));
        if AT_REST {
            // Only the supply land depends on the flow in the supply tube.
            return [fixed, columns.map(|column| scale * (self.lines[0].by_total * column[0]))];
        }
        [fixed, solved(self.lines.each_ref().map(|line| line.by_total))]
    }
}

/// The cofactors of the rows a, b and c, grouped by unknown.
#[inline(always)]
fn cofactors(a: &[Pair; 3], b: &[Pair; 3], c: &[Pair; 3]) -> [[Pair; 3]; 3] {
    let [bc, ca, ab] = [cross(b, c), cross(c, a), cross(a, b)];
    [0, 1, 2].map(|unknown| [bc[unknown], ca[unknown], ab[unknown]])
}

#[inline(always)]
fn cross(a: &[Pair; 3], b: &[Pair; 3]) -> [Pair; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
