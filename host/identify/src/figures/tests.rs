//! Figures that records of a simulated drive tell, whatever its incline.

use pneudrive_controller::Command;
use pneudrive_sim::follow::{Timing, follow};
use pneudrive_sim::{Accuracy, Rig};

use super::*;
use crate::recording::{CHANNELS, Channel, reading};

/// What a count is worth in each channel, SI.
const SCALES: [f64; CHANNELS.len()] = [1e-5, 10.0, 10.0, 1e-8];

/// A drive by its data sheets that starts at mid-stroke, and what else it has.
fn own(settings: &[&str]) -> Rig {
    let by_conductance = [
        "valve.model=iso-6358",
        "valve.characteristic=linear",
        "valve.sonic_conductance_m3_per_s_pa=1.4e-8",
        "valve.critical_ratio=0.3",
        "operator.model=solenoid-empirical",
        "operator.dither_mm=0",
        "tubing.model=none",
        "controller.loop=open",
        "test.position_m=0.12",
        "load.mass_kg=8",
        "load.static_extend_n=60",
        "load.static_retract_n=50",
        "load.coulomb_extend_n=30",
        "load.coulomb_retract_n=25",
    ];
    let settings: Vec<String> =
        by_conductance.iter().chain(settings).map(|text| (*text).to_owned()).collect();
    Rig::read_with("own", "", &settings).expect("a valid rig")
}

/// A record of it under commands, each for so many samples.
fn record(rig: &Rig, commands: &[(i16, usize)]) -> Recording {
    let commands: Vec<Command> = commands
        .iter()
        .flat_map(|&(counts, samples)| vec![Command { counts, step: 0, drive_enable: true }; samples])
        .collect();
    let timing = Timing { period_us: 1000, delay_us: 400 };
    let readings = follow(rig, Accuracy::default(), timing, &commands).expect("it runs");
    let channels = std::array::from_fn(|c| Channel {
        measured: readings.iter().map(|one| (reading(one, c) / SCALES[c]).floor()).collect(),
        taken: Vec::new(),
        offset: 0.0,
        scale: SCALES[c],
        ..Channel::default()
    });
    Recording { name: "a record".to_owned(), timing, commands, channels, start: [0.0; 3] }
}

/// Slow pushes off a rest in both directions, and strokes that accelerate.
fn figures(rig: &Rig) -> Figures {
    let slow = 300;
    let pushes =
        [(0, 100), (slow, 250), (0, 400), (-slow, 300), (0, 400), (slow, 200), (0, 400), (-slow, 200)];
    let strokes = [(0, 100), (1200, 150), (-1200, 150), (1200, 120), (-1200, 120)];
    Figures::of(rig, &[record(rig, &pushes), record(rig, &strokes)])
}

fn assert_near(what: &str, figure: Option<Figure>, expected: f64, off: f64) {
    let Some(Figure { value, error }) = figure else { panic!("{what}: not seen") };
    assert!((value / expected - 1.0).abs() < off, "{what}: {value} +- {error}, not {expected}");
}

#[test]
fn friction_and_mass_are_read_off_records_of_level_inclined_and_vertical_axes() {
    for incline in [0, 30, -30, 90, -90] {
        let figures = figures(&own(&[&format!("load.incline_deg={incline}")]));
        let at = |what: &str| format!("{what} at {incline} degrees");
        assert_near(&at("mass"), figures.mass, 8.0, 0.03);
        for (i, [stiction, coulomb]) in [[60.0, 30.0], [50.0, 25.0]].into_iter().enumerate() {
            assert_near(&at("stiction"), figures.stiction[i], stiction, 0.1);
            assert_near(&at("dry friction"), figures.coulomb[i], coulomb, 0.1);
        }
    }
}

/// The sensors do not tell of the air behind a spear.
#[test]
fn what_happens_in_a_cushion_is_left_out_of_friction_and_mass() {
    let cushioned = [
        "actuator.cushion=adjustable",
        "actuator.cushion_1_length_m=0.1",
        "actuator.cushion_2_length_m=0.15",
    ];
    let figures = figures(&own(&cushioned));
    assert_near("mass", figures.mass, 8.0, 0.03);
    for (i, coulomb) in [30.0, 25.0].into_iter().enumerate() {
        assert_near("dry friction", figures.coulomb[i], coulomb, 0.1);
    }
}

#[test]
fn a_cylinder_with_a_rod_on_both_sides_pushes_with_what_the_rods_leave() {
    let figures = figures(&own(&["actuator.model=symmetric"]));
    assert_near("mass", figures.mass, 8.0, 0.03);
    assert_near("stiction", figures.stiction[0], 60.0, 0.1);
}

#[test]
fn the_weight_goes_with_the_mass_that_the_records_show() {
    let truth = own(&["load.incline_deg=90"]);
    let pushes = [(0, 100), (400, 250), (0, 400), (-400, 300), (0, 300)];
    let strokes = [(0, 100), (1200, 150), (-1200, 150), (1200, 120), (-1200, 120)];
    let recordings = [record(&truth, &pushes), record(&truth, &strokes)];
    let file = own(&["load.incline_deg=90", "load.mass_kg=9"]);
    let figures = Figures::of(&file, &recordings);
    assert_near("mass", figures.mass, 8.0, 0.03);
    assert_near("stiction", figures.stiction[0], 60.0, 0.15);
}
