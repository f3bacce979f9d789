//! Newton's method for flows of the usual pattern: from the supply into both nodes, and out of both into the exhaust,
//! through orifices of which none is shut; no tube's drop depends on the temperature of its air.
//!
//! Then most of what [`super::balance`] asks in general is known. With a = -e, what flows out to the exhaust, and each
//! line times the temperature of its air:
//!
//! ```text
//! land to the supply    f_s s^2 - K_s/T_s psi(f_s w_sv, w_n) = 0
//! land to the exhaust   a H - K_e psi(w_n, w_e) = 0                H = a T_b + d s,  T_n = H/a,  d = f_s T_s - T_b
//! port                  T_p m|m| + K_p psi(w_v, w_n) = 0           m = s - a
//! ```
//!
//! Behind a port that gives air back T_b is the temperature f_c T_c of that air; else it is f_s T_s, and d is zero. T_p is
//! the temperature of the air in the port. The factors f are 1 where air is at rest in front of a restriction.
//!
//! With M the flow in the supply tube, the first line gives ds = -(rho + alpha dw + tau dM), and with that the others
//!
//! ```text
//! g dw + b dm = r_2 - v_2 dM
//! c dw + q dm = -r_3 - v_3 dM
//! ```
//!
//! which Cramer's rule solves. The ds of both nodes add up to dM.

use super::newton::{ARRIVED, NO_FLOW, SMALLEST};
use super::nodes::{Nodes, Surroundings, pair};
use super::{FLOW_ERROR, Network};
use crate::component::gas::FlowFunction;
use crate::number::{Number, Pair};

/// How far Newton's method came.
pub(super) enum Outcome {
    /// To the flows.
    Found,
    /// Nowhere: the iterations are used up.
    Lost,
    /// To flows of another pattern, with so many iterations left.
    Unusual(u32),
}

/// What does not change while the flows are looked for.
struct Known {
    /// d ln w/d mdot of the supply's tube and of the cylinder's, s/kg.
    decays: [f64; 2],
    /// w in the chambers.
    chambers: Pair,
    /// T_s and T_c, K.
    of_supply: Pair,
    of_chambers: Pair,
    /// K_s/T_s, K_e and K_p.
    supply: Pair,
    exhaust: Pair,
    port: Pair,
    /// Where the port's air goes into the cylinder.
    charging: <Pair as Number>::Truth,
    /// P^2 M^2 / mdot^2 times (n-1)/2, of the supply's air and of the chambers', and (n-1)/2.
    speeds: [Pair; 2],
    at_sound: Pair,
}

/// A node's w, s and e, or the changes of them.
#[derive(Clone, Copy)]
struct Unknowns {
    exner: Pair,
    supply: Pair,
    exhaust: Pair,
}

/// f, its slope over the flow that approaches, and that over the flow in the tube by the pressure there.
#[derive(Clone, Copy)]
struct Approach {
    factor: Pair,
    by_flow: Pair,
    by_tube: Pair,
}

impl Known {
    /// None where the flows cannot be of the usual pattern.
    #[inline(always)]
    fn of(network: &Network, around: &Surroundings) -> Option<Known> {
        let decays = [network.supply_tube.decay()?, network.cylinder_tube.decay()?];
        let (of_supply, of_chambers) = (network.supply_temperature(), around.chambers.temperature);
        let at_sound = 0.5 * (network.gas.heat_capacity_ratio - 1.0) * network.turbulence_squared;
        let speed = |rests: bool| if rests { 0.0 } else { at_sound * network.mach };
        Some(Known {
            decays,
            chambers: around.chambers.exner,
            of_supply,
            of_chambers,
            supply: around.valve.supply * pair(network.per_supply_temperature),
            exhaust: around.valve.exhaust,
            port: around.valve.port?,
            charging: around.charging,
            speeds: [
                pair(speed(network.vessels.supply)) * of_supply,
                pair(speed(network.vessels.chambers)) * of_chambers,
            ],
            at_sound: pair(at_sound),
        })
    }

