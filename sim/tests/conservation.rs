//! What goes into the chambers is in them: mass (thesis 6.15 to 6.18 as corrected in EQUATIONS
//! section 5) and energy, over whole runs.
//!
//! Rows have flows at an instant. They are integrated by Simpson's rule over panels whose ends take in
//! the outputs of the controller, where the flows bend.

use pneudrive_controller::Command;
use pneudrive_sim::plant::Plant;
use pneudrive_sim::trace::Row;
use pneudrive_sim::{Accuracy, Method, Rig, Run, run};

/// What is lost goes with the tolerance: a billionth asks for this one.
const FINE: Accuracy = Accuracy { method: Method::DormandPrince, tolerance: 3e-12 };

const N: f64 = 1.4;
const R: f64 = 286.76;
const BLIND: f64 = std::f64::consts::PI / 4.0 * 0.05 * 0.05;
const ROD_SIDE: f64 = BLIND - std::f64::consts::PI / 4.0 * 0.025 * 0.025;

fn rig(name: &str, settings: &[&str]) -> Rig {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

fn simulate(name: &str, settings: &[&str]) -> Run {
    run(&rig(name, settings), FINE).expect("a transient")
}

fn volumes(row: &Row) -> [f64; 2] {
    [BLIND * row.plant.position + 2e-5, ROD_SIDE * (0.3 - row.plant.position) + 2e-5]
}

fn mass(row: &Row) -> f64 {
    let (p, t, v) = (row.plant.pressures, row.plant.temperatures, volumes(row));
    (0..2).map(|i| p[i] * v[i] / (R * t[i])).sum()
}

/// Simpson's rule from the first row to the last.
fn integral(rows: &[Row], value: impl Fn(&Row) -> f64) -> f64 {
    let panels = rows.windows(3).step_by(2);
    panels.map(|p| (p[2].time - p[0].time) / 6.0 * (value(&p[0]) + 4.0 * value(&p[1]) + value(&p[2]))).sum()
}

/// The largest gap in the balance of mass, over the mass at the start.
fn gap_of_mass(rows: &[Row]) -> f64 {
    let start = mass(&rows[0]);
    let ends = (2..rows.len()).step_by(200);
    ends.map(|end| {
        let crossed = integral(&rows[..=end], |row| row.plant.mass_flows.iter().sum());
        ((mass(&rows[end]) - start - crossed) / start).abs()
    })
    .fold(0.0, f64::max)
}

/// A valve that opens, its spool and load without dry friction: nothing bends the flows.
const SMOOTH: [&str; 10] = [
    "controller.loop=open",
    "test.moves=[[0.0, 700]]",
    "test.duration_s=0.2",
    "test.trace_period_s=1e-5",
    "operator.dither_mm=0",
    "operator.static_friction_n=0",
    "operator.coulomb_friction_n=0",
    "operator.hysteresis_percent=0",
    "valve.upstream_mach=false",
    "load.viscous_n_s_per_m=200",
];

#[test]
fn both_chambers_hold_what_has_crossed_their_ports_whatever_leaks_past_the_piston() {
    for leakage in [
        &["actuator.leakage=none"][..],
        &["actuator.leakage=laminar", "actuator.leakage_coefficient=1e-9"],
        &["actuator.leakage=adiabatic"],
    ] {
        let run = simulate("servo-b", &[&SMOOTH[..], leakage].concat());
        let gap = gap_of_mass(&run.rows);
        assert!(gap < 1e-9, "{leakage:?}: {gap:e}");
    }
}

#[test]
fn both_chambers_hold_what_has_crossed_their_ports_in_a_closed_loop() {
    for (name, leakage) in [("servo-b", "none"), ("servo-b-tuned", "adiabatic")] {
        let leakage = format!("actuator.leakage={leakage}");
        let run = simulate(name, &[&leakage, "test.duration_s=0.6", "test.trace_period_s=5e-6"]);
        let gap = gap_of_mass(&run.rows);
        assert!(gap < 1e-9, "{name}: {gap:e}");
    }
}

/// dU = cp (T_s mdot_1 + T_2 mdot_2) dt - P_1 dV_1 - P_2 dV_2 + Q dt: chamber 1 is charged by the supply's air,
/// chamber 2 discharges its own, and what leaks past the piston stays inside. Walls of 320 K heat both.
#[test]
fn both_chambers_hold_the_enthalpy_and_heat_that_have_come_less_the_work_done() {
    balance_energy(0.0);
    balance_energy(100.0);
}

/// Q of walls of 320 K, W, for a coefficient in W/(m^2 K).
fn heat(coefficient: f64, row: &Row) -> f64 {
    let lengths = [row.plant.position, 0.3 - row.plant.position];
    let girths = [0.05, 0.075].map(|diameters| std::f64::consts::PI * diameters);
    let area = |i: usize| 2.0 * [BLIND, ROD_SIDE][i] + girths[i] * lengths[i];
    (0..2).map(|i| coefficient * area(i) * (320.0 - row.plant.temperatures[i])).sum()
}

fn balance_energy(coefficient: f64) {
    let heated = format!("actuator.heat_transfer_w_per_m2_k={coefficient}");
    let others =
        ["actuator.leakage=laminar", "actuator.leakage_coefficient=1e-9", "actuator.wall_temperature_k=320"];
    let run = simulate("servo-b", &[&SMOOTH[..], &others, &[&heated]].concat());
    let rows = &run.rows[2000..];
    assert!(rows.iter().all(|row| row.plant.mass_flows[0] > 0.0 && row.plant.mass_flows[1] < 0.0));
    let energy = |row: &Row| {
        let (p, v) = (row.plant.pressures, volumes(row));
        (p[0] * v[0] + p[1] * v[1]) / (N - 1.0)
    };
    let enthalpy = |row: &Row| {
        let [m1, m2] = row.plant.mass_flows;
        N * R / (N - 1.0) * (294.0 * m1 + row.plant.temperatures[1] * m2)
    };
    let power = |row: &Row| {
        let [p1, p2] = row.plant.pressures;
        (p1 * BLIND - p2 * ROD_SIDE) * row.plant.velocity
    };
    let last = rows.len() - 1 - (rows.len() - 1) % 2;
    let gained = energy(&rows[last]) - energy(&rows[0]);
    let came = integral(&rows[..=last], |row| enthalpy(row) - power(row) + heat(coefficient, row));
    let work = integral(&rows[..=last], |row| power(row).abs());
    assert!(work > 9.0, "the piston works: {work} J");
    let heated = integral(&rows[..=last], |row| heat(coefficient, row));
    assert!(coefficient == 0.0 || heated > 0.1, "the walls heat the air: {heated} J");
    assert!((gained - came).abs() < 1e-9 * energy(&rows[0]), "{gained} {came}");
}

/// A row's flows are slopes of masses; these are the flows that the valve's equations give at the same instant, to
/// 0.003 % of what the valve can pass (docs/explanation/agreement.md).
#[test]
fn the_flows_of_a_row_are_those_through_the_valve() {
    let leaks = ["actuator.leakage=laminar", "actuator.leakage_coefficient=1e-9"];
    let lags = [leaks[0], leaks[1], "tubing.lag_s=0.003"];
    for (name, settings) in [
        ("servo-a", &leaks[..]),
        ("servo-a", &lags[..]),
        ("servo-b", &leaks[..]),
        ("servo-b-tuned", &leaks[..]),
        ("servo-c", &leaks[..]),
    ] {
        let rig = rig(name, settings);
        let mut plant = Plant::new(&rig, Accuracy::of(&rig), 0);
        let period = f64::from(rig.period_us().get()) * 1e-6;
        for k in 0..400 {
            let counts = if (k / 40) % 2 == 0 { 600 } else { -600 };
            plant.command(Command { counts, step: counts.signum() as i8, drive_enable: true });
            for part in [0.0, 0.3, 0.45, 0.9] {
                let t = (f64::from(k) + part) * period;
                let row = plant.look(t).expect("a transient");
                for (row, valve) in row.mass_flows.into_iter().zip(plant.solved_flows(t)) {
                    assert!((row - valve).abs() < 3e-7, "{name} {settings:?} at {t} s: {row} {valve}");
                }
            }
            plant.next_sample().expect("a transient");
        }
    }
}
