//! The temperature of the air in the tubes is that of its source (EQUATIONS section 12).

use super::tests::network_with;
use super::*;
use crate::component::valve::{Valve, thesis_valve};

const BORE: f64 = 0.004;

fn tubes(gas: &Gas) -> [(&'static str, Tube); 3] {
    [
        ("connector", Tube::connector(gas, 0.8, BORE)),
        ("narrow connector", Tube::connector(gas, 0.6, 0.002)),
        ("pipe", Tube::analytical(gas, 1.0, BORE, 0.005)),
    ]
}

fn station(gas: &Gas, pressure: f64, temperature: f64) -> GasState {
    GasState { exner: gas.exner(pressure), temperature }
}

/// The nodes, with port directions that match their flows.
fn settled(
    network: &mut Network,
    valve: &Valve,
    spool: f64,
    chambers: &[GasState; 2],
) -> ([Node; 2], [PortFlow; 2]) {
    let mut ports = [PortFlow::Charging; 2];
    for _ in 0..3 {
        let nodes = network.flows(valve, spool, chambers, &ports);
        ports = nodes.map(|node| match node.port_flow() >= 0.0 {
            true => PortFlow::Charging,
            false => PortFlow::Discharging,
        });
    }
    (network.flows(valve, spool, chambers, &ports), ports)
}

#[test]
fn a_choked_flow_into_a_chamber_does_not_depend_on_the_air_in_the_chamber() {
    let (gas, template) = network_with(false, false);
    for (name, tube) in tubes(&gas) {
        let flow = |pressure: f64, temperature: f64| {
            let mut network = Network { cylinder_tube: tube, ..template.clone() }.with_flow_error(1e-15);
            let chambers = [station(&gas, pressure, temperature), station(&gas, 300e3, 294.0)];
            settled(&mut network, &thesis_valve(), 1e-3, &chambers).0[0].port_flow()
        };
        let cold = flow(105e3, 250.0);
        for temperature in [294.0, 350.0] {
            let other = flow(105e3, temperature);
            assert!((other / cold - 1.0).abs() < 1e-9, "{name}, {temperature} K: {other} {cold}");
        }
        assert!(flow(450e3, 294.0) < 0.97 * cold, "{name}: a higher pressure counts");
    }
}

/// The air has the same temperature at any pressure, and air that leaves the chamber has the chamber's.
#[test]
fn air_that_leaves_a_chamber_has_its_temperature_all_the_way() {
    let (gas, template) = network_with(false, false);
    for (name, tube) in tubes(&gas) {
        let flow = |temperature: f64| {
            let mut network = Network { cylinder_tube: tube, ..template.clone() }.with_flow_error(1e-15);
            let chambers = [station(&gas, 580e3, temperature), station(&gas, 300e3, 294.0)];
            settled(&mut network, &Valve { spool_diameter: 10e-3, ..thesis_valve() }, -1e-3, &chambers).0[0]
                .port_flow()
        };
        let ratio = flow(350.0) / flow(294.0);
        assert!((ratio - (294.0_f64 / 350.0).sqrt()).abs() < 1e-9, "{name}: {ratio}");
    }
}

#[test]
fn newton_and_brackets_agree_whatever_the_temperatures() {
    let mut compared = 0;
    for approach in [false, true] {
        for has_node in [true, false] {
            let (gas, template) = network_with(false, approach);
            for (name, tube) in tubes(&gas) {
                for spool in [-0.9e-3, -1e-6, 1e-5, 0.3e-3] {
                    for (p1, p2) in [(110e3, 580e3), (325e3, 400e3), (588e3, 102e3), (650e3, 150e3)] {
                        let valve = Valve { has_node, ..thesis_valve() };
                        let chambers = [station(&gas, p1, 250.0), station(&gas, p2, 350.0)];
                        let mut newton =
                            Network { cylinder_tube: tube, ..template.clone() }.with_flow_error(1e-15);
                        let (_, ports) = settled(&mut newton, &valve, spool, &chambers);
                        let boundary = BoundaryConditions::new(
                            valve.conductances(&gas, spool),
                            GasState::both(&chambers),
                            &ports,
                        );
                        let mut brackets = newton.clone();
                        if !brackets.by_brackets(&boundary) {
                            continue;
                        }
                        compared += 1;
                        for (a, b) in newton.nodes.each().iter().zip(&brackets.nodes.each()) {
                            let what = format!("{name} {has_node} {approach} {spool} {p1} {p2}: {a:?} {b:?}");
                            assert!((a.supply_flow - b.supply_flow).abs() < 1e-9, "{what}");
                            assert!((a.exhaust_flow - b.exhaust_flow).abs() < 1e-9, "{what}");
                        }
                    }
                }
            }
        }
    }
    assert!(compared > 150, "{compared}");
}

/// All slopes are complete: near the solution each correction is about the square of the last.
#[test]
fn newton_converges_as_fast_with_tubes_that_feel_the_temperature() {
    let (gas, template) = network_with(false, true);
    for (name, tube) in tubes(&gas) {
        let mut network = Network { supply_tube: tube, cylinder_tube: tube, ..template.clone() };
        let at = |p1: f64| [station(&gas, p1, 250.0), station(&gas, 400e3, 350.0)];
        let ports = [PortFlow::Charging, PortFlow::Discharging];
        network.flows(&thesis_valve(), 0.2e-3, &at(325e3), &ports);
        network.work = NetworkWork::default();
        for step in 1..=100 {
            network.flows(&thesis_valve(), 0.2e-3, &at(325e3 + 50.0 * f64::from(step)), &ports);
        }
        assert_eq!(network.work.bracketed, 0, "{name}");
        assert!(network.work.iterations <= 3 * 100, "{name}: {:?}", network.work);
    }
}

/// A supply that dips below the chambers takes air back. Its tube carries the flow that the nodes give back, at their
/// temperature.
#[test]
fn air_that_goes_back_to_the_supply_is_as_warm_as_the_nodes_that_give_it() {
    let (gas, template) = network_with(false, false);
    for (name, tube) in tubes(&gas) {
        let flow = |supply_k: f64, chamber_k: f64| {
            let supply = station(&gas, 120e3, supply_k);
            let mut network =
                Network { supply_tube: tube, supply, ..template.clone() }.with_flow_error(1e-15);
            let chambers = [station(&gas, 580e3, chamber_k), station(&gas, 570e3, chamber_k)];
            let ([one, two], _) = settled(&mut network, &thesis_valve(), 0.0, &chambers);
            one.supply_flow + two.supply_flow
        };
        let back = flow(294.0, 294.0);
        assert!(back < 0.0, "{name}: {back}");
        assert!(
            (flow(250.0, 294.0) / back - 1.0).abs() < 1e-7,
            "{name}: the supply's own air does not count"
        );
        let ratio = flow(294.0, 350.0) / back;
        assert!((ratio - (294.0_f64 / 350.0).sqrt()).abs() < 1e-7, "{name}: {ratio}");
    }
}
