//! A 4-way poppet valve by its conductances (ISO 6358-1): four seats, one from the supply to each port and one from each
//! port to the exhaust.
//!
//! ```text
//! mdot = s C rho_0 P_u sqrt(T_0/T_u) g(P_d/P_u),   s = |x|/X_max      ([`crate::component::valve::iso6358`] has g)
//! x > 0: supply to port 1 and port 2 to exhaust     x < 0: supply to port 2 and port 1 to exhaust     x = 0: all shut
//! ```
//!
//! A seat opens as the curtain between it and its disc, in proportion to the lift, and is tight when shut. Its coil lifts
//! it within `operator.switch_time_s`, its spring shuts it within `operator.switch_off_time_s`, so that a reversal takes
//! both. There is no spool: no null, no lap, no force of the flow on one.

use super::{Facts, Opening, Paths, ValveModel};
use crate::component::valve::characteristic::Characteristic;
use crate::component::valve::flow_law::FlowLaw;
use crate::component::valve::iso6358::Iso6358;
use crate::component::valve::keys as valve;
use crate::key::keys;
use crate::values::{Findings, Rig};

keys! {
    SEAT_CONDUCTANCE_M3_PER_S_PA: Option<f64> = optional_number("valve.seat_conductance_m3_per_s_pa", 1e-12, 1e-6, "the data sheet's; needed by poppet", "", "Sonic conductance C of the seat between the supply and a port, fully open.").chosen_by(&valve::MODEL, &["poppet"]).spread();
    SEAT_CRITICAL_RATIO: Option<f64> = optional_number("valve.seat_critical_ratio", 0.0, 0.9, "the data sheet's; needed by poppet", "", "Critical pressure ratio b of that seat.").chosen_by(&valve::MODEL, &["poppet"]).spread();
    EXHAUST_SEAT_CONDUCTANCE_M3_PER_S_PA: Option<f64> = optional_number("valve.exhaust_seat_conductance_m3_per_s_pa", 1e-12, 1e-6, "that of the seat from the supply", "", "Sonic conductance C of the seat between a port and the exhaust, fully open.").chosen_by(&valve::MODEL, &["poppet"]).spread();
    EXHAUST_SEAT_CRITICAL_RATIO: Option<f64> = optional_number("valve.exhaust_seat_critical_ratio", 0.0, 0.9, "that of the seat from the supply", "", "Critical pressure ratio b of that seat.").chosen_by(&valve::MODEL, &["poppet"]).spread();
}

/// Seats by their conductances.
pub struct Poppet;

impl ValveModel for Poppet {
    const FACTS: Facts =
        Facts { paths: Paths::Own, has_spool: false, operators: &["on-off"], ..Facts::CONDUCTANCES };

    /// Of zeros where the figures are absent, which `check` refuses.
    fn laws(rig: &Rig) -> [FlowLaw; 2] {
        let seat = |[sonic, ratio]: [Option<f64>; 2]| Iso6358 {
            sonic_conductance: sonic.unwrap_or(0.0),
            critical_ratio: ratio.unwrap_or(0.0),
            subsonic_index: 0.5,
        };
        let supply =
            [&keys::SEAT_CONDUCTANCE_M3_PER_S_PA, &keys::SEAT_CRITICAL_RATIO].map(|key| rig.get(key));
        let [sonic, ratio] =
            [&keys::EXHAUST_SEAT_CONDUCTANCE_M3_PER_S_PA, &keys::EXHAUST_SEAT_CRITICAL_RATIO]
                .map(|key| rig.get(key));
        [supply, [sonic.or(supply[0]), ratio.or(supply[1])]].map(|figures| FlowLaw::Iso6358(seat(figures)))
    }

    fn opening(_rig: &Rig) -> Opening {
        Opening::Shares(Characteristic::Linear { leakage: 0.0 })
    }

