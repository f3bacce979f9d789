//! Every pair of component models in one drive: a step of the valve runs to its end, the air stays
//! air, and none of it is lost.

use pneudrive_sim::trace::Row;
use pneudrive_sim::{Accuracy, Rig, Run, run};

const OPERATORS: [&[&str]; 4] = [
    &["operator.model=solenoid"],
    &["operator.model=solenoid-empirical"],
    &["operator.model=stepper"],
    &["operator.model=on-off", "operator.switch_time_s=0.01"],
];

const VALVES: [&[&str]; 5] = [
    &["valve.model=flow-node"],
    &["valve.model=single-restriction"],
    &["valve.model=multiple-flow-node"],
    &["valve.model=iso-6358", "valve.sonic_conductance_m3_per_s_pa=3e-8", "valve.critical_ratio=0.35"],
    &["valve.model=flow-node", "valve.discharge_model=perry", "valve.upstream_mach=false"],
];

const TUBES: [&[&str]; 4] = [
    &["tubing.model=empirical"],
    &["tubing.model=analytical"],
    &["tubing.model=none"],
    &["tubing.lag_s=0.001"],
];

const LEAKAGES: [&[&str]; 3] = [
    &["actuator.leakage=none"],
    &["actuator.leakage=laminar", "actuator.leakage_coefficient=5e-10"],
    &["actuator.leakage=adiabatic"],
];

const FLOW_FORCES: [&[&str]; 3] =
    [&["valve.flow_force=none"], &["valve.flow_force=experimental"], &["valve.flow_force=analytical"]];

const STEP: [&str; 3] =
    ["controller.loop=open", "test.moves=[[0.0, 0], [0.02, 1200], [0.2, -1200]]", "test.duration_s=0.3"];

fn simulate(settings: &[&str]) -> Run {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig = Rig::read_with("catalogue", "", &settings)
        .unwrap_or_else(|problems| panic!("{settings:?}: {problems}"));
    run(&rig, Accuracy { tolerance: 1e-8, ..Accuracy::default() })
        .unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

/// Each model of each family with each of every other: all operators, valves and tubes,
/// leakages and flow forces going round.
fn drives() -> Vec<Vec<&'static str>> {
    let of = |family: &[&'static [&'static str]], i: usize| family[i % family.len()].to_vec();
    let mut drives = Vec::new();
    for operator in 0..OPERATORS.len() {
        for valve in 0..VALVES.len() {
            for i in 0..TUBES.len() {
                let (leakage, force) = (operator + valve + i, operator + 2 * valve + i + i / 3);
                let mut settings = of(&OPERATORS, operator);
                settings.extend(of(&VALVES, valve));
                settings.extend(of(&TUBES, i));
                settings.extend(of(&LEAKAGES, leakage));
                settings.extend(of(&FLOW_FORCES, force));
                drives.push(settings);
            }
        }
    }
    drives
}

fn mass(row: &Row) -> f64 {
    let blind = std::f64::consts::PI / 4.0 * 0.05 * 0.05;
    let rod_side = blind - std::f64::consts::PI / 4.0 * 0.025 * 0.025;
    let volumes = [blind * row.plant.position + 2e-5, rod_side * (0.3 - row.plant.position) + 2e-5];
    (0..2).map(|i| row.plant.pressures[i] * volumes[i] / (286.76 * row.plant.temperatures[i])).sum()
}

/// Mass gained while the command stands (a stepper has walked there by 0.08 s), and what the ports passed.
fn balance(run: &Run, from: f64, until: f64) -> (f64, f64) {
    let rows: Vec<&Row> = run.rows.iter().filter(|row| row.time >= from && row.time <= until).collect();
    let flow = |row: &Row| row.plant.mass_flows.iter().sum::<f64>();
    let crossed =
        rows.windows(2).map(|pair| (pair[1].time - pair[0].time) * 0.5 * (flow(pair[0]) + flow(pair[1])));
    (mass(rows[rows.len() - 1]) - mass(rows[0]), crossed.sum())
}

