//! The cylinder: two chambers of air and the piston between them (thesis 6.1).
//!
//! ```text
//! V_1 = A_1 y + V_R1,  V_2 = A_2 (L - y) + V_R2                          (6.21, 6.22)
//! m' = sum of mdot                                                       mass
//! w'/w = (n-1) (R sum of mdot T_in / (P V) - V'/V)                       energy: 6.15, 6.17 in w;
//!                                                                        with heat, see [`crate::component::actuator::walls`]
//! T = P V / (m R),   T_in: of the air that comes in, else T              (6.6)
//! F_a = P_1 A_1 - P_2 A_2 - P_e A_R2                                     (6.25)
//! ```
//!
//! The states are the mass m and the Exner pressure w = P^((n-1)/n). An integrator conserves the mass exactly, and a
//! chamber with shut ports keeps w V^(n-1). The thesis's temperature equations 6.16 and 6.18 follow from these two;
//! as printed they lose mass with leakage (EQUATIONS section 5). A vented chamber has constant pressure and temperature instead
//! ([`crate::component::actuator::vent`]).

pub mod cushion;
pub mod leakage;
pub mod spring;
pub mod vent;
pub(crate) mod walls;

use std::f64::consts::PI;

use crate::component::actuator::walls::Walls;
use crate::component::air::{ChamberAir, Volume};
use crate::component::exhaust;
use crate::component::gas::Gas;
use crate::key::{keys, words};
use crate::number::{Number, Pair};
use crate::values::{Findings, Rig};
use leakage::Leakage;
use vent::Vent;

words! {
    /// Kind of cylinder.
    pub enum ActuatorKind {
        /// With a rod on one side.
        Asymmetric = "asymmetric",
        /// Rodless, or with a rod on both sides.
        Symmetric = "symmetric",
    } not built "rotary-vane"
}

keys! {
    MODEL: ActuatorKind = choice("actuator.model", "L(18)", "Kind of cylinder; a symmetric one is rodless, or has a rod on both sides.");
    STROKE_M: f64 = number("actuator.stroke_m", 0.3, 1e-3, 20.0, "C(14)", "Length of the stroke.");
    BORE_M: f64 = number("actuator.bore_m", 0.05, 1e-3, 2.0, "C(15)", "Bore of the cylinder.");
    ROD_DIAMETER_M: f64 = number("actuator.rod_diameter_m", 0.025, 0.0, 2.0, "C(16)", "Diameter of the rod: on one side (asymmetric) or on both (symmetric).").of(&["asymmetric", "symmetric"]);
    RESIDUAL_VOLUME_1_M3: f64 = number("actuator.residual_volume_1_m3", 2e-5, 1e-9, 1.0, "C(35)", "Dead volume of chamber 1 with its tube.").spread();
    RESIDUAL_VOLUME_2_M3: f64 = number("actuator.residual_volume_2_m3", 2e-5, 1e-9, 1.0, "C(36)", "Dead volume of chamber 2 with its tube.").spread();
}

impl Actuator {
    /// The cylinder of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Actuator {
        let (bore, rod_diameter) = (rig.get(&keys::BORE_M), rig.get(&keys::ROD_DIAMETER_M));
        let [blind, rod_side, rod] = Actuator::areas(bore, rod_diameter);
        let symmetric = rig.get(&keys::MODEL) == ActuatorKind::Symmetric;
        let area_1 = if symmetric { rod_side } else { blind };
        let rods = [if symmetric { rod_diameter } else { 0.0 }, rod_diameter];
        let (stroke, vent) = (rig.get(&keys::STROKE_M), Vent::of(rig));
        let mut residual_volumes =
            [rig.get(&keys::RESIDUAL_VOLUME_1_M3), rig.get(&keys::RESIDUAL_VOLUME_2_M3)];
        if let Some(vent) = vent {
            // The surroundings are behind it, so that no stop takes its volume up.
            residual_volumes[vent.chamber] = blind * stroke;
        }
        Actuator {
            stroke,
            area_1,
            area_2: rod_side,
            rod_area: if symmetric { 0.0 } else { rod },
            residual_volumes,
            ambient_pressure: rig.get(&exhaust::keys::PRESSURE_PA),
            leakage: Leakage::of(rig, bore),
            walls: Walls::of(rig, [area_1, rod_side], bore, rods),
            vent,
        }
    }
}

/// The constraints on the cylinder's dimensions.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let why = "the rod must leave an area for the air to push on";
    findings.below(rig, &keys::ROD_DIAMETER_M, &keys::BORE_M, why);
    cushion::check(rig, findings);
}