    /// How air at w = `exner`, behind a tube with this decay, approaches a restriction. P^2 is w^7.
    #[inline(always)]
    fn approach(&self, speed: Pair, exner: Pair, flow: Pair, decay: f64) -> Approach {
        let (zero, square) = (pair(0.0), exner * exner);
        let per_square = speed / (square * square * (square * exner));
        let rise = per_square * (flow * flow);
        let bends = |slope: Pair| Pair::choose(self.at_sound.above(rise), slope, zero);
        Approach {
            factor: pair(1.0) + rise.smaller(self.at_sound),
            by_flow: bends(pair(2.0) * per_square * flow),
            by_tube: bends(pair(-7.0 * decay) * rise),
        }
    }
}

impl Approach {
    /// Of air at rest.
    const NONE: Approach = Approach { factor: Pair::ONE, by_flow: Pair::ZERO, by_tube: Pair::ZERO };

    /// The same of air that flows where `truth` holds, and rests elsewhere.
    #[inline(always)]
    fn only(self, truth: <Pair as Number>::Truth) -> Approach {
        Approach {
            factor: Pair::choose(truth, self.factor, pair(1.0)),
            by_flow: Pair::choose(truth, self.by_flow, pair(0.0)),
            by_tube: Pair::choose(truth, self.by_tube, pair(0.0)),
        }
    }
}

/// What is left of a line, and its slopes over w_n, over s, over a or m, and over M.
struct Line {
    residual: Pair,
    by_exner: Pair,
    by_supply: Pair,
    by_flow: Pair,
    by_total: Pair,
}

/// A correction, with that of M, and how the air from supply and chambers approached before it.
struct Correction {
    change: Unknowns,
    total: Pair,
    approaches: [Approach; 2],
}

impl Network {
    /// Leads `nodes` to the solution as long as the flows are of the usual pattern, by so many corrections at most.
    #[inline(always)]
    pub(super) fn newton_of_usual<const AT_REST: bool>(
        &mut self,
        around: &Surroundings,
        nodes: &mut Nodes,
        most: u32,
    ) -> Outcome {
        let Some(known) = Known::of(self, around) else { return Outcome::Unusual(most) };
        let mut at = Unknowns { exner: nodes.exner, supply: nodes.supply, exhaust: nodes.exhaust };
        let mut outcome = Outcome::Lost;
        for done in 0..most {
            let Some(correction) = self.correction::<AT_REST>(&known, &at) else {
                outcome = Outcome::Unusual(most - done);
                break;
            };
            self.work.iterations += 1;
            let found = self.settles(&at, &correction.change);
            at = at.after(&correction.change, found);
            if found {
                nodes.temperature = known.mixed(&at, &correction);
                outcome = Outcome::Found;
                break;
            }
        }
        [nodes.exner, nodes.supply, nodes.exhaust] = [at.exner, at.supply, at.exhaust];
        outcome
    }

    /// The correction of the unknowns; None where the flows are not of the usual pattern.
    #[inline(always)]
    fn correction<const AT_REST: bool>(&self, known: &Known, at: &Unknowns) -> Option<Correction> {
        let Unknowns { exner: w, supply: s, exhaust: e } = *at;
        let [of_supply, of_cylinder] = known.decays;
        let ahead = pair(self.supply.exner * (of_supply * s.reduce_add()).exponential());
        let from_supply = match AT_REST {
            true => Approach::NONE,
            false => known.approach(known.speeds[0], ahead, s, of_supply),
        };
        let (a, least, outside) = (-e, pair(NO_FLOW), pair(self.exhaust.exner));
        let falls = (ahead * from_supply.factor).above(w) & w.above(outside);
        if !Pair::all(s.above(least) & a.above(least) & falls) {
            return None;
        }
        let back = a - s;
        let behind = known.chambers * (pair(of_cylinder) * back).exponential();
        let from_chamber = match AT_REST {
            true => Approach::NONE,
            false => known.approach(known.speeds[1], behind, back, of_cylinder).only(back.above(pair(0.0))),
        };
        let approaches = [from_supply, from_chamber];
        let lines = [
            self.supply_line_of_usual::<AT_REST>(known, (w, s), ahead, &from_supply),
            self.exhaust_line_of_usual::<AT_REST>(known, (w, s, a), outside, &approaches),
            self.port_line_of_usual::<AT_REST>(known, (w, back), behind, &approaches),
        ];
        let (change, total) = solve::<AT_REST>(&lines);
        Some(Correction { change, total, approaches })
    }

