//! A single-acting cylinder (`actuator.vented`): the closed forms of one chamber against a spring, its balances, and what is refused.

use pneudrive_sim::plant::Plant;
use pneudrive_sim::{Accuracy, Method, Rig, Run, keys, run};

const SUPPLY: f64 = 300e3;
const OUTSIDE: f64 = 101_300.0;
const STROKE: f64 = 0.3;
const PRELOAD: f64 = 60.0;
const STIFFNESS: f64 = 2000.0;
const BLIND: f64 = std::f64::consts::PI / 4.0 * 0.05 * 0.05;
const ROD_SIDE: f64 = BLIND - std::f64::consts::PI / 4.0 * 0.025 * 0.025;

const SPRING: [&str; 2] =
    ["actuator.return_spring_preload_n=60", "actuator.return_spring_stiffness_n_per_m=2000"];
/// Air extends the piston and a spring retracts it; the other way round.
const PUSHES: [&str; 2] = ["actuator.vented=chamber-2", "actuator.return_spring=retract"];
const PULLS: [&str; 2] = ["actuator.vented=chamber-1", "actuator.return_spring=extend"];
const NO_FRICTION: [&str; 4] = [
    "load.static_extend_n=0",
    "load.coulomb_extend_n=0",
    "load.static_retract_n=0",
    "load.coulomb_retract_n=0",
];
/// Lands that shut tight, and an open loop.
const TIGHT: [&str; 6] = [
    "supply.pressure_pa=300e3",
    "controller.loop=open",
    "operator.dither_mm=0",
    "valve.spool_diameter_mm=10",
    "valve.null_offset_mm=0",
    "load.viscous_n_s_per_m=200",
];
const SHUT: [&str; 3] = ["valve.underlap_mm=0.5", "test.moves=[[0.0, 0]]", "test.duration_s=0.5"];

fn settings(parts: &[&[&str]]) -> Vec<String> {
    parts.concat().iter().map(ToString::to_string).collect()
}

fn read(name: &str, parts: &[&[&str]]) -> Result<Rig, pneudrive_sim::rig::Problems> {
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    Rig::read_with(name, text, &settings(parts))
}

fn rig(name: &str, parts: &[&[&str]]) -> Rig {
    read(name, parts).unwrap_or_else(|problems| panic!("{problems}"))
}

fn simulate(name: &str, parts: &[&[&str]]) -> Run {
    let rig = rig(name, parts);
    run(&rig, Accuracy::of(&rig)).expect("a transient")
}

/// (P_s - P_e) A = F_0 + k y_e. The other chamber keeps the state of the surroundings all the way, and no port feeds it.
#[test]
fn an_open_valve_takes_the_piston_to_where_the_supply_balances_the_spring_and_back() {
    let moves = |sign: i32| format!("test.moves=[[0.0, {}], [1.5, {}]]", sign * 1200, -sign * 1200);
    for (vent, sign, area, vented) in [(PUSHES, 1, BLIND, 1), (PULLS, -1, ROD_SIDE, 0)] {
        let moves = moves(sign);
        let more = [moves.as_str(), "test.duration_s=3.0", "exhaust.temperature_k=285", "tubing.model=none"];
        let run = simulate("servo-b", &[&TIGHT, &NO_FRICTION, &SPRING, &vent, &more]);
        for row in &run.rows {
            let plant = &row.plant;
            assert!((plant.pressures[vented] / OUTSIDE - 1.0).abs() < 1e-12, "{:?}", plant.pressures);
            assert!((plant.temperatures[vented] / 285.0 - 1.0).abs() < 1e-9, "{:?}", plant.temperatures);
            assert_eq!(plant.mass_flows[vented], 0.0);
        }
        let pressed = |at: f64| {
            let row = run.rows.iter().rfind(|row| row.time < at).expect("a row");
            assert!(row.plant.velocity.abs() < 1e-6, "{} m/s at {at} s", row.plant.velocity);
            if sign > 0 { row.plant.position } else { STROKE - row.plant.position }
        };
        let expected = ((SUPPLY - OUTSIDE) * area - PRELOAD) / STIFFNESS;
        assert!((pressed(1.5) - expected).abs() < 1e-6, "{vent:?}: {} m, not {expected}", pressed(1.5));
        // At the end the spring presses the piston into its stop.
        assert!((-2e-4..0.0).contains(&pressed(3.0)), "{vent:?}: {} m", pressed(3.0));
    }
}

