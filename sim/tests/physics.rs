//! The drive against physics that nobody here invented.

use pneudrive_sim::{Accuracy, Rig, Run, run};

const GAMMA: f64 = 1.4;
const BLIND: f64 = std::f64::consts::PI / 4.0 * 0.05 * 0.05;
const ROD_SIDE: f64 = BLIND - std::f64::consts::PI / 4.0 * 0.025 * 0.025;

fn simulate(settings: &[&str]) -> Run {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig = Rig::read_with("test", "", &settings).unwrap_or_else(|problems| panic!("{problems}"));
    run(&rig, Accuracy::of(&rig)).expect("a transient")
}

/// A cylinder with all ports shut (a spool without clearance, overlapped), no friction, and a force
/// that pushes the piston out of its equilibrium.
fn shut_cylinder() -> Run {
    simulate(&[
        "controller.loop=open",
        "test.moves=[[0.0, 0]]",
        "test.duration_s=0.5",
        "test.pressure_1_pa=325325",
        "operator.dither_mm=0",
        "valve.spool_diameter_mm=10",
        "valve.underlap_mm=0.5",
        "load.constant_force_n=300",
        "load.viscous_n_s_per_m=0",
        "load.static_extend_n=0",
        "load.coulomb_extend_n=0",
        "load.static_retract_n=0",
        "load.coulomb_retract_n=0",
    ])
}

fn volumes(position: f64) -> [f64; 2] {
    [BLIND * position + 2e-5, ROD_SIDE * (0.3 - position) + 2e-5]
}

fn spread(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let high = values.clone().fold(f64::NEG_INFINITY, f64::max);
    let low = values.fold(f64::INFINITY, f64::min);
    (high - low) / high
}

#[test]
fn air_that_is_shut_in_is_compressed_with_p_v_to_the_1_4_constant() {
    let run = shut_cylinder();
    let travel = spread(run.rows.iter().map(|row| row.plant.position));
    assert!(travel > 0.05, "the piston swings: {travel}");
    for chamber in 0..2 {
        let constants = run
            .rows
            .iter()
            .map(|row| row.plant.pressures[chamber] * volumes(row.plant.position)[chamber].powf(GAMMA));
        assert!(spread(constants.clone()) < 1e-8, "chamber {chamber}: {:e}", spread(constants));
    }
}

#[test]
fn air_that_is_shut_in_keeps_its_mass() {
    let run = shut_cylinder();
    for chamber in 0..2 {
        let masses = run.rows.iter().map(|row| {
            let (p, t) = (row.plant.pressures[chamber], row.plant.temperatures[chamber]);
            p * volumes(row.plant.position)[chamber] / (286.76 * t)
        });
        assert!(spread(masses.clone()) < 1e-12, "chamber {chamber}: {:e}", spread(masses));
    }
}

/// Internal energy of both chambers, kinetic energy, and the work of the force and of the
/// surroundings on the rod.
#[test]
fn a_swinging_piston_without_friction_keeps_its_energy() {
    let run = shut_cylinder();
    let energies = run.rows.iter().map(|row| {
        let plant = &row.plant;
        let [v1, v2] = volumes(plant.position);
        let internal = (plant.pressures[0] * v1 + plant.pressures[1] * v2) / (GAMMA - 1.0);
        let kinetic = 0.5 * 1.6 * plant.velocity * plant.velocity;
        let outside = (101_300.0 * (BLIND - ROD_SIDE) - 300.0) * plant.position;
        internal + kinetic + outside
    });
    assert!(spread(energies.clone()) < 1e-9, "{:e}", spread(energies));
}

/// A valve that stays open fills or empties a chamber whose piston rests on its stop until the flow
/// ends: at supply or exhaust pressure.
#[test]
fn an_open_valve_takes_the_chambers_to_supply_and_exhaust() {
    let run = simulate(&[
        "controller.loop=open",
        "test.moves=[[0.0, 2048]]",
        "test.duration_s=12",
        "operator.dither_mm=0",
        "valve.spool_diameter_mm=10",
        "valve.upstream_mach=false",
    ]);
    let last = run.rows.last().expect("rows").plant;
    assert!((last.pressures[0] - 589e3).abs() < 10.0, "{}", last.pressures[0]);
    assert!((last.pressures[1] - 101.3e3).abs() < 10.0, "{}", last.pressures[1]);
    assert!(last.position > 0.3 && last.position < 0.302, "on its stop: {}", last.position);
    // The last of the air creeps in (EQUATIONS section 3), and the piston follows it into its stop: its
    // velocity dies away, and has no instant at which it is zero.
    assert!(last.velocity.abs() < 1e-15, "{}", last.velocity);
}

