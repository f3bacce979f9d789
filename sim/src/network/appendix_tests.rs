//! The network's restrictions and nodes against the thesis's equations as printed, with EQUATIONS
//! sections 1 and 3 where those correct them.

use super::mixing::mean_of_inflows;
use super::restriction::EndState;
use super::*;
use crate::component::valve::{Valve, thesis_valve};

const N: f64 = 1.4;
const R: f64 = 286.76;

/// Gamma of V.13 towards a lower pressure: V.9, and V.11 below the critical ratio V.10.
fn gamma(p1: f64, t1: f64, m1: f64, p2: f64) -> f64 {
    let mach_term = (m1 * m1 * (N - 1.0) + 2.0) / (N + 1.0);
    let (ratio, critical) = (p2 / p1, mach_term.powf(N / (N - 1.0)));
    let sonic = mach_term.powf((N + 1.0) / (2.0 * (N - 1.0)));
    let subsonic =
        |r: f64| r.powf(1.0 / N) * (m1 * m1 + 2.0 / (N - 1.0) * (1.0 - r.powf((N - 1.0) / N))).sqrt();
    p1 / t1.sqrt() * if ratio <= critical { sonic } else { subsonic(ratio) }
}

/// An orifice of 6.39 to 6.46: Gamma from air at rest, negative for reverse flow.
fn orifice(area: f64, (p_a, t_a): (f64, f64), (p_b, t_b): (f64, f64)) -> f64 {
    let flux = if p_a >= p_b { gamma(p_a, t_a, 0.0, p_b) } else { -gamma(p_b, t_b, 0.0, p_a) };
    area * (N / R).sqrt() * flux
}

fn station(pressure: f64, temperature: f64) -> GasState {
    GasState { exner: Gas::new(N, R).exner(pressure), temperature }
}

fn network(approach: bool) -> Network {
    let laws = Laws::alike(FlowLaw::Orifice);
    let port_area = approach.then(|| thesis_valve().port_area());
    let (supply, exhaust) = (station(589e3, 294.0), station(101.3e3, 290.0));
    Network::new(Gas::new(N, R), supply, exhaust, Tube::none(), Tube::none(), laws, port_area)
}

/// Gamma of the network: one restriction with C_d A of 1, approached at a Mach number.
fn gamma_of_network(p1: f64, t1: f64, m1: f64, p2: f64) -> f64 {
    gamma_with(&network(true), p1, t1, m1, p2)
}

/// Gamma of a network with any C(54).
fn gamma_with(network: &Network, p1: f64, t1: f64, m1: f64, p2: f64) -> f64 {
    let gas = Gas::new(N, R);
    let flow = m1 * p1 / (network.mach * t1).sqrt();
    let up = station(p1, t1);
    let square = network.land(
        &FlowLaw::Orifice,
        gas.flow_constant(),
        &EndState::of(&up),
        &network.approach(&up, flow),
        &EndState::of(&station(p2, 300.0)),
    );
    square.value.abs().sqrt().copysign(square.value) * (R / N).sqrt()
}

/// V.9 to V.11, over pressure ratio and upstream Mach number.
#[test]
fn the_flow_function_is_that_of_appendix_v_at_any_pressure_ratio_and_upstream_mach_number() {
    for mach in (0..=18).map(|i| 0.05 * f64::from(i)) {
        for ratio in (1..=50).map(|i| 0.02 * f64::from(i)) {
            for (p1, t1) in [(589e3, 294.0), (150e3, 350.0)] {
                let expected = gamma(p1, t1, mach, ratio * p1);
                let got = gamma_of_network(p1, t1, mach, ratio * p1);
                let scale = gamma(p1, t1, mach, 0.0);
                // Near zero flow, the root of a pressure difference keeps half of the digits.
                let allowed = if expected < 1e-3 * scale { 1e-7 } else { 1e-11 };
                assert!((got - expected).abs() < allowed * scale, "M {mach}, r {ratio}: {got} {expected}");
            }
        }
    }
}

