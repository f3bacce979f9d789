//! The force of the flowing air on the spool (thesis 6.4.4, Appendix III).
//!
//! Sign: F_ind > 0 pushes towards negative x. It stands beside the spring in 6.33, so that the spool's
//! equation subtracts it, and a positive F_ind closes a spool that is open to positive x:
//!
//! ```text
//! M x'' = ... - K x - F_ind                                                              (6.33)
//! ```
//!
//! Analytical: the momentum of the jets at the edges (6.35 to 6.37). Land 1 is open for x > 0, land 2
//! for x < 0, and every edge closes, whichever way its air flows:
//!
//! ```text
//! F_ind = |s_1| u_s1 + |e_2| u_e2 - |s_2| u_s2 - |e_1| u_e1
//! u_s1  = |s_1| R T_s / (P_sv A_1)      u_e2 = |e_2| R T_e / (P_e A_1)       edges of land 1
//! u_s2  = |s_2| R T_s / (P_sv A_2)      u_e1 = |e_1| R T_e / (P_e A_2)       edges of land 2
//! u    <= sqrt(n R T_s)
//! ```
//!
//! As printed, m_e1 u_e1 has the sign that opens. At the density of P_e a speed u_e would reach
//! 800 m/s; u_s stays below that of sound by itself. Left out, as in the reference (EQUATIONS section
//! 8): (l/2)(m_s'' - m_e''), below 0.05 N, and m_1 u_1, whose jet leaves through the port, radially.
//! The jets count as axial, which makes the force an upper bound.
//!
//! Experimental: coefficients over the opening of the edges, after Louis and Logan (6.34):
//!
//! ```text
//! F_ind = A_vp (f_1 - f_2),   f_i = C_in(z_si) (P_sv - P_ni)     air goes into cylinder side i
//!                             f_i = C_out(z_ei) (P_ni - P_iv)    air comes out of it
//! z_s1 = z_e2 = max(0, x)/travel,   z_s2 = z_e1 = max(0, -x)/travel,   z <= 1
//! A_vp = pi/4 (D_s^2 - D_sp^2)
//! ```
//!
//! Two departures from 6.34, both for its own rule that the force closes the valve. Node 2's outflow
//! is printed with a plus: it would open. And C is taken at |x| for edges that the spool has shut as
//! well: with x > 0 and blocked ports, C_in (P_sv - P_n2) would push the thesis valve open with 2.3 N.
//! Here a shut edge has its coefficient at 0, which makes F_ind continuous through x = 0. Where a port's
//! flow reverses it jumps, as in 6.34; that reversal is an event.

use std::f64::consts::PI;

use crate::component::gas::Gas;
use crate::key::{Typed, keys, words};
use crate::values::Rig;

words! {
    /// Which force of the flow the spool feels.
    pub enum FlowForceKind {
        /// None.
        None = "none",
        /// Louis and Logan's, by measured coefficients.
        Experimental = "experimental",
        /// By the momentum of the jets.
        Analytical = "analytical",
    }
}

keys! {
    FLOW_FORCE: FlowForceKind = choice("valve.flow_force", "L(16)=4,5", "Force of the flow on the spool.");
    FLOW_FORCE_INLET: Option<Vec<f64>> = optional_numbers("valve.flow_force_inlet", 12, "a stand-in fitted to the force of a free jet; Louis and Logan's coefficients are not published in the thesis", "6.34", "C_Fin: coefficients of the powers 0 to 11 of the opening, for the experimental flow force of air that goes in.");
    FLOW_FORCE_OUTLET: Option<Vec<f64>> = optional_numbers("valve.flow_force_outlet", 12, "as flow_force_inlet", "6.34", "C_Fout: the same for air that comes out.");
    LAND_LENGTH_M: f64 = number("valve.land_length_m", 0.01, 0.0, 1.0, "C(70)", "Length of the lands: it weighs the rates of change of the mass flows, which the flow forces leave out.").default_only();
}

impl FlowForce {
    /// The flow force of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> FlowForce {
        let coefficients =
            |key: &Typed<Option<Vec<f64>>>| rig.get(key).and_then(|values| values.try_into().ok());
        match rig.get(&keys::FLOW_FORCE) {
            FlowForceKind::Analytical => FlowForce::Analytical,
            FlowForceKind::Experimental => FlowForce::Experimental {
                inlet: coefficients(&keys::FLOW_FORCE_INLET).unwrap_or(DEFAULT_INLET),
                outlet: coefficients(&keys::FLOW_FORCE_OUTLET).unwrap_or(DEFAULT_OUTLET),
            },
            FlowForceKind::None => FlowForce::None,
        }
    }
}

/// Coefficients of z^0 to z^11.
pub type Polynomial = [f64; 12];

