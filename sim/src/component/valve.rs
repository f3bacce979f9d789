//! The spool valve: how far the lands are open, and what they and the ports let pass.
//!
//! Area between an edge of the spool and the sleeve (6.38, Appendix IV), z the opening:
//!
//! ```text
//! A(z) = pi (D_v + D_s)/2 sqrt(z^2 + (D_v - D_s)^2/4)     z >= 0   (a truncated cone)
//! A(z) = pi (D_v^2 - D_s^2)/4                             z <  0   (the clearance leaks always)
//! z_1 = x - lap,  z_2 = -x - lap                                   (lap < 0: underlap)
//! ```
//!
//! Land 1 joins supply and port 1, and port 2 and exhaust; land 2 the other two. Single restriction
//! (6.39 to 6.46): the lands are all there is. Flow node (6.47 to 6.51): each port has a small volume between its lands and its bore of area A_p, whose
//! pressure balances the three flows. [`crate::network`] solves that balance.

pub mod characteristic;
pub mod discharge;
pub mod flow_force;
pub mod flow_law;
pub mod flow_map;
pub mod iso6358;
pub mod lands;
pub mod model;
mod restrictions;

use std::f64::consts::PI;

use crate::component::gas::Gas;
use crate::component::valve::flow_law::FlowLaw;
use crate::key::{Key, keys};
use crate::number::Pair;
use crate::values::{Findings, Rig};
use iso6358::{REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use lands::keys::CHARACTERISTIC;
pub use model::{Opening, ValveKind};
use model::{Paths, WITH_AREAS, WITH_NODES, WITH_SPOOL};
use restrictions::Shares;
pub(crate) use restrictions::{Conductances, Restrictions};

keys! {
    MODEL: ValveKind = choice("valve.model", "L(16)", "How the flows through the valve are formed.");
    SPOOL_TRAVEL_MM: f64 = number("valve.spool_travel_mm", 1.0, 0.01, 100.0, "C(3)", "Travel of the spool to either side; also what a command of 2048 asks for.");
    UNDERLAP_MM: f64 = number("valve.underlap_mm", 0.0, -10.0, 10.0, "C(4)", "Lap of the lands: negative is underlap, positive overlap.").chosen_by(&CHARACTERISTIC, &["lands", "linear"]);
    SLEEVE_DIAMETER_MM: f64 = number("valve.sleeve_diameter_mm", 10.0, 0.1, 500.0, "C(9)", "Bore of the sleeve.").chosen_by(&CHARACTERISTIC, &["lands"]);
    SPOOL_DIAMETER_MM: f64 = number("valve.spool_diameter_mm", 9.98, 0.1, 500.0, "C(10)", "Diameter of the spool's lands.").chosen_by(&CHARACTERISTIC, &["lands"]);
    SPOOL_ROD_DIAMETER_MM: f64 = number("valve.spool_rod_diameter_mm", 6.0, 0.0, 500.0, "C(25)", "Diameter of the spool between its lands.").chosen_by(&CHARACTERISTIC, &["lands"]);
    PORT_DIAMETER_MM: f64 = number("valve.port_diameter_mm", 3.3, 0.01, 500.0, "C(39)", "Bore of the ports.").of(WITH_NODES);
    DISCHARGE_SUPPLY: f64 = number("valve.discharge_supply", 0.8, 0.01, 1.0, "C(11)", "Coefficient of discharge of the supply lands and the ports.").of(WITH_AREAS).spread();
    DISCHARGE_EXHAUST: f64 = number("valve.discharge_exhaust", 0.8, 0.01, 1.0, "C(12)", "Coefficient of discharge of the exhaust lands.").of(WITH_AREAS).spread();
    DISCHARGE_REVERSE: f64 = number("valve.discharge_reverse", 1.0, 0.01, 1.0, "C(58)", "Multiplier of the coefficient of discharge for reverse flow.").default_only();
    UPSTREAM_MACH: bool = switch("valve.upstream_mach", true, "", "Whether the speed counts at which a tube brings air to the ports of flow nodes; false sets every upstream Mach number to zero.").of(WITH_NODES);
    TURBULENCE: f64 = number("valve.turbulence", 1.0, 0.0, 1.0, "C(54)", "Every upstream Mach number is multiplied by it; 0 is upstream_mach = false.").of(WITH_NODES);
    NULL_OFFSET_MM: f64 = number("valve.null_offset_mm", 0.0, -10.0, 10.0, "", "Spool position at which the valve is at its null.").of(WITH_SPOOL);
    NULL_DRIFT_MM_PER_H: f64 = number("valve.null_drift_mm_per_h", 0.0, -3600.0, 3600.0, "8.4", "How fast the valve\'s null moves, from null_offset_mm at the start of the test.").of(WITH_SPOOL);
}

/// The lists of the keys of all models, in the order of `rig explain`.
pub(crate) static KEYS: &[&[&[&Key]]] =
    &[&[keys::ALL, flow_force::keys::ALL, discharge::keys::ALL], model::KEYS, &[lands::keys::ALL]];

impl Valve {
    /// The valve of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Valve {
        let metres = |key| rig.get(key) * 1e-3;
        let model = rig.get(&keys::MODEL);
        Valve {
            null_offset: metres(&keys::NULL_OFFSET_MM),
            lap: metres(&keys::UNDERLAP_MM),
            sleeve_diameter: metres(&keys::SLEEVE_DIAMETER_MM),
            spool_diameter: metres(&keys::SPOOL_DIAMETER_MM),
            port_diameter: metres(&keys::PORT_DIAMETER_MM),
            has_node: model.facts().has_node,
            land_laws: model.laws(rig),
            opening: opening(rig),
            travel: spool_travel(rig),
            rod_diameter: metres(&keys::SPOOL_ROD_DIAMETER_MM),
            discharge_supply: rig.get(&keys::DISCHARGE_SUPPLY),
            discharge_exhaust: rig.get(&keys::DISCHARGE_EXHAUST),
        }
    }
}

