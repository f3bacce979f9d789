//! One-way flow controls at the ports of the cylinder (`tubing.flow_control`): the speed that they set, and the directions.

use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::component::valve::iso6358::Iso6358;
use pneudrive_sim::trace::Extra;
use pneudrive_sim::{Accuracy, Recording, Rig, Run, run, run_recorded};

const GAS_CONSTANT: f64 = 286.76;
const ROD_SIDE: f64 = std::f64::consts::PI / 4.0 * (0.05 * 0.05 - 0.025 * 0.025);
/// C rho_0 sqrt(T_0) of 1 nm^3/(s Pa), kg sqrt(K)/(s Pa).
const CHOKED: f64 = 1e-9 * 1.185;

fn settings(parts: &[&[&str]]) -> Vec<String> {
    parts.concat().iter().map(ToString::to_string).collect()
}

fn rig(parts: &[&[&str]]) -> Rig {
    Rig::read_with("controlled", "", &settings(parts)).unwrap_or_else(|problems| panic!("{problems}"))
}

fn simulate(parts: &[&[&str]]) -> Run {
    let rig = rig(parts);
    run(&rig, Accuracy::of(&rig)).expect("a transient")
}

/// A wide valve by its conductance right at the cylinder, opened to either side.
const VALVE: [&str; 9] = [
    "valve.model=iso-6358",
    "valve.characteristic=linear",
    "valve.sonic_conductance_m3_per_s_pa=2e-8",
    "valve.critical_ratio=0.3",
    "tubing.model=none",
    "controller.loop=open",
    "operator.dither_mm=0",
    "test.position_m=0.02",
    "test.duration_s=1.2",
];
const OUT: &str = "tubing.flow_control=meter-out";
const IN: &str = "tubing.flow_control=meter-in";
const NARROW: [&str; 3] = [
    "tubing.flow_control_1_conductance_m3_per_s_pa=1e-9",
    "tubing.flow_control_2_conductance_m3_per_s_pa=1e-9",
    "tubing.flow_control_critical_ratio=0.4",
];
const EXTEND: &str = "test.moves=[[0.0, 2000]]";

/// A chamber whose pressure and temperature stay is emptied by its piston alone: P A v/(R T) leaves it, and through a choked throttle
/// that is C rho_0 P sqrt(T_0/T). So v = C rho_0 R sqrt(T_0 T)/A, whatever the pressure. A choked flow comes out right to 0.5 %
/// (sim/src/component/tubing.rs).
#[test]
fn a_throttle_behind_a_chamber_sets_the_speed_by_its_conductance_alone() {
    let run = simulate(&[&VALVE, &NARROW, &[OUT, EXTEND]]);
    let steady = run.rows.iter().filter(|row| (0.6..1.0).contains(&row.time));
    for row in steady.clone() {
        let plant = &row.plant;
        let [_, temperature] = plant.temperatures;
        // What is left of changes of the pressure: V P'/(n P A), by the flow that does leave.
        let leaves = -plant.mass_flows[1] * GAS_CONSTANT * temperature / (plant.pressures[1] * ROD_SIDE);
        let expected = CHOKED * GAS_CONSTANT * (293.15 * temperature).sqrt() / ROD_SIDE;
        assert!((leaves / expected - 1.0).abs() < 5e-3, "{} s: {leaves} m/s, not {expected}", row.time);
        assert!((plant.velocity / expected - 1.0).abs() < 0.03, "{} s: {} m/s", row.time, plant.velocity);
    }
    assert!(steady.count() > 100);
}

/// The other way is free: retraction empties chamber 1, whose throttle is wide here, as fast as without flow controls.
#[test]
fn each_throttle_acts_on_the_air_of_its_own_chamber_and_one_way() {
    let wide = ["tubing.flow_control_1_conductance_m3_per_s_pa=1e-6", NARROW[1], NARROW[2]];
    let until = |parts: &[&[&str]], begin: &str, there: &dyn Fn(f64) -> bool| {
        let run = simulate(&[&[&VALVE, parts.concat().as_slice()].concat(), &[begin]]);
        run.rows.iter().find(|row| there(row.plant.position)).map_or(f64::INFINITY, |row| row.time)
    };
    let extends = |parts: &[&[&str]]| until(parts, EXTEND, &|y| y > 0.2);
    let retracts = |parts: &[&[&str]]| {
        until(&[&parts.concat(), &["test.position_m=0.28"]], "test.moves=[[0.0, -2000]]", &|y| y < 0.1)
    };
    let (free_out, free_back) = (extends(&[]), retracts(&[]));
    // Chamber 2 is narrow: meter-out slows the extension, which empties it, and meter-in the retraction, which charges it.
    let (out, back) = (extends(&[&wide, &[OUT]]), retracts(&[&wide, &[OUT]]));
    assert!(out > 2.5 * free_out && back < 1.02 * free_back, "{out} {free_out}, {back} {free_back} s");
    let (out, back) = (extends(&[&wide, &[IN]]), retracts(&[&wide, &[IN]]));
    assert!(out < 1.02 * free_out && back > 2.5 * free_back, "{out} {free_out}, {back} {free_back} s");
}

