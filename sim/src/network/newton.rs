//! Newton's method on (w_n, s, e) of both nodes at once, bordered by the flow in the supply tube.
//!
//! The slopes are complete, including those of the node's temperature. So the error after a correction goes with its
//! square: about d^2/(2|f|) for a flow f whose last correction is d. The last correction is applied and not checked
//! again.

use super::balance::Correction;
use super::mixing::Mixture;
use super::nodes::{BoundaryConditions, Nodes, pair};
use super::rest::{Slope, is_rounding};
use super::restriction::{EndState, Side};
use super::settling::{ARRIVED, NO_FLOW, SMALLEST};
use super::usual::Outcome;
use super::{FLOW_ERROR, Network};
use crate::component::air::GasState;
use crate::component::valve::flow_law::FlowLaw;
use crate::number::{Number, Pair};

/// How far a node's w may exceed those around it: a factor of eleven in pressure.
const BEYOND: f64 = 2.0;

/// Whether the next correction would be within the allowed error.
enum Arrived {
    Yes,
    NotYet,
    /// The iteration gave no number.
    Never,
}

impl Network {
    /// Newton's method from `nodes`, which it leads to the solution. Returns false if it does not converge.
    #[inline(always)]
    pub(super) fn newton(&mut self, boundary: &BoundaryConditions, nodes: &mut Nodes, slopes: Slope) -> bool {
        self.begin(boundary, nodes);
        let mut left = slopes.max_iterations();
        if slopes == Slope::Tangent && self.may_be_usual(boundary) {
            let (outcome, corrections) = match self.mach == 0.0 {
                true => self.newton_of_usual::<true>(boundary, nodes, left),
                false => self.newton_of_usual_at_speed(boundary, nodes, left),
            };
            self.work.iterations += u64::from(corrections);
            match outcome {
                Outcome::Found => return true,
                Outcome::Lost => return false,
                Outcome::Unusual => left -= corrections,
            }
        }
        let found = self.newton_in_general(boundary, nodes, slopes, left);
        nodes.carried = nodes.temperature;
        found && self.may_be(boundary, nodes)
    }

    /// Whether the nodes lie between their surroundings, apart from the rise of air at speed. The equations have
    /// other roots, far beyond.
    #[inline(never)]
    fn may_be(&self, boundary: &BoundaryConditions, nodes: &Nodes) -> bool {
        let ends =
            [pair(self.supply.exner), pair(self.exhaust.exner), boundary.chambers.exner].map(Pair::to_array);
        let all = || ends.as_flattened().iter().copied();
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        let between = nodes.exner.at_least(pair(low / BEYOND)) & pair(high * BEYOND).at_least(nodes.exner);
        Pair::all(between)
    }

    /// The same for flows of any pattern.
    #[inline(never)]
    fn newton_in_general(
        &mut self,
        boundary: &BoundaryConditions,
        nodes: &mut Nodes,
        slopes: Slope,
        most: u32,
    ) -> bool {
        match (self.mach == 0.0 && slopes == Slope::Tangent, self.is_plain()) {
            (true, true) => self.iterate::<true, true>(boundary, nodes, slopes, most),
            (true, false) => self.iterate::<true, false>(boundary, nodes, slopes, most),
            (false, true) => self.iterate::<false, true>(boundary, nodes, slopes, most),
            (false, false) => self.iterate::<false, false>(boundary, nodes, slopes, most),
        }
    }

    /// `AT_REST` and `PLAIN`: see [`Network::balance`].
    #[inline(never)]
    fn iterate<const AT_REST: bool, const PLAIN: bool>(
        &mut self,
        boundary: &BoundaryConditions,
        nodes: &mut Nodes,
        slopes: Slope,
        most: u32,
    ) -> bool {
        for _ in 0..most {
            self.work.iterations += 1;
            let total = nodes.supply.reduce_add();
            let at_valve =
                if PLAIN { self.supply_tube.far_end(&self.supply, total) } else { self.supply_end(total) };
            let supply = self.supply_side::<AT_REST>(nodes, &at_valve);
            match self.correct::<AT_REST, PLAIN>(nodes, boundary, &supply, slopes) {
                Arrived::Yes => return true,
                Arrived::Never => return false,
                Arrived::NotYet => {}
            }
        }
        false
    }

