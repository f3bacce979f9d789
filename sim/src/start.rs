//! The state in which a test begins.

use crate::component::actuator::spring::{self, ReturnSpring};
use crate::component::actuator::vent::{self, Vent, VentedKind};
use crate::component::actuator::{self, Actuator};
use crate::component::load::{self, Load};
use crate::component::{exhaust, friction, supply};
use crate::key::Key;
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
        let mut start = Start {
            position: rig.get(&test::POSITION_M),
            pressures: [pressure_1, rig.get(&test::PRESSURE_2_PA)],
            temperatures: [rig.get(&test::TEMPERATURE_1_K), rig.get(&test::TEMPERATURE_2_K)],
        };
        if let Some(Vent { chamber, pressure, temperature }) = Vent::of(rig) {
            (start.pressures[chamber], start.temperatures[chamber]) = (pressure, temperature);
        }
        start
    }
}

/// P_1 at which the load of a rig is in equilibrium at the start of its test, Pa.
fn equilibrium_pressure_1(rig: &Rig) -> f64 {
    let standing = Load::of(rig).standing_force(rig.get(&test::POSITION_M));
    let pressure_2 = Vent::of(rig).map_or_else(|| rig.get(&test::PRESSURE_2_PA), |vent| vent.pressure);
    Actuator::of(rig).balancing_pressure_1(pressure_2, -standing)
}

/// The same of P_2 beside a chamber 1 that is vented.
pub(crate) fn equilibrium_pressure_2(rig: &Rig) -> f64 {
    let standing = Load::of(rig).standing_force(rig.get(&test::POSITION_M));
    Actuator::of(rig).balancing_pressure_2(rig.get(&exhaust::keys::PRESSURE_PA), -standing)
}

/// Pressure of the receiver of the supply, Pa.
pub(crate) fn receiver_pressure(rig: &Rig) -> f64 {
    rig.get(&test::RECEIVER_PRESSURE_PA).unwrap_or_else(|| rig.get(&supply::keys::PRESSURE_PA))
}

/// The constraints on the start of a test.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    check_receiver(rig, findings);
    let why = "the test starts within the stroke";
    findings.not_above(rig, &test::POSITION_M, &actuator::keys::STROKE_M, why);
    let retracts = rig.get(&vent::keys::VENTED) == VentedKind::Chamber1;
    let given =
        if retracts { rig.is_set(&test::PRESSURE_2_PA) } else { rig.get(&test::PRESSURE_1_PA).is_some() };
    if given {
        return;
    }
    if let Some((key, message)) = beyond_the_supply(rig) {
        findings.note(key, message);
        return;
    }
    // A vented chamber 1 leaves P_2 to be found, and the supply can hold the load.
    let balanced = equilibrium_pressure_1(rig);
    if !retracts && !(1e4..=5e6).contains(&balanced) {
        let message = format!(
            "no pressure in chamber 1 balances it at the start (it would be {balanced:.0} Pa); give test.pressure_1_pa"
        );
        findings.note(&test::PRESSURE_2_PA, message);
    }
}

/// Air flows out of the receiver.
fn check_receiver(rig: &Rig, findings: &mut Findings) {
    let (outside, key) = (&exhaust::keys::PRESSURE_PA, &test::RECEIVER_PRESSURE_PA);
    if !rig.is_set(key) || !rig.uses(key) {
        return;
    }
    let (least, pressure) = (rig.get(outside), receiver_pressure(rig));
    if pressure < least {
        findings.note(key, format!("must not be below {} = {least}, is {pressure}", outside.path));
    }
}