/// V.8 with M_2 of V.5 (EQUATIONS section 1) is V.9.
#[test]
fn the_flow_function_by_the_mach_number_in_the_throat_is_the_same() {
    for mach in [0.0_f64, 0.2, 0.5, 0.9] {
        for ratio in [0.6_f64, 0.8, 0.95] {
            let cooling = ratio.powf((N - 1.0) / N);
            let throat = ((mach * mach + 2.0 / (N - 1.0) * (1.0 - cooling)) / cooling).sqrt();
            if throat >= 1.0 {
                continue;
            }
            let fraction = (mach * mach * (N - 1.0) + 2.0) / (throat * throat * (N - 1.0) + 2.0);
            let by_throat = throat * fraction.powf((N + 1.0) / (2.0 * (N - 1.0)));
            let got = gamma_of_network(589e3, 294.0, mach, ratio * 589e3) * 294.0_f64.sqrt() / 589e3;
            assert!((got - by_throat).abs() < 1e-11, "M {mach}, r {ratio}: {got} {by_throat}");
        }
    }
}

/// EQUATIONS section 1: Gamma(P1, T1, M1, P2) = Gamma(P01, T01, 0, P2).
#[test]
fn air_that_approaches_flows_like_air_at_rest_at_its_stagnation_state() {
    for mach in (0..=9).map(|i| 0.1 * f64::from(i)) {
        for ratio in (1..50).map(|i| 0.02 * f64::from(i)) {
            let rise = 1.0 + 0.5 * (N - 1.0) * mach * mach;
            let (p0, t0) = (589e3 * rise.powf(N / (N - 1.0)), 294.0 * rise);
            let (moving, still) = (
                gamma_of_network(589e3, 294.0, mach, ratio * 589e3),
                gamma_of_network(p0, t0, 0.0, ratio * 589e3),
            );
            assert!((moving / still - 1.0).abs() < 1e-11, "M {mach}, r {ratio}: {moving} {still}");
        }
    }
}

/// 6.54: C(54) multiplies the Mach number; values above 1 count as 1.
#[test]
fn the_turbulence_coefficient_multiplies_the_upstream_mach_number() {
    for coefficient in [0.0, 0.3, 0.7, 1.0] {
        let turbulent = network(true).with_turbulence(coefficient);
        for (mach, counted) in [(0.2, 0.2), (0.5, 0.5), (0.9, 0.9), (1.4, 1.0)] {
            let got = gamma_with(&turbulent, 589e3, 294.0, mach, 300e3);
            let expected = gamma(589e3, 294.0, coefficient * counted, 300e3);
            assert!((got / expected - 1.0).abs() < 1e-11, "C(54) {coefficient}, M {mach}: {got} {expected}");
        }
    }
}

/// V.12, V.13: reverse flow is negative and follows from the state behind the restriction.
#[test]
fn reverse_flow_is_negative_and_takes_the_other_side_as_upstream() {
    for ratio in [0.1, 0.5, 0.9] {
        let got = gamma_of_network(ratio * 589e3, 250.0, 0.0, 589e3);
        let expected = -gamma(589e3, 300.0, 0.0, ratio * 589e3);
        assert!((got / expected - 1.0).abs() < 1e-11, "{ratio}: {got} {expected}");
    }
}

fn ports_of(network: &mut Network, valve: &Valve, chambers: &[GasState; 2], spool: f64) -> [Node; 2] {
    let conductances = valve.conductances(&Gas::new(N, R), spool);
    let mut ports = [PortFlow::Charging; 2];
    for _ in 0..2 {
        ports = network.solve(&conductances, chambers, &ports).map(|node| match node.port_flow() >= 0.0 {
            true => PortFlow::Charging,
            false => PortFlow::Discharging,
        });
    }
    network.solve(&conductances, chambers, &ports)
}