/// EQUATIONS section 1, 6.54: a supply without a tube and the surroundings are at rest. Once their air
/// came at the speed of its own flow, and a full chamber left the flows without a solution.
#[test]
fn with_upstream_mach_numbers_an_open_valve_without_a_supply_tube_fills_and_empties_the_chambers() {
    for (tubing, valve) in [("none", "flow-node"), ("empirical", "multiple-flow-node")] {
        let run = simulate(&[
            "controller.loop=open",
            "test.moves=[[0.0, 2048]]",
            "test.duration_s=2",
            "test.pressure_1_pa=50000",
            "operator.dither_mm=0",
            &format!("tubing.model={tubing}"),
            &format!("valve.model={valve}"),
        ]);
        let last = run.rows.last().expect("rows").plant;
        // The clearance of the shut edges feeds the one and empties the other a little.
        assert!((last.pressures[0] - 589e3).abs() < 100.0, "{valve}: {}", last.pressures[0]);
        assert!((last.pressures[1] - 101.3e3).abs() < 100.0, "{valve}: {}", last.pressures[1]);
    }
}

/// Leakage equalises the chambers of a locked cylinder (6.26): the difference decays, the mass of
/// both together stays.
#[test]
fn leakage_moves_air_from_one_chamber_to_the_other_and_loses_none() {
    let run = simulate(&[
        "controller.loop=open",
        "test.moves=[[0.0, 0]]",
        "test.duration_s=2",
        "test.pressure_1_pa=500000",
        "test.pressure_2_pa=200000",
        "operator.dither_mm=0",
        "valve.spool_diameter_mm=10",
        "valve.underlap_mm=0.5",
        "load.static_extend_n=9000",
        "load.static_retract_n=9000",
        "actuator.leakage=laminar",
        "actuator.leakage_coefficient=1e-9",
    ]);
    let difference = |row: &pneudrive_sim::trace::Row| row.plant.pressures[0] - row.plant.pressures[1];
    let (first, last) = (&run.rows[0], run.rows.last().expect("rows"));
    assert!(difference(last) < 0.2 * difference(first) && difference(last) > 0.0);
    let masses = run.rows.iter().map(|row| {
        let volumes = volumes(row.plant.position);
        (0..2).map(|i| row.plant.pressures[i] * volumes[i] / (286.76 * row.plant.temperatures[i])).sum()
    });
    assert!(spread(masses.clone()) < 1e-12, "{:e}", spread(masses));
}

/// A held load does not creep: its velocity is zero, not small.
#[test]
fn a_load_inside_its_stiction_band_is_held_exactly() {
    let run = simulate(&["controller.loop=open", "test.moves=[[0.0, 0]]", "test.duration_s=0.2"]);
    for row in &run.rows {
        assert_eq!((row.plant.velocity, row.plant.acceleration), (0.0, 0.0));
        assert_eq!(row.plant.position, 98.719_625e-3);
        assert!((-40.0..=70.0).contains(&row.plant.friction), "{}", row.plant.friction);
    }
}

/// What is left of the default tolerance in a run that is not chaotic: a tenth of it changes nothing
/// that could be measured.
#[test]
fn a_tenth_of_the_tolerance_changes_the_position_by_less_than_a_nanometre() {
    let settings =
        ["controller.loop=open", "test.moves=[[0.0, 0], [0.1, 512], [0.5, -512]]", "test.duration_s=0.9"];
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig = Rig::read_with("test", "", &settings).expect("valid");
    let at = |tolerance| run(&rig, Accuracy { tolerance, ..Accuracy::default() }).expect("a transient").rows;
    let (default, tenth) = (at(1e-11), at(1e-12));
    let farthest = default.iter().zip(&tenth).map(|(a, b)| (a.plant.position - b.plant.position).abs());
    assert!(farthest.clone().fold(0.0, f64::max) < 1e-9, "{:e}", farthest.fold(0.0, f64::max));
}
