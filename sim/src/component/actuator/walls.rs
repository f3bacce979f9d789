//! Heat exchange between the air of the chambers and their walls, by Newton's law of cooling.
//!
//! ```text
//! Q_i  = h A_wi (T_w - T_i)                                 W, into the air of chamber i
//! A_wi = 2 A_i + pi (D + d_i) L_i,   L_1 = y, L_2 = L - y   both faces, barrel and rod
//! ```
//!
//! [`crate::component::air`] has its effect on the air. The thesis has adiabatic chambers, h = 0. The coefficient h is constant and
//! the walls keep their temperature T_w; dead volumes and tubes have no wall of their own.

use std::f64::consts::PI;

use crate::component::air::ChamberAir;
use crate::component::gas::Gas;
use crate::key::keys;
use crate::number::Pair;
use crate::values::Rig;

keys! {
    HEAT_TRANSFER_W_PER_M2_K: f64 = number("actuator.heat_transfer_w_per_m2_k", 0.0, 0.0, 1e5, "", "Heat transfer of the chambers' walls; 0: adiabatic, as in the thesis.");
    WALL_TEMPERATURE_K: f64 = number("actuator.wall_temperature_k", 294.0, 150.0, 600.0, "", "Temperature of the chambers' walls.");
}

impl Walls {
    /// The walls of a rig around pistons of these areas (m^2), a bore and rods of these diameters (m).
    pub(super) fn of(rig: &Rig, areas: [f64; 2], bore: f64, rods: [f64; 2]) -> Option<Walls> {
        let coefficient = rig.get(&keys::HEAT_TRANSFER_W_PER_M2_K);
        let temperature = rig.get(&keys::WALL_TEMPERATURE_K);
        (coefficient > 0.0).then(|| Walls::new(coefficient, temperature, areas, bore, rods))
    }
}

/// The walls of both chambers, SI.
#[derive(Clone, Copy, Debug)]
pub struct Walls {
    /// h, W/(m^2 K), above 0.
    coefficient: f64,
    /// T_w, K.
    temperature: f64,
    /// A_wi of a chamber of no length, m^2.
    faces: [f64; 2],
    /// pi (D + d_i), m.
    girths: [f64; 2],
}

impl Walls {
    /// Walls of a temperature (K) with a coefficient of heat transfer (W/(m^2 K)), around chambers of these areas
    /// (m^2), with a bore and the diameters of the rods in them (m).
    #[must_use]
    pub fn new(coefficient: f64, temperature: f64, areas: [f64; 2], bore: f64, rods: [f64; 2]) -> Walls {
        let [faces, girths] = [areas.map(|area| 2.0 * area), rods.map(|rod| PI * (bore + rod))];
        Walls { coefficient, temperature, faces, girths }
    }

    /// Q of chambers of these lengths (m) for air of these temperatures (K), W.
    #[inline(always)]
    pub(crate) fn heat(&self, lengths: Pair, temperatures: Pair) -> Pair {
        let areas = Pair::new(self.faces) + Pair::new(self.girths) * lengths;
        Pair::splat(self.coefficient) * areas * (Pair::splat(self.temperature) - temperatures)
    }