/// Spool positions and chamber pressures over the whole working range of the valve.
fn operating_points() -> impl Iterator<Item = (f64, [f64; 2])> {
    let spools = [-0.8e-3, -0.15e-3, 0.0, 0.05e-3, 0.5e-3];
    let chambers = [[110e3, 580e3], [325e3, 400e3], [560e3, 150e3]];
    spools.into_iter().flat_map(move |spool| chambers.into_iter().map(move |pair| (spool, pair)))
}

/// 6.39 to 6.46 without a node: each land is an orifice between its source and the chamber.
#[test]
fn a_single_restriction_has_the_conventional_flows_of_its_lands() {
    let valve = Valve { has_node: false, ..thesis_valve() };
    for (spool, pressures) in operating_points() {
        let chambers = pressures.map(|p| station(p, 310.0));
        let nodes = ports_of(&mut network(false), &valve, &chambers, spool);
        let areas = valve.land_areas(spool);
        for (i, node) in nodes.iter().enumerate() {
            let chamber = (pressures[i], 310.0);
            let supply = 0.8 * orifice(areas[i], (589e3, 294.0), chamber);
            let exhaust = 0.8 * orifice(areas[1 - i], (101.3e3, 290.0), chamber);
            assert!((node.supply_flow - supply).abs() < 1e-12, "{spool} {pressures:?}");
            assert!((node.exhaust_flow - exhaust).abs() < 1e-12, "{spool} {pressures:?}");
        }
    }
}

/// 6.47 to 6.51 with all Mach numbers zero: lands and port are the orifices of 6.39 to 6.46 between their stations,
/// and the flows into a node equal the flow out of it.
#[test]
fn without_mach_numbers_every_flow_of_a_node_is_that_of_a_conventional_orifice() {
    let (valve, gas) = (thesis_valve(), Gas::new(N, R));
    for (spool, pressures) in operating_points() {
        let chambers = pressures.map(|p| station(p, 310.0));
        let nodes = ports_of(&mut network(false), &valve, &chambers, spool);
        let areas = valve.land_areas(spool);
        for (i, node) in nodes.iter().enumerate() {
            let here = (gas.pressure(node.exner), node.temperature);
            let flows = [
                orifice(areas[i], (589e3, 294.0), here),
                orifice(areas[1 - i], (101.3e3, 290.0), here),
                orifice(valve.port_area(), here, (pressures[i], 310.0)),
            ]
            .map(|ideal| 0.8 * ideal);
            let got = [node.supply_flow, node.exhaust_flow, node.port_flow()];
            for (got, expected) in got.into_iter().zip(flows) {
                assert!((got - expected).abs() < 1e-10, "{spool} {pressures:?}: {got} {expected}");
            }
        }
    }
}

/// Appendix VI (a) to (h): T_v of VI.1 to VI.9 for every combination of signs, with given stagnation temperatures.
/// EQUATIONS section 3: VI.7, where nothing flows in, has no rule.
#[test]
fn the_eight_cases_of_appendix_vi_are_one_rule_of_mixing() {
    let [t_s, t_e, t_1] = [294.0, 280.0, 350.0];
    // s and e into the node, m out of it, as the thesis signs them.
    for (s, e, m, expected) in [
        (3.0, 1.0, 4.0, Some((3.0 * t_s + 1.0 * t_e) / (3.0 + 1.0))),
        (3.0, -1.0, 2.0, Some(t_s)),
        (3.0, 1.0, -2.0, Some((3.0 * t_s + 1.0 * t_e + 2.0 * t_1) / (3.0 + 1.0 + 2.0))),
        (3.0, -5.0, -2.0, Some((3.0 * t_s + 2.0 * t_1) / (3.0 + 2.0))),
        (-1.0, 3.0, 2.0, Some(t_e)),
        (-1.0, -3.0, 2.0, None),
        (-3.0, 1.0, -2.0, Some((2.0 * t_1 + 1.0 * t_e) / (2.0 + 1.0))),
        (-1.0, -2.0, -3.0, Some(t_1)),
    ] {
        let got = mean_of_inflows(&[(s, t_s), (e, t_e), (-m, t_1)]);
        assert_eq!(got, expected, "{s} {e} {m}");
    }
}