/// A stand-in for the C_Fin of Louis and Logan, whose coefficients the thesis does not print: not their
/// measurement, but a fit of our own to the steady flow force of an incompressible jet (Blackburn,
/// Reethof, Shearer, Fluid Power Control, 1960), which leaves the edge at von Mises' 69 degrees:
///
/// ```text
/// F = 2 C_d C_v A cos(69 deg) dP,   C = F / (A_vp dP),   C_d = 0.8, C_v = 0.98
/// ```
///
/// A is the thesis valve's edge area (6.38) at x = z 1 mm, at most its port's 8.553 mm^2; its A_vp is
/// 49.95 mm^2. C goes from 0.0035 to 0.0962 at z = 0.272, where it has a corner, and is level beyond.
///
/// Least squares at 400 Chebyshev points of 0..1, in Chebyshev polynomials (condition number 2; 50
/// digits), then as powers of z, whose cancellation costs less than 1e-11. Largest error 0.0044, at the
/// corner (4.5 % of the level); 0.0009 in the root mean square.
pub const DEFAULT_INLET: Polynomial = [
    0.0031044800728385,
    0.16781822896831,
    5.6204515340642,
    -92.695580836996,
    839.27008425235,
    -4340.6043328209,
    13455.145380116,
    -26009.849115189,
    31690.293968291,
    -23692.547235861,
    9937.0683339351,
    -1791.7771435896,
];

/// A stand-in for C_Fout: the same fit, as both edges of a land are alike and so are their C_d. 6.34
/// multiplies it by the drop over the port, not over the edge: where the edge is narrower than the
/// port, the fit falls short of the jet's force.
pub const DEFAULT_OUTLET: Polynomial = DEFAULT_INLET;

/// How the force of the flow is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlowForce {
    /// There is none (thesis L(16) = 1).
    None,
    /// From the momentum of the jets (L(16) = 5).
    Analytical,
    /// From measured coefficients over |x|/travel in 0..1 (L(16) = 4).
    Experimental {
        /// C_Fin.
        inlet: Polynomial,
        /// C_Fout.
        outlet: Polynomial,
    },
}

/// The air on the outer side of an edge.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Pa.
    pub pressure: f64,
    /// K.
    pub temperature: f64,
}

/// The flows and pressures around one node.
#[derive(Clone, Copy, Debug)]
pub struct NodeFlows {
    /// s, kg/s, from the supply into the node.
    pub supply: f64,
    /// e, kg/s, from the exhaust into the node; negative when air leaves.
    pub exhaust: f64,
    /// P_n, Pa.
    pub pressure: f64,
    /// P_v, Pa, at the far side of the port.
    pub port_pressure: f64,
}

/// What the force depends on, at one instant.
#[derive(Clone, Copy, Debug)]
pub struct ValveFlows {
    /// P_sv and T_s.
    pub supply: Source,
    /// P_e and T_e.
    pub exhaust: Source,
    /// Nodes 1 and 2.
    pub nodes: [NodeFlows; 2],
    /// A_1 and A_2, m^2. Through an edge without area nothing flows and nothing pushes.
    pub land_areas: [f64; 2],
    /// A_vp, m^2.
    pub path_area: f64,
    /// x over the travel, signed; more than 1 counts as 1.
    pub opening: f64,
}

/// A_vp, m^2, between spool (D_s) and spool rod (D_sp, C(25)); diameters in m.
#[must_use]
pub fn path_area(spool_diameter: f64, rod_diameter: f64) -> f64 {
    PI / 4.0 * (spool_diameter * spool_diameter - rod_diameter * rod_diameter)
}

impl FlowForce {
    /// F_ind, N: positive closes a spool that is open to positive x.
    #[must_use]
    pub fn force(&self, gas: &Gas, valve: &ValveFlows) -> f64 {
        match self {
            FlowForce::None => 0.0,
            FlowForce::Analytical => valve.momentum(gas),
            FlowForce::Experimental { inlet, outlet } => valve.measured(inlet, outlet),
        }
    }
}

impl ValveFlows {
    fn momentum(&self, gas: &Gas) -> f64 {
        let sound = (gas.heat_capacity_ratio * gas.gas_constant * self.supply.temperature).sqrt();
        let jet = |flow: f64, source: &Source, area: f64| {
            if area <= 0.0 {
                return 0.0;
            }
            let flow = flow.abs();
            let speed = flow * gas.gas_constant * source.temperature / (source.pressure * area);
            flow * speed.min(sound)
        };
        let [one, two] = &self.nodes;
        let [area_1, area_2] = self.land_areas;
        let land_1 = jet(one.supply, &self.supply, area_1) + jet(two.exhaust, &self.exhaust, area_1);
        let land_2 = jet(two.supply, &self.supply, area_2) + jet(one.exhaust, &self.exhaust, area_2);
        land_1 - land_2
    }