    #[inline(always)]
    fn supply_line_of_usual<const AT_REST: bool>(
        &self,
        known: &Known,
        (w, s): (Pair, Pair),
        ahead: Pair,
        approach: &Approach,
    ) -> Line {
        let decay = pair(known.decays[0]);
        if AT_REST {
            let psi = self.gas.flow_function_of_air_times(known.supply, ahead, w);
            return Line {
                residual: s * s - psi.value,
                by_exner: -psi.by_downstream,
                by_supply: s + s,
                by_flow: pair(0.0),
                by_total: -(psi.by_upstream * (decay * ahead)),
            };
        }
        let psi = self.gas.flow_function_of_air_times(known.supply, ahead * approach.factor, w);
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

    /// With its slope over s at a fixed m, and that over -m.
    #[inline(always)]
    fn exhaust_line_of_usual<const AT_REST: bool>(
        &self,
        known: &Known,
        (w, s, a): (Pair, Pair, Pair),
        outside: Pair,
        approaches: &[Approach; 2],
    ) -> Line {
        let psi = self.gas.flow_function_of_air_times(known.exhaust, w, outside);
        let gives = known.gives_back(a - s);
        let [warm, own] = known.temperatures(approaches);
        let base = Pair::choose(gives, own, warm);
        let (d, heat) = (warm - base, a * base);
        let mixed = heat + d * s;
        let by_outflow = mixed + heat;
        let line = Line {
            residual: a * mixed - psi.value,
            by_exner: -psi.by_upstream,
            by_supply: by_outflow + a * d,
            by_flow: by_outflow,
            by_total: pair(0.0),
        };
        if AT_REST {
            return line;
        }
        let [supply, chamber] = approaches;
        let warming = a * (Pair::choose(gives, s, a) * known.of_supply);
        let by_back = Pair::choose(gives, a * ((a - s) * known.of_chambers), pair(0.0));
        Line {
            by_supply: line.by_supply + warming * supply.by_flow,
            by_flow: line.by_flow + by_back * (chamber.by_flow + chamber.by_tube),
            by_total: warming * supply.by_tube,
            ..line
        }
    }

    /// With its slope over m.
    #[inline(always)]
    fn port_line_of_usual<const AT_REST: bool>(
        &self,
        known: &Known,
        (w, back): (Pair, Pair),
        behind: Pair,
        [supply, chamber]: &[Approach; 2],
    ) -> Line {
        let decay = pair(known.decays[1]);
        let (m, size) = (-back, back.abs());
        if AT_REST {
            let inward = behind.at_least(w);
            let psi = self.flow_of_port(known.port, inward, [behind.larger(w), behind.smaller(w)]);
            let t = Pair::choose(known.charging, known.of_supply, known.of_chambers) * size;
            return Line {
                residual: t * m + psi.value,
                by_exner: psi.by_downstream,
                by_supply: pair(0.0),
                by_flow: t + t - psi.by_upstream * (decay * behind),
                by_total: pair(0.0),
            };
        }
        let risen = behind * chamber.factor;
        let inward = risen.at_least(w);
        let sides = [Pair::choose(inward, risen, w), Pair::choose(inward, w, behind)];
        let psi = self.flow_of_port(known.port, inward, sides);
        let Approach { factor, by_flow, by_tube } = chamber.only(inward);
        let bend = -(by_flow + by_tube);
        let square = m * size;
        let own = Pair::choose(known.charging, supply.factor * known.of_supply, known.of_chambers);
        let warming = Pair::choose(known.charging, known.of_supply, pair(0.0)) * (factor * square);
        let t = own * factor * size;
        Line {
            residual: t * m + psi.value,
            by_exner: psi.by_downstream,
            by_supply: warming * supply.by_flow,
            by_flow: t + t + own * (bend * square) + psi.by_upstream * (behind * (bend - decay * factor)),
            by_total: warming * supply.by_tube,
        }
    }

    /// The squared flow out of the tube where it goes `inward`, from the one to the other side; its slopes are over w at the
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

    /// Whether another correction would be no more than the allowed error.
    #[inline(always)]
    fn settles(&self, at: &Unknowns, change: &Unknowns) -> bool {
        let error = pair(if self.tight { FLOW_ERROR } else { self.flow_error });
        let small = |flow: Pair, change: Pair| {
            (error * flow.abs()).larger(pair(SMALLEST * SMALLEST)).at_least(change * change)
        };
        let (s, e) = (at.supply + change.supply, at.exhaust + change.exhaust);
        let flows =
            small(s, change.supply) & small(e, change.exhaust) & small(s + e, change.supply + change.exhaust);
        Pair::all(flows & (pair(ARRIVED) * at.exner).at_least(change.exner.abs()))
    }
}

/// Both nodes' changes, and that of M. The determinants are above zero where air flows.
#[inline(always)]
fn solve<const AT_REST: bool>([supply, exhaust, port]: &[Line; 3]) -> (Unknowns, Pair) {
    let per_supply = pair(1.0) / supply.by_supply;
    let rho = supply.residual * per_supply;
    let alpha = supply.by_exner * per_supply;
    let tau = supply.by_total * per_supply;
    let without = |line: &Line| {
        let [residual, by_exner, by_total] = [rho, alpha, tau].map(|part| line.by_supply * part);
        (line.residual - residual, line.by_exner - by_exner, line.by_total - by_total)
    };
    let (r_2, g, v_2) = without(exhaust);
    let (r_3, c, v_3) = match AT_REST {
        true => (port.residual, port.by_exner, pair(0.0)),
        false => without(port),
    };
    // The line to the exhaust is r_2 + g dw - b dm + v_2 dM = 0 here.
    let (b, q) = (exhaust.by_flow, port.by_flow);
    let determinant = g * q + b * c;
    let inverse = pair(1.0) / determinant;
    let fixed = r_2 * q + b * r_3;
    let (per_total, into_port) = match AT_REST {
        true => (v_2 * q, v_2 * c),
        false => (v_2 * q + b * v_3, v_2 * c - g * v_3),
    };
    // Times both determinants, so that no division waits for another one.
    let [one, two] = determinant.to_array();
    let other = Pair::new([two, one]);
    let sum = ((alpha * fixed - rho * determinant) * other).reduce_add();
    let shared = ((tau * determinant - alpha * per_total) * other).reduce_add();
    let total = pair(sum / (one * two + shared));
    let exner = -(fixed + per_total * total) * inverse;
    let s = -(rho + tau * total + alpha * exner);
    let m = (r_2 * c - g * r_3 + into_port * total) * inverse;
    (Unknowns { exner, supply: s, exhaust: m - s }, total)
}

impl Known {
    /// Where the air behind a port goes to the exhaust, by the flow out of the chamber.
    #[inline(always)]
    fn gives_back(&self, back: Pair) -> <Pair as Number>::Truth {
        Pair::choose(self.charging, pair(0.0), back).above(pair(0.0))
    }

