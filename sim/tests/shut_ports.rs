//! Valves that shut tight: where no air flows, the flows are hard to find, and nothing may be made of that.

use pneudrive_sim::{Accuracy, Rig, Run, run};

/// A switched valve with connectors in place of tubes, opened and shut in turns.
fn switched(tolerance: f64) -> Run {
    let settings = [
        "valve.model=multiple-flow-node",
        "controller.loop=open",
        "test.moves=[[0.0, 0], [0.05, 2048], [0.3, 0], [0.35, -2048], [0.55, 2048], [0.7, 0], [0.75, -1200]]",
        "test.duration_s=1.0",
    ]
    .map(str::to_owned);
    let text = pneudrive_sim::rigfile::builtin("bang-bang").expect("a built-in rig");
    let rig = Rig::read_with("bang-bang", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
    run(&rig, Accuracy { tolerance, ..Accuracy::default() }).unwrap_or_else(|error| panic!("{error}"))
}

/// Once a solution that was not found counted as a flow that had reversed: the air that still went into a chamber
/// had the chamber's temperature, and its pressure was off by pascals at any tolerance.
#[test]
fn as_a_port_shuts_the_air_in_it_keeps_its_direction() {
    let (usual, fine) = (switched(1e-9), switched(1e-12));
    for (one, other) in usual.rows.iter().zip(&fine.rows) {
        let off =
            (0..2).map(|i| (one.plant.pressures[i] - other.plant.pressures[i]).abs()).fold(0.0, f64::max);
        assert!(off < 0.1, "{off} Pa at {} s", one.time);
    }
}