    /// The contribution of the heat to w'.
    #[inline(always)]
    pub(crate) fn exner_rate(&self, gas: &Gas, lengths: Pair, volumes: Pair, air: &ChamberAir<Pair>) -> Pair {
        air.exner_rate_of_heat(gas, volumes, self.heat(lengths, air.temperature))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::air::Volume;
    use crate::number::Number;

    const GAS_CONSTANT: f64 = 286.76;

    fn gas() -> Gas {
        Gas::new(1.4, GAS_CONSTANT)
    }

    fn walls() -> Walls {
        let area = PI / 4.0 * 0.05 * 0.05;
        Walls::new(80.0, 294.0, [area, area - PI / 4.0 * 0.02 * 0.02], 0.05, [0.0, 0.02])
    }

    fn air(temperature: f64, volume: f64) -> ChamberAir {
        let [mass, exner] = ChamberAir::state_of(&gas(), 5e5, temperature, volume);
        ChamberAir::of_state(&gas(), mass, exner, volume)
    }

    fn both(one: ChamberAir, two: ChamberAir) -> ChamberAir<Pair> {
        let pair = |of: fn(&ChamberAir) -> f64| Pair::new([of(&one), of(&two)]);
        ChamberAir {
            mass: pair(|air| air.mass),
            exner: pair(|air| air.exner),
            pressure: pair(|air| air.pressure),
            temperature: pair(|air| air.temperature),
        }
    }

    #[test]
    fn the_area_is_that_of_a_cylinder_with_two_faces_and_a_rod() {
        let heat = walls().heat(Pair::new([0.1, 0.2]), Pair::splat(293.0));
        let face = PI / 4.0 * 0.05 * 0.05;
        let with_rod = 2.0 * (face - PI / 4.0 * 0.02 * 0.02) + PI * 0.07 * 0.2;
        assert!((heat.lane(0) - 80.0 * (2.0 * face + PI * 0.05 * 0.1)).abs() < 1e-12);
        assert!((heat.lane(1) - 80.0 * with_rod).abs() < 1e-12);
    }

    /// In a closed volume m c_v T' = h A_w (T_w - T), which decays with the time constant m c_v / (h A_w).
    #[test]
    fn the_temperature_of_a_closed_volume_decays_to_that_of_its_walls() {
        let (gas, walls, volume, lengths) = (gas(), walls(), [2e-4, 3e-4], Pair::new([0.1, 0.2]));
        let start = both(air(340.0, volume[0]), air(250.0, volume[1]));
        let volumes = Pair::new(volume);
        let rate = |w: Pair| {
            walls.exner_rate(&gas, lengths, volumes, &ChamberAir::of_state(&gas, start.mass, w, volumes))
        };
        let (steps, seconds) = (2000, 2.0);
        let h = Pair::splat(seconds / f64::from(steps));
        let half = Pair::splat(0.5);
        let mut w = start.exner;
        for _ in 0..steps {
            let k1 = rate(w);
            let k2 = rate(w + half * h * k1);
            let k3 = rate(w + half * h * k2);
            let k4 = rate(w + h * k3);
            w += h * Pair::splat(1.0 / 6.0) * (k1 + Pair::splat(2.0) * (k2 + k3) + k4);
        }
        let end = ChamberAir::of_state(&gas, start.mass, w, volumes);
        for i in 0..2 {
            let heat_capacity = start.mass.lane(i) * GAS_CONSTANT / 0.4;
            let per_kelvin = walls.heat(lengths, Pair::splat(293.0)).lane(i);
            let off = start.temperature.lane(i) - 294.0;
            let closed = 294.0 + off * (-per_kelvin * seconds / heat_capacity).exp();
            assert!(off.abs() > 30.0 && (end.temperature.lane(i) - closed).abs() < 1e-9, "{i}");
        }
    }

    #[test]
    fn the_energy_of_the_air_grows_by_enthalpy_work_and_heat() {
        let (gas, walls, volume, lengths) = (gas(), walls(), [2e-4, 3e-4], Pair::new([0.1, 0.2]));
        let air = both(air(310.0, volume[0]), air(270.0, volume[1]));
        let growing = Volume { volume: Pair::new(volume), rate: Pair::new([3e-4, -2e-4]) };
        let (flow, carried) = (Pair::new([2e-3, -1e-3]), Pair::new([300.0, 270.0]));
        let none = (Pair::ZERO, Pair::ZERO);
        let [_, adiabatic] = air.derivative(&gas, growing, [(flow, carried), none, none]);
        let rate = adiabatic + walls.exner_rate(&gas, lengths, growing.volume, &air);
        for (i, v) in volume.into_iter().enumerate() {
            let p = air.pressure.lane(i);
            let p_rate = gas.pressure_rate(air.exner.lane(i), rate.lane(i));
            let energy_rate = (p_rate * v + p * growing.rate.lane(i)) / 0.4;
            let enthalpy = 3.5 * GAS_CONSTANT * flow.lane(i) * carried.lane(i);
            let heat = walls.heat(lengths, air.temperature).lane(i);
            let balance = enthalpy - p * growing.rate.lane(i) + heat;
            assert!(heat.abs() > 10.0 && (energy_rate - balance).abs() < 1e-9 * enthalpy.abs(), "{i}");
        }
    }
}
