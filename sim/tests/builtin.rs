//! Every rig that comes with the program: it runs, and what it does is no matter of the tolerance.

use pneudrive_sim::keys;
use pneudrive_sim::rigfile::BUILTIN;
use pneudrive_sim::{Accuracy, Rig, Run, run};

fn simulate(name: &str, tolerance: f64) -> Run {
    let rig = Rig::builtin(name).expect("a built-in rig");
    run(&rig, Accuracy { tolerance, ..Accuracy::default() }).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// What a drive does in the last half second of its test: where, in encoder counts, and how far it
/// moves there.
#[derive(Debug)]
struct Behaviour {
    middle: f64,
    swing: f64,
}

fn behaviour(run: &Run) -> Behaviour {
    let end = run.rows.last().expect("rows").time;
    let late = run.rows.iter().filter(|row| row.time > end - 0.5).map(|row| row.plant.position / 12.05e-6);
    let high = late.clone().fold(f64::NEG_INFINITY, f64::max);
    let low = late.fold(f64::INFINITY, f64::min);
    Behaviour { middle: 0.5 * (high + low), swing: high - low }
}

#[test]
fn every_built_in_rig_is_read_without_an_unused_key_and_runs_its_test_without_a_fault() {
    for (name, text) in BUILTIN {
        let rig = Rig::read(name, text).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!((rig.name(), rig.written_in_vain().len()), (*name, 0));
        let run = simulate(name, 1e-11);
        assert_eq!(run.fault, None, "{name}");
        let end = run.rows.last().expect("rows").time;
        assert!(
            (end - rig.get(&keys::test::DURATION_S)).abs() < rig.get(&keys::controller::PERIOD_S),
            "{name}"
        );
        assert!(run.rows.iter().all(|row| row.values().iter().all(|value| value.is_finite())), "{name}");
    }
}

/// A drive at rest stays within 3 counts of where it was; one that limit-cycles within 3 % of its swing.
#[test]
fn a_tenth_of_the_tolerance_leaves_the_behaviour_of_every_built_in_rig_as_it_is() {
    for (name, _) in BUILTIN {
        let [usual, fine] = [1e-11, 1e-12].map(|tolerance| behaviour(&simulate(name, tolerance)));
        let few = (0.03 * usual.swing).max(3.0);
        assert!((usual.swing - fine.swing).abs() < few, "{name}: {usual:?} {fine:?}");
        assert!((usual.middle - fine.middle).abs() < few, "{name}: {usual:?} {fine:?}");
    }
}
