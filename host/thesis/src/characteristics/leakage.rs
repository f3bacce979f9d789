//! Leakage past the piston on a bench (8.3.3, Fig. 8.8): one chamber is fed and the other is open to the
//! surroundings. The flow out of it has passed the seal.

use super::points::{evenly, over};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_sim::Rig;
use pneudrive_sim::component::actuator::Actuator;
use pneudrive_sim::component::actuator::leakage::Leakage;
use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str =
    "leakage past the piston over the pressure of the fed chamber (8.3.3, Fig. 8.8)";

/// Litres a minute, at 20 degrees Celsius, 100 kPa and 65 % relative humidity (ANR, ISO 8778), in a kg/s.
const LITRES_A_MINUTE: f64 = 60.0 / 1.185e-3;

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let actuator = Actuator::of(rig);
    if actuator.leakage == Leakage::None {
        return Err(Unfit::NoPart("its piston does not leak: actuator.leakage is \"none\""));
    }
    let gas = Gas::of(rig);
    let [supply, exhaust] = [&keys::supply::PRESSURE_PA, &keys::exhaust::PRESSURE_PA].map(|key| rig.get(key));
    let temperature = rig.get(&keys::supply::TEMPERATURE_K);
    let flow = |fed: f64| actuator.leakage.at_pressures(&gas, [fed, exhaust], temperature);
    let pressures = evenly(exhaust / 1e3, supply / 1e3, 200);
    let series = over("past the piston", &pressures, |fed| 1e3 * flow(1e3 * fed));
    let at_supply = format!("with {:.0} kPa in the fed chamber", supply / 1e3);
    Ok(Characteristic {
        notes: vec![
            "Chamber 1 is fed, chamber 2 is open to the surroundings; its flow meter shows what passes the piston. Litres are at 20 \u{b0}C, 100 kPa and 65 % relative humidity (ANR, ISO 8778).".to_owned(),
        ],
        across: "fed chamber, kPa",
        graphs: vec![Graph { title: "leakage, g/s", series: vec![series] }],
        figures: vec![
            Figure::computed(format!("leakage {at_supply}"), 1e3 * flow(supply), "g/s"),
            Figure::computed(format!("leakage {at_supply}"), LITRES_A_MINUTE * flow(supply), "l/min (ANR)"),
        ],
        ..Characteristic::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    #[test]
    fn a_laminar_leak_is_its_coefficient_times_the_difference() {
        let leaks = rig(&["actuator.leakage=\"laminar\"", "actuator.leakage_coefficient=2e-9"]);
        let found = measure(&leaks).expect("it leaks");
        let by_hand = 1e3 * 2e-9 * (589e3 - 101.3e3);
        assert!((found.figures[0].value().expect("a figure") - by_hand).abs() < 1e-12);
        assert_eq!(found.graphs[0].series[0].y[0], 0.0, "nothing flows without a difference");
    }

    #[test]
    fn a_piston_that_is_tight_says_so() {
        assert!(matches!(measure(&rig(&["actuator.leakage=\"none\""])), Err(Unfit::NoPart(_))));
    }
}
