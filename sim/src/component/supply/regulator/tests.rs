use super::*;
use crate::component::supply::receiver::Receiver;
use crate::component::supply::receiver::tests::pressure_after;

const SET: f64 = 6e5;
const DROOP: f64 = 1e5;
const TEMPERATURE: f64 = 293.15;
/// What its inlet passes wide open, kg/s.
const WIDE_OPEN: f64 = 0.02;

fn gas() -> Gas {
    Gas::new(1.4, 286.76)
}

/// A regulator of 6 bar in front of 2 l, choked up to there.
fn rig() -> Rig {
    let text = "
        [supply]
        model = \"regulator\"
        pressure_pa = 6e5
        primary_pressure_pa = 9e5
        temperature_k = 293.15
        droop_pa = 1e5
        feed_conductance_m3_per_s_pa = 2e-8
        feed_critical_ratio = 0.8
        relief_conductance_m3_per_s_pa = 1e-9
        receiver_volume_m3 = 2e-3
        [gas]
        heat_capacity_ratio = 1.4
        gas_constant_j_per_kg_k = 286.76
    ";
    Rig::read("regulated", text).unwrap_or_else(|problems| panic!("{problems}"))
}

fn flow(pressure: f64) -> (f64, f64) {
    let [mass, exner] = ChamberAir::state_of(&gas(), pressure, 1.21 * TEMPERATURE, 2e-3);
    let air = ChamberAir::of_state(&gas(), mass, exner, 2e-3);
    Regulator::of(&rig(), 0.8).expect("a regulator").passes(&air, (WIDE_OPEN, TEMPERATURE))
}

#[test]
fn it_opens_in_proportion_to_the_fall_of_its_outlet_pressure_until_it_is_wide_open() {
    for (fall, share) in [(0.0, 0.0), (0.25, 0.25), (0.5, 0.5), (1.0, 1.0), (1.5, 1.0), (5.0, 1.0)] {
        let (passed, temperature) = flow(SET - fall * DROOP);
        assert!((passed / WIDE_OPEN - share).abs() < 1e-9, "{fall}: {passed}");
        assert_eq!(temperature, TEMPERATURE, "the line's air");
    }
}

/// By hand, choked: 1e-9 1.185 P sqrt(293.15/T) with T = 1.21 T_0, so 1/1.1 of it.
#[test]
fn it_relieves_in_proportion_to_the_surplus_of_its_outlet_pressure() {
    for (surplus, share) in [(0.25, 0.25), (1.0, 1.0), (2.0, 1.0)] {
        let pressure = SET + surplus * DROOP;
        let (passed, temperature) = flow(pressure);
        let expected = -share * 1e-9 * 1.185 * pressure / 1.1;
        assert!((passed / expected - 1.0).abs() < 1e-9, "{surplus}: {passed}");
        assert!((temperature / TEMPERATURE - 1.21).abs() < 1e-9, "its own air");
    }
}

#[test]
fn its_flow_does_not_jump_where_it_begins_to_open_and_where_it_is_wide_open() {
    for edge in [SET - DROOP, SET, SET + DROOP] {
        let [below, above] = [-1e-3, 1e-3].map(|by| flow(edge + by).0);
        assert!((below - above).abs() < 1e-7 * WIDE_OPEN, "{edge}: {below} {above}");
    }
}

/// From half open, P = P_s - D/2 exp(-t/tau): what is off after tau in this many steps of one length.
fn off_after(steps: u32) -> f64 {
    let receiver = Receiver::of(&rig()).expect("a volume");
    let inlet = Opening::new(2e-8, 0.8).choked * 9e5 / TEMPERATURE.sqrt();
    let tau = 2e-3 * DROOP / (1.4 * 286.76 * TEMPERATURE * inlet);
    let end = pressure_after(receiver, SET - 0.5 * DROOP, tau, steps);
    (end - (SET - 0.5 * DROOP * (-1.0_f64).exp())).abs()
}

#[test]
fn the_error_of_its_outlet_pressure_falls_with_the_order_of_the_method() {
    let observed = (off_after(8) / off_after(16)).log2();
    assert!((observed - 4.0).abs() < 0.3, "{observed}");
}
