//! The air of a record against that of the same run simulated.

use std::path::Path;

use pneudrive_evaluate::evaluation::{Air, Chambers, Motion, moves, moves_of_run};
use pneudrive_evaluate::transient::{POSITION, PRESSURES, Transient};
use pneudrive_records::run_folder::StoredRun;
use pneudrive_sim::component::sensors::Sensors;
use pneudrive_sim::keys;
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::{Accuracy, Rig, Run, run};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::program::{folder, ok, virtual_rig_of};

/// The built-in rigs with a closed loop.
const CLOSED: [&str; 9] = [
    "servo-a",
    "servo-a-tuned",
    "servo-b",
    "servo-b-tuned",
    "servo-c",
    "servo-c-tuned",
    "lut-stepper",
    "lut-solenoid",
    "burrows",
];

fn rig(name: &str, settings: &[String]) -> Rig {
    let text = builtin(name).expect("a built-in rig");
    Rig::read_with(name, text, settings).unwrap_or_else(|problems| panic!("{name}: {problems}"))
}

fn simulated(rig: &Rig) -> Run {
    run(rig, Accuracy::of(rig)).unwrap_or_else(|error| panic!("{}: {error}", rig.name()))
}

/// The air of all moves of a transient.
fn air(transient: &Transient, chambers: Option<&Chambers>) -> Option<Air> {
    let moves = moves(transient, &Motion::of(transient), chambers, 0.05);
    let add =
        |a: Air, b: Air| Air { litres: a.litres + b.litres, least: a.least + b.least, most: a.most + b.most };
    moves.iter().map(|one| one.air).reduce(|a, b| Some(add(a?, b?))).flatten()
}

/// The air that flows in a run, with a row every tenth of a millisecond.
fn truth(name: &str, settings: &[String]) -> f64 {
    let fine = [settings, &["test.trace_period_s=0.0001".to_owned()]].concat();
    let rig = rig(name, &fine);
    let transient = Transient::of_run(name, &StoredRun::of(&rig, &simulated(&rig)));
    let flows = transient.inflow_kg_s.expect("a run has flows");
    let steps = transient.time.windows(2).zip(flows.windows(2));
    steps.map(|(t, flow)| (t[1] - t[0]) * (flow[0] + flow[1]) / 2.0).sum::<f64>() / 1.185e-3
}

/// What the drive's encoder and converters make of a run.
fn recorded(rig: &Rig, run: &Run, seed: u64) -> Transient {
    let mut transient = Transient::of_run("", &StoredRun::of(rig, run));
    let mut sensors = Sensors::new(rig, seed);
    let [low, high] =
        [&keys::sensors::PRESSURE_MIN_PA, &keys::sensors::PRESSURE_MAX_PA].map(|key| rig.get(key) / 1e3);
    let step = (high - low) / f64::from((1 << rig.get(&keys::sensors::BITS)) - 1);
    for (k, row) in run.rows.iter().enumerate() {
        let seen = sensors.read(row.plant.position, row.plant.pressures, row.plant.spool);
        transient.channels[POSITION][k] = f64::from(seen.position) * transient.mm_per_count;
        for (channel, raw) in PRESSURES.into_iter().zip([seen.pressure_1, seen.pressure_2]) {
            transient.channels[channel][k] = low + f64::from(raw) * step;
        }
    }
    Transient { inflow_kg_s: None, pressure_step_kpa: step, ..transient }
}

/// Recorded over the protocol from a virtual rig with its converters, by the program.
fn downloaded(folder: &Path, rig: &Rig) -> Transient {
    let port = virtual_rig_of(rig.clone());
    ok(folder, &format!("run {} --port {}", rig.name(), port.port()));
    let printed = ok(folder, &format!("record --port {}", port.port()));
    let name = printed.split(':').next().expect("a file");
    Transient::read(&folder.join(name)).expect("a record")
}

/// Prints the table air.md beside this file, which `--nocapture` shows.
#[test]
fn the_air_of_a_record_is_that_of_the_run_within_3_percent_and_within_its_bounds() {
    let folder = folder();
    for name in CLOSED {
        let mut row = format!("| {name} |");
        for noise in [0.0, 1.0] {
            let noisy = [format!("sensors.noise_counts={noise:?}")];
            let (rig, truth) = (rig(name, &noisy), truth(name, &noisy));
            let found =
                air(&downloaded(folder.path(), &rig), Some(&Chambers::of(&rig))).expect("it shows it");
            assert!(
                (found.litres / truth - 1.0).abs() < 0.03,
                "{name}, noise {noise}: {found:?} for {truth}"
            );
            assert!(
                found.least < truth && truth < found.most,
                "{name}, noise {noise}: {found:?} for {truth}"
            );
            if noise == 0.0 {
                row += &format!(" {truth:.3} |");
            }
            row += &format!(" {:.3} ({:.3} to {:.3}) |", found.litres, found.least, found.most);
        }
        println!("{row}");
    }
}

