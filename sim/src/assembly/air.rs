//! The air of a drive in a state: the contents of its chambers, the flows into them, and their energy.
//!
//! Ports are on the valve's side, chambers on the cylinder's. Swapped tubes join each port to the other chamber.

use super::{Assembly, StateVector, slot};
use crate::component::air::{ChamberAir, GasState};
use crate::component::faults::through_hole;
use crate::network::{BoundaryConditions, Nodes, PortFlow};
use crate::number::{Number, Pair};

impl Assembly {
    /// The directions that the flows in the ports have now.
    pub(super) fn find_port_directions(&mut self, t: f64, x: &StateVector) {
        let nodes = self.nodes(t, x);
        if self.ports.follow(&nodes) {
            // The direction decides only the temperature, so the second solution has the right signs.
            self.solved = None;
            let nodes = self.nodes(t, x);
            self.ports.follow(&nodes);
            self.solved = None;
        }
    }

    /// The air in both chambers.
    pub(super) fn air(&self, x: &StateVector) -> ChamberAir<Pair> {
        self.air_in(self.volumes(x).volume, x)
    }

    /// The same in volumes of m^3.
    #[inline(always)]
    pub(super) fn air_in(&self, volumes: Pair, x: &StateVector) -> ChamberAir<Pair> {
        let both = |slots: [usize; 2]| Pair::new(slots.map(|i| x[i]));
        ChamberAir::of_state(&self.parts.gas, both(slot::MASS), both(slot::EXNER), volumes)
    }

    /// The flows at a state; solved once for each.
    pub(super) fn nodes(&mut self, t: f64, x: &StateVector) -> Nodes {
        match &self.solved {
            Some((at, solved, nodes)) if *at == t && solved == x => *nodes,
            _ => self.nodes_of(t, x, &self.at_ports(x)),
        }
    }

    /// The same for the air at the ports in that state.
    pub(super) fn nodes_of(&mut self, t: f64, x: &StateVector, at_ports: &GasState<Pair>) -> Nodes {
        match &self.solved {
            Some((at, solved, nodes)) if *at == t && solved == x => *nodes,
            _ => self.solve(t, x, at_ports),
        }
    }

    /// The same if the answer decides about an event: if following the last solution fails, the flows are searched for.
    pub(super) fn nodes_found(&mut self, t: f64, x: &StateVector) -> Nodes {
        let nodes = self.nodes(t, x);
        if nodes.are_finite() {
            return nodes;
        }
        self.solved = None;
        self.parts.network.expect_jump();
        self.nodes(t, x)
    }

    #[inline(always)]
    fn solve(&mut self, t: f64, x: &StateVector, at_ports: &GasState<Pair>) -> Nodes {
        let openings = self.parts.valve.openings(self.spool_to_lands(t, x));
        let mut conductances = self.restrictions.at(openings, self.lands.open);
        if let Some(port) = self.plugged_port() {
            conductances = conductances.plugged(port);
        }
        if self.parts.valve.laws_follow_spool() {
            self.follow_map(t, x);
        }
        let stations = self.ends_at_valve(x, at_ports);
        if let Some(lag) = self.parts.lag.as_ref().filter(|lag| lag.recovery > 0.0) {
            let width = self.parts.valve.widest_supply_land(openings);
            self.parts.network.let_supply_follow(lag.supply, lag.supply_tube, lag.at_once(width));
        }
        let boundary = BoundaryConditions::new(conductances, stations, &self.ports.directions);
        let nodes = self.parts.network.solve_at(t, &boundary);
        self.solved = Some((t, *x, nodes));
        nodes
    }

    /// Updates the network from the valve's map at the present position of its spool.
    #[inline(never)]
    fn follow_map(&mut self, t: f64, x: &StateVector) {
        let spool = self.spool_to_lands(t, x);
        if let Some(laws) = self.parts.valve.laws_at(spool) {
            self.parts.network.set_land_laws(laws);
        }
    }

