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

pub mod discharge;
pub mod flow_force;
pub mod flow_law;
pub mod iso6358;

use std::f64::consts::PI;

use crate::component::gas::Gas;
use crate::component::valve::flow_law::FlowLaw;
use crate::number::{Number, Pair};

/// The dimensions of the valve that its flow depends on, SI.
#[derive(Clone, Copy, Debug)]
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
    /// What the lands are: orifices by their areas, or a component by its conductance at full opening.
    pub land_law: FlowLaw,
    /// Spool travel to either side, m.
    pub travel: f64,
    /// Diameter of the spool between its lands, m.
    pub rod_diameter: f64,
    /// C_d of the lands to the supply, and of the ports.
    pub discharge_supply: f64,
    /// C_d of the lands to the exhaust.
    pub discharge_exhaust: f64,
}

/// (C_d A)^2 2n/((n-1)R) of the restrictions around a node, or around both: a squared mass flow for a flow
/// function over a temperature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conductances<N = f64> {
    pub supply: N,
    pub exhaust: N,
    /// None: the port has no bore of its own (single restriction, 6.39 to 6.46).
    pub port: Option<N>,
}

impl Conductances<Pair> {
    /// Those of node `i`.
    pub fn lane(&self, i: usize) -> Conductances {
        Conductances {
            supply: self.supply.lane(i),
            exhaust: self.exhaust.lane(i),
            port: self.port.map(|port| port.lane(i)),
        }
    }
}

/// What a valve's conductances have in common for all places of its spool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Restrictions {
    /// Of lands to the supply and to the exhaust over z^2 + c^2, c the clearance.
    per_square: [f64; 2],
    /// c^2, m^2.
    clearance_squared: f64,
    port: Option<f64>,
}

impl Restrictions {
    /// Around nodes 1 and 2, with lands 1 and 2 open by `openings` (m), or counted as shut: smooth a little
    /// beyond the change as well.
    #[inline]
    pub fn at(&self, openings: [f64; 2], open: [bool; 2]) -> Conductances<Pair> {
        let squares = [0, 1].map(|i| {
            let across = if open[i] { openings[i] * openings[i] } else { 0.0 };
            across + self.clearance_squared
        });
        let [supply, exhaust] = self.per_square.map(Pair::splat);
        Conductances {
            supply: supply * Pair::new(squares),
            exhaust: exhaust * Pair::new([squares[1], squares[0]]),
            port: self.port.map(Pair::splat),
        }
    }
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

    /// C_d A of the wider land to the supply, over the area of a port.
    pub(crate) fn widest_supply_land(&self, openings: [f64; 2]) -> f64 {
        self.discharge_supply * self.edge_area(openings[0].max(openings[1])) / self.port_area()
    }

    /// A_p, m^2.
    #[must_use]
    pub fn port_area(&self) -> f64 {
        PI / 4.0 * self.port_diameter * self.port_diameter
    }

    /// The conductances around nodes 1 and 2 for a spool position in m.
    pub(crate) fn conductances(&self, gas: &Gas, spool: f64) -> Conductances<Pair> {
        let openings = self.openings(spool);
        self.restrictions(gas).at(openings, openings.map(|opening| opening >= 0.0))
    }

    /// What they have in common for all places of the spool.
    pub(crate) fn restrictions(&self, gas: &Gas) -> Restrictions {
        let around = PI * (self.sleeve_diameter + self.spool_diameter) / 2.0;
        let clearance = (self.sleeve_diameter - self.spool_diameter) / 2.0;
        let constant = gas.flow_constant();
        let of = |discharge: f64, squared_area: f64| match self.land_law {
            FlowLaw::Orifice => constant * discharge * discharge * squared_area,
            FlowLaw::Perry => constant * squared_area,
            // The conductance is that of full opening, and goes with the area of the edge.
            FlowLaw::Iso6358(component) => {
                let full = self.travel - self.lap;
                component.conductance() * squared_area
                    / (around * around * (full * full + clearance * clearance))
            }
        };
        let port_area = self.port_area();
        Restrictions {
            per_square: [self.discharge_supply, self.discharge_exhaust]
                .map(|discharge| of(discharge, around * around)),
            clearance_squared: clearance * clearance,
            port: self.has_node.then(|| of(self.discharge_supply, port_area * port_area)),
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
        land_law: FlowLaw::Orifice,
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
