//! Newton's method for flows of the usual pattern: from the supply into both nodes and out of both into the exhaust,
//! through orifices that are all open. No tube's drop depends on the temperature of its air.
//!
//! Most of the general equations of [`super::balance`] are then known. Let a = -e be the flow out to the exhaust.
//! Each line is multiplied by the temperature of its air:
//!
//! ```text
//! land to the supply    f_s s^2 - K_s/T_s psi(f_s w_sv, w_n) = 0
//! land to the exhaust   a H - K_e psi(w_n, w_e) = 0                H = a T_b + d s,  T_n = H/a,  d = f_s T_s - T_b
//! port                  T_p m|m| + K_p psi(w_v, w_n) = 0           m = s - a
//! ```
//!
//! Behind a port that gives air back, T_b is the temperature f_c T_c of that air. Otherwise it is f_s T_s, and d is zero.
//! T_p is the temperature of the air in the port. The factors f are 1 where air is at rest in front of a restriction.
//!
//! The pressures behind the tubes depend on the flows: w_sv on M, the flow of both nodes from the supply, and w_v on m.

mod approach;
mod elimination;
mod lines;

use super::nodes::{BoundaryConditions, Nodes, pair};
use super::settling::{ARRIVED, NO_FLOW, SMALLEST};
use super::{FLOW_ERROR, Network};
use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::number::{Number, Pair};
use approach::Approach;
use elimination::solve;

/// The result of Newton's method.
pub(super) enum Outcome {
    /// Converged.
    Found,
    /// All corrections are used up.
    Lost,
    /// The flows have another pattern.
    Unusual,
}

/// The constants of one solution.
struct Known<'a> {
    gas: &'a Gas,
    supply: &'a GasState,
    chambers: &'a GasState<Pair>,
    /// w of the exhaust.
    outside: f64,
    /// d ln w/d mdot of the supply's tube and of the cylinder's, s/kg.
    decays: [f64; 2],
    /// K_s/T_s, K_e and K_p.
    supply_land: Pair,
    exhaust_land: Pair,
    port: Pair,
    /// Whether the port's air flows into the cylinder.
    charging: <Pair as Number>::Truth,
    /// (n-1)/2 M^2 P^2/mdot^2 of the supply's air and of the chambers', and (n-1)/2.
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

/// A correction, the one of M, and the approach of the air from supply and chambers before it.
struct Correction {
    change: Unknowns,
    total: Pair,
    approaches: [Approach; 2],
}

impl Network {
    /// Leads `nodes` to the solution while the flows keep the usual pattern. Returns the number of corrections.
    #[inline(always)]
    pub(super) fn newton_of_usual<const AT_REST: bool>(
        &self,
        boundary: &BoundaryConditions,
        nodes: &mut Nodes,
        most: u32,
    ) -> (Outcome, u32) {
        let Some(known) = self.known(boundary) else { return (Outcome::Unusual, 0) };
        let error = pair(if self.tight { FLOW_ERROR } else { self.flow_error });
        let mut at = Unknowns { exner: nodes.exner, supply: nodes.supply, exhaust: nodes.exhaust };
        let (mut outcome, mut corrections) = (Outcome::Lost, 0);
        while corrections < most {
            let Some(correction) = known.correction::<AT_REST>(&at) else {
                outcome = Outcome::Unusual;
                break;
            };
            corrections += 1;
            let found = at.settle(&correction.change, error);
            at = at.after(&correction.change, found);
            if found {
                [nodes.carried, nodes.temperature] = known.temperatures::<AT_REST>(&at, &correction);
                outcome = Outcome::Found;
                break;
            }
        }
        [nodes.exner, nodes.supply, nodes.exhaust] = [at.exner, at.supply, at.exhaust];
        (outcome, corrections)
    }

    /// None if the flows cannot have the usual pattern.
    #[inline(always)]
    fn known<'a>(&'a self, boundary: &'a BoundaryConditions) -> Option<Known<'a>> {
        let at_sound = 0.5 * (self.gas.heat_capacity_ratio - 1.0) * self.turbulence_squared;
        let speed = |rests: bool| pair(if rests { 0.0 } else { at_sound * self.mach });
        Some(Known {
            gas: &self.gas,
            supply: &self.supply,
            chambers: &boundary.chambers,
            outside: self.exhaust.exner,
            decays: [self.supply_tube.decay()?, self.cylinder_tube.decay()?],
            supply_land: boundary.valve.supply * pair(self.per_supply_temperature),
            exhaust_land: boundary.valve.exhaust,
            port: boundary.valve.port?,
            charging: boundary.charging,
            speeds: [
                speed(self.vessels.supply) * self.supply_temperature(),
                speed(self.vessels.chambers) * boundary.chambers.temperature,
            ],
            at_sound: pair(at_sound),
        })
    }
}