    /// Where air approaches its restrictions at a speed.
    #[inline(never)]
    fn newton_of_usual_at_speed(
        &self,
        boundary: &BoundaryConditions,
        nodes: &mut Nodes,
        most: u32,
    ) -> (Outcome, u32) {
        self.newton_of_usual::<false>(boundary, nodes, most)
    }

    /// One correction. The constants are those of [`Network::balance`].
    #[inline(always)]
    fn correct<const AT_REST: bool, const PLAIN: bool>(
        &self,
        nodes: &mut Nodes,
        boundary: &BoundaryConditions,
        supply: &Side,
        slopes: Slope,
    ) -> Arrived {
        let balance = self.balance::<AT_REST, PLAIN>(nodes, boundary, supply, slopes);
        let corrections = balance.corrections::<AT_REST>();
        // The change of the total is the sum of its parts, which depend on it.
        let [[_, fixed, _], [_, per_total, _]] = &corrections;
        let change = fixed.reduce_add() / (1.0 - per_total.reduce_add());
        if !change.is_finite() {
            return Arrived::Never;
        }
        match self.apply::<AT_REST>(nodes, &balance.mixture, &corrections, change, slopes) {
            true => Arrived::Yes,
            false => Arrived::NotYet,
        }
    }

    /// The nodes to start from.
    #[inline(always)]
    fn begin(&self, boundary: &BoundaryConditions, nodes: &mut Nodes) {
        let least = pair(NO_FLOW);
        let rests = least.above(nodes.supply.abs()) | least.above(nodes.exhaust.abs());
        if rests.any() {
            self.begin_from_rest(boundary, nodes);
        }
    }

    /// A land that has just opened starts from the flow that its pressures drive: at zero flow a square has no slope
    /// to follow.
    #[inline(never)]
    fn begin_from_rest(&self, boundary: &BoundaryConditions, nodes: &mut Nodes) {
        let supply = GasState { exner: pair(self.supply.exner), temperature: self.supply_temperature() };
        let begin = |flow: Pair, law: &FlowLaw, conductance: Pair, source: &GasState<Pair>| {
            let square = self
                .land(law, conductance, &EndState::of(source), &None, &EndState::of(&nodes.stations()))
                .value;
            let driven = Pair::of(|i| square.lane(i).abs().sqrt().copysign(square.lane(i)));
            let opens = pair(NO_FLOW).above(flow.abs()) & conductance.above(pair(0.0));
            Pair::choose(opens, driven, flow)
        };
        let begun = [
            begin(nodes.supply, &self.laws.supply, boundary.valve.supply, &supply),
            begin(nodes.exhaust, &self.laws.exhaust, boundary.valve.exhaust, &self.exhausts()),
        ];
        [nodes.supply, nodes.exhaust] = begun;
    }

