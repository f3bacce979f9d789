//! What the law keeps from one arming to the next: what a run begins with, and that it stays within its bounds.

use pneudrive_controller::choice::Adapt;
use pneudrive_controller::law::cascade::kept::{Changed, Kept, Learned};
use pneudrive_controller::parameters::{KEPT, TABLE, id};
use pneudrive_controller::{Config, Fault, Parameters};

use super::record::{RECORDS, Record, Row};
use super::{Draws, keeps_its_bounds, law};
use crate::bench::ControllerBench;

fn level() -> Record {
    Record::read(RECORDS[0].1)
}

/// The drive of a record that begins with what is kept.
fn keeping(record: &Record, kept: &Kept) -> ControllerBench {
    let mut parameters = record.parameters.clone();
    keep(&mut parameters, kept);
    Record { parameters, rows: record.rows.clone() }.bench()
}

fn keep(parameters: &mut Parameters, kept: &Kept) {
    for (id, value) in kept.values().into_iter().chain([(id::ADAPT, Adapt::Kept as i32)]) {
        parameters.set(id, value).expect("in range");
    }
}

/// The commands on the samples of a record.
fn commands(bench: &mut ControllerBench, rows: &[Row]) -> Vec<i16> {
    rows.iter().map(|row| bench.take(row.sample())).collect()
}

#[test]
fn a_drive_that_keeps_and_has_kept_nothing_yet_is_one_that_begins_afresh() {
    for (name, text) in RECORDS {
        let record = Record::read(text);
        let recorded: Vec<i16> = record.rows.iter().map(|row| row.command).collect();
        let mut bench = keeping(&record, &Kept::default());
        assert_eq!(commands(&mut bench, &record.rows), recorded, "{name}");
    }
}

#[test]
fn a_run_begins_with_what_is_kept_and_without_keeping_with_the_rig_file() {
    let learned = Learned {
        mass: 98_304,
        friction: 50_000,
        force: 1 << 23,
        viscous: -(1 << 22),
        pace: 70_000,
        looseness: 3,
    };
    let record = level();
    let mut bench = keeping(&record, &Kept { learned, armings: 4, ..Kept::default() });
    bench.take(record.rows[0].sample());
    let begun = law(&bench.state).learned();
    assert!(begun.mass.abs_diff(learned.mass) < 2 && begun.friction.abs_diff(learned.friction) < 2);
    assert_eq!(Learned { mass: learned.mass, friction: learned.friction, ..begun }, learned);
    assert!(law(&bench.state).load().standing > 0, "d counts");

    let mut parameters = bench_parameters(&record, learned);
    parameters.set(id::ADAPT, Adapt::Afresh as i32).expect("in range");
    let mut bench = Record { parameters, rows: record.rows.clone() }.bench();
    let recorded: Vec<i16> = record.rows.iter().map(|row| row.command).collect();
    assert_eq!(commands(&mut bench, &record.rows), recorded, "what is stored is not looked at");
    assert_eq!(bench.state.kept(&bench.config), None);
}

fn bench_parameters(record: &Record, learned: Learned) -> Parameters {
    let mut parameters = record.parameters.clone();
    keep(&mut parameters, &Kept { learned, ..Kept::default() });
    parameters
}

/// The drive of the record has 9.5 kg instead of 8.38.
#[test]
fn what_a_run_has_learned_is_told_at_its_end_once_and_makes_another_run_of_the_same_samples() {
    let record = level();
    let mut bench = keeping(&record, &Kept::default());
    assert_eq!(bench.state.kept(&bench.config), None, "nothing has run");
    let first = commands(&mut bench, &record.rows);
    let kept = bench.state.kept(&bench.config).expect("a run");
    assert_eq!((kept.armings, kept.changed), (1, Changed::No));
    let found = law(&bench.state).learned();
    assert!(found.mass > 70_000 && kept.learned.mass == found.mass - (found.mass - 65_536) / 8, "{kept:?}");
    bench.state.forget_run();
    assert_eq!(bench.state.kept(&bench.config), None, "once");

    let mut again = keeping(&record, &kept);
    assert_ne!(commands(&mut again, &record.rows), first);
}

#[test]
fn a_drive_that_has_tripped_begins_afresh_unless_it_was_stopped() {
    let record = level();
    let mut bench = keeping(&record, &Kept::default());
    commands(&mut bench, &record.rows);
    let [mut stopped, mut tripped] = [bench.state.clone(), bench.state.clone()];
    stopped.supervisor.trip(Fault::Stop);
    assert_eq!(stopped.kept(&bench.config), bench.state.kept(&bench.config));
    tripped.supervisor.trip(Fault::EncoderStep);
    let afresh = Kept { changed: Changed::Tripped, ..Kept::default() };
    assert_eq!(tripped.kept(&bench.config), Some(afresh));
}

/// A configuration takes over what an arming has learned as if it had been made of the parameters.
#[test]
fn a_configuration_that_learns_is_that_of_the_parameters() {
    let record = level();
    let mut draws = Draws(0x1234_5678_9abc_def1);
    let mut parameters = record.parameters.clone();
    keep(&mut parameters, &Kept::default());
    let mut config = Config::new(&parameters).expect("of a checked rig");
    for id in KEPT.into_iter().chain([id::NULL_OFFSET_COUNTS]) {
        let line = TABLE.iter().find(|line| line.id == id).expect("in the table");
        parameters.set(id, draws.within(line.min, line.max)).expect("in range");
    }
    let learned = Config::new(&parameters).expect("of a checked rig");
    assert_ne!(config, learned);
    config.law.learn(&learned.law);
    assert_eq!(config, learned);
}

/// Whatever is stored, and whatever samples come: run after run.
#[test]
fn no_kept_values_and_no_samples_take_it_out_of_its_bounds() {
    let mut draws = Draws(0x2545_f491_4f6c_dd1d);
    let mut carried = 0;
    for (_, text) in RECORDS.into_iter().take(4) {
        let record = Record::read(text);
        let mut parameters = record.parameters.clone();
        for line in TABLE.iter().filter(|line| line.name.starts_with("kept_")) {
            parameters.set(line.id, draws.within(line.min, line.max)).expect("in range");
        }
        parameters.set(id::ADAPT, 1).expect("in range");
        for id in [id::MODEL_BOUND_MS, id::PRESSURE_DOUBT_MS, id::NO_MOTION_MS] {
            parameters.set(id, 0).expect("in range");
        }
        let mut kept = Kept::of(&parameters);
        for round in 0..12 {
            keep(&mut parameters, &kept);
            let mut bench = Record { parameters: parameters.clone(), rows: record.rows.clone() }.bench();
            let from = (draws.next() as usize) % (record.rows.len() / 2);
            for row in &record.rows[from..] {
                let mut sample = row.sample();
                let noise = 1 << (round % 8);
                sample.pressure_1 += draws.within(-noise, noise) as i16;
                sample.position += draws.within(-noise, noise);
                bench.take(sample);
                assert!(keeps_its_bounds(law(&bench.state)), "{:?}", law(&bench.state).load());
            }
            if let Some(next) = bench.state.kept(&bench.config) {
                (kept, carried) = (next, carried + 1);
            }
        }
    }
    assert!(carried > 20, "{carried} runs told what they learned");
}
