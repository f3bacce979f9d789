//! Rigs at the edge of what anybody builds, drawn at random: cylinders from 8 to 320 mm, dead volumes from a thousandth of
//! the stroke on, stops and bristles of any stiffness, tubes of any kind, supplies up to 25 bar.

mod draw;
pub mod every_key;

use pneudrive_sim::Rig;
use pneudrive_sim::rig::Problems;

use draw::Draw;

/// The cylinder, and what follows from it.
struct Size {
    area: f64,
    stroke: f64,
    push: f64,
    supply: f64,
    exhaust: f64,
}

/// The rig of a seed, as `rig check` sees it.
pub fn rig(seed: u64) -> Result<Rig, Problems> {
    let settings = settings(seed);
    Rig::read_with("extreme", "name = \"extreme\"\n", &settings)
}

/// The settings of a seed, as `key=value`.
pub fn settings(seed: u64) -> Vec<String> {
    let mut draw = Draw::of(seed);
    let mut all = Vec::new();
    let size = cylinder(&mut draw, &mut all);
    load(&mut draw, &size, &mut all);
    valve(&mut draw, &size, &mut all);
    tubing(&mut draw, &size, &mut all);
    operator(&mut draw, &mut all);
    test(&mut draw, &size, &mut all);
    all
}

fn set(all: &mut Vec<String>, key: &str, value: f64) {
    all.push(format!("{key}={value:?}"));
}

fn word(all: &mut Vec<String>, key: &str, value: &str) {
    all.push(format!("{key}={value}"));
}

fn cylinder(draw: &mut Draw, all: &mut Vec<String>) -> Size {
    let bore = draw.one_of(&[0.008, 0.012, 0.025, 0.05, 0.1, 0.2, 0.32]);
    let (stroke, exhaust) = (bore * draw.decades(0.5, 20.0), draw.one_of(&[80e3, 101_325.0, 101_325.0, 3e5]));
    let supply = exhaust + draw.decades(1e5, 22e5);
    let area = std::f64::consts::PI / 4.0 * bore * bore;
    word(all, "actuator.model", draw.one_of(&["asymmetric", "symmetric"]));
    set(all, "actuator.bore_m", bore);
    set(all, "actuator.stroke_m", stroke);
    set(all, "actuator.rod_diameter_m", bore * draw.between(0.15, 0.6));
    for chamber in ["1", "2"] {
        set(all, &format!("actuator.residual_volume_{chamber}_m3"), area * stroke * draw.decades(1e-3, 1.0));
    }
    set(all, "actuator.heat_transfer_w_per_m2_k", draw.one_of(&[0.0, 50.0, 1000.0]));
    set(all, "exhaust.pressure_pa", exhaust);
    set(all, "supply.pressure_pa", supply);
    set(all, "supply.temperature_k", draw.one_of(&[250.0, 293.15, 350.0]));
    Size { area, stroke, push: area * (supply - exhaust), supply, exhaust }
}

fn load(draw: &mut Draw, size: &Size, all: &mut Vec<String>) {
    set(all, "load.mass_kg", size.push / 9.81 * draw.decades(1e-3, 1.0));
    set(all, "load.viscous_n_s_per_m", draw.one_of(&[0.0, 1.0, 30.0, 300.0]));
    set(all, "load.stop_stiffness_n_per_m", size.push / size.stroke * draw.decades(1e2, 1e6));
    set(all, "load.stop_region_m", draw.decades(1e-5, 1e-3));
    set(all, "load.incline_deg", draw.one_of(&[0.0, 0.0, 30.0, 90.0, -90.0]));
    set(all, "load.spring_n_per_m", draw.one_of(&[0.0, 100.0]));
    let coulomb = size.push * draw.one_of(&[0.0, 0.01, 0.1]);
    for direction in ["extend", "retract"] {
        set(all, &format!("load.coulomb_{direction}_n"), coulomb);
        set(all, &format!("load.static_{direction}_n"), coulomb * draw.between(1.0, 2.0));
    }
    if coulomb > 0.0 && draw.unit() < 0.5 {
        word(all, "load.friction", "lugre");
        set(all, "load.bristle_stiffness_n_per_m", draw.decades(1e4, 1e7));
    }
}

