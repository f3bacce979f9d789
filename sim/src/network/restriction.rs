//! One restriction of the network, or the same restriction of both nodes at once: its squared flow with the slopes
//! that Newton's method needs, and the approach of the air.

use super::{GasState, Network, PortFlow};
use crate::component::tubing::Tube;
use crate::component::valve::flow_law::FlowLaw;
use crate::number::{Number, Pair};

/// A signed square of the flow from a place into a node, with its slopes over both Exner pressures and over the flow
/// itself (through its speed of approach).
pub(super) struct SquareFlow<N = f64> {
    pub value: N,
    pub by_end_state: N,
    pub by_node: N,
    pub by_flow: N,
}

/// The factor by which an approach raises w and T at a place, with its slopes over w and over the flow from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach<N = f64> {
    pub factor: N,
    pub by_exner: N,
    pub by_flow: N,
}

/// The air in front of or behind a restriction.
#[derive(Clone, Copy)]
pub(super) struct EndState<N = f64> {
    /// w.
    pub exner: N,
    /// 1/T, 1/K.
    pub per_temperature: N,
}

impl<N: Number> EndState<N> {
    #[inline(always)]
    pub fn of(station: &GasState<N>) -> EndState<N> {
        EndState { exner: station.exner, per_temperature: N::from(1.0) / station.temperature }
    }
}

/// None: air at rest.
pub(super) type MaybeApproach<N = f64> = Option<Approach<N>>;

/// The air in front of the lands of both nodes, or behind their ports.
pub(super) struct Side {
    pub station: GasState<Pair>,
    pub approach: MaybeApproach<Pair>,
    /// Slope of its w over the flow out of the known end.
    pub by_flow: Pair,
}

/// The effect of an approach on w and T at a place.
#[inline(always)]
pub(super) fn factor<N: Number>(approach: &MaybeApproach<N>) -> N {
    approach.as_ref().map_or(N::from(1.0), |approach| approach.factor)
}

impl Network {
    /// The approach of the air at a place to a restriction that takes `flow` from it.
    #[inline(always)]
    pub(super) fn approach<N: Number>(&self, place: &GasState<N>, flow: N) -> MaybeApproach<N> {
        if self.mach == 0.0 {
            return None;
        }
        let (zero, one) = (N::from(0.0), N::from(1.0));
        let flux = flow / self.gas.pressure_of(place.exner);
        let mach_squared = N::from(self.mach) * place.temperature * flux * flux;
        let of_mach = 0.5 * (self.gas.heat_capacity_ratio - 1.0) * self.turbulence_squared;
        let rise = N::from(of_mach) * -(-mach_squared).larger(-one);
        // No slope for a flow in the other direction, or at the speed of sound.
        let bends =
            |slope: N| N::choose(flow.above(zero), N::choose(one.above(mach_squared), slope, zero), zero);
        let twice = N::from(2.0) * rise;
        Some(Approach {
            factor: N::choose(flow.above(zero), one + rise, one),
            by_exner: bends(-twice / (N::from(self.gas.exner_exponent()) * place.exner)),
            by_flow: bends(twice / flow),
        })
    }

    /// The approach of the supply's air to a land.
    #[inline(always)]
    pub(super) fn supply_approach<N: Number>(&self, supply: &GasState<N>, flow: N) -> MaybeApproach<N> {
        if self.vessels.supply { None } else { self.approach(supply, flow) }
    }

    /// The approach of the cylinder's air to its port.
    #[inline(always)]
    pub(super) fn port_approach<N: Number>(&self, far: &GasState<N>, flow: N) -> MaybeApproach<N> {
        if self.vessels.chambers { None } else { self.approach(far, flow) }
    }

    /// The flow through a restriction from a place with this approach into a node, where air is at rest. The
    /// stagnation pressures give its direction.
    #[inline(always)]
    fn restriction<N: Number>(
        &self,
        law: &FlowLaw,
        conductance: N,
        place: &EndState<N>,
        approach: &MaybeApproach<N>,
        node: &EndState<N>,
    ) -> SquareFlow<N> {
        let raised = match approach {
            None => *place,
            Some(approach) => EndState {
                exner: place.exner * approach.factor,
                per_temperature: place.per_temperature / approach.factor,
            },
        };
        let inward = raised.exner.at_least(node.exner);
        let [upstream, downstream] = if approach.is_none() {
            [raised.exner.larger(node.exner), raised.exner.smaller(node.exner)]
        } else {
            [N::choose(inward, raised.exner, node.exner), N::choose(inward, node.exner, place.exner)]
        };
        let psi = law.flow_function(&self.gas, upstream, downstream);
        let per_temperature = N::choose(inward, raised.per_temperature, node.per_temperature);
        let k = (conductance * per_temperature).signed(inward);
        let [by_end_state, by_node] = N::either(inward, k * psi.by_upstream, k * psi.by_downstream);
        let square = SquareFlow { value: k * psi.value, by_end_state, by_node, by_flow: N::from(0.0) };
        let Some(approach) = approach else { return square };
        // Over any quantity that changes the factor by df, w changes by w df and T by T df.
        let by_factor = k * (psi.by_upstream * place.exner - psi.value / approach.factor);
        let by_end_state = k * psi.by_upstream * approach.factor + by_factor * approach.by_exner;
        SquareFlow {
            by_end_state: N::choose(inward, by_end_state, square.by_end_state),
            by_flow: N::choose(inward, by_factor * approach.by_flow, N::from(0.0)),
            ..square
        }
    }

    /// A land with a flow law, from a source to a node.
    #[inline(always)]
    pub(super) fn land<N: Number>(
        &self,
        law: &FlowLaw,
        conductance: N,
        source: &EndState<N>,
        approach: &MaybeApproach<N>,
        node: &EndState<N>,
    ) -> SquareFlow<N> {
        self.restriction(law, conductance, source, approach, node)
    }

    /// The port from the far end of a tube to its node. The air on both sides has the same temperature. The direction
    /// of the step tells whose air it is, also slightly beyond the reversal.
    #[inline(always)]
    pub(super) fn port<N: Number>(
        &self,
        conductance: N,
        far: &EndState<N>,
        approach: &MaybeApproach<N>,
        node_exner: N,
    ) -> SquareFlow<N> {
        let near = EndState { exner: node_exner, ..*far };
        self.restriction(&self.laws.port, conductance, far, approach, &near)
    }

    /// w at the valve's end of a cylinder's `tube` for a port flow `m` into the cylinder, with the temperature of the
    /// air in port and tube. `charging` is the temperature of the air from the valve, K.
    pub(super) fn port_station(
        &self,
        tube: &Tube,
        charging: f64,
        (chamber, port): (&GasState, PortFlow),
        m: f64,
    ) -> GasState {
        let temperature = match port {
            PortFlow::Charging => charging,
            PortFlow::Discharging => chamber.temperature,
        };
        let known = GasState { temperature, ..*chamber };
        GasState { exner: tube.far_end(&known, -m).exner, temperature }
    }

    /// A flow that a restriction cannot reach, whatever the Mach number of its approach: the end of a bracket, with a
    /// sign that rounding cannot change.
    pub(super) fn more_than_choked(&self, law: &FlowLaw, conductance: f64, upstream: f64) -> f64 {
        let upstream = 0.5 * (self.gas.heat_capacity_ratio + 1.0) * upstream;
        1.01 * (conductance * law.flow_function(&self.gas, upstream, 0.0).value).sqrt()
    }
}