/// X_max, m.
#[must_use]
pub(crate) fn spool_travel(rig: &Rig) -> f64 {
    rig.get(&keys::SPOOL_TRAVEL_MM) * 1e-3
}

/// How the paths of a rig open over the spool.
fn opening(rig: &Rig) -> Opening {
    let model = rig.get(&keys::MODEL);
    match model.facts().paths {
        Paths::Areas => Opening::Areas,
        Paths::Conductances => lands::characteristic(rig).map_or(Opening::Areas, Opening::Shares),
        Paths::Own => model.opening(rig),
    }
}

/// Whether the speed of the air in front of a restriction counts: where there are flow nodes. Lands alone have the
/// conventional flows of 6.39 to 6.46, without Mach numbers.
#[must_use]
pub fn speed_counts(rig: &Rig) -> bool {
    rig.get(&keys::UPSTREAM_MACH)
        && rig.get(&keys::TURBULENCE) > 0.0
        && rig.get(&keys::MODEL).facts().has_node
}

/// The largest coefficient of discharge with upstream Mach numbers. At 1 a choked port behind a wide
/// land is approached at M = 1, and its flow equation has a double root: M = C_d (5/6)^3 (1 + M^2/5)^3
/// for n = 1.4. Close to 1 the solution is nearly double, and is not found reliably.
pub const MAX_DISCHARGE: f64 = 0.9;

/// The constraints on the valve's dimensions.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    for key in [&keys::DISCHARGE_SUPPLY, &keys::DISCHARGE_EXHAUST] {
        if speed_counts(rig) && rig.get(key) > MAX_DISCHARGE {
            let message = format!(
                "must not be above {MAX_DISCHARGE} with upstream_mach: a port that loses nothing has no steady flow"
            );
            findings.note(key, message);
        }
    }
    lands::check(rig, findings);
    let why = "the spool moves inside the sleeve";
    findings.not_above(rig, &keys::SPOOL_DIAMETER_MM, &keys::SLEEVE_DIAMETER_MM, why);
    rig.get(&keys::MODEL).check(rig, findings);
}