/// P_1 A_1 = P_e A_1 + F_0 + k y + F_s,ext: the pressure at which it breaks away as its chamber fills.
#[test]
fn the_load_breaks_away_at_the_pressure_of_spring_and_stiction() {
    let more = [
        "load.static_extend_n=70",
        "load.static_retract_n=70",
        "test.position_m=0.05",
        "test.moves=[[0.0, 400]]",
        "test.duration_s=0.5",
        "test.trace_period_s=1e-5",
    ];
    let run = simulate("servo-b", &[&TIGHT, &SPRING, &PUSHES, &more]);
    let first = run.rows[0].plant;
    let balanced = OUTSIDE + (PRELOAD + STIFFNESS * 0.05) / BLIND;
    assert!((first.pressures[0] - balanced).abs() < 1e-6, "{} Pa", first.pressures[0]);
    let moving = run.rows.iter().position(|row| row.plant.velocity != 0.0).expect("it moves");
    let [before, after] = [moving - 1, moving].map(|i| run.rows[i].plant.pressures[0]);
    let needed = balanced + 70.0 / BLIND;
    assert!((before..=after + 1.0).contains(&needed), "{before} to {after} Pa, not {needed}");
    assert!(moving > 100 && after - before < 100.0, "{moving}: {before} to {after} Pa");
}

/// Internal energy of the one chamber, kinetic energy, that of the spring, and the work on the surroundings: P_e (A_2 + A_R) = P_e A_1.
#[test]
fn a_piston_that_swings_on_one_chamber_keeps_the_energy_of_air_spring_and_surroundings() {
    let more = ["load.viscous_n_s_per_m=0", "test.position_m=0.1", "test.pressure_1_pa=350e3"];
    let rig = rig("servo-b", &[&TIGHT, &SHUT, &NO_FRICTION, &SPRING, &PUSHES, &more]);
    let run = run(&rig, Accuracy { method: Method::DormandPrince, tolerance: 3e-12 }).expect("a transient");
    let energies: Vec<f64> = run
        .rows
        .iter()
        .map(|row| {
            let plant = &row.plant;
            let y = plant.position;
            let internal = plant.pressures[0] * (BLIND * y + 2e-5) / 0.4;
            let spring = PRELOAD * y + 0.5 * STIFFNESS * y * y;
            internal + spring + 0.5 * 1.6 * plant.velocity * plant.velocity + OUTSIDE * BLIND * y
        })
        .collect();
    let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|of| energies.iter().copied().reduce(of).expect("rows"));
    let [near, far] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|of| run.rows.iter().map(|row| row.plant.position).reduce(of).expect("rows"));
    assert!(far - near > 0.02, "it swings: {near} to {far} m");
    assert!((high - low) / high < 1e-9, "{low} to {high} J");
}

/// What has crossed the port of chamber 1, less what has leaked into the vented chamber and out of it, is in chamber 1.
#[test]
fn the_driven_chamber_holds_what_has_crossed_its_port_less_what_leaks_past_the_piston() {
    let more = [
        "actuator.leakage=laminar",
        "actuator.leakage_coefficient=1e-9",
        "valve.upstream_mach=false",
        "test.position_m=0.05",
        "test.moves=[[0.0, 700]]",
        "test.duration_s=0.2",
        "test.trace_period_s=1e-5",
        "operator.static_friction_n=0",
        "operator.coulomb_friction_n=0",
        "operator.hysteresis_percent=0",
    ];
    let rig = rig("servo-b", &[&TIGHT[..3], &TIGHT[5..], &NO_FRICTION, &SPRING, &PUSHES, &more]);
    let run = run(&rig, Accuracy { method: Method::DormandPrince, tolerance: 3e-12 }).expect("a transient");
    let mass = |i: usize| {
        let plant = &run.rows[i].plant;
        plant.pressures[0] * (BLIND * plant.position + 2e-5) / (286.76 * plant.temperatures[0])
    };
    let net = |i: usize| {
        let plant = &run.rows[i].plant;
        plant.mass_flows[0] - 1e-9 * (plant.pressures[0] - plant.pressures[1])
    };
    let last = (run.rows.len() - 1) / 2 * 2;
    let panels = (0..last).step_by(2);
    let crossed: f64 = panels.map(|i| 2e-5 / 6.0 * (net(i) + 4.0 * net(i + 1) + net(i + 2))).sum();
    let gained = mass(last) - mass(0);
    assert!(gained > 1e-4 && ((gained - crossed) / mass(0)).abs() < 1e-8, "{gained} {crossed} kg");
}

