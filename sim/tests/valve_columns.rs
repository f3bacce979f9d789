//! The columns of the air inside the valve: what they are, and that looking changes nothing.

use pneudrive_sim::keys;
use pneudrive_sim::rigfile::BUILTIN;
use pneudrive_sim::trace::{EXTRAS, Extra, Row, to_csv};
use pneudrive_sim::{Accuracy, Recording, Rig, Run, run, run_recorded};

fn recorded(rig: &Rig) -> Run {
    run_recorded(rig, Accuracy::of(rig), Recording { valve: true }, |_, _| {}).expect("runs")
}

fn column(name: &str, row: &Row) -> f64 {
    Extra::named(name).expect("a column").value(row)
}

fn rig(name: &str, settings: &[&str]) -> Rig {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

#[test]
fn a_run_whose_valve_is_recorded_is_the_same_run() {
    for (name, _) in BUILTIN {
        let rig = Rig::builtin(name).expect("a built-in rig");
        let rig = rig.with_numbers(&[("test.duration_s", 0.4)]).unwrap_or(rig);
        let (plain, watched) = (run(&rig, Accuracy::of(&rig)).expect("runs"), recorded(&rig));
        assert_eq!(to_csv(&plain.rows), to_csv(&watched.rows), "{name}");
        assert_eq!(plain.work, watched.work, "{name}: what it has cost");
        let of_valve = || EXTRAS.iter().filter(|extra| extra.is_of_valve());
        let finite = |row: &Row| of_valve().all(|extra| extra.value(row).is_finite());
        assert!(watched.rows.iter().all(finite), "{name}");
        assert!(plain.rows.iter().all(|row| of_valve().all(|extra| extra.value(row).is_nan())));
    }
}

/// What flows into a node by its lands flows on through its port.
#[test]
fn the_flows_of_a_node_are_those_of_its_chamber() {
    let rig = rig("servo-b-tuned", &["test.duration_s=0.6"]);
    for row in &recorded(&rig).rows {
        for (i, flow) in row.plant.mass_flows.into_iter().enumerate() {
            let of = |side: &str| column(&format!("{side}_flow_{}_kg_s", i + 1), row);
            let sum = of("supply") + of("exhaust");
            assert!((sum - flow).abs() < 1e-6, "{} s: {sum} for {flow} kg/s", row.time);
        }
    }
}

/// Without tubes the ports are the chambers, and the supply's lands are at the supply.
#[test]
fn without_tubes_the_ports_have_the_pressures_of_the_chambers() {
    let rig = rig("servo-b-tuned", &["tubing.drop_slope=0", "test.duration_s=0.6"]);
    for row in &recorded(&rig).rows {
        for (i, pressure) in row.plant.pressures.into_iter().enumerate() {
            let port = column(&format!("port_pressure_{}_pa", i + 1), row);
            assert!((port / pressure - 1.0).abs() < 1e-9, "{} s: {port} for {pressure} Pa", row.time);
        }
        let supply = column("supply_port_pressure_pa", row);
        assert!((supply / rig.get(&keys::supply::PRESSURE_PA) - 1.0).abs() < 1e-9, "{supply} Pa");
    }
}

/// Air goes from the higher pressure to the lower: supply, node, port, chamber while a chamber charges. (With upstream
/// Mach numbers a static pressure may be below that of the still air in the node.)
#[test]
fn pressures_fall_along_the_way_of_the_air() {
    let rig = rig("servo-b-tuned", &["valve.upstream_mach=false", "test.duration_s=0.6"]);
    let mut charging = 0;
    for row in recorded(&rig).rows.iter().filter(|row| row.plant.mass_flows[0] > 1e-4) {
        let path = ["supply_port_pressure_pa", "node_pressure_1_pa", "port_pressure_1_pa"];
        let [supply, node, port] = path.map(|name| column(name, row));
        assert!(supply > node && node > port && port > row.plant.pressures[0], "{} s", row.time);
        charging += 1;
    }
    assert!(charging > 50, "{charging} rows charge chamber 1");
}