    fn check(rig: &Rig, findings: &mut Findings) {
        for key in [&keys::SEAT_CONDUCTANCE_M3_PER_S_PA, &keys::SEAT_CRITICAL_RATIO] {
            if rig.get(key).is_none() {
                findings.note(key, "valve.model = \"poppet\" needs it; the data sheet has it");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::air::GasState;
    use crate::component::gas::Gas;
    use crate::component::valve::Valve;
    use crate::network::{Network, PortFlow};

    const EXAMPLE: &str = include_str!("../../../../../docs/examples/poppet.toml");
    const SUPPLY: Iso6358 = Iso6358 { sonic_conductance: 0.7e-8, critical_ratio: 0.25, subsonic_index: 0.5 };
    const EXHAUST: Iso6358 = Iso6358 { sonic_conductance: 0.9e-8, critical_ratio: 0.3, subsonic_index: 0.5 };

    fn example(settings: &[&str]) -> Rig {
        let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
        Rig::read_with("poppet", EXAMPLE, &settings).unwrap_or_else(|problems| panic!("{problems}"))
    }

    /// Flow out of a port, kg/s: the seats at a lift (m), with 7 bar at the supply port, a pressure at both ports (Pa), and
    /// all air at 293.15 K.
    fn port_flow(port: usize, lift: f64, port_pa: f64) -> f64 {
        let (rig, gas) = (example(&[]), Gas::new(1.4, 286.76));
        let air = GasState { exner: gas.exner(port_pa), temperature: 293.15 };
        let mut network = Network::without_tubes(&rig, gas, 7e5, None);
        network.flows(&Valve::of(&rig), lift, &[air; 2], &[PortFlow::Charging; 2])[port].port_flow()
    }

    /// As the other seat of its port is tight, small flows of an open one are laminar (EQUATIONS section 3):
    /// `m sqrt(m^2 + m_l^2) = F^2`, F by its C and b and m_l a thousandth of what supply or exhaust would drive through it
    /// into a vacuum. So a seat passes less than its C and b say, by `(m_l/F)^2/4` of that: choked from the supply by 2.5e-7.
    fn beside_a_tight_seat(by_c_and_b: f64, into_vacuum: f64) -> f64 {
        let (square, laminar) = (by_c_and_b * by_c_and_b, 1e-6 * into_vacuum * into_vacuum);
        (((laminar * laminar + 4.0 * square * square).sqrt() - laminar) / 2.0).sqrt()
    }

    /// Choked and unchoked, at the whole lift and at a part of it.
    #[test]
    fn a_seat_passes_what_its_c_and_b_say_times_the_part_of_its_lift() {
        let gas = Gas::new(1.4, 286.76);
        for share in [1.0, 0.4] {
            let flow = |seat: Iso6358, from: f64, to: f64| share * seat.flow(&gas, from, 293.15, to);
            for port_pa in [1.5e5, 3.0e5, 5.5e5, 6.8e5] {
                let charged = beside_a_tight_seat(flow(SUPPLY, 7e5, port_pa), flow(SUPPLY, 7e5, 0.0));
                let emptied =
                    -beside_a_tight_seat(flow(EXHAUST, port_pa, 101_325.0), flow(EXHAUST, 101_325.0, 0.0));
                for (lift, flows) in [(share, [charged, emptied]), (-share, [emptied, charged])] {
                    for (port, flow) in flows.into_iter().enumerate() {
                        let found = port_flow(port, 1e-3 * lift, port_pa);
                        assert!((found / flow - 1.0).abs() < 1e-9, "{lift} {port_pa}: {found} {flow}");
                    }
                }
            }
        }
    }

    #[test]
    fn shut_seats_are_tight() {
        for port in [0, 1] {
            assert_eq!(port_flow(port, 0.0, 3e5), 0.0);
        }
    }

    #[test]
    fn a_relay_positions_a_drive_with_it_within_its_dead_zone() {
        let run = crate::run(&example(&[]), crate::Accuracy::default()).expect("a run");
        let last = run.observations.last().expect("a sample");
        assert_eq!((run.fault, last.command), (None, 0), "at rest");
        assert!((last.position - 12_448).abs() < 80, "{}", last.position);
    }

    #[test]
    fn it_is_refused_without_its_figures_and_with_an_operator_of_spools() {
        for (settings, says) in [
            (&["valve.model=poppet", "operator.model=on-off"][..], "valve.seat_conductance_m3_per_s_pa"),
            (
                &[
                    "valve.model=poppet",
                    "valve.seat_conductance_m3_per_s_pa=1e-8",
                    "valve.seat_critical_ratio=0.3",
                ],
                "must be on-off",
            ),
        ] {
            let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
            let refused = Rig::read_with("", "", &settings).expect_err("refused").to_string();
            assert!(refused.contains(says), "{refused}");
        }
    }
}