#[test]
fn every_pair_of_models_runs_and_keeps_its_air() {
    for settings in drives() {
        let run = simulate(&[&STEP[..], &settings, &["test.trace_period_s=2e-5"]].concat());
        for row in &run.rows {
            let plant = &row.plant;
            assert!(row.values().iter().all(|value| value.is_finite()), "{settings:?} {}", row.time);
            // Isentropic from 400 kPa and 294 K to the surroundings is 199 K.
            assert!(plant.temperatures.iter().all(|t| (150.0..450.0).contains(t)), "{settings:?} {plant:?}");
            assert!(plant.pressures.iter().all(|p| (9e4..8e5).contains(p)), "{settings:?} {plant:?}");
        }
        let (gained, crossed) = balance(&run, 0.08, 0.19);
        assert!((gained - crossed).abs() < 1e-6 * mass(&run.rows[0]), "{settings:?}: {gained} {crossed}");
        assert!(run.rows.iter().any(|row| row.plant.velocity > 0.05), "{settings:?}: it moves");
    }
}

const BY_DATA_SHEET: [&str; 3] =
    ["valve.model=iso-6358", "valve.sonic_conductance_m3_per_s_pa=3e-8", "valve.critical_ratio=0.35"];

/// Valves that are known by their flows.
fn known_by_flows() -> Vec<Vec<String>> {
    let owned = |settings: &[&str]| settings.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>();
    let of_data_sheet = |more: &[&str]| [owned(&BY_DATA_SHEET), owned(more)].concat();
    let map: Vec<String> = [-20.0, 0.0, 10.0, 40.0, 100.0]
        .iter()
        .flat_map(|spool: &f64| {
            [0.2, 0.5, 0.7, 0.85, 0.95].map(|ratio: f64| {
                let share = (spool / 100.0).max(0.01);
                format!(
                    "[{spool}, 700, {}, {}, 5]",
                    700.0 * ratio,
                    1260.0 * share * (1.0 - ratio * ratio).sqrt()
                )
            })
        })
        .collect();
    vec![
        of_data_sheet(&[
            "valve.characteristic=linear",
            "valve.leakage_percent=1",
            "valve.subsonic_index=0.55",
        ]),
        of_data_sheet(&[
            "valve.characteristic=linear",
            "valve.exhaust_sonic_conductance_m3_per_s_pa=4e-8",
            "valve.exhaust_critical_ratio=0.2",
        ]),
        of_data_sheet(&[
            "valve.characteristic=linear",
            "valve.underlap_mm=0.05",
            "valve.subsonic_index=0.42",
        ]),
        of_data_sheet(&[
            "valve.characteristic=table",
            "valve.characteristic_table=[[-3.0, 0.5], [0.0, 1.0], [5.0, 3.0], [50.0, 60.0], [100.0, 100.0]]",
        ]),
        vec!["valve.model=flow-map".to_owned(), format!("valve.flow_map=[{}]", map.join(", "))],
    ]
}

/// Tight lands and overlaps too, on which nothing leaks.
#[test]
fn valves_that_are_known_by_their_flows_run_with_every_operator_and_tube() {
    for (i, valve) in known_by_flows().iter().enumerate() {
        for (j, operator) in OPERATORS.iter().enumerate() {
            let settings: Vec<&str> =
                valve.iter().map(String::as_str).chain(operator.iter().copied()).collect();
            let settings = [&settings[..], TUBES[(i + j) % TUBES.len()]].concat();
            let run = simulate(&[&STEP[..], &settings, &["test.trace_period_s=2e-5"]].concat());
            assert!(
                run.rows.iter().all(|row| row.values().iter().all(|value| value.is_finite())),
                "{settings:?}"
            );
            let (gained, crossed) = balance(&run, 0.08, 0.19);
            assert!((gained - crossed).abs() < 1e-6 * mass(&run.rows[0]), "{settings:?}: {gained} {crossed}");
            assert!(run.rows.iter().any(|row| row.plant.velocity > 0.05), "{settings:?}: it moves");
        }
    }
}

