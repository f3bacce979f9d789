//! The table against the network that it stands for.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::*;
use crate::air::Station;
use crate::build;
use crate::network::PortFlow;
use crate::rig::{Rig, builtin, unit_interval};

/// A rig with a table, and other settings.
fn rig(settings: &[&str]) -> Rig {
    let all: Vec<String> = ["valve.upstream_mach=false", "valve.table=true"]
        .iter()
        .chain(settings)
        .map(|setting| (*setting).to_owned())
        .collect();
    Rig::read_with("servo-b", builtin("servo-b").expect("built in"), &all)
        .unwrap_or_else(|problems| panic!("{settings:?}: {problems}"))
}

/// The network of a rig with its table and without, and the valve.
fn networks(rig: &Rig) -> ([Network; 2], Valve) {
    let exact = build::network(rig, build::gas(rig));
    ([exact.clone().with_table(rig.flow_table()), exact], build::valve(rig))
}

/// What is asked of a network.
#[derive(Clone, Copy, Debug)]
struct Question {
    spool: f64,
    pressures: [f64; 2],
    temperatures: [f64; 2],
}

impl Question {
    fn random(random: &mut impl Rng) -> Question {
        let mut between = |low: f64, high: f64| low + (high - low) * unit_interval(random);
        // A third of them near the edges of the lands.
        let spool = between(-1e-3, 1e-3) * if between(0.0, 1.0) < 0.33 { 0.05 } else { 1.0 };
        Question {
            spool,
            pressures: [between(110e3, 589e3), between(110e3, 589e3)],
            temperatures: [between(230.0, 360.0), between(230.0, 360.0)],
        }
    }

    /// The flows of both nodes, m and s each, with the port directions that they have.
    fn ask(&self, network: &mut Network, valve: &Valve) -> [[f64; 2]; 2] {
        let station = |i: usize| Station {
            exner: network.gas.exner(self.pressures[i]),
            temperature: self.temperatures[i],
        };
        let chambers = [station(0), station(1)];
        let mut ports = [PortFlow::Charging; 2];
        let mut nodes = network.flows(valve, self.spool, &chambers, &ports);
        ports = nodes.map(|node| match node.port_flow() >= 0.0 {
            true => PortFlow::Charging,
            false => PortFlow::Discharging,
        });
        network.expect_jump();
        nodes = network.flows(valve, self.spool, &chambers, &ports);
        nodes.map(|node| [node.port_flow(), node.supply_flow])
    }
}

/// The larger error of m or s, over the larger of the flow and `floor`.
fn error(found: &[f64; 2], exact: &[f64; 2], floor: f64) -> f64 {
    let off = (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs());
    off / exact[0].abs().max(exact[1].abs()).max(floor)
}

/// The largest error at so many random places, and the part of them that the table answered.
fn at_random(rig: &Rig, places: u32) -> (f64, f64) {
    let ([mut tabulated, mut exact], valve) = networks(rig);
    let floor = FLOOR * rig.table_quality().expect("a table").largest;
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut worst = 0.0_f64;
    for _ in 0..places {
        let question = Question::random(&mut random);
        let (found, right) = (question.ask(&mut tabulated, &valve), question.ask(&mut exact, &valve));
        for (found, right) in found.iter().zip(&right) {
            worst = worst.max(error(found, right, floor));
        }
    }
    (worst, tabulated.work.tabulated as f64 / tabulated.work.solutions as f64)
}

#[test]
fn at_random_places_a_flow_is_off_by_no_more_than_0_1_percent() {
    for settings in [
        &[][..],
        &["tubing.model=none"],
        &["gas.heat_capacity_ratio=1.67"],
        &["valve.underlap_mm=-0.1"],
        &["valve.underlap_mm=0.05"],
        &["valve.discharge_model=perry"],
        &["valve.discharge_supply=0.6", "valve.null_offset_mm=0.2"],
        &["supply.temperature_k=320", "supply.pressure_pa=8e5"],
    ] {
        let rig = rig(settings);
        let quality = rig.table_quality().expect("a table");
        assert!(quality.error <= RESERVE * MOST_ERROR, "{settings:?}: {quality:?}");
        let (worst, answered) = at_random(&rig, 10_000);
        assert!(worst <= MOST_ERROR, "{settings:?}: {worst:.2e}");
        assert!(answered > 0.4, "{settings:?}: the table answers {answered:.2} of all places");
    }
}