/// The dimensions of a cylinder, SI.
#[derive(Clone, Copy, Debug)]
pub struct Actuator {
    /// L, m (C(14)).
    pub stroke: f64,
    /// A_1, m^2, the blind side.
    pub area_1: f64,
    /// A_2, m^2, the rod side.
    pub area_2: f64,
    /// A_R2, m^2: the rod, on which the surrounding air pushes.
    pub rod_area: f64,
    /// V_R1 and V_R2, m^3 (C(35), C(36)); any of a vented chamber.
    pub residual_volumes: [f64; 2],
    /// P_e, Pa.
    pub ambient_pressure: f64,
    /// The leakage past the piston.
    pub leakage: Leakage,
    /// With which the air exchanges heat; None where the chambers are adiabatic.
    pub walls: Option<Walls>,
    /// Of a single-acting cylinder.
    pub vent: Option<Vent>,
}

/// Air that leaks past the piston.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leak {
    /// kg/s from chamber 1 to chamber 2.
    pub flow: f64,
    /// Of the chamber that it comes from, K.
    pub temperature: f64,
}

impl Leak {
    /// The flows into the chambers and the temperature that they carry.
    #[inline(always)]
    pub fn entering(self) -> (Pair, Pair) {
        (Pair::new([-self.flow, self.flow]), Pair::splat(self.temperature))
    }
}

/// Part of a dead volume that is next to nothing.
const LEFT_OVER: f64 = 0.01;

const USED_UP: [&str; 2] = [
    "the piston has run into its stop and taken up all of actuator.residual_volume_1_m3: give more of it, a larger load.stop_stiffness_n_per_m, or a load that arrives more slowly",
    "the piston has run into its stop and taken up all of actuator.residual_volume_2_m3: give more of it, a larger load.stop_stiffness_n_per_m, or a load that arrives more slowly",
];

impl Actuator {
    /// Areas of a cylinder with a rod on one side; `rod_diameter` 0 for a rodless one. Lengths in m.
    #[must_use]
    pub fn areas(bore: f64, rod_diameter: f64) -> [f64; 3] {
        let rod = PI / 4.0 * rod_diameter * rod_diameter;
        let blind = PI / 4.0 * bore * bore;
        [blind, blind - rod, rod]
    }

    /// Volumes of chambers 1 and 2 at a position (m) and velocity (m/s).
    #[must_use]
    pub fn volumes(&self, position: f64, velocity: f64) -> [Volume; 2] {
        let both = self.both_volumes(position, velocity);
        [0, 1].map(|i| Volume { volume: both.volume.lane(i), rate: both.rate.lane(i) })
    }

    /// Both at once.
    #[inline(always)]
    pub(crate) fn both_volumes(&self, position: f64, velocity: f64) -> Volume<Pair> {
        let areas = Pair::new([self.area_1, self.area_2]);
        Volume {
            volume: areas * Pair::new([position, self.stroke - position]) + Pair::new(self.residual_volumes),
            rate: areas * Pair::new([velocity, -velocity]),
        }
    }