    /// The known ends of the network, one per port: the air at the ports, or the pressures behind lagged tubes; the supply
    /// likewise.
    #[inline(always)]
    pub(super) fn ends_at_valve(&mut self, x: &StateVector, at_ports: &GasState<Pair>) -> GasState<Pair> {
        if self.parts.receiver.is_some() {
            self.draw_from_receiver(x);
        }
        let mut stations = *at_ports;
        if let Some(lag) = &self.parts.lag {
            let [supply, one, two] = slot::RATIO.map(|i| x[i]);
            let exner = lag.supply.exner * self.parts.gas.exner_ratio(supply);
            self.parts.network.set_supply(GasState { exner, ..lag.supply });
            stations.exner *= self.parts.gas.exner_ratio(Pair::new([one, two]));
        }
        GasState { exner: self.joined(stations.exner), temperature: self.joined(stations.temperature) }
    }

    /// Values of the ports in the order of their chambers, and the other way round.
    #[inline(always)]
    pub(super) fn joined(&self, each: Pair) -> Pair {
        if self.parts.faults.now.swapped_tubes { Pair::new([each.lane(1), each.lane(0)]) } else { each }
    }

    /// The port without a tube, of the chamber that is vented.
    #[inline(always)]
    fn plugged_port(&self) -> Option<usize> {
        let vented = self.parts.actuator.vent.as_ref()?.chamber;
        Some(if self.parts.faults.now.swapped_tubes { 1 - vented } else { vented })
    }

    /// The flows into the chambers through their ports, kg/s. A vent is no port.
    ///
    /// Reading has no side effect: the network continues from where the integrator left it.
    pub fn port_flows(&mut self, t: f64, x: &StateVector) -> Pair {
        let left = (self.parts.network.clone(), self.solved);
        let nodes = self.nodes_for_a_row(t, x);
        (self.parts.network, self.solved) = left;
        self.joined(nodes.port_flow())
    }

    /// The flows at the instant of a row.
    pub(super) fn nodes_for_a_row(&mut self, t: f64, x: &StateVector) -> Nodes {
        if let Some((at, ..)) = &mut self.solved
            && self.parts.operator.stands(t)
        {
            *at = t;
        }
        // A row is not a trial step: if the flows are hard to find, they are searched for.
        self.parts.network.expect_jump();
        self.nodes(t, x)
    }

    /// The same where the masses of the air have these slopes, kg/s.
    pub fn port_flows_of(&self, masses: Pair, air: &ChamberAir<Pair>) -> Pair {
        let (leaks, _) = self.parts.actuator.leak(&self.parts.gas, air).entering();
        let (holes, _) = self.through_holes(air);
        let flows = masses - leaks - holes;
        self.parts.actuator.vent.map_or(flows, |vent| vent.with(flows, 0.0))
    }

    /// The temperatures of the air in the tubes into or out of the chambers. While charging it is the temperature of
    /// the air from the valve (the tube is adiabatic, EQUATIONS section 3), else the chamber's.
    #[inline(always)]
    pub(super) fn carried(&self, nodes: &Nodes, at_ports: &GasState<Pair>) -> Pair {
        let charging = PortFlow::charging(&self.ports.directions);
        self.joined(Pair::choose(charging, nodes.carried, self.joined(at_ports.temperature)))
    }

    /// The flows into the chambers through holes, and the temperatures that they carry.
    #[inline(always)]
    pub(super) fn through_holes(&self, air: &ChamberAir<Pair>) -> (Pair, Pair) {
        let areas = self.parts.faults.now.leak_areas;
        if areas == [0.0; 2] {
            return (Pair::ZERO, air.temperature);
        }
        let (gas, outside) = (&self.parts.gas, self.parts.network.exhaust());
        let [one, two] = [0, 1].map(|i| through_hole(gas, areas[i], &air.lane(i).station(), outside));
        (Pair::new([one.0, two.0]), Pair::new([one.1, two.1]))
    }
}