/// In the middle of a move, with room to every end of the table.
const MOVING: Question = Question { spool: 0.3e-3, pressures: [400e3, 350e3], temperatures: [300.0, 280.0] };

#[test]
fn a_choked_port_and_one_that_hardly_flows_are_the_networks() {
    let rig = rig(&["tubing.model=none"]);
    let ([mut tabulated, mut exact], valve) = networks(&rig);
    let floor = FLOOR * rig.table_quality().expect("a table").largest;
    let choked = Question { pressures: [150e3, 480e3], ..MOVING };
    let [[low, _], _] = choked.ask(&mut exact, &valve);
    let [[lower, _], _] = Question { pressures: [120e3, 480e3], ..choked }.ask(&mut exact, &valve);
    assert!((low / lower - 1.0).abs() < 1e-9, "chamber 1 is filled through a choked port: {low} {lower}");
    let rest = Question { spool: 0.3e-3, pressures: [580e3, 200e3], ..MOVING };
    for question in [choked, rest] {
        let (found, right) = (question.ask(&mut tabulated, &valve), question.ask(&mut exact, &valve));
        for (found, right) in found.iter().zip(&right) {
            assert!(error(found, right, floor) < MOST_ERROR, "{question:?}: {found:?} {right:?}");
        }
    }
    assert_eq!(tabulated.work.tabulated, 4);
}

#[test]
fn flows_go_on_from_cell_to_cell_with_the_slopes_of_the_network() {
    let rig = rig(&[]);
    let ([mut tabulated, mut exact], valve) = networks(&rig);
    let step = 0.5e-6;
    let mut flow_at = |i: u32| {
        let question = Question { spool: 0.05e-3 + f64::from(i) * step, ..MOVING };
        let port = |network: &mut Network| question.ask(network, &valve)[0][0];
        [port(&mut tabulated), port(&mut exact)]
    };
    let mut last = flow_at(0);
    let begin = (flow_at(1)[1] - last[1]) / step;
    for i in 1..800 {
        let flows = flow_at(i);
        let [slope, right] = [0, 1].map(|k| (flows[k] - last[k]) / step);
        // A cell that did not meet the next one would show by its step over half a micrometre.
        assert!((slope - right).abs() < 0.02 * begin, "{i}: {slope} {right}");
        last = flows;
    }
    assert_eq!(tabulated.work.tabulated, tabulated.work.solutions);
}

#[test]
fn beyond_the_table_the_network_solves() {
    let rig = rig(&[]);
    for beyond in [
        Question { pressures: [90e3, 350e3], ..MOVING },
        Question { pressures: [400e3, 700e3], ..MOVING },
        Question { temperatures: [300.0, 150.0], ..MOVING },
        Question { spool: 2e-3, ..MOVING },
    ] {
        let ([mut tabulated, mut exact], valve) = networks(&rig);
        let (found, right) = (beyond.ask(&mut tabulated, &valve), beyond.ask(&mut exact, &valve));
        assert!(tabulated.work.tabulated < tabulated.work.solutions, "{beyond:?}");
        for (found, right) in found.iter().zip(&right) {
            assert!(error(found, right, 1e-5) < 1e-9, "{beyond:?}: {found:?} {right:?}");
        }
    }
}

#[test]
fn a_table_that_would_answer_little_is_refused_with_its_figure() {
    let settings = ["valve.upstream_mach=false", "valve.table=true", "valve.spool_diameter_mm=8"];
    let settings = settings.map(str::to_owned);
    let refused = Rig::read_with("servo-b", builtin("servo-b").expect("built in"), &settings);
    let message = refused
        .map(|rig| rig.table_quality())
        .expect_err("lands that leak as much as the bore lets pass")
        .to_string();
    assert!(message.contains("% of its cells are off by more than"), "{message}");
}