    /// The dead volume that a piston at a position (m) has taken up except for a hundredth, and the remedy. A stop
    /// that gives way that far lets it run through the end cover, and the pressure of no air at all is not a number.
    pub(crate) fn used_up(&self, position: f64) -> Option<&'static str> {
        let volumes = self.both_volumes(position, 0.0).volume.to_array();
        let chamber = (0..2).find(|&i| volumes[i] < LEFT_OVER * self.residual_volumes[i])?;
        Some(USED_UP[chamber])
    }

    /// F_a, N, for the chamber pressures in Pa.
    #[must_use]
    pub fn force(&self, pressure_1: f64, pressure_2: f64) -> f64 {
        pressure_1 * self.area_1 - pressure_2 * self.area_2 - self.ambient_pressure * self.rod_area
    }

    /// F_a', N/s, for the rates of the chamber pressures in Pa/s.
    #[must_use]
    pub(crate) fn force_rate(&self, pressure_rate_1: f64, pressure_rate_2: f64) -> f64 {
        pressure_rate_1 * self.area_1 - pressure_rate_2 * self.area_2
    }

    /// The leakage past the piston between the two chambers.
    #[inline(always)]
    pub(crate) fn leak(&self, gas: &Gas, air: &ChamberAir<Pair>) -> Leak {
        let from = leakage::source(air);
        Leak { flow: self.leakage.flow(gas, air), temperature: air.temperature.lane(from) }
    }

    /// The contribution of the walls to w' of the air in both chambers, with the piston at a position (m).
    #[inline(always)]
    pub(crate) fn exner_rate_of_heat(
        &self,
        gas: &Gas,
        position: f64,
        volumes: Pair,
        air: &ChamberAir<Pair>,
    ) -> Option<Pair> {
        let lengths = Pair::new([position, self.stroke - position]);
        self.walls.as_ref().map(|walls| walls.exner_rate(gas, lengths, volumes, air))
    }

    /// The largest force in the direction of `sign` (1: extension, -1: retraction), N: one chamber under `supply` Pa, the other
    /// open to the surroundings.
    #[must_use]
    pub(crate) fn largest_force(&self, supply: f64, sign: f64) -> f64 {
        let (outside, [one, two]) = (self.ambient_pressure, self.highest_pressures(supply));
        if sign < 0.0 { -self.force(outside, two) } else { self.force(one, outside) }
    }

    /// The highest pressures in chambers 1 and 2 under a `supply`, Pa.
    #[must_use]
    pub(crate) fn highest_pressures(&self, supply: f64) -> [f64; 2] {
        [0, 1].map(|i| if self.is_vented(i) { self.ambient_pressure } else { supply })
    }

    /// Whether chamber `i`, 0 or 1, is open to the surroundings.
    #[must_use]
    pub fn is_vented(&self, i: usize) -> bool {
        self.vent.is_some_and(|vent| vent.chamber == i)
    }

    /// P_2 at which the cylinder delivers `force` N with `pressure_1`.
    #[must_use]
    pub(crate) fn balancing_pressure_2(&self, pressure_1: f64, force: f64) -> f64 {
        (pressure_1 * self.area_1 - self.ambient_pressure * self.rod_area - force) / self.area_2
    }

    /// P_1 at which the cylinder delivers `force` N against `pressure_2`.
    #[must_use]
    pub(crate) fn balancing_pressure_1(&self, pressure_2: f64, force: f64) -> f64 {
        (force + pressure_2 * self.area_2 + self.ambient_pressure * self.rod_area) / self.area_1
    }
}

#[cfg(test)]
mod charging;

#[cfg(test)]
mod tests {
    use super::*;

    fn thesis() -> Actuator {
        let [area_1, area_2, rod_area] = Actuator::areas(0.05, 0.025);
        Actuator {
            stroke: 0.3,
            area_1,
            area_2,
            rod_area,
            residual_volumes: [2e-5; 2],
            ambient_pressure: 101_300.0,
            leakage: Leakage::None,
            walls: None,
            vent: None,
        }
    }

    #[test]
    fn the_starting_pressures_of_the_reference_are_in_equilibrium() {
        assert!((thesis().balancing_pressure_1(400e3, 0.0) - 325_325.0).abs() < 1e-6);
        assert!(thesis().force(325_325.0, 400e3).abs() < 1e-9);
    }

    /// 6.15 and 6.16 in pressure and temperature, as derived in EQUATIONS section 5 without leakage.
    #[test]
    fn the_states_change_as_the_thesis_says_in_pressure_and_temperature() {
        let gas = Gas::new(1.4, 286.76);
        let volume = Volume { volume: 2e-4, rate: 1e-4 };
        let (p, t, flow, carried) = (3e5, 300.0, 2e-3, 280.0);
        let [mass, exner] = ChamberAir::state_of(&gas, p, t, volume.volume);
        let air = ChamberAir::of_state(&gas, mass, exner, volume.volume);
        let [mass_rate, exner_rate] = air.derivative(&gas, volume, [(flow, carried), (0.0, t), (0.0, t)]);

        let energy = 1.4 * 286.76 * carried * flow;
        let p_rate = (energy - 1.4 * p * volume.rate) / volume.volume;
        let t_rate = t / (p * volume.volume) * (energy - 286.76 * flow * t - 0.4 * p * volume.rate);
        assert!((exner_rate / exner - 0.4 / 1.4 * p_rate / p).abs() < 1e-12);
        let t_rate_of_states = t * (p_rate / p + volume.rate / volume.volume - mass_rate / mass);
        assert!((t_rate_of_states - t_rate).abs() < 1e-9 * t_rate.abs());
    }

    #[test]
    fn a_chamber_with_shut_ports_keeps_w_v_to_the_n_minus_1() {
        let gas = Gas::new(1.4, 286.76);
        let air = ChamberAir::of_state(&gas, 1e-3, 36.0, 3e-4);
        let volume = Volume { volume: 3e-4, rate: 1e-4 };
        let [mass_rate, exner_rate] = air.derivative(&gas, volume, [(0.0, 294.0); 3]);
        assert_eq!(mass_rate, 0.0);
        assert!((exner_rate / 36.0 + 0.4 * volume.rate / volume.volume).abs() < 1e-15);
    }
}
