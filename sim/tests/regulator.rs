//! A pressure regulator in front of the valve (`supply.model = "regulator"`), against closed forms of its outlet pressure and in balance
//! with the drive.
//!
//! ```text
//! through a valve of C_v, choked on both sides    P = P_s/(1 + D C_v/(C P_l))                steady
//! charging at no flow, choked        wide open    P = P_0 + D t/tau                          tau = V D/(n R T_l mdot_o)
//!                                    then         P = P_s - D exp(-(t - t_1)/tau)
//!                      not choked    wide open    as a receiver (receiver.rs)
//!                                    then         t = t_1 + tau_c int ds/phi(P/P_l),  P = P_s - D exp(-s)    tau_c: choked
//! relieving, adiabatic, choked                    dP/dt = -n R sqrt(T T_0) C_r rho_0 P z/V,   T = T_0 (P/P_0)^((n-1)/n)
//! ```
//!
//! The pressure in a volume that is charged rises with n R T_l mdot/V whatever its temperature is.

use pneudrive_controller::Command;
use pneudrive_sim::trace::{Extra, Row};
use pneudrive_sim::{Accuracy, Method, Plant, Recording, Rig, run, run_recorded};

use crate::receiver::{
    BY_CONDUCTANCE, C_VALVE, DENSITY, N, OPEN, OUTSIDE, R, SHUT, T, VOLUME, balance, driven, largest_gap,
    off_the_ideal_supply, pressure, rows, servo, vessel,
};
use crate::vessel::charged;

const SET: f64 = 7e5;
const LINE: f64 = 9e5;
const DROOP: f64 = 1e5;
const C: f64 = 2e-8;
const C_RELIEF: f64 = 2e-9;

/// It is choked at all pressures with the second.
const B: f64 = 0.25;
const CHOKED: &str = "supply.feed_critical_ratio=0.85";

const REGULATOR: [&str; 5] = [
    "supply.model=regulator",
    "supply.primary_pressure_pa=9e5",
    "supply.droop_pa=1e5",
    "supply.feed_conductance_m3_per_s_pa=2e-8",
    "supply.relief_conductance_m3_per_s_pa=0",
];

/// A regulator in front of a litre.
fn regulated(parts: &[&[&str]], faults: &str) -> Rig {
    vessel(&[&[&REGULATOR[..]], parts].concat(), faults)
}

/// mdot_o where it is choked, kg/s.
const WIDE_OPEN: f64 = C * DENSITY * LINE;

fn tau() -> f64 {
    VOLUME * DROOP / (N * R * T * WIDE_OPEN)
}

/// phi of ISO 6358 with m = 0.5.
fn phi(ratio: f64, b: f64) -> f64 {
    if ratio <= b { 1.0 } else { (1.0 - ((ratio - b) / (1.0 - b)).powi(2)).sqrt() }
}

fn simpson(from: f64, to: f64, value: impl Fn(f64) -> f64) -> f64 {
    let h = (to - from) / 400.0;
    let panel = |i: i32| {
        let a = from + f64::from(i) * h;
        h / 6.0 * (value(a) + 4.0 * value(a + 0.5 * h) + value(a + h))
    };
    (0..400).map(panel).sum()
}

/// Chamber 1 has a hole of 10 mm, so that the surroundings are behind the valve; its last row, in steady flow.
fn drawn_from(parts: &[&str]) -> Row {
    let hole = "[[faults.event]]\nkind = \"leak\"\nat_s = 0.0\nchamber = 1\ndiameter_mm = 10.0\n";
    let steady = ["test.duration_s=20", OPEN];
    *rows(&regulated(&[&steady, parts], hole)).last().expect("rows")
}