/// Draws from a seed.
struct Draws(ChaCha8Rng);

impl Draws {
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// As often between 1 and 2 as between 2 and 4.
    fn by_ratio(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
}

/// A built-in rig with another supply, load, cylinder, dither and leakage.
fn drawn(seed: u64) -> (&'static str, Vec<String>) {
    let mut draws = Draws(ChaCha8Rng::seed_from_u64(seed));
    let name = CLOSED[(draws.unit() * CLOSED.len() as f64) as usize];
    let supply = if name == "burrows" { [2e5, 3.5e5] } else { [3.5e5, 9e5] };
    let mut settings = vec![
        format!("supply.pressure_pa={:?}", draws.between(supply[0], supply[1])),
        format!("supply.temperature_k={:?}", draws.between(278.0, 313.0)),
        format!("load.mass_kg={:?}", draws.by_ratio(0.5, 40.0)),
        format!("load.viscous_n_s_per_m={:?}", draws.by_ratio(5.0, 150.0)),
        format!("actuator.residual_volume_1_m3={:?}", draws.by_ratio(5e-6, 8e-5)),
        format!("actuator.residual_volume_2_m3={:?}", draws.by_ratio(5e-6, 8e-5)),
        format!("operator.dither_mm={:?}", draws.between(0.0, 0.3)),
        format!("operator.dither_hz={:?}", draws.between(25.0, 100.0)),
    ];
    if draws.unit() < 0.3 {
        settings.push("actuator.leakage=\"adiabatic\"".to_owned());
    }
    (name, settings)
}

/// Noise is in counts of a converter of 12 bits.
#[test]
fn on_rigs_drawn_at_random_the_bounds_hold_and_the_figure_is_within_3_percent_of_the_truth() {
    let mut all = 0;
    for seed in 0..60 {
        let (name, settings) = drawn(seed);
        let noise = f64::from(seed as u32 % 3) / 2.0;
        let settings = [settings, vec![format!("sensors.noise_counts={noise:?}")]].concat();
        let (rig, truth) = (rig(name, &settings), truth(name, &settings));
        let record = recorded(&rig, &simulated(&rig), 7 + seed);
        let Some(found) = air(&record, Some(&Chambers::of(&rig))) else { continue };
        let off = found.litres / truth - 1.0;
        all += 1;
        assert!(off.abs() < 0.03, "{seed} {name}, noise {noise}: {found:?} for {truth}");
        assert!(
            found.least < truth && truth < found.most,
            "{seed} {name}, noise {noise}: {found:?} for {truth}"
        );
    }
    assert!(all >= 50, "{all} records show it");
}

#[test]
fn what_a_record_cannot_show_is_none() {
    let rig_b = rig("servo-b-tuned", &[]);
    let run = simulated(&rig_b);
    let record = recorded(&rig_b, &run, 1);
    assert_eq!(air(&record, None), None, "no cylinder is known");
    let mut sparse = record.clone();
    let every = |values: &mut Vec<f64>| *values = values.iter().step_by(4).copied().collect();
    every(&mut sparse.time);
    sparse.channels.iter_mut().for_each(every);
    sparse.counts = sparse.counts.iter().step_by(4).copied().collect();
    assert_eq!(air(&sparse, Some(&Chambers::of(&rig_b))), None, "four samples to a period of the dither");
    let narrow = rig("servo-b-tuned", &["sensors.pressure_max_pa=400000.0".to_owned()]);
    let cut = recorded(&narrow, &run, 1);
    assert_eq!(air(&cut, Some(&Chambers::of(&narrow))), None, "the pressure is beyond its converter");
    let cushioned = |length: &str| {
        let length = format!("actuator.cushion_2_length_m={length}");
        air(
            &record,
            Some(&Chambers::of(&rig("servo-b-tuned", &["actuator.cushion=adjustable".to_owned(), length]))),
        )
    };
    assert_eq!(cushioned("0.15"), None, "its moves to 0.197 m end in that cushion, whose air no sensor sees");
    assert_eq!(cushioned("0.02"), air(&record, Some(&Chambers::of(&rig_b))));
}

/// Rows at a whole multiple of the dither's period all see it at one phase: every other row has the same sum.
#[test]
fn the_air_of_a_run_whose_rows_do_not_resolve_the_dither_is_not_told() {
    let air = |period: &str| {
        let rig = rig("servo-b-tuned", &[format!("test.trace_period_s={period}")]);
        moves_of_run(&rig, &simulated(&rig)).iter().map(|one| one.air).collect::<Vec<_>>()
    };
    for period in ["0.02", "0.04", "0.004"] {
        assert!(air(period).iter().all(Option::is_none), "{period} s: {:?}", air(period));
    }
    assert!(air("0.001").iter().all(Option::is_some), "twenty rows to a period of the dither");
}