/// The dimensions of the valve that its flow depends on, SI.
#[derive(Clone, Debug)]
pub struct Valve {
    /// Spool position at which the valve is at its null, m.
    pub null_offset: f64,
    /// C(4), m: negative is underlap, positive overlap.
    pub lap: f64,
    /// D_v, m.
    pub sleeve_diameter: f64,
    /// D_s, m.
    pub spool_diameter: f64,
    /// Bore of a port, m.
    pub port_diameter: f64,
    /// Whether the flow node is there: the bore of the port between it and the tube.
    pub has_node: bool,
    /// What the lands to the supply and to the exhaust are: orifices by their areas, or components by their conductances
    /// at full opening.
    pub land_laws: [FlowLaw; 2],
    /// How they follow the spool.
    pub opening: Opening,
    /// Spool travel to either side, m.
    pub travel: f64,
    /// Diameter of the spool between its lands, m.
    pub rod_diameter: f64,
    /// C_d of the lands to the supply, and of the ports.
    pub discharge_supply: f64,
    /// C_d of the lands to the exhaust.
    pub discharge_exhaust: f64,
}

impl Valve {
    /// Area of an edge that is open by `opening` m, m^2.
    #[must_use]
    pub fn edge_area(&self, opening: f64) -> f64 {
        let (sleeve, spool) = (self.sleeve_diameter, self.spool_diameter);
        if opening >= 0.0 {
            let clearance = (sleeve - spool) / 2.0;
            PI * (sleeve + spool) / 2.0 * (opening * opening + clearance * clearance).sqrt()
        } else {
            PI * (sleeve * sleeve - spool * spool) / 4.0
        }
    }

    /// Areas of land 1 and land 2 for a spool position in m.
    #[must_use]
    pub fn land_areas(&self, spool: f64) -> [f64; 2] {
        self.openings(spool).map(|opening| self.edge_area(opening))
    }

    /// z_1 and z_2 for a spool position, m.
    pub(crate) fn openings(&self, spool: f64) -> [f64; 2] {
        let x = spool - self.null_offset;
        [x - self.lap, -x - self.lap]
    }

    /// Where z_1 and z_2 are zero, m.
    pub(crate) fn edges(&self) -> [f64; 2] {
        [self.null_offset + self.lap, self.null_offset - self.lap]
    }

    /// C_d A of the wider land to the supply, over the area of a port.
    pub(crate) fn widest_supply_land(&self, openings: [f64; 2]) -> f64 {
        self.discharge_supply * self.edge_area(openings[0].max(openings[1])) / self.port_area()
    }

    /// A_p, m^2.
    #[must_use]
    pub fn port_area(&self) -> f64 {
        PI / 4.0 * self.port_diameter * self.port_diameter
    }

    /// Whether the laws of the lands depend on the place of the spool.
    pub(crate) fn laws_follow_spool(&self) -> bool {
        matches!(self.opening, Opening::Map(_))
    }

    /// The laws of the lands to the supply and to the exhaust with the spool at a place, m, where they depend on it.
    #[must_use]
    pub fn laws_at(&self, spool: f64) -> Option<[FlowLaw; 2]> {
        let Opening::Map(map) = &self.opening else { return None };
        let place = (spool - self.null_offset) / self.travel;
        let [one, two] = [map.at(place), map.at(-place)];
        Some([FlowLaw::Map([one, two]), FlowLaw::Map([two, one])])
    }

    /// The conductance of the land from the supply to node 1 for a spool position in m.
    #[must_use]
    pub fn supply_conductance(&self, gas: &Gas, spool: f64) -> f64 {
        self.conductances(gas, spool).lane(0).supply
    }

    /// The conductances around nodes 1 and 2 for a spool position in m.
    pub(crate) fn conductances(&self, gas: &Gas, spool: f64) -> Conductances<Pair> {
        let openings = self.openings(spool);
        self.restrictions(gas).at(openings, openings.map(|opening| opening >= 0.0))
    }