    fn measured(&self, inlet: &Polynomial, outlet: &Polynomial) -> f64 {
        let at_node = |node: &NodeFlows, supply_opening: f64| {
            if node.supply + node.exhaust >= 0.0 {
                coefficient(inlet, supply_opening) * (self.supply.pressure - node.pressure)
            } else {
                coefficient(outlet, -supply_opening) * (node.pressure - node.port_pressure)
            }
        };
        let [one, two] = &self.nodes;
        self.path_area * (at_node(one, self.opening) - at_node(two, -self.opening))
    }
}

/// A polynomial at the opening of an edge over the travel; that of a shut edge is 0.
fn coefficient(polynomial: &Polynomial, opening: f64) -> f64 {
    let z = opening.clamp(0.0, 1.0);
    polynomial.iter().rev().fold(0.0, |sum, term| sum * z + term)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::valve::thesis_valve;

    const STAND_IN: FlowForce = FlowForce::Experimental { inlet: DEFAULT_INLET, outlet: DEFAULT_OUTLET };
    const BOTH: [FlowForce; 2] = [FlowForce::Analytical, STAND_IN];

    fn gas() -> Gas {
        Gas::new(1.4, 286.76)
    }

    /// The thesis valve at x mm with these nodes.
    fn valve(x_mm: f64, nodes: [NodeFlows; 2]) -> ValveFlows {
        ValveFlows {
            supply: Source { pressure: 5e5, temperature: 294.0 },
            exhaust: Source { pressure: 101_300.0, temperature: 294.0 },
            nodes,
            land_areas: thesis_valve().land_areas(x_mm * 1e-3),
            path_area: path_area(9.98e-3, 6e-3),
            opening: x_mm,
        }
    }

    const CHARGING: NodeFlows =
        NodeFlows { supply: 2.1e-3, exhaust: -0.1e-3, pressure: 4.2e5, port_pressure: 3.8e5 };
    const DISCHARGING: NodeFlows =
        NodeFlows { supply: 0.1e-3, exhaust: -1.6e-3, pressure: 1.3e5, port_pressure: 2.1e5 };

    #[test]
    fn it_closes_a_spool_that_is_open_either_way() {
        for force in BOTH {
            for x in [0.05, 0.2, 0.8] {
                assert!(force.force(&gas(), &valve(x, [CHARGING, DISCHARGING])) > 0.01, "{force:?} {x}");
                assert!(force.force(&gas(), &valve(-x, [DISCHARGING, CHARGING])) < -0.01, "{force:?} {x}");
            }
        }
    }

    #[test]
    fn each_open_edge_closes_by_itself_whichever_way_its_air_flows() {
        let still = NodeFlows { supply: 0.0, exhaust: 0.0, pressure: 3e5, port_pressure: 3e5 };
        for flow in [1e-3, -1e-3] {
            let (fed, vented) = (NodeFlows { supply: flow, ..still }, NodeFlows { exhaust: flow, ..still });
            for (x, nodes) in [(0.2, [fed, still]), (0.2, [still, vented])] {
                assert!(FlowForce::Analytical.force(&gas(), &valve(x, nodes)) > 0.0, "{flow}");
                let mirrored = valve(-x, [nodes[1], nodes[0]]);
                assert!(FlowForce::Analytical.force(&gas(), &mirrored) < 0.0, "{flow}");
            }
        }
    }

    #[test]
    fn exchanging_the_nodes_and_the_side_of_the_spool_reverses_it() {
        for force in BOTH {
            for x in [-0.7, -0.1, 0.0, 0.1, 0.3] {
                for [a, b] in [[CHARGING, DISCHARGING], [CHARGING, CHARGING], [DISCHARGING, CHARGING]] {
                    let forth = force.force(&gas(), &valve(x, [a, b]));
                    assert_eq!(force.force(&gas(), &valve(-x, [b, a])), -forth, "{force:?} {x}");
                }
            }
        }
    }

    #[test]
    fn air_at_rest_exerts_none_and_neither_does_an_edge_without_area() {
        let still = NodeFlows { supply: 0.0, exhaust: 0.0, pressure: 5e5, port_pressure: 5e5 };
        for force in [FlowForce::None, FlowForce::Analytical, STAND_IN] {
            assert_eq!(force.force(&gas(), &valve(0.3, [still, still])), 0.0);
        }
        assert_eq!(FlowForce::None.force(&gas(), &valve(0.3, [CHARGING, DISCHARGING])), 0.0);
        let shut = ValveFlows { land_areas: [0.0; 2], ..valve(0.0, [still, still]) };
        assert_eq!(FlowForce::Analytical.force(&gas(), &shut), 0.0);
    }

    /// By hand: u = 2e-3 286.76 294 / (5e5 8e-6) = 42.1537 m/s; F = 2e-3 u = 0.0843 N.
    #[test]
    fn a_jet_of_2_grams_a_second_at_42_metres_a_second_pushes_with_0_084_newtons() {
        let still = NodeFlows { supply: 0.0, exhaust: 0.0, pressure: 3e5, port_pressure: 3e5 };
        let fed = NodeFlows { supply: 2e-3, ..still };
        let open = ValveFlows { land_areas: [8e-6, 3e-7], ..valve(0.25, [fed, still]) };
        let got = FlowForce::Analytical.force(&gas(), &open);
        assert!((got - 0.084_307_4).abs() < 1e-7, "{got}");
    }

    #[test]
    fn air_leaves_no_faster_than_sound() {
        let still = NodeFlows { supply: 0.0, exhaust: 0.0, pressure: 3e5, port_pressure: 3e5 };
        let sound = (1.4_f64 * 286.76 * 294.0).sqrt();
        let push = |flow: f64| {
            let vented = NodeFlows { exhaust: -flow, ..still };
            let open = ValveFlows { land_areas: [8e-6, 3e-7], ..valve(0.25, [still, vented]) };
            FlowForce::Analytical.force(&gas(), &open)
        };
        assert!((push(8e-3) - 8e-3 * sound).abs() < 1e-12, "832 m/s at the density of P_e");
        assert!(push(2e-3) < 2e-3 * sound);
    }

    #[test]
    fn measured_coefficients_take_the_drop_of_their_own_edge() {
        let (mut inlet, mut outlet) = ([0.0; 12], [0.0; 12]);
        (inlet[1], outlet[0]) = (0.5, 0.25);
        let force = FlowForce::Experimental { inlet, outlet };
        // 0.5 0.4 (5e5 - 4.2e5) in, 0.25 (2.1e5 - 1.3e5) out.
        let expected = path_area(9.98e-3, 6e-3) * (0.2 * 8e4 + 0.25 * 8e4);
        let got = force.force(&gas(), &valve(0.4, [CHARGING, DISCHARGING]));
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
    }

    #[test]
    fn blocked_ports_do_not_pull_the_spool_open() {
        let full = NodeFlows { supply: 1e-4, exhaust: -1e-4, pressure: 4.99e5, port_pressure: 4.99e5 };
        let empty = NodeFlows { supply: 1e-4, exhaust: -1e-4, pressure: 1.02e5, port_pressure: 1.02e5 };
        let got = STAND_IN.force(&gas(), &valve(0.5, [full, empty]));
        assert!(got.abs() < 0.1, "{got}: 6.34 to the letter gives -1.9 N");
    }

    #[test]
    fn polynomials_have_twelve_terms_and_end_at_the_travel() {
        let ones = [1.0; 12];
        assert_eq!(coefficient(&ones, 0.5), 2.0 - f64::powi(0.5, 11));
        assert_eq!(coefficient(&ones, 1.0), 12.0);
        assert_eq!((coefficient(&ones, 1.05), coefficient(&ones, -0.3)), (12.0, 1.0));
    }

    #[test]
    fn the_stand_in_is_the_force_of_a_jet_at_69_degrees_within_0_0044() {
        let (valve, area) = (thesis_valve(), path_area(9.98e-3, 6e-3));
        let jet = 2.0 * 0.8 * 0.98 * libm::cos(69.0 * PI / 180.0);
        let source = |z: f64| jet * valve.edge_area(z * 1e-3).min(valve.port_area()) / area;
        assert!((source(0.0) - 0.003_53).abs() < 1e-5 && (source(1.0) - 0.096_215).abs() < 1e-6);
        let errors: Vec<f64> = (0..=4000)
            .map(|i| f64::from(i) / 4000.0)
            .chain([0.272_339])
            .map(|z| (coefficient(&DEFAULT_INLET, z) - source(z)).abs())
            .collect();
        let largest = errors.iter().copied().fold(0.0, f64::max);
        let mean_square = errors.iter().map(|e| e * e).sum::<f64>() / 4002.0;
        assert!(largest < 0.0044 && largest > 0.0043, "{largest}, at the corner");
        assert!(mean_square.sqrt() < 0.0009, "{mean_square}");
    }

    #[test]
    fn the_stand_in_never_opens() {
        for i in 0..=1000 {
            assert!(coefficient(&DEFAULT_INLET, f64::from(i) / 1000.0) > 0.0, "{i}");
        }
    }
}