#[test]
fn the_outlet_pressure_falls_with_the_flow_in_proportion_to_the_droop() {
    for droop in [2e4, 5e4, 1e5, 1.5e5] {
        let row = drawn_from(&[CHOKED, &format!("supply.droop_pa={droop}")]);
        let expected = SET / (1.0 + droop * C_VALVE / (C * LINE));
        assert!((pressure(&row) / expected - 1.0).abs() < 1e-7, "{droop}: {} {expected}", pressure(&row));
        let flow = row.receiver.expect("a volume").feed_flow;
        let fall = droop * flow / WIDE_OPEN;
        assert!((pressure(&row) - (SET - fall)).abs() < 1e-6 * SET, "{droop}: {fall} Pa at {flow} kg/s");
    }
    // Not choked, the flow wide open is less.
    let row = drawn_from(&[]);
    let (p, flow) = (pressure(&row), row.receiver.expect("a volume").feed_flow);
    let expected = (SET - p) / DROOP * WIDE_OPEN * phi(p / LINE, B);
    assert!((flow / expected - 1.0).abs() < 1e-9 && p < 0.96 * SET, "{flow} {expected} kg/s at {p} Pa");
    // And more than its wide opening passes, it cannot: the pressure falls through the droop.
    let row = drawn_from(&["supply.feed_conductance_m3_per_s_pa=8e-9"]);
    let (p, flow) = (pressure(&row), row.receiver.expect("a volume").feed_flow);
    let expected = 8e-9 * DENSITY * LINE * phi(p / LINE, B);
    assert!((flow / expected - 1.0).abs() < 1e-9 && p < SET - DROOP, "{flow} {expected} kg/s at {p} Pa");
}

/// At half of the flow wide open, D = 40 kPa has fallen by 20 kPa.
#[test]
fn a_regulator_bought_with_20_kpa_of_droop_at_half_of_its_largest_flow_has_that() {
    let half = C_VALVE * (SET - 2e4) / (0.5 * LINE);
    let own = ["supply.droop_pa=4e4", &format!("supply.feed_conductance_m3_per_s_pa={half:e}"), CHOKED];
    let row = drawn_from(&own);
    assert!((pressure(&row) - (SET - 2e4)).abs() < 0.1, "{} Pa", pressure(&row));
}

const FILLS: [&str; 3] = ["test.receiver_pressure_pa=101325", "test.duration_s=1.5", SHUT];

#[test]
fn at_no_flow_it_charges_the_volume_behind_it_to_its_set_pressure() {
    let until = tau() * (SET - DROOP - OUTSIDE) / DROOP;
    let closed = |t: f64| {
        let late = SET - DROOP * (-(t - until) / tau()).exp();
        Some(if t < until { OUTSIDE + DROOP * t / tau() } else { late })
    };
    let rows = rows(&regulated(&[&FILLS, &[CHOKED]], ""));
    let gap = largest_gap(&rows, closed);
    assert!(gap < 1e-7, "{gap:e}");
    let last = rows.last().expect("rows");
    assert!((pressure(last) / SET - 1.0).abs() < 1e-7, "it rests at the set pressure: {last:?}");
    assert!(last.receiver.expect("a volume").feed_flow.abs() < 1e-8);
    // What has come in brings c_p T_l: T (m - m_0) n = T_end m - T m_0 with m R T_end = P V.
    let (start, end) = (OUTSIDE / SET, last.receiver.expect("a volume").temperature);
    let gap = end * (start + (1.0 - start) / N) / T - 1.0;
    assert!(gap.abs() < 1e-7, "{end} K, {gap:e}");
}

#[test]
fn an_inlet_that_is_not_choked_charges_it_as_the_integral_of_its_flow_says() {
    let per_s = DROOP / (tau() * LINE);
    let slowly = |t: f64| LINE * charged(OUTSIDE / LINE, per_s, B, t);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if slowly(middle) < SET - DROOP { &mut low } else { &mut high }) = middle;
    }
    let until = |s: f64| low + tau() * simpson(0.0, s, |s| 1.0 / phi((SET - DROOP * (-s).exp()) / LINE, B));
    let late = |t: f64| {
        let (mut before, mut after) = (0.0_f64, 40.0);
        for _ in 0..50 {
            let middle = 0.5 * (before + after);
            *(if until(middle) < t { &mut before } else { &mut after }) = middle;
        }
        SET - DROOP * (-before).exp()
    };
    let rows = rows(&regulated(&[&FILLS], ""));
    let gap = largest_gap(&rows, |t| Some(if t < low { slowly(t) } else { late(t) }));
    assert!(gap < 1e-7, "{gap:e}");
}

