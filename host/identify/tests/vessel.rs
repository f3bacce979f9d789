//! Conductance and critical ratio from the charge and the discharge of a vessel (ISO 6358-2), as a test bench would find them.

use pneudrive_identify::conductance::{Path, Point};
use pneudrive_sim::trace::Row;
use pneudrive_sim::{Accuracy, Rig, keys, run};

/// m^3, of docs/examples/vessel.toml.
const VOLUME: f64 = 1e-3;

fn vessel(settings: &[&str]) -> (Rig, Vec<Row>) {
    let settings: Vec<String> = settings.iter().map(|text| (*text).to_owned()).collect();
    let text = include_str!("../../../docs/examples/vessel.toml");
    let rig = Rig::read_with("vessel", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
    let rows = run(&rig, Accuracy::of(&rig)).expect("it runs").rows;
    (rig, rows)
}

/// The flow into the vessel from the slope of its pressure, kg/s, with its pressure, Pa: between samples.
fn flows(rig: &Rig, rows: &[Row]) -> Vec<(f64, f64)> {
    let per_slope = VOLUME / (rig.get(&keys::gas::GAS_CONSTANT_J_PER_KG_K) * 293.15);
    let pairs = rows.windows(2).skip(1);
    let flow = |pair: &[Row]| {
        let [before, after] = [0, 1].map(|i| pair[i].plant.pressures[0]);
        (per_slope * (after - before) / (pair[1].time - pair[0].time), 0.5 * (before + after))
    };
    pairs.map(flow).collect()
}

fn assert_within_1_percent(found: &Path) {
    let (sonic, ratio) = (found.sonic_conductance.value / 1.375e-8, found.critical_ratio.value / 0.3);
    println!("C {sonic:.5}, b {ratio:.5} of the true ones, {found:?}");
    assert!((sonic - 1.0).abs() < 0.01 && (ratio - 1.0).abs() < 0.01, "{found:?}");
}

#[test]
fn charging_a_vessel_tells_conductance_and_critical_ratio_within_1_percent() {
    let (rig, rows) = vessel(&[]);
    let supply = rig.get(&keys::supply::PRESSURE_PA);
    let charging = flows(&rig, &rows).into_iter().filter(|(_, pressure)| *pressure < 0.999 * supply);
    let points: Vec<Point> =
        charging.map(|(flow, pressure)| Point::of(flow, [supply, pressure], 293.15)).collect();
    assert_within_1_percent(&Path::through(&points, 0.5).expect("C and b"));
}

#[test]
fn emptying_a_vessel_tells_conductance_and_critical_ratio_within_1_percent() {
    let (rig, rows) =
        vessel(&["test.moves=[[0.0, -2048]]", "test.pressure_1_pa=7e5", "test.pressure_2_pa=7e5"]);
    let outside = rig.get(&keys::exhaust::PRESSURE_PA);
    let emptying = flows(&rig, &rows).into_iter().filter(|(_, pressure)| *pressure > 1.001 * outside);
    let points: Vec<Point> =
        emptying.map(|(flow, pressure)| Point::of(-flow, [pressure, outside], 293.15)).collect();
    assert_within_1_percent(&Path::through(&points, 0.5).expect("C and b"));
}