    /// f_s T_s and f_c T_c, K.
    #[inline(always)]
    fn temperatures(&self, [supply, chamber]: &[Approach; 2]) -> [Pair; 2] {
        [supply.factor * self.of_supply, chamber.factor * self.of_chambers]
    }

    /// T_n after the last correction, K.
    #[inline(always)]
    fn mixed(&self, at: &Unknowns, correction: &Correction) -> Pair {
        let Correction { change, total, approaches: [supply, chamber] } = correction;
        let change_of_back = -(change.supply + change.exhaust);
        let factors = [
            supply.factor + supply.by_flow * change.supply + supply.by_tube * *total,
            chamber.factor + (chamber.by_flow + chamber.by_tube) * change_of_back,
        ];
        let (warm, own) = (factors[0] * self.of_supply, factors[1] * self.of_chambers);
        let d = Pair::choose(self.gives_back(-(at.supply + at.exhaust)), warm - own, pair(0.0));
        warm - d - d * (at.supply / at.exhaust)
    }
}

impl Unknowns {
    /// The unknowns after a change, which no w follows by more than its half.
    #[inline(always)]
    fn after(&self, change: &Unknowns, found: bool) -> Unknowns {
        let mut exner = self.exner + change.exner;
        if !found {
            exner = exner.larger(pair(0.5) * self.exner).smaller(pair(2.0) * self.exner);
        }
        Unknowns { exner, supply: self.supply + change.supply, exhaust: self.exhaust + change.exhaust }
    }
}