/// Half a bar beyond its droop at the start.
const FULL: f64 = SET + 1.5 * DROOP;
const RELIEVES: [&str; 4] = [
    "supply.relief_conductance_m3_per_s_pa=2e-9",
    "test.receiver_pressure_pa=8.5e5",
    "test.duration_s=1.5",
    SHUT,
];

/// -dP/dt while it relieves with the whole of its relief, Pa/s.
fn relieves(p: f64) -> f64 {
    let temperature = T * (p / FULL).powf((N - 1.0) / N);
    N * R * (temperature * T).sqrt() * C_RELIEF * DENSITY * p / VOLUME
}

/// The time until a pressure, in two pieces, of which the second goes with the logarithm of the surplus.
fn relieved_after(pressure: f64) -> f64 {
    let edge = SET + DROOP;
    let wide_open = simpson(pressure.max(edge), FULL, |p| 1.0 / relieves(p));
    let s = (DROOP / (pressure.min(edge) - SET)).ln();
    wide_open + simpson(0.0, s, |s| DROOP / relieves(SET + DROOP * (-s).exp()))
}

#[test]
fn a_relieving_regulator_vents_the_surplus_and_another_one_keeps_it() {
    let vented = run(&regulated(&[&RELIEVES], ""), FINE).expect("it runs").rows;
    let off = |row: &Row| {
        let (p, late) = (pressure(row), relieved_after(pressure(row)) - row.time);
        (late * relieves(p) * ((p - SET) / DROOP).min(1.0)).abs()
    };
    let seen = vented.iter().filter(|row| row.time > 0.0 && pressure(row) > SET + 0.01 * DROOP);
    let most = seen.clone().map(off).fold(0.0, f64::max);
    assert!(seen.count() > 50 && most < 1e-8 * SET, "{most} Pa");
    let last = vented.last().expect("rows");
    assert!((SET..SET + 0.1 * DROOP).contains(&pressure(last)), "{last:?}");
    assert!(vented.iter().all(|row| row.receiver.expect("a volume").feed_flow <= 0.0), "it goes out");

    let kept = rows(&regulated(&[&RELIEVES, &["supply.relief_conductance_m3_per_s_pa=0"]], ""));
    let lost = kept.iter().map(|row| (pressure(row) / FULL - 1.0).abs()).fold(0.0, f64::max);
    assert!(lost < 1e-12, "{lost}");
}

const FINE: Accuracy = Accuracy { method: Method::DormandPrince, tolerance: 3e-12 };

/// Servo-drive B behind a regulator that its valve brings to droop.
const DROOPS: [&str; 4] = [
    "supply.model=regulator",
    "supply.primary_pressure_pa=8e5",
    "supply.droop_pa=2e5",
    "supply.feed_conductance_m3_per_s_pa=1e-8",
];

#[test]
fn regulator_and_drive_hold_the_mass_and_the_energy_that_line_relief_exhaust_and_piston_bring() {
    for own in [&[][..], &["test.receiver_pressure_pa=7e5", "supply.relief_conductance_m3_per_s_pa=2e-9"]] {
        let rig = servo(&[&DROOPS, own]);
        let run = run_recorded(&rig, FINE, Recording { valve: true }, |_, _| {}).expect("it runs");
        let flow = |row: &Row| row.receiver.expect("a volume").feed_flow;
        let rows = &run.rows[2000..];
        let [in_line, relieved] = [f64::max, f64::min].map(|most| rows.iter().map(flow).fold(0.0, most));
        assert!(in_line > 1e-3 && (own.is_empty() || relieved < -1e-4), "{in_line} {relieved} kg/s");
        balance(rows, |_| 0.0);
    }
}

