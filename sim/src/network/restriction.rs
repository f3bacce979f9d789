//! One restriction of the network: its squared flow with the slopes that Newton's method needs, and
//! how the air approaches it.

use super::{Network, PortFlow, Station};
use crate::flow_law::FlowLaw;

/// A signed square of a flow from a first place to a second, with its slopes over both Exner
/// pressures and over the flow itself (by its speed of approach).
pub(super) struct SquareFlow {
    pub value: f64,
    pub by_first: f64,
    pub by_second: f64,
    pub by_flow: f64,
}

/// How much approaching raises w and T at a place, with its slopes over w and the flow.
#[derive(Clone, Copy)]
pub(super) struct Approach {
    pub factor: f64,
    pub by_exner: f64,
    pub by_flow: f64,
}

impl Approach {
    /// Air at rest.
    pub const NONE: Approach = Approach { factor: 1.0, by_exner: 0.0, by_flow: 0.0 };
}

impl Network {
    /// How the air at a place approaches a restriction that takes `flow` from it.
    #[inline(always)]
    pub(super) fn approach(&self, place: &Station, flow: f64) -> Approach {
        if self.mach == 0.0 || flow <= 0.0 {
            return Approach::NONE;
        }
        let pressure = self.gas.pressure(place.exner);
        let mach_squared = self.mach * place.temperature * (flow / pressure) * (flow / pressure);
        let half = 0.5 * (self.gas.heat_capacity_ratio - 1.0);
        if mach_squared >= 1.0 {
            return Approach { factor: 1.0 + half, ..Approach::NONE };
        }
        let rise = half * mach_squared;
        Approach {
            factor: 1.0 + rise,
            by_exner: -2.0 * rise / (self.gas.exner_exponent() * place.exner),
            by_flow: 2.0 * rise / flow,
        }
    }

    /// How the supply's air approaches a land.
    #[inline(always)]
    pub(super) fn supply_approach(&self, supply: &Station, flow: f64) -> Approach {
        if self.reservoir { Approach::NONE } else { self.approach(supply, flow) }
    }

    /// The flow through a restriction from `first` to `second`, whose air approaches as told. The
    /// stagnation pressures decide its direction.
    #[inline(always)]
    pub(super) fn restriction(
        &self,
        law: &FlowLaw,
        conductance: f64,
        (first, approach_1): (&Station, Approach),
        (second, approach_2): (&Station, Approach),
    ) -> SquareFlow {
        let forward = first.exner * approach_1.factor >= second.exner * approach_2.factor;
        let (up, approach, down) =
            if forward { (first, approach_1, second) } else { (second, approach_2, first) };
        let psi = law.flow_function(&self.gas, up.exner * approach.factor, down.exner);
        let k = conductance / (up.temperature * approach.factor);
        let by_down = k * psi.by_downstream;
        let (mut by_up, mut by_flow) = (k * psi.by_upstream, 0.0);
        if approach.factor > 1.0 {
            // Over anything that changes the factor by df: w changes by w df and T by T df.
            let by_factor = psi.by_upstream * up.exner - psi.value / approach.factor;
            by_up = k * (psi.by_upstream * approach.factor + by_factor * approach.by_exner);
            by_flow = k * by_factor * approach.by_flow;
        }
        if forward {
            SquareFlow { value: k * psi.value, by_first: by_up, by_second: by_down, by_flow }
        } else {
            SquareFlow { value: -k * psi.value, by_first: -by_down, by_second: -by_up, by_flow }
        }
    }

    /// A land from a source to a node, where air stands still.
    #[inline(always)]
    pub(super) fn land(
        &self,
        conductance: f64,
        source: &Station,
        approach: Approach,
        node: &Station,
    ) -> SquareFlow {
        self.restriction(&self.laws.land, conductance, (source, approach), (node, Approach::NONE))
    }

    /// The port between a node and the far end of its tube, whose air has the same temperature: the
    /// direction of the step tells whose, also a little beyond the reversal.
    #[inline(always)]
    pub(super) fn port(
        &self,
        conductance: f64,
        node: &Station,
        far: &Station,
        approach: Approach,
    ) -> SquareFlow {
        let near = Station { exner: node.exner, temperature: far.temperature };
        self.restriction(&self.laws.port, conductance, (&near, Approach::NONE), (far, approach))
    }

    /// w at the valve's end of a cylinder's tube for a flow `m` into the cylinder.
    pub(super) fn far_of_cylinder(&self, chamber: &Station, m: f64) -> f64 {
        self.cylinder_tube.far_end(chamber, -m).exner
    }

    /// The far end of a cylinder's tube for a port flow `m` into the cylinder, with its slope over m.
    pub(super) fn port_station(
        &self,
        node: &Station,
        chamber: &Station,
        port: PortFlow,
        m: f64,
    ) -> (Station, f64) {
        let far = self.cylinder_tube.far_end(chamber, -m);
        let temperature = match port {
            PortFlow::Charging => node.temperature,
            PortFlow::Discharging => chamber.temperature,
        };
        (Station { exner: far.exner, temperature }, -far.by_flow)
    }

    /// A flow that a restriction cannot reach, at whatever Mach number it is approached: a bracket's
    /// end with a sign that rounding cannot turn.
    pub(super) fn more_than_choked(&self, law: &FlowLaw, conductance: f64, upstream: f64) -> f64 {
        let upstream = 0.5 * (self.gas.heat_capacity_ratio + 1.0) * upstream;
        1.01 * (conductance * law.flow_function(&self.gas, upstream, 0.0).value).sqrt()
    }
}