    /// Applies a correction. Returns true if the next one would be within the allowed error.
    #[inline(always)]
    fn apply<const AT_REST: bool>(
        &self,
        nodes: &mut Nodes,
        mixture: &Mixture,
        [fixed, per_total]: &[Correction; 2],
        change: f64,
        slopes: Slope,
    ) -> bool {
        let change = pair(change);
        let [exner, supply, exhaust] = [
            fixed[0] + change * per_total[0],
            fixed[1] + change * per_total[1],
            fixed[2] + change * per_total[2],
        ];
        nodes.temperature = mixture.after::<AT_REST>(supply, exhaust, change);
        // While a pressure still moves, the iteration has not converged, whatever the flows say. Between shut lands
        // they say nothing.
        let arrives = (pair(ARRIVED) * nodes.exner).at_least(exner.abs());
        let half = pair(0.5) * nodes.exner;
        nodes.exner = (nodes.exner + exner).larger(half).smaller(pair(2.0) * nodes.exner);
        nodes.supply += supply;
        nodes.exhaust += exhaust;
        let error = pair(if self.tight { FLOW_ERROR } else { self.flow_error });
        let settles = |flow: Pair, change: Pair| match slopes {
            Slope::Tangent => {
                (error * flow.abs()).larger(pair(SMALLEST * SMALLEST)).at_least(change * change)
            }
            Slope::Secant => Pair::of(|i| {
                let change = change.lane(i);
                f64::from(change.abs() < SMALLEST || is_rounding(change))
            })
            .above(pair(0.0)),
        };
        let settled = settles(nodes.supply, supply)
            & settles(nodes.exhaust, exhaust)
            & settles(nodes.supply + nodes.exhaust, supply + exhaust);
        (arrives & settled).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::gas::Gas;
    use crate::component::tubing::Tube;
    use crate::component::valve::{Conductances, thesis_valve};
    use crate::network::{Laws, PortFlow};
    use proptest::prelude::*;

    /// A network for air, with or without tubes, with or without speeds of approach.
    fn network(tube: bool, approach: bool) -> Network {
        let gas = Gas::new(1.4, 286.76);
        let station = |pressure, temperature| GasState { exner: gas.exner(pressure), temperature };
        let tube = if tube { Tube::empirical(&gas, 0.4, 0.00465) } else { Tube::none() };
        let laws = Laws::alike(FlowLaw::Orifice);
        let port_area = approach.then(|| thesis_valve().port_area());
        let (supply, exhaust) = (station(589e3, 294.0), station(101.3e3, 290.0));
        Network::new(gas, supply, exhaust, tube, tube, laws, port_area)
    }

    fn both(range: std::ops::Range<f64>) -> impl Strategy<Value = Pair> {
        [range.clone(), range].prop_map(Pair::new)
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 20_000, ..ProptestConfig::with_cases(2000) })]

        /// Both ways to the flows from any start: the usual pattern and the general one.
        #[test]
        fn flows_of_the_usual_pattern_are_those_of_the_general_equations_to_the_last_digits(
            (tube, approach) in (any::<bool>(), any::<bool>()),
            spool in -1e-3..1e-3,
            chambers in both(1.05e5..5.8e5),
            temperature in both(240.0..340.0),
            beside in [both(0.98..1.02), both(0.7..1.4), both(0.7..1.4)],
        ) {
            let mut network = network(tube, approach);
            network.tighten(true);
            let exner = Pair::of(|i| network.gas.exner(chambers.lane(i)));
            let valve = thesis_valve().conductances(&network.gas, spool);
            let (ports, nodes) = network.flowing(valve, GasState { exner, temperature });
            let boundary = BoundaryConditions::new(valve, GasState { exner, temperature }, &ports);
            let [exner, supply, exhaust] = [nodes.exner, nodes.supply, nodes.exhaust];
            let begin = Nodes {
                exner: exner * beside[0],
                supply: supply * beside[1],
                exhaust: exhaust * beside[2],
                ..nodes
            };
            prop_assert!(network.may_be_usual(&boundary));
            let (mut usual, mut general) = (begin, begin);
            // The second time takes the pressures to the last digits, too.
            for _ in 0..2 {
                let (outcome, _) = match approach {
                    false => network.newton_of_usual::<true>(&boundary, &mut usual, 40),
                    true => network.newton_of_usual::<false>(&boundary, &mut usual, 40),
                };
                let found = network.newton_in_general(&boundary, &mut general, Slope::Tangent, 40);
                prop_assume!(found && matches!(outcome, Outcome::Found));
            }
            let of = |nodes: &Nodes| [nodes.exner, nodes.temperature, nodes.supply, nodes.exhaust];
            for (one, other) in of(&usual).into_iter().zip(of(&general)) {
                let most = pair(1e-11) * other.abs();
                prop_assert!(Pair::all(most.at_least((one - other).abs())), "{usual:?} {general:?}");
            }
        }
    }

    impl Network {
        /// The directions of the air in the ports between these, and the flows.
        fn flowing(&mut self, valve: Conductances<Pair>, chambers: GasState<Pair>) -> ([PortFlow; 2], Nodes) {
            let mut ports = [PortFlow::Charging; 2];
            let mut nodes = self.nodes;
            for _ in 0..3 {
                nodes = self.solve_among(&BoundaryConditions::new(valve, chambers, &ports));
                let flows = nodes.port_flow().to_array();
                ports =
                    flows.map(|flow| if flow >= 0.0 { PortFlow::Charging } else { PortFlow::Discharging });
            }
            (ports, nodes)
        }
    }
}