/// Also where the outlet pressure goes through the set pressure and through the droop, and where the line has lost its own.
#[test]
fn the_outlet_pressure_converges_with_the_tolerance() {
    let models: [&[&str]; 6] = [
        &[],
        &["supply.droop_pa=1e4"],
        &["test.receiver_pressure_pa=6.5e5", "supply.relief_conductance_m3_per_s_pa=1e-8"],
        &[BY_CONDUCTANCE[0], BY_CONDUCTANCE[1], BY_CONDUCTANCE[2], BY_CONDUCTANCE[3], BY_CONDUCTANCE[4]],
        &["load.friction=lugre", "sensors.pressure_lag_s=0.004"],
        &[
            "supply.check_valve=true",
            "faults.event=[{ kind = \"supply-dip\", at_s = 0.05, duration_s = 0.1, pressure_pa = 4e5 }]",
        ],
    ];
    for model in models {
        let moves = "test.moves=[[0.0, 600], [0.08, 0], [0.12, -900], [0.18, 0]]";
        let rig = servo(&[&DROOPS, &[moves, "test.trace_period_s=1e-3"], model]);
        let at = |tolerance| run(&rig, Accuracy { tolerance, ..Accuracy::default() }).expect("a transient");
        let exact = at(1e-12);
        let errors = [1e-6, 1e-8, 1e-10].map(|tolerance| {
            let pairs = at(tolerance).rows.into_iter().zip(&exact.rows);
            pairs.map(|(one, other)| (pressure(&one) - pressure(other)).abs()).fold(0.0, f64::max)
        });
        assert!(errors[0] < 3.0 && errors[1] < 0.03 && errors[2] < 3e-3, "{model:?}: {errors:?} Pa");
    }
}

/// What it keeps from being an ideal supply goes with the droop.
#[test]
fn a_regulator_without_droop_is_the_ideal_supply() {
    let off = |droop: &str| {
        let small = ["supply.receiver_volume_m3=1e-3", "supply.feed_conductance_m3_per_s_pa=1e-7", droop];
        off_the_ideal_supply(&[&REGULATOR[..3], &small].concat())
    };
    let [large, small] = ["supply.droop_pa=1e4", "supply.droop_pa=1e3"].map(off);
    assert!(small < 1e-5 && (large / small - 10.0).abs() < 1.0, "{large} m, {small} m");
}

/// The law knows the set pressure alone.
#[test]
fn a_drive_positions_behind_a_regulator_that_droops_and_does_not_swing() {
    let small = ["supply.receiver_volume_m3=2e-4"];
    let [late, beyond, low] = driven(&[&REGULATOR[..], &small].concat());
    assert!(late < 0.37 && beyond < 0.03 && (6.7e5..6.9e5).contains(&low), "{late} s, {beyond} mm, {low} Pa");
}

#[test]
fn shut_it_lets_no_dip_of_its_line_through_and_loses_its_pressure_where_the_line_has_less() {
    let lowest = |dip: &str, more: &[&str]| {
        let dip = format!(
            "[[faults.event]]\nkind = \"supply-dip\"\nat_s = 0.1\nduration_s = 0.3\npressure_pa = {dip}\n"
        );
        let rests = ["test.duration_s=0.6", "test.trace_period_s=1e-3", SHUT];
        let rows = rows(&regulated(&[&rests, more], &dip));
        rows.iter().map(pressure).fold(f64::INFINITY, f64::min)
    };
    let above = lowest("7.5e5", &[]);
    assert!((above / SET - 1.0).abs() < 1e-12, "{above} Pa");
    let drawn = ["test.receiver_pressure_pa=6.5e5"];
    let (lost, kept) =
        (lowest("3e5", &drawn), lowest("3e5", &[&drawn[..], &["supply.check_valve=true"]].concat()));
    assert!(lost < 6e5 && (kept / 6.5e5 - 1.0).abs() < 1e-9, "half open, air flows back: {lost} {kept} Pa");
}