/// When the piston has gone 20 mm.
fn arrival(settings: &[&str]) -> f64 {
    let run = simulate(&[&STEP[..], &["operator.dither_mm=0"], settings].concat());
    let start = run.rows[0].plant.position;
    let row = run.rows.iter().find(|row| row.plant.position > start + 0.02);
    row.unwrap_or_else(|| panic!("{settings:?}: it moves")).time
}

/// Thesis 7.2.1 and 7.3: every drop of pressure between supply and cylinder costs time.
#[test]
fn each_restriction_between_supply_and_cylinder_makes_the_drive_slower() {
    let at_rest = "valve.upstream_mach=false";
    let tubed = arrival(&["valve.model=flow-node", "tubing.model=empirical", at_rest]);
    let connector = arrival(&["valve.model=multiple-flow-node", at_rest]);
    let bare = arrival(&["valve.model=flow-node", "tubing.model=none", at_rest]);
    let no_node = arrival(&["valve.model=single-restriction", "tubing.model=none", at_rest]);
    assert!(no_node < bare && bare < connector && connector < tubed, "{no_node} {bare} {connector} {tubed}");
}

/// Thesis 6.4.3: the force of the flow closes the valve, so that a coil opens it less.
#[test]
fn flow_forces_hold_the_spool_back() {
    let opening = |force: &str| {
        let run = simulate(&[&STEP[..], &["operator.dither_mm=0", force]].concat());
        run.rows.iter().filter(|row| row.time < 0.2).map(|row| row.plant.spool).fold(0.0, f64::max)
    };
    let [none, experimental, analytical] =
        ["none", "experimental", "analytical"].map(|force| opening(&format!("valve.flow_force={force}")));
    assert!(experimental < none && analytical < none, "{none} {experimental} {analytical}");
}

/// 6.54: C(54) takes the upstream Mach numbers from all to none. Air that has a speed at a port passes it faster.
#[test]
fn the_turbulence_coefficient_leads_from_upstream_mach_numbers_to_none() {
    let of = |turbulence: &str| arrival(&[turbulence, "test.trace_period_s=1e-5"]);
    let [all, half, few] = [1.0, 0.5, 0.1].map(|c| of(&format!("valve.turbulence={c}")));
    let none = of("valve.upstream_mach=false");
    assert!(all < half && half < few && few < none, "{all} {half} {few} {none} s");
    let rows = |setting: &str| -> Vec<_> {
        simulate(&[&STEP[..], &[setting]].concat()).rows.iter().map(|row| row.plant).collect()
    };
    assert_eq!(rows("valve.turbulence=0"), rows("valve.upstream_mach=false"));
}

/// 6.3.3: "The open loop function is available for all controller modules." A continuous one drives at once what a
/// sampled one drives a microsecond later.
#[test]
fn the_continuous_controller_passes_the_commands_of_an_open_loop() {
    for operator in ["operator.model=solenoid", "operator.model=solenoid-empirical"] {
        let of = |model: &str| {
            let settings = ["controller.delay_s=1e-6", "operator.dither_mm=0", operator, model];
            simulate(&[&STEP[..], &settings].concat()).rows
        };
        let (continuous, sampled) = (of("controller.model=continuous"), of("controller.model=sampled"));
        assert_eq!(continuous.len(), sampled.len());
        for (one, other) in continuous.iter().zip(&sampled) {
            assert_eq!(one.observation.command, other.observation.command, "at {} s", one.time);
            let apart = (one.plant.position - other.plant.position).abs();
            assert!(
                apart < 2e-6 * one.plant.velocity.abs().max(1.0),
                "{operator}: {apart} m at {} s",
                one.time
            );
        }
        let farthest = continuous.iter().map(|row| row.plant.position).fold(0.0, f64::max);
        assert!(farthest > continuous[0].plant.position + 0.02, "{operator}: it moves");
    }
}