/// Of a cylinder with two equal areas either chamber may be vented: extension of one is retraction of the other.
#[test]
fn a_symmetric_cylinder_pulls_as_it_pushes() {
    let of = |vent: [&str; 2], sign: i32| {
        let moves = format!("test.moves=[[0.0, {}], [0.2, {}]]", 900 * sign, -900 * sign);
        let more =
            ["actuator.model=symmetric", "test.position_m=0.15", "test.duration_s=0.5", moves.as_str()];
        let soft = [SPRING[0], "actuator.return_spring_stiffness_n_per_m=500"];
        let open: Vec<&str> = TIGHT.into_iter().filter(|setting| !setting.starts_with("supply")).collect();
        let text = settings(&[&open, &NO_FRICTION, &soft, &vent, &more]);
        let rig = Rig::read_with("symmetric", "", &text).unwrap_or_else(|problems| panic!("{problems}"));
        run(&rig, Accuracy::of(&rig)).expect("a transient")
    };
    let (pushes, pulls) = (of(PUSHES, 1), of(PULLS, -1));
    for (one, other) in pushes.rows.iter().zip(&pulls.rows) {
        let off = one.plant.position - (STROKE - other.plant.position);
        assert!(off.abs() < 1e-7, "{off} m at {} s", one.time);
    }
    assert!(pushes.rows.iter().any(|row| row.plant.position > 0.16), "it moves");
}

#[test]
fn swapped_tubes_join_the_driven_chamber_to_the_other_port() {
    let of = |counts: i32, text: &str| {
        let text = format!(
            "[supply]\npressure_pa = 300e3\n[controller]\nloop = \"open\"\n[operator]\ndither_mm = 0\n[actuator]\nvented = \"chamber-2\"\nreturn_spring = \"retract\"\n[test]\nmoves = [[0.0, {counts}]]\nduration_s = 0.3\n{text}"
        );
        let rig = Rig::read("swapped", &text).unwrap_or_else(|problems| panic!("{problems}"));
        run(&rig, Accuracy::of(&rig)).expect("a transient")
    };
    let swapped = "[[faults.event]]\nkind = \"swapped-tubes\"\nat_s = 0.0\n";
    let (straight, crossed) = (of(700, ""), of(-700, swapped));
    let last = |run: &Run| run.rows.last().expect("rows").plant.position;
    assert!(last(&straight) > 0.11, "{}", last(&straight));
    assert!((last(&straight) - last(&crossed)).abs() < 1e-6, "{} {}", last(&straight), last(&crossed));
}

#[test]
fn an_open_loop_converges_with_the_tolerance_behind_any_valve() {
    let conductance = [
        "valve.characteristic=linear",
        "valve.sonic_conductance_m3_per_s_pa=1e-8",
        "valve.critical_ratio=0.3",
    ];
    let map = [
        "valve.model=flow-map",
        "valve.flow_map=[[0, 700, 140, 4, 1], [0, 700, 560, 3, 1], [100, 700, 140, 800, 9], [100, 700, 560, 500, 9]]",
    ];
    for (name, more) in [
        ("servo-a", &["tubing.lag_s=0.003"][..]),
        ("servo-b", &["valve.model=single-restriction", "valve.discharge_model=perry"]),
        ("servo-b", &["valve.model=multiple-flow-node", "actuator.leakage=adiabatic"]),
        ("servo-b", &["tubing.model=analytical", "actuator.heat_transfer_w_per_m2_k=50"]),
        ("servo-b", &[&["valve.model=iso-6358"], &conductance[..]].concat()),
        ("servo-b", &map),
        ("servo-c", &[]),
    ] {
        let open = [
            "controller.loop=open",
            "test.moves=[[0.0, 600], [0.15, 0], [0.25, -600], [0.4, 0]]",
            "test.duration_s=0.5",
            "actuator.return_spring_preload_n=20",
        ];
        let rig = rig(name, &[&open, &PUSHES, more]);
        let at = |tolerance| run(&rig, Accuracy { tolerance, ..Accuracy::default() }).expect("a transient");
        let exact = at(1e-12);
        let errors = [1e-6, 1e-8, 1e-10].map(|tolerance| {
            let pairs = at(tolerance).rows.into_iter().zip(&exact.rows);
            pairs.map(|(one, other)| (one.plant.position - other.plant.position).abs()).fold(0.0, f64::max)
        });
        println!("{name} {more:?}: {errors:?} m");
        assert!(errors[0] < 1e-5 && errors[1] < 1e-6 && errors[2] < 2e-8, "{name} {more:?}: {errors:?}");
    }
}

