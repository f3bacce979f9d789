//! Pressure drop in the tubing (7.1.4, 6.61 to 6.65): the pressure at the far end of a tube over its flow.
//!
//! Positive flows go away from the end with the known pressure. For negative flows the far end has the higher pressure.

use super::points::{evenly, over};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_sim::Rig;
use pneudrive_sim::component::air::GasState;
use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::component::tubing::tubes;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "pressure behind a tube over its flow (7.1.4)";

/// The pressure at the far end of a rig's cylinder tube over that at its known end, for a flow (kg/s) away from it.
#[must_use]
pub fn ratio(rig: &Rig, known_pa: f64, flow: f64) -> f64 {
    let gas = Gas::of(rig);
    let known = GasState { exner: gas.exner(known_pa), temperature: rig.get(&keys::supply::TEMPERATURE_K) };
    let (_, tube) = tubes(rig, &gas);
    gas.pressure(tube.far_exner(&known, flow)) / known_pa
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if tubes(rig, &Gas::of(rig)).1.is_none() {
        return Err(Unfit::NoPart("it has no tubes: tubing.model is \"none\""));
    }
    let supply = rig.get(&keys::supply::PRESSURE_PA);
    let reference = rig.get(&keys::tubing::REFERENCE_FLOW_KG_S);
    let curve = |part: f64| {
        let known = part * supply;
        let flows = evenly(-reference * 1e3, reference * 2e3, 150);
        over(&format!("{:.0} kPa at the known end", known / 1e3), &flows, |flow| {
            ratio(rig, known, flow * 1e-3)
        })
    };
    Ok(Characteristic {
        notes: vec!["Flows away from the end whose pressure is known are positive.".to_owned()],
        across: "flow, g/s",
        graphs: vec![Graph { title: "pressure ratio", series: [1.0, 0.75, 0.5].map(curve).into() }],
        figures: vec![Figure::computed(
            format!("ratio at {:.2} g/s from the supply", 1e3 * reference),
            ratio(rig, supply, reference),
            "",
        )],
        ..Characteristic::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    /// C(28), C(30): 40 % at 4.65 g/s; reading R1 of EQUATIONS section 4 is its own reciprocal.
    #[test]
    fn the_regression_line_loses_0_4_at_its_reference_flow_and_gains_it_backwards() {
        let tube = rig(&[]);
        assert!((ratio(&tube, 589e3, 0.00465) - 0.6).abs() < 1e-12);
        assert!((ratio(&tube, 200e3, -0.00465) * 0.6 - 1.0).abs() < 1e-12);
        assert!((ratio(&tube, 589e3, 0.0) - 1.0).abs() < 1e-14);
    }

    /// EQUATIONS section 4: Fanno with L = 1 m, f = 0.005 and 317 kPa gives 0.552 at the reference flow, where the air
    /// at the inlet has a static temperature of 294 K: M is 0.286 there, and the supply 298.8 K.
    #[test]
    fn a_pipe_of_a_metre_loses_0_448() {
        let pipe = rig(&["tubing.model=\"analytical\"", "supply.temperature_k=298.825"]);
        assert!((ratio(&pipe, 317e3, 0.00465) - 0.552).abs() < 5e-4, "{}", ratio(&pipe, 317e3, 0.00465));
    }

    #[test]
    fn a_rig_without_tubes_says_so() {
        let none = rig(&["tubing.model=\"none\"", "valve.upstream_mach=false"]);
        assert!(matches!(measure(&none), Err(Unfit::NoPart(_))));
    }
}
