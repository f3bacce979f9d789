//! A chamber that is open to the surroundings: the cylinder is single-acting, and the valve drives its other chamber alone.
//!
//! ```text
//! P_i = P_e,   T_i = T_e,   m_i' = P_e V_i'/(R T_e)        the vented chamber i
//! F_a = (P_1 - P_e) A_1   or   F_a = -(P_2 - P_e) A_2      of 6.25, chamber 2 or 1 vented
//! F_a + F = 0                                              rest without friction, F: all other forces along +y
//! ```
//!
//! P_e and T_e are those of the surroundings. The vent has no resistance, so that no motion compresses the air behind it, and the
//! air in it has their temperature: it comes from there, and goes back before walls or piston change it. What leaks past the
//! piston leaves by the vent. The valve's port of this chamber is plugged: its lands pass nothing, and the valve is one with two
//! paths (a 3/2-way valve where it switches). The thesis names single-acting cylinders (6.1) and has no equation of one; this is the
//! balance of [`crate::component::air`] for a chamber without walls to the surroundings.
//!
//! Air pushes one way only. Something else must push the piston back: a return spring ([`crate::component::actuator::spring`]), the
//! weight of the load, or its spring ([`crate::component::load::returning`]).

use crate::component::air::Volume;
use crate::component::exhaust;
use crate::component::gas::Gas;
use crate::key::{keys, words};
use crate::number::{Number, Pair};
use crate::values::Rig;

words! {
    /// The chamber that is open to the surroundings.
    pub enum VentedKind {
        /// Neither: the cylinder is double-acting.
        None = "none",
        /// Chamber 1: air retracts the piston.
        Chamber1 = "chamber-1",
        /// Chamber 2: air extends the piston.
        Chamber2 = "chamber-2",
    }
}

keys! {
    VENTED: VentedKind = choice("actuator.vented", "6.1", "The chamber that is open to the surroundings, in a single-acting cylinder; the valve's port of it is plugged.");
}

impl VentedKind {
    /// Index of the chamber, 0 or 1.
    #[must_use]
    pub fn chamber(self) -> Option<usize> {
        match self {
            VentedKind::None => None,
            VentedKind::Chamber1 => Some(0),
            VentedKind::Chamber2 => Some(1),
        }
    }
}

/// A chamber under the pressure of the surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vent {
    /// Index of the chamber, 0 or 1.
    pub chamber: usize,
    /// P_e, Pa.
    pub pressure: f64,
    /// T_e, K.
    pub temperature: f64,
}

impl Vent {
    /// The vent of a rig's cylinder.
    #[must_use]
    pub fn of(rig: &Rig) -> Option<Vent> {
        let of_chamber = |chamber| Vent {
            chamber,
            pressure: rig.get(&exhaust::keys::PRESSURE_PA),
            temperature: rig.get(&exhaust::keys::TEMPERATURE_K),
        };
        rig.get(&keys::VENTED).chamber().map(of_chamber)
    }

    /// Values of the chambers, with another one in the vented chamber.
    #[inline]
    pub(crate) fn with(&self, each: Pair, vented: f64) -> Pair {
        Pair::of(|i| if i == self.chamber { vented } else { each.lane(i) })
    }

    /// m' and w' of both chambers, with those of the vented one.
    #[inline]
    pub(crate) fn hold(&self, gas: &Gas, volumes: &Volume<Pair>, [masses, exners]: [Pair; 2]) -> [Pair; 2] {
        let density = self.pressure / (gas.gas_constant * self.temperature);
        [self.with(masses, density * volumes.rate.lane(self.chamber)), self.with(exners, 0.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::air::ChamberAir;

    const VENT: Vent = Vent { chamber: 1, pressure: 101_300.0, temperature: 290.0 };

    fn gas() -> Gas {
        Gas::new(1.4, 286.76)
    }

    #[test]
    fn the_air_of_a_vented_chamber_keeps_pressure_and_temperature_as_its_volume_changes() {
        let gas = gas();
        let [mass, exner] = ChamberAir::state_of(&gas, VENT.pressure, VENT.temperature, 3e-4);
        let volumes = Volume { volume: Pair::splat(3e-4), rate: Pair::new([2e-4, -2e-4]) };
        let [masses, exners] = VENT.hold(&gas, &volumes, [Pair::splat(7.0), Pair::splat(9.0)]);
        assert_eq!(
            [masses.lane(0), exners.lane(0), exners.lane(1)],
            [7.0, 9.0, 0.0],
            "chamber 1 is not vented"
        );
        for seconds in [0.1, 0.5, 1.0] {
            let volume = 3e-4 - 2e-4 * seconds;
            let air = ChamberAir::of_state(&gas, mass + masses.lane(1) * seconds, exner, volume);
            assert!((air.pressure / VENT.pressure - 1.0).abs() < 1e-12);
            assert!((air.temperature / VENT.temperature - 1.0).abs() < 1e-12);
        }
    }
}