/// Chamber 1 is charged to what the regulator is set to meanwhile.
#[test]
fn it_can_be_set_to_another_pressure_while_the_plant_runs() {
    let rig = regulated(&[&["supply.relief_conductance_m3_per_s_pa=1e-7", OPEN]], "");
    let mut plant = Plant::new(&rig, Accuracy::default(), 0);
    let mut charged_to = |set: f64, until_s: f64| {
        plant.set_supply_pressure(set);
        for _ in 0..2000 {
            plant.advance(Command { counts: 2048, step: 0, drive_enable: true }).expect("it runs");
        }
        plant.look(until_s).expect("it runs").pressures[0]
    };
    let [high, low] = [(6e5, 10.0), (4e5, 20.0)].map(|(set, until_s)| charged_to(set, until_s) / set);
    assert!((high - 1.0).abs() < 1e-3 && (low - 1.0).abs() < 1e-3, "{high} {low}");
}

#[test]
fn what_does_not_go_with_a_regulator_is_refused_by_key_with_what_to_do() {
    let refused = |text: &str| Rig::read("regulated", text).expect_err("refused").to_string();
    let with = |more: &str| refused(&format!("supply.model = \"regulator\"\n{more}\n"));
    for (why, says) in [
        (refused("supply.droop_pa = 5e4\n"), "has no effect with supply.model = \"ideal\""),
        (
            refused("supply.model = \"receiver\"\nsupply.relief_conductance_m3_per_s_pa = 1e-8\n"),
            "has no effect with supply.model = \"receiver\"",
        ),
        (
            with("supply.primary_pressure_pa = 5e5"),
            "supply.pressure_pa: must be below supply.primary_pressure_pa = 500000, is 589000: a regulator only lowers",
        ),
        (with("supply.primary_pressure = \"9 bar\""), "write \"9 bar(g)\" or \"9 bar(a)\""),
        (
            with(
                "supply.droop_pa = 1e3\nsupply.receiver_volume_m3 = 1e-4\nsupply.feed_conductance_m3_per_s_pa = 5e-7",
            ),
            "supply.droop_pa: the pressure behind it follows within 1.6e-6 s, less than 1e-5 s: give at least",
        ),
        (with("tubing.lag_s = 0.003"), "tubing.lag_s: must be 0 beside supply.model = \"regulator\""),
        (
            with(
                "faults.event = [{ kind = \"supply-dip\", at_s = 0.1, duration_s = 0.1, pressure_pa = 9.5e5 }]",
            ),
            "it must be between exhaust.pressure_pa = 101300 and supply.primary_pressure_pa = 900000",
        ),
    ] {
        assert!(why.contains(says), "{why}");
    }
}

#[test]
fn what_a_refusal_of_a_fast_regulator_advises_is_accepted() {
    let text = "supply.model = \"regulator\"\nsupply.receiver_volume_m3 = 1e-4\nsupply.feed_conductance_m3_per_s_pa = 5e-7\n";
    let why =
        Rig::read("regulated", &format!("{text}supply.droop_pa = 1e3\n")).expect_err("too fast").to_string();
    let advised =
        why.split("give at least ").nth(1).and_then(|rest| rest.split(',').next()).expect("a droop");
    Rig::read("regulated", &format!("{text}supply.droop_pa = {advised}\n"))
        .unwrap_or_else(|problems| panic!("{problems}"));
}

#[test]
fn a_trace_has_the_columns_of_the_air_behind_a_regulator() {
    let names = Extra::of_rig(&regulated(&[&FILLS], "")).iter().map(|extra| extra.name).collect::<Vec<_>>();
    assert_eq!(names, ["receiver_pressure_pa", "receiver_temperature_k", "receiver_flow_kg_s"]);
    let row = rows(&regulated(&[&[SHUT]], ""))[0];
    let value = Extra::named(names[0]).expect("a column").value(&row);
    assert!((value / SET - 1.0).abs() < 1e-12, "it begins at the set pressure: {value} Pa");
}
