//! Newton's method on (w_n, s, e) of both nodes at once, bordered by the flow in the supply tube.
//!
//! The slopes are complete, those of the node's temperature included, so that the error after a correction
//! goes with its square: about d^2/(2|f|) for a flow f whose last correction is d. The last one is applied
//! and not looked at again.

use super::balance::Correction;
use super::mixing::Mixture;
use super::nodes::{Nodes, Surroundings, pair};
use super::rest::{Slope, is_rounding};
use super::restriction::{EndState, Side};
use super::{FLOW_ERROR, Network};
use crate::component::air::Station;
use crate::component::valve::flow_law::FlowLaw;
use crate::number::{Number, Pair};

/// kg/s: a flow whose correction is smaller is found.
const SMALLEST: f64 = 1e-12;

/// A node's w whose correction is more than this part of it is not found.
const ARRIVED: f64 = 0.01;

/// kg/s: less than this counts as no flow.
const NO_FLOW: f64 = 1e-20;

/// Whether another correction would be no more than the allowed error.
enum Arrived {
    Yes,
    NotYet,
    /// No number comes out.
    Never,
    /// Nothing was corrected.
    Unknown,
}

impl Network {
    /// Newton's method from `nodes`, which it leads to the solution; false where it does not converge.
    #[inline(always)]
    pub(super) fn newton(&mut self, around: &Surroundings, nodes: &mut Nodes, slopes: Slope) -> bool {
        self.begin(around, nodes);
        let mut left = slopes.max_iterations();
        if slopes == Slope::Tangent && self.may_be_usual(around) {
            while left > 0 {
                let arrived = match self.mach == 0.0 {
                    true => self.correct_usual::<true>(nodes, around),
                    false => self.correct_usual::<false>(nodes, around),
                };
                match arrived {
                    Arrived::Yes => return true,
                    Arrived::Never => return false,
                    Arrived::NotYet => left -= 1,
                    Arrived::Unknown => break,
                }
            }
        }
        self.newton_in_general(around, nodes, slopes, left)
    }

    /// The same for flows of any pattern.
    #[inline(never)]
    fn newton_in_general(
        &mut self,
        around: &Surroundings,
        nodes: &mut Nodes,
        slopes: Slope,
        most: u32,
    ) -> bool {
        match (self.mach == 0.0 && slopes == Slope::Tangent, self.is_plain()) {
            (true, true) => self.iterate::<true, true>(around, nodes, slopes, most),
            (true, false) => self.iterate::<true, false>(around, nodes, slopes, most),
            (false, true) => self.iterate::<false, true>(around, nodes, slopes, most),
            (false, false) => self.iterate::<false, false>(around, nodes, slopes, most),
        }
    }

