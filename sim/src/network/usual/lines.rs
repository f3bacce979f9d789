//! The three lines of a node, with air at rest in front of each restriction (`AT_REST`) or at a speed.

use super::Known;
use super::approach::Approach;
use crate::component::gas::FlowFunction;
use crate::network::nodes::pair;
use crate::number::{Number, Pair};

/// The residual of a line, and its slopes over w_n, s, m and M.
pub(super) struct Line {
    pub residual: Pair,
    pub by_exner: Pair,
    pub by_supply: Pair,
    pub by_flow: Pair,
    pub by_total: Pair,
}

impl Known<'_> {
    /// The land to the supply.
    #[inline(always)]
    pub fn supply_line<const AT_REST: bool>(
        &self,
        (w, s): (Pair, Pair),
        ahead: Pair,
        approach: &Approach,
    ) -> Line {
        let decay = pair(self.decays[0]);
        if AT_REST {
            let psi = self.gas.flow_function_of_air_times(self.supply_land, ahead, w);
            return Line {
                residual: s * s - psi.value,
                by_exner: -psi.by_downstream,
                by_supply: s + s,
                by_flow: pair(0.0),
                by_total: -(psi.by_upstream * (decay * ahead)),
            };
        }
        let psi = self.gas.flow_function_of_air_times(self.supply_land, ahead * approach.factor, w);
        let (square, risen) = (s * s, psi.by_upstream * ahead);
        let by_factor = square - risen;
        Line {
            residual: approach.factor * square - psi.value,
            by_exner: -psi.by_downstream,
            by_supply: approach.factor * (s + s) + approach.by_flow * by_factor,
            by_flow: pair(0.0),
            by_total: approach.by_tube * by_factor - decay * (approach.factor * risen),
        }
    }

    /// The land to the exhaust. Its slope over s is at a fixed m, so a changes with s.
    #[inline(always)]
    pub fn exhaust_line<const AT_REST: bool>(
        &self,
        (w, s, a): (Pair, Pair, Pair),
        approaches: &[Approach; 2],
    ) -> Line {
        let psi = self.gas.flow_function_of_air_times(self.exhaust_land, w, pair(self.outside));
        let gives = self.gives_back(a - s);
        let [supply, chamber] = approaches;
        let (warm, own) =
            (supply.factor * pair(self.supply.temperature), chamber.factor * self.chambers.temperature);
        let base = Pair::choose(gives, own, warm);
        let (d, heat) = (warm - base, a * base);
        let mixed = heat + d * s;
        let by_outflow = mixed + heat;
        let line = Line {
            residual: a * mixed - psi.value,
            by_exner: -psi.by_upstream,
            by_supply: by_outflow + a * d,
            by_flow: -by_outflow,
            by_total: pair(0.0),
        };
        if AT_REST {
            return line;
        }
        let warming = a * (Pair::choose(gives, s, a) * pair(self.supply.temperature));
        let by_back = Pair::choose(gives, a * ((a - s) * self.chambers.temperature), pair(0.0));
        Line {
            by_supply: line.by_supply + warming * supply.by_flow,
            by_flow: line.by_flow - by_back * (chamber.by_flow + chamber.by_tube),
            by_total: warming * supply.by_tube,
            ..line
        }
    }

    /// The port. `behind` is w at the valve's end of its tube, `back` the flow out of that tube.
    #[inline(always)]
    pub fn port_line<const AT_REST: bool>(
        &self,
        (w, back): (Pair, Pair),
        behind: Pair,
        [supply, chamber]: &[Approach; 2],
    ) -> Line {
        let (decay, m, size) = (pair(self.decays[1]), -back, back.abs());
        if AT_REST {
            let inward = behind.at_least(w);
            let psi = self.flow_of_port(self.port, inward, [behind.larger(w), behind.smaller(w)]);
            let heat =
                Pair::choose(self.charging, pair(self.supply.temperature), self.chambers.temperature) * size;
            return Line {
                residual: heat * m + psi.value,
                by_exner: psi.by_downstream,
                by_supply: pair(0.0),
                by_flow: heat + heat - psi.by_upstream * (decay * behind),
                by_total: pair(0.0),
            };
        }
        let risen = behind * chamber.factor;
        let inward = risen.at_least(w);
        let sides = [Pair::choose(inward, risen, w), Pair::choose(inward, w, behind)];
        let psi = self.flow_of_port(self.port, inward, sides);
        let Approach { factor, by_flow, by_tube } = chamber.only(inward);
        let bend = -(by_flow + by_tube);
        let square = m * size;
        let own = Pair::choose(
            self.charging,
            supply.factor * pair(self.supply.temperature),
            self.chambers.temperature,
        );
        let warming =
            Pair::choose(self.charging, pair(self.supply.temperature), pair(0.0)) * (factor * square);
        let heat = own * factor * size;
        Line {
            residual: heat * m + psi.value,
            by_exner: psi.by_downstream,
            by_supply: warming * supply.by_flow,
            by_flow: heat
                + heat
                + own * (bend * square)
                + psi.by_upstream * (behind * (bend - decay * factor)),
            by_total: warming * supply.by_tube,
        }
    }

    /// The squared flow between these sides, positive for `inward` flow out of the tube, and its slopes over w at the
    /// tube's end and in the node.
    #[inline(always)]
    fn flow_of_port(
        &self,
        conductance: Pair,
        inward: <Pair as Number>::Truth,
        [upstream, downstream]: [Pair; 2],
    ) -> FlowFunction<Pair> {
        let psi = self.gas.flow_function_of_air_times(conductance.signed(inward), upstream, downstream);
        let [by_upstream, by_downstream] = Pair::either(inward, psi.by_upstream, psi.by_downstream);
        FlowFunction { value: psi.value, by_upstream, by_downstream }
    }
}