#[test]
fn a_closed_loop_positions_against_the_spring() {
    let more = ["test.moves=[[0.0, 12000]]", "test.duration_s=2.0"];
    let rig = rig("servo-b-tuned", &[&PUSHES, &more]);
    let run = run(&rig, Accuracy::of(&rig)).expect("a transient");
    let last = run.rows.last().expect("rows");
    assert_eq!(run.work.network.bracketed, 0, "a plugged port has a solution at once");
    let off = last.plant.position * 1e3 - 12000.0 * 0.01205;
    assert!(off.abs() < 5.0, "{off} mm");
    // The vented chamber reads as the surroundings do, in counts of 12 bits of 1 MPa.
    assert!(run.rows.iter().all(|row| row.observation.pressure_2 == 415));
}

/// Chamber 2 begins where it holds the load, unless it is told otherwise.
#[test]
fn a_test_of_a_cylinder_that_pulls_starts_in_balance() {
    let all = settings(&[&TIGHT, &SHUT, &NO_FRICTION, &SPRING, &PULLS, &["test.position_m=0.2"]]);
    let rig = Rig::read_with("pulls", "", &all).unwrap_or_else(|problems| panic!("{problems}"));
    let balanced = OUTSIDE + (PRELOAD + STIFFNESS * (STROKE - 0.2)) / ROD_SIDE;
    assert!((rig.get(&keys::test::PRESSURE_2_PA) - balanced).abs() < 1e-6);
    let run = run(&rig, Accuracy::of(&rig)).expect("a transient");
    let last = run.rows.last().expect("rows").plant;
    assert!((last.position - 0.2).abs() < 1e-9, "{} m", last.position);
    let path = keys::test::PRESSURE_2_PA.path;
    let other = rig.with_numbers(&[(path, 150e3)]).expect("valid");
    assert_eq!(other.number_at(path), Some(150e3));
    let heavier = rig.with_numbers(&[(keys::load::CONSTANT_FORCE_N.path, 20.0)]).expect("valid");
    assert!((heavier.get(&keys::test::PRESSURE_2_PA) - balanced - 20.0 / ROD_SIDE).abs() < 1e-6);
}

#[test]
fn a_linear_model_has_no_states_of_the_surroundings() {
    let rig = rig("servo-b", &[&SPRING, &PUSHES]);
    let mut plant = Plant::new(&rig, Accuracy::of(&rig), 0);
    plant.next_sample().expect("a sample");
    let model = plant.linearise().expect("linear");
    assert!(model.states.contains(&"pressure_1_pa") && model.states.contains(&"temperature_1_k"));
    assert!(!model.states.contains(&"pressure_2_pa") && !model.states.contains(&"temperature_2_k"));
    let row = model.outputs.iter().position(|name| *name == "pressure_2_pa").expect("an output");
    assert!(model.c[row].iter().all(|slope| *slope == 0.0), "{:?}", model.c[row]);
}

#[test]
fn what_a_vented_chamber_takes_the_effect_from_is_refused_by_key() {
    let refusal = |text: &str| Rig::read("vented", text).expect_err("refused").to_string();
    for (table, line) in [
        ("test", "pressure_2_pa = 300e3"),
        ("test", "temperature_2_k = 300.0"),
        ("actuator", "residual_volume_2_m3 = 3e-5"),
    ] {
        let refusal = refusal(&format!("actuator.vented = \"chamber-2\"\n{table}.{line}\n"));
        assert!(refusal.contains("has no effect with actuator.vented = \"chamber-2\""), "{line}: {refusal}");
    }
    let weight = refusal("actuator.vented = \"chamber-2\"\nload.incline_deg = -90.0\nload.mass_kg = 30.0\n");
    assert!(weight.contains("the cylinder holds 0 N at most"), "{weight}");
    let event =
        "[actuator]\nvented = \"chamber-2\"\n[[faults.event]]\nkind = \"leak\"\nat_s = 0.1\nchamber = 2\n";
    let leak = refusal(event);
    assert!(leak.contains("chamber = 2 is vented"), "{leak}");
    let press = include_str!("cascade/press.toml");
    let cascade = Rig::read_with("press", press, &["actuator.vented=chamber-2".to_owned()]);
    let cascade = cascade.expect_err("refused").to_string();
    assert!(cascade.contains("needs actuator.vented = \"none\""), "{cascade}");
}