    /// `AT_REST` and `PLAIN` are those of [`Network::balance`].
    #[inline(never)]
    fn iterate<const AT_REST: bool, const PLAIN: bool>(
        &mut self,
        around: &Surroundings,
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
            match self.correct::<AT_REST, PLAIN, false>(nodes, around, &supply, slopes) {
                Arrived::Yes => return true,
                Arrived::Never => return false,
                Arrived::NotYet | Arrived::Unknown => {}
            }
        }
        false
    }

    /// One correction of flows of the usual pattern; unknown where they are of another one.
    #[inline(never)]
    fn correct_usual<const AT_REST: bool>(&mut self, nodes: &mut Nodes, around: &Surroundings) -> Arrived {
        let at_valve = self.supply_tube.far_end(&self.supply, nodes.supply.reduce_add());
        let supply = self.supply_side::<AT_REST>(nodes, &at_valve);
        if !self.are_usual(nodes, &supply) {
            return Arrived::Unknown;
        }
        self.work.iterations += 1;
        self.correct::<AT_REST, true, true>(nodes, around, &supply, Slope::Tangent)
    }

    /// One correction. The constants are those of [`Network::balance`].
    #[inline(always)]
    fn correct<const AT_REST: bool, const PLAIN: bool, const USUAL: bool>(
        &self,
        nodes: &mut Nodes,
        around: &Surroundings,
        supply: &Side,
        slopes: Slope,
    ) -> Arrived {
        let balance = self.balance::<AT_REST, PLAIN, USUAL>(nodes, around, supply, slopes);
        let corrections = balance.corrections::<AT_REST, USUAL>();
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

    /// The nodes to begin with.
    #[inline(always)]
    fn begin(&self, around: &Surroundings, nodes: &mut Nodes) {
        let least = pair(NO_FLOW);
        let rests = least.above(nodes.supply.abs()) | least.above(nodes.exhaust.abs());
        if rests.any() {
            self.begin_from_rest(around, nodes);
        }
    }

    /// A land that was shut and has opened begins with what its pressures drive through it: from no flow
    /// at all a square has no slope to follow.
    #[inline(never)]
    fn begin_from_rest(&self, around: &Surroundings, nodes: &mut Nodes) {
        let supply = Station { exner: pair(self.supply.exner), temperature: self.supply_temperature() };
        let begin = |flow: Pair, law: &FlowLaw, conductance: Pair, source: &Station<Pair>| {
            let square = self
                .land(law, conductance, &EndState::of(source), &None, &EndState::of(&nodes.stations()))
                .value;
            let driven = Pair::of(|i| square.lane(i).abs().sqrt().copysign(square.lane(i)));
            let opens = pair(NO_FLOW).above(flow.abs()) & conductance.above(pair(0.0));
            Pair::choose(opens, driven, flow)
        };
        let begun = [
            begin(nodes.supply, &self.laws.supply, around.valve.supply, &supply),
            begin(nodes.exhaust, &self.laws.exhaust, around.valve.exhaust, &self.exhausts()),
        ];
        [nodes.supply, nodes.exhaust] = begun;
    }

    /// Applies a correction; true where another one would be no more than the allowed error.
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
        // A pressure that still moves has not arrived, whatever the flows say: between shut lands they say nothing.
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
    use crate::component::valve::thesis_valve;
    use crate::network::{Laws, PortFlow};
    use proptest::prelude::*;

    /// A network for air with tubes or without, whose air approaches its restrictions at a speed or rests.
    fn network(tube: bool, approach: bool) -> Network {
        let gas = Gas::new(1.4, 286.76);
        let station = |pressure, temperature| Station { exner: gas.exner(pressure), temperature };
        let tube = if tube { Tube::empirical(&gas, 0.4, 0.00465) } else { Tube::none() };
        let laws = Laws::alike(FlowLaw::Orifice);
        let port_area = approach.then(|| thesis_valve().port_area());
        let (supply, exhaust) = (station(589e3, 294.0), station(101.3e3, 290.0));
        Network::new(gas, supply, exhaust, tube, tube, laws, port_area)
    }

    fn bits(nodes: &Nodes) -> [u64; 8] {
        let Nodes { exner, temperature, supply, exhaust, .. } = nodes;
        let [a, b, c, d] =
            [exner, temperature, supply, exhaust].map(|pair| pair.to_array().map(f64::to_bits));
        [a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]]
    }

    fn both(range: std::ops::Range<f64>) -> impl Strategy<Value = Pair> {
        [range.clone(), range].prop_map(Pair::new)
    }

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: 20_000, ..ProptestConfig::with_cases(2000) })]

        /// Whether or not it is known beforehand which way the air flows.
        #[test]
        fn a_correction_of_usual_flows_is_that_of_any_flows_to_the_last_bit(
            (tube, approach) in (any::<bool>(), any::<bool>()),
            spool in -1e-3..1e-3,
            chambers in both(1.05e5..7e5),
            temperature in both(240.0..340.0),
            nodes in both(1.05e5..5.8e5),
            supply in both(1e-9..5e-3),
            exhaust in both(-5e-3..-1e-9),
            charging in any::<[bool; 2]>(),
        ) {
            let network = network(tube, approach);
            let exner = |pressure: Pair| Pair::of(|i| network.gas.exner(pressure.lane(i)));
            let valve = thesis_valve().conductances(&network.gas, spool);
            let stations = Station { exner: exner(chambers), temperature };
            let ports = charging.map(|on| if on { PortFlow::Charging } else { PortFlow::Discharging });
            let around = Surroundings::new(valve, stations, &ports);
            let nodes = Nodes { exner: exner(nodes), supply, exhaust, ..network.nodes };
            prop_assert!(network.may_be_usual(&around));
            let [usual, general] = match approach {
                false => corrected::<true>(&network, &nodes, &around),
                true => corrected::<false>(&network, &nodes, &around),
            };
            prop_assume!(usual.is_some());
            prop_assert_eq!(usual, general);
        }
    }

    /// By a correction that knows which way the air flows, and by one that asks; None where it flows another way.
    fn corrected<const AT_REST: bool>(
        network: &Network,
        nodes: &Nodes,
        around: &Surroundings,
    ) -> [Option<(bool, [u64; 8])>; 2] {
        let at_valve = network.supply_tube.far_end(&network.supply, nodes.supply.reduce_add());
        let side = network.supply_side::<AT_REST>(nodes, &at_valve);
        if !network.are_usual(nodes, &side) {
            return [None; 2];
        }
        let (mut one, mut other) = (*nodes, *nodes);
        let usual = network.correct::<AT_REST, true, true>(&mut one, around, &side, Slope::Tangent);
        let general = network.correct::<AT_REST, true, false>(&mut other, around, &side, Slope::Tangent);
        let of = |arrived: Arrived, nodes: &Nodes| Some((matches!(arrived, Arrived::Yes), bits(nodes)));
        [of(usual, &one), of(general, &other)]
    }
}