fn valve(draw: &mut Draw, size: &Size, all: &mut Vec<String>) {
    let model = draw.one_of(&[
        "single-restriction",
        "flow-node",
        "multiple-flow-node",
        "iso-6358",
        "iso-6358",
        "iso-6358",
    ]);
    word(all, "valve.model", model);
    word(all, "valve.flow_force", "none");
    // A piston as fast as one to ten strokes a second at the most, by C in m3/(s Pa).
    let conductance = (size.area * size.stroke * draw.decades(0.3, 10.0) / 1e5).clamp(1e-11, 1e-6);
    if model == "iso-6358" {
        word(all, "valve.characteristic", "linear");
        set(all, "valve.sonic_conductance_m3_per_s_pa", conductance);
        set(all, "valve.critical_ratio", draw.one_of(&[0.0, 0.2, 0.35, 0.5]));
        set(all, "valve.leakage_percent", draw.one_of(&[0.0, 0.1, 5.0]));
        set(all, "valve.underlap_mm", draw.one_of(&[-0.02, 0.0, 0.05]));
    } else {
        let port = (conductance / 1.2e-9).sqrt().clamp(0.05, 60.0);
        set(all, "valve.port_diameter_mm", port);
        for (key, times) in [("sleeve", 3.0), ("spool", 3.0), ("spool_rod", 2.0)] {
            set(all, &format!("valve.{key}_diameter_mm"), port.max(0.1) * times);
        }
        set(all, "valve.underlap_mm", draw.one_of(&[-0.02, 0.0, 0.05]));
        word(all, "valve.upstream_mach", draw.one_of(&["true", "false"]));
    }
}

fn tubing(draw: &mut Draw, size: &Size, all: &mut Vec<String>) {
    let flow = size.area * size.stroke * size.supply / 1e5 * draw.decades(0.3, 30.0);
    word(all, "tubing.model", draw.one_of(&["none", "empirical", "analytical"]));
    set(all, "tubing.reference_flow_kg_s", flow.clamp(1e-5, 100.0));
    set(all, "tubing.drop_slope", draw.one_of(&[0.05, 0.4, 0.9]));
    set(all, "tubing.diameter_mm", draw.one_of(&[2.0, 4.0, 15.0]));
    set(all, "tubing.length_m", draw.one_of(&[0.1, 1.0, 10.0]));
    set(all, "tubing.lag_s", draw.one_of(&[0.0, 0.0, 1e-4, 1e-2]));
}

fn operator(draw: &mut Draw, all: &mut Vec<String>) {
    word(all, "operator.model", "solenoid-empirical");
    set(all, "operator.hysteresis_percent", draw.one_of(&[0.0, 5.0]));
    set(all, "operator.dither_mm", draw.one_of(&[0.0, 0.0, 0.2]));
    set(all, "operator.stiffness_per_mass_per_s2", draw.decades(1e4, 1e7));
    set(all, "operator.damping_per_s", draw.decades(100.0, 5e3));
}

fn test(draw: &mut Draw, size: &Size, all: &mut Vec<String>) {
    let pressure = |draw: &mut Draw| draw.between(size.exhaust, size.supply);
    for (key, value) in [("sensors.pressure", "false"), ("controller.loop", "open")] {
        word(all, key, value);
    }
    set(all, "encoder.mm_per_count", 0.001);
    set(all, "safety.position_margin_mm", 1000.0);
    set(all, "safety.max_speed_m_s", 100.0);
    set(all, "test.position_m", size.stroke * draw.between(0.02, 0.98));
    for chamber in ["1", "2"] {
        let value = pressure(draw);
        set(all, &format!("test.pressure_{chamber}_pa"), value);
    }
    word(all, "test.moves", "[[0.0, 0], [0.05, 2047], [0.45, -2047], [0.9, 682], [1.0, 0]]");
    set(all, "test.duration_s", 1.5);
}
