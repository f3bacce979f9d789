//! Force of the flow on the spool (6.4.4) over the spool, by supply pressure.
//!
//! Both ports have a pressure half-way between supply and exhaust. So air goes into one and out of the other, as in a
//! moving cylinder.

use super::bench::ValveBench;
use super::points::{evenly, over, supplies};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_sim::Rig;
use pneudrive_sim::component::valve::flow_force::{FlowForce, NodeFlows, Source, ValveFlows, path_area};
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "force of the flow on the spool over the spool, by supply pressure (6.4.4)";

/// F_ind, N, with the spool at a place (m) and the pressures (Pa) of the supply and of both ports: positive closes a spool
/// that is open to positive x.
#[must_use]
pub fn force(rig: &Rig, spool: f64, supply_pa: f64, port_pa: f64) -> f64 {
    let mut bench = ValveBench::new(rig, supply_pa);
    let nodes = bench.nodes(spool, [port_pa; 2]);
    let (gas, valve) = (&bench.gas, &bench.valve);
    let source = |pressure, temperature| Source { pressure, temperature: rig.get(temperature) };
    let flows = ValveFlows {
        supply: source(supply_pa, &keys::supply::TEMPERATURE_K),
        exhaust: source(rig.get(&keys::exhaust::PRESSURE_PA), &keys::exhaust::TEMPERATURE_K),
        nodes: nodes.map(|node| NodeFlows {
            supply: node.supply_flow,
            exhaust: node.exhaust_flow,
            pressure: gas.pressure(node.exner),
            port_pressure: port_pa,
        }),
        land_areas: valve.land_areas(spool),
        path_area: path_area(valve.spool_diameter, valve.rod_diameter),
        opening: (spool - valve.null_offset) / valve.travel,
    };
    FlowForce::of(rig).force(gas, &flows)
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if FlowForce::of(rig) == FlowForce::None {
        return Err(Unfit::NoPart("its flow does not push the spool: valve.flow_force is \"none\""));
    }
    let travel = rig.get(&keys::valve::SPOOL_TRAVEL_MM);
    let exhaust = rig.get(&keys::exhaust::PRESSURE_PA);
    let at = |spool_mm: f64, supply: f64| force(rig, spool_mm * 1e-3, supply, (exhaust + supply) / 2.0);
    let curve = |&supply: &f64| {
        over(&format!("Ps = {:.1} kPa", supply / 1e3), &evenly(-travel, travel, 160), |spool| {
            at(spool, supply)
        })
    };
    let supplies = supplies(rig);
    let wide_open = |&supply: &f64| {
        let name = format!("force wide open, Ps = {:.1} kPa", supply / 1e3);
        Figure::computed(name, at(travel, supply), "N")
    };
    Ok(Characteristic {
        notes: vec![
            "Positive forces push the spool towards negative positions, so that they close a spool that is open to positive ones. Both ports are half-way between supply and exhaust.".to_owned(),
        ],
        across: "spool, mm",
        graphs: vec![Graph { title: "force of the flow, N", series: supplies.iter().map(curve).collect() }],
        figures: supplies.iter().map(wide_open).collect(),
        ..Characteristic::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    #[test]
    fn the_force_closes_the_valve_on_either_side_of_its_null() {
        for model in ["analytical", "experimental"] {
            let rig = rig(&[&format!("valve.flow_force=\"{model}\"")]);
            for spool in [0.1e-3, 0.5e-3, 1e-3] {
                let [open, other] = [spool, -spool].map(|spool| force(&rig, spool, 589e3, 345e3));
                assert!(open > 0.0 && other < 0.0, "{model}: {open} and {other} N at {spool} m");
                assert!((open + other).abs() < 1e-6 * open, "{model}: the valve is symmetric");
            }
        }
    }

    #[test]
    fn a_spool_that_no_flow_pushes_says_so() {
        assert!(matches!(measure(&rig(&[])), Err(Unfit::NoPart(_))));
    }
}