/// Between valve and chamber there is no other loss: of small and of choked flows.
#[test]
fn what_leaves_a_chamber_is_the_flow_of_the_throttle_between_chamber_and_valve() {
    let more = [OUT, "test.moves=[[0.0, 150], [0.3, -900], [0.6, 2000]]"];
    let rig = rig(&[&VALVE, &NARROW, &more]);
    let run = run_recorded(&rig, Accuracy::of(&rig), Recording { valve: true }, |_, _| {}).expect("runs");
    let gas = Gas::of(&rig);
    let throttle = Iso6358 { sonic_conductance: 1e-9, critical_ratio: 0.4, subsonic_index: 0.5 };
    let port = ["port_pressure_1_pa", "port_pressure_2_pa"].map(|name| Extra::named(name).expect("a column"));
    let mut ratios = Vec::new();
    for row in &run.rows {
        for (i, port) in port.iter().enumerate() {
            let (chamber, valve) = (row.plant.pressures[i], port.value(row));
            let leaves = -row.plant.mass_flows[i];
            if leaves > 1e-5 {
                let passes = throttle.flow(&gas, chamber, row.plant.temperatures[i], valve);
                assert!(
                    (leaves - passes).abs() < 3e-7 + 5e-3 * passes,
                    "{} s: {leaves} {passes} kg/s",
                    row.time
                );
                ratios.push(valve / chamber);
            } else if leaves < -1e-5 {
                assert!((valve / chamber - 1.0).abs() < 1e-9, "{} s: a free way", row.time);
            }
        }
    }
    let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|of| ratios.iter().copied().reduce(of).expect("flows"));
    assert!(low < 0.4 && high > 0.9, "{low} to {high}");
}

#[test]
fn an_open_loop_converges_with_the_tolerance() {
    let [others, by_conductance] = [&VALVE[4..], &VALVE[..]];
    for (setting, valve, more) in [
        (OUT, by_conductance, &[][..]),
        (IN, by_conductance, &["actuator.vented=chamber-2", "actuator.return_spring=retract"]),
        (OUT, others, &["valve.model=flow-node"]),
        (IN, others, &["valve.model=flow-node", "supply.temperature_k=280"]),
        (OUT, others, &["valve.model=single-restriction"]),
    ] {
        let open =
            ["test.moves=[[0.0, 600], [0.15, 0], [0.25, -900], [0.4, 0]]", "test.duration_s=0.5", setting];
        let rig = rig(&[valve, &open, more]);
        let at = |tolerance| run(&rig, Accuracy { tolerance, ..Accuracy::default() }).expect("a transient");
        let exact = at(1e-12);
        let errors = [1e-6, 1e-8, 1e-10].map(|tolerance| {
            let pairs = at(tolerance).rows.into_iter().zip(&exact.rows);
            pairs.map(|(one, other)| (one.plant.position - other.plant.position).abs()).fold(0.0, f64::max)
        });
        println!("{setting} {more:?}: {errors:?} m, {:?}", exact.work);
        assert!(errors[0] < 1e-5 && errors[1] < 1e-6 && errors[2] < 2e-8, "{setting} {more:?}: {errors:?}");
    }
}

/// A flow control stays with its chamber.
#[test]
fn swapped_tubes_take_their_flow_controls_along() {
    let of = |counts: i32, fault: &str| {
        let text = format!(
            "[valve]\nmodel = \"iso-6358\"\ncharacteristic = \"linear\"\nsonic_conductance_m3_per_s_pa = 2e-8\ncritical_ratio = 0.3\n[tubing]\nmodel = \"none\"\nflow_control = \"meter-out\"\nflow_control_2_conductance_m3_per_s_pa = 1e-9\n[controller]\nloop = \"open\"\n[operator]\ndither_mm = 0\n[test]\nmoves = [[0.0, {counts}]]\nduration_s = 0.4\n{fault}"
        );
        let rig = Rig::read("swapped", &text).unwrap_or_else(|problems| panic!("{problems}"));
        run(&rig, Accuracy::of(&rig)).expect("a transient").rows.last().expect("rows").plant.position
    };
    let fault = "[[faults.event]]\nkind = \"swapped-tubes\"\nat_s = 0.0\n";
    let (straight, crossed, back) = (of(1500, ""), of(-1500, fault), of(1500, fault));
    assert!(straight > 0.11 && (straight - crossed).abs() < 1e-6, "{straight} {crossed}");
    assert!(back < 0.05, "{back}");
}

#[test]
fn flow_controls_behind_tubes_are_refused_by_key() {
    let refused = |text: &str| Rig::read("controlled", text).expect_err("refused").to_string();
    let behind = refused("tubing.flow_control = \"meter-out\"\n");
    assert!(behind.contains("has no effect with tubing.model = \"empirical\""), "{behind}");
    let vented = refused(
        "tubing.model = \"none\"\ntubing.flow_control = \"meter-in\"\ntubing.flow_control_2_conductance_m3_per_s_pa = 1e-9\nactuator.vented = \"chamber-2\"\n",
    );
    assert!(vented.contains("has no effect with actuator.vented = \"chamber-2\""), "{vented}");
    let press = include_str!("cascade/press.toml");
    let cascade = Rig::read_with("press", press, &[OUT.to_owned()]).expect_err("refused").to_string();
    assert!(cascade.contains("needs tubing.flow_control = \"none\""), "{cascade}");
}
