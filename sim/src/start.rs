//! The state in which a test begins.

use crate::component::actuator::{self, Actuator};
use crate::component::load::Load;
use crate::schedule::keys as test;
use crate::values::{Findings, Rig};

/// Position (m), and pressures (Pa) and temperatures (K) of the chambers, at the start of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    pub position: f64,
    pub pressures: [f64; 2],
    pub temperatures: [f64; 2],
}

impl Start {
    /// The start of a rig's test.
    pub fn of(rig: &Rig) -> Start {
        let pressure_1 = rig.get(&test::PRESSURE_1_PA).unwrap_or_else(|| equilibrium_pressure_1(rig));
        Start {
            position: rig.get(&test::POSITION_M),
            pressures: [pressure_1, rig.get(&test::PRESSURE_2_PA)],
            temperatures: [rig.get(&test::TEMPERATURE_1_K), rig.get(&test::TEMPERATURE_2_K)],
        }
    }
}

/// P_1 at which the load of a rig is in equilibrium at the start of its test, Pa.
fn equilibrium_pressure_1(rig: &Rig) -> f64 {
    let standing = Load::of(rig).standing_force(rig.get(&test::POSITION_M));
    Actuator::of(rig).balancing_pressure_1(rig.get(&test::PRESSURE_2_PA), -standing)
}

/// What the start of a test must hold.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let why = "the test starts within the stroke";
    findings.not_above(rig, &test::POSITION_M, &actuator::keys::STROKE_M, why);
    if rig.get(&test::TARGETS).is_some() && rig.is_set(&test::MOVES) {
        findings.note(&test::TARGETS, "give either targets or moves, not both");
    }
    let balanced = equilibrium_pressure_1(rig);
    if rig.get(&test::PRESSURE_1_PA).is_none() && !(1e4..=5e6).contains(&balanced) {
        let message = format!(
            "no pressure in chamber 1 balances it at the start (it would be {balanced:.0} Pa); give test.pressure_1_pa"
        );
        findings.note(&test::PRESSURE_2_PA, message);
    }
}
