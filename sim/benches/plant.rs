//! What a run is made of, in time: `cargo bench -p pneudrive-sim`. What it costs in counts, on any machine, is in
//! docs/reference/counts.md.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pneudrive_controller::Command;
use pneudrive_sim::component::air::GasState;
use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::component::tubing::Tube;
use pneudrive_sim::component::valve::flow_law::FlowLaw;
use pneudrive_sim::component::valve::{Opening, Valve};
use pneudrive_sim::network::{Laws, Network, PortFlow};
use pneudrive_sim::rigfile::BUILTIN;
use pneudrive_sim::{Accuracy, Plant, Rig, run};

/// The valve of servo-drive B.
const VALVE: Valve = Valve {
    null_offset: 0.0,
    lap: 0.0,
    sleeve_diameter: 10e-3,
    spool_diameter: 9.98e-3,
    port_diameter: 3.3e-3,
    has_node: true,
    land_laws: [FlowLaw::Orifice; 2],
    opening: Opening::Areas,
    travel: 1e-3,
    rod_diameter: 6e-3,
    discharge_supply: 0.8,
    discharge_exhaust: 0.8,
};

/// Both flow nodes with their tubes, for a spool that has gone a micrometre since the last solution.
fn flow_nodes(criterion: &mut Criterion) {
    let gas = Gas::new(1.4, 286.76);
    let station = |pressure| GasState { exner: gas.exner(pressure), temperature: 294.0 };
    let tube = Tube::empirical(&gas, 0.4, 0.00465);
    let laws = Laws::alike(FlowLaw::Orifice);
    let mut network = Network::new(gas, station(589e3), station(101.3e3), tube, tube, laws, None);
    let chambers = [station(325e3), station(400e3)];
    let mut steps = 0_u32;
    criterion.bench_function("flow nodes", |bencher| {
        bencher.iter(|| {
            steps = (steps + 1) % 200;
            let spool = 2e-4 + 1e-6 * f64::from(steps.min(200 - steps));
            black_box(network.flows(&VALVE, spool, &chambers, &[PortFlow::Charging, PortFlow::Discharging]))
        });
    });
}

/// Servo-drive B in the middle of a move, looked at 10 microseconds farther on each time.
fn right_hand_side(criterion: &mut Criterion) {
    let rig = Rig::builtin("servo-b").expect("a built-in rig");
    let mut plant = Plant::new(&rig, Accuracy::of(&rig), 0);
    for _ in 0..100 {
        plant.advance(Command { counts: 700, ..Command::OFF }).expect("a transient");
    }
    let mut steps = 0_u32;
    criterion.bench_function("right-hand side", |bencher| {
        bencher.iter(|| {
            steps = (steps + 1) % 100;
            black_box(plant.evaluate(1e-5 * f64::from(steps.min(100 - steps))))
        });
    });
}

/// The reference cases that docs/explanation/speed.md compares with a specialised program.
const CASES: [&str; 6] =
    ["A_closed", "A_open_quarter", "A_open_taulag", "B_open_nodither", "B_open_dither", "B_closed_damped"];

fn case(name: &str) -> Rig {
    let path = format!("{}/tests/cases/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a case in the repository");
    Rig::read(name, &text).expect("a valid case")
}

fn runs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("run");
    group.sample_size(10);
    let built_in = BUILTIN.iter().map(|(name, _)| (*name, Rig::builtin(name).expect("a built-in rig")));
    let cases = CASES.map(|name| (name, case(name)));
    for (name, rig) in built_in.chain(cases) {
        group.bench_function(name, |bencher| {
            bencher.iter(|| run(&rig, Accuracy::of(&rig)).expect("a transient"));
        });
    }
    group.finish();
}

criterion_group!(benches, flow_nodes, right_hand_side, runs);
criterion_main!(benches);