impl Known<'_> {
    /// The correction of the unknowns; None if the flows do not have the usual pattern.
    #[inline(always)]
    fn correction<const AT_REST: bool>(&self, at: &Unknowns) -> Option<Correction> {
        let Unknowns { exner: w, supply: s, exhaust: e } = *at;
        let (a, least) = (-e, pair(NO_FLOW));
        let ahead = pair(self.supply.exner * fall(self.decays[0], s.reduce_add()));
        let from_supply = if AT_REST { Approach::NONE } else { self.approach_to_lands(ahead, s) };
        let falls = (ahead * from_supply.factor).above(w) & w.above(pair(self.outside));
        if !Pair::all(s.above(least) & a.above(least) & falls) {
            return None;
        }
        let back = a - s;
        let behind = self.chambers.exner * fall(self.decays[1], back);
        let from_chamber = if AT_REST { Approach::NONE } else { self.approach_to_port(behind, back) };
        let approaches = [from_supply, from_chamber];
        let (change, total) = solve::<AT_REST>(&[
            self.supply_line::<AT_REST>((w, s), ahead, &from_supply),
            self.exhaust_line::<AT_REST>((w, s, a), &approaches),
            self.port_line::<AT_REST>((w, back), behind, &approaches),
        ]);
        Some(Correction { change, total, approaches })
    }

    /// Where the air from behind a port goes to the exhaust, by the flow out of the chamber.
    #[inline(always)]
    fn gives_back(&self, back: Pair) -> <Pair as Number>::Truth {
        Pair::choose(self.charging, pair(0.0), back).above(pair(0.0))
    }

    /// f_s T_s, the temperature of the air that charges, and T_n, both after the last correction, K.
    #[inline(always)]
    fn temperatures<const AT_REST: bool>(&self, at: &Unknowns, correction: &Correction) -> [Pair; 2] {
        let Correction { change, total, approaches: [supply, chamber] } = correction;
        let (mut warm, mut own) = (pair(self.supply.temperature), self.chambers.temperature);
        if !AT_REST {
            let back = -(change.supply + change.exhaust);
            warm *= supply.after(change.supply, *total);
            own *= chamber.after(back, back);
        }
        let gives_back = self.gives_back(-(at.supply + at.exhaust));
        let d = Pair::choose(gives_back, warm - own, pair(0.0));
        [warm, warm - d - d * (at.supply / at.exhaust)]
    }
}

/// w behind a tube over w in front of it; 1 without a tube, at no cost.
#[inline(always)]
fn fall<N: Number>(decay: f64, flow: N) -> N {
    if decay == 0.0 { N::from(1.0) } else { (N::from(decay) * flow).exponential() }
}

impl Unknowns {
    /// Whether the next correction would be within the allowed error of a flow.
    #[inline(always)]
    fn settle(&self, change: &Unknowns, error: Pair) -> bool {
        let small = |flow: Pair, change: Pair| {
            (error * flow.abs()).larger(pair(SMALLEST * SMALLEST)).at_least(change * change)
        };
        let (s, e) = (self.supply + change.supply, self.exhaust + change.exhaust);
        let flows =
            small(s, change.supply) & small(e, change.exhaust) & small(s + e, change.supply + change.exhaust);
        Pair::all(flows & (pair(ARRIVED) * self.exner).at_least(change.exner.abs()))
    }

    /// The unknowns after a correction. Unless the flows are found, no w goes below half or above twice its value.
    #[inline(always)]
    fn after(&self, change: &Unknowns, found: bool) -> Unknowns {
        let mut exner = self.exner + change.exner;
        if !found {
            exner = exner.larger(pair(0.5) * self.exner).smaller(pair(2.0) * self.exner);
        }
        Unknowns { exner, supply: self.supply + change.supply, exhaust: self.exhaust + change.exhaust }
    }
}