/// If no pressures between exhaust and supply can hold the load: the key of the largest force, and the remedy.
fn beyond_the_supply(rig: &Rig) -> Option<(&'static Key, String)> {
    let (load, position) = (Load::of(rig), rig.get(&test::POSITION_M));
    let standing = load.standing_force(position);
    let sticks =
        if standing < 0.0 { &friction::keys::STATIC_RETRACT_N } else { &friction::keys::STATIC_EXTEND_N };
    let supply = rig.get(&supply::keys::PRESSURE_PA);
    let air = Actuator::of(rig).largest_force(supply, -standing.signum()).max(0.0);
    if standing.abs() <= air + rig.get(sticks) {
        return None;
    }
    let message = format!(
        "the supply cannot hold the load at the start: it pulls with {:.0} N, and the cylinder holds {air:.0} N at most; take less load, more supply or a larger bore, or give {} where it rests on a stop",
        standing.abs(),
        if rig.get(&vent::keys::VENTED) == VentedKind::Chamber1 {
            "test.pressure_2_pa"
        } else {
            "test.pressure_1_pa"
        },
    );
    Some((pulls_most(rig, &load), message))
}

/// The key of the largest of the forces on a load at rest.
fn pulls_most(rig: &Rig, load: &Load) -> &'static Key {
    let (position, inside) = (rig.get(&test::POSITION_M), ReturnSpring::of(rig));
    let parts: [(&'static Key, f64); 4] = [
        (&load::keys::MASS_KG, -load.weight()),
        (&load::keys::CONSTANT_FORCE_N, rig.get(&load::keys::CONSTANT_FORCE_N)),
        (&load::keys::SPRING_N_PER_M, -rig.get(&load::keys::SPRING_N_PER_M) * position),
        (&spring::keys::RETURN_SPRING_PRELOAD_N, inside.force(position)),
    ];
    let direction = load.standing_force(position).signum();
    let [first, others @ ..] = parts;
    others
        .into_iter()
        .fold(first, |most, part| if direction * part.1 > direction * most.1 { part } else { most })
        .0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(settings: &[&str]) -> String {
        let settings: Vec<String> = settings.iter().map(|text| (*text).to_owned()).collect();
        let problems = Rig::read_with("servo-b", "", &settings).expect_err("it cannot be held");
        problems.to_string()
    }

    /// Its supply holds 958 N that push it in and 718 N that pull it out, its friction 40 and 70 N more.
    #[test]
    fn a_load_that_the_supply_cannot_hold_is_named_by_what_pulls_most() {
        for (settings, key) in [
            (&["load.incline_deg=90", "load.mass_kg=400"][..], "load.mass_kg"),
            (&["load.incline_deg=-30", "load.mass_kg=250"], "load.mass_kg"),
            (&["load.constant_force_n=1200", "load.incline_deg=90"], "load.constant_force_n"),
            (&["load.constant_force_n=-1200", "load.incline_deg=-90"], "load.constant_force_n"),
            (&["load.spring_n_per_m=30e3", "load.incline_deg=10"], "load.spring_n_per_m"),
            (
                &["actuator.return_spring=retract", "actuator.return_spring_preload_n=1500"],
                "actuator.return_spring_preload_n",
            ),
            (
                &["actuator.return_spring=extend", "actuator.return_spring_stiffness_n_per_m=9e3"],
                "actuator.return_spring_preload_n",
            ),
        ] {
            let refusal = refusal(settings);
            assert!(refusal.contains(&format!("{key}: the supply cannot hold the load")), "{refusal}");
        }
    }

    #[test]
    fn a_load_that_chamber_1_cannot_balance_at_the_pressure_of_chamber_2_is_named_by_that() {
        let refusal = refusal(&["load.constant_force_n=700", "test.pressure_2_pa=50e3"]);
        assert!(refusal.contains("test.pressure_2_pa: no pressure in chamber 1 balances it"), "{refusal}");
    }

    #[test]
    fn a_load_that_rests_on_a_stop_starts_at_the_pressure_that_it_is_given() {
        let settings = ["load.incline_deg=90", "load.mass_kg=400", "test.pressure_1_pa=300e3"];
        assert!(Rig::read_with("servo-b", "", &settings.map(str::to_owned)).is_ok());
    }
}