    /// What they have in common for all places of the spool.
    pub(crate) fn restrictions(&self, gas: &Gas) -> Restrictions {
        let clearance = (self.sleeve_diameter - self.spool_diameter) / 2.0;
        let around = PI * (self.sleeve_diameter + self.spool_diameter) / 2.0;
        let [supply, exhaust] = &self.land_laws;
        let port_area = self.port_area();
        let port = || self.conductance(gas, supply, self.discharge_supply, port_area * port_area);
        Restrictions {
            per_square: [(supply, self.discharge_supply), (exhaust, self.discharge_exhaust)]
                .map(|(law, discharge)| self.conductance(gas, law, discharge, around * around)),
            clearance_squared: clearance * clearance,
            are_areas: matches!(self.opening, Opening::Areas),
            shares: match &self.opening {
                Opening::Shares(characteristic) => {
                    Some(Shares { characteristic: characteristic.clone(), spool: [self.travel, self.lap] })
                }
                Opening::Areas | Opening::Map(_) => None,
            },
            port: self.has_node.then(port),
        }
    }

    /// That of a restriction by its law, coefficient of discharge and squared area (m^4, or m^2 per m^2 of opening).
    fn conductance(&self, gas: &Gas, law: &FlowLaw, discharge: f64, squared_area: f64) -> f64 {
        let constant = gas.flow_constant();
        match law {
            FlowLaw::Orifice => constant * discharge * discharge * squared_area,
            FlowLaw::Perry => constant * squared_area,
            FlowLaw::Map(_) => REFERENCE_DENSITY * REFERENCE_DENSITY * REFERENCE_TEMPERATURE,
            FlowLaw::Iso6358(component) if !matches!(self.opening, Opening::Areas) => component.conductance(),
            // The conductance is that of full opening, and goes with the area of the edge.
            FlowLaw::Iso6358(component) => {
                let around = PI * (self.sleeve_diameter + self.spool_diameter) / 2.0;
                let clearance = (self.sleeve_diameter - self.spool_diameter) / 2.0;
                let full = self.travel - self.lap;
                component.conductance() * squared_area
                    / (around * around * (full * full + clearance * clearance))
            }
        }
    }
}

#[cfg(test)]
pub(crate) fn thesis_valve() -> Valve {
    Valve {
        null_offset: 0.0,
        lap: 0.0,
        sleeve_diameter: 10e-3,
        spool_diameter: 9.98e-3,
        port_diameter: 3.3e-3,
        has_node: true,
        land_laws: [FlowLaw::Orifice; 2],
        opening: Opening::Areas,
        travel: 1e-3,
        rod_diameter: 6e-3,
        discharge_supply: 0.8,
        discharge_exhaust: 0.8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_edge_leaks_through_the_clearance() {
        let area = thesis_valve().edge_area(-1e-3);
        assert!((area - 0.3138e-6).abs() < 1e-10, "{area}: EQUATIONS section 2 has 0.314 mm2");
        assert_eq!(thesis_valve().edge_area(-1e-12), area);
        assert!((thesis_valve().edge_area(0.0) - area).abs() < 1e-18, "continuous at the edge");
    }

    #[test]
    fn lands_reach_the_port_area_at_0_27_mm() {
        let valve = thesis_valve();
        assert!((valve.port_area() - 8.55e-6).abs() < 0.01e-6);
        assert!(
            valve.edge_area(0.27e-3) < valve.port_area() && valve.edge_area(0.274e-3) > valve.port_area()
        );
    }

    #[test]
    fn an_ideal_spool_opens_in_proportion_and_does_not_leak() {
        let ideal = Valve { spool_diameter: 10e-3, ..thesis_valve() };
        assert_eq!(ideal.edge_area(-1e-4), 0.0);
        assert!((ideal.edge_area(1e-4) - PI * 10e-3 * 1e-4).abs() < 1e-18);
    }

    #[test]
    fn lap_and_null_offset_move_the_edges() {
        let overlapped = Valve { lap: 0.1e-3, ..thesis_valve() };
        assert_eq!(overlapped.land_areas(0.05e-3)[0], overlapped.edge_area(-1.0));
        let shifted = Valve { null_offset: 0.2e-3, ..thesis_valve() };
        assert_eq!(shifted.land_areas(0.2e-3)[0], shifted.land_areas(0.2e-3)[1]);
    }
}
