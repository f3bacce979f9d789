//! A fit finds what a virtual rig hides, as exactly as it says; docs/identification.md has a hundred trials.

use pneudrive::identification::figures::Figures;
use pneudrive::identification::parameter::Parameter;
use pneudrive::identification::recovery::{Case, Coverage, HIDDEN, Trial, held, spread};
use pneudrive::identification::{Identification, identify};
use pneudrive_sim::Accuracy;

const TRIALS: u64 = 10;

#[test]
fn the_intervals_hold_what_was_hidden_as_often_as_they_say() {
    let mut coverage = Coverage::default();
    for seed in 1..=TRIALS {
        let trial = Trial::run(seed, HIDDEN, &mut |_| {}).expect("a fit");
        println!("seed {seed}: {}", trial.summary());
        coverage.count(&trial);
    }
    println!("{coverage}");
    assert_eq!((coverage.failed, coverage.unseen), (0, 0));
    let pooled = coverage.pooled();
    assert_eq!(pooled.len(), 110);
    // Of a hundred trials it is 92 to 98 %; ten scatter more.
    assert!(held(&pooled) >= 0.9, "intervals too narrow");
    assert!((0.8..1.25).contains(&spread(&pooled)), "errors are not as large as they are said to be");
    assert!(coverage.runs as u64 / TRIALS < 2500, "a trial costs {} runs", coverage.runs as u64 / TRIALS);
}

/// A fit of some parameters to some of the tests.
fn fit(keys: &[&str], tests: &[usize]) -> (Case, Identification) {
    let case = Case::draw(1, HIDDEN).expect("a case");
    let parameters = keys.iter().map(|key| Parameter::of(&case.model, key).expect("a parameter")).collect();
    let recordings: Vec<_> = tests.iter().map(|&test| case.recordings[test].clone()).collect();
    let found =
        identify(&case.model, &recordings, parameters, Accuracy::default(), &mut |_| {}).expect("a fit");
    (case, found)
}

#[test]
fn stiction_and_the_force_balance_are_near_what_was_hidden_without_a_model_of_the_air() {
    let case = Case::draw(1, HIDDEN).expect("a case");
    let figures = Figures::of(&case.model, &case.recordings);
    let hidden =
        |key: &str| case.hidden.iter().find(|(parameter, _)| parameter.key.path == key).expect("hidden").1;
    for (figure, key, off) in [
        (figures.mass, "load.mass_kg", 0.01),
        (figures.viscous, "load.viscous_n_s_per_m", 0.05),
        (figures.coulomb[0], "load.coulomb_extend_n", 0.03),
        (figures.coulomb[1], "load.coulomb_retract_n", 0.1),
        (figures.stiction[0], "load.static_extend_n", 0.2),
        (figures.stiction[1], "load.static_retract_n", 0.2),
    ] {
        let (figure, hidden) = (figure.expect(key), hidden(key));
        println!("{key}: {figure:?}, hidden {hidden}");
        assert!((figure.value / hidden - 1.0).abs() < off, "{key}: {figure:?}, hidden {hidden}");
    }
    assert!(figures.top_speed.iter().all(|speed| speed.is_some_and(|speed| speed > 0.3)));
}

fn unseen(found: &Identification) -> Vec<&str> {
    found.unseen.iter().map(|unseen| unseen.parameter.key.path).collect()
}

#[test]
fn friction_of_retraction_is_not_invented_from_extensions() {
    let case = Case::draw(1, HIDDEN).expect("a case");
    let keys: Vec<&str> = case.hidden.iter().map(|(parameter, _)| parameter.key.path).collect();
    let (_, found) = fit(&keys, &[0, 4]);
    let mut unseen = unseen(&found);
    unseen.sort_unstable();
    assert_eq!(unseen, ["load.coulomb_retract_n", "load.static_retract_n"]);
    for unseen in &found.unseen {
        assert_eq!(found.rig.number(unseen.parameter.key.path), unseen.parameter.start, "it keeps its value");
    }
    let trial = Trial { hidden: case.hidden, found };
    for (key, miss) in trial.misses().filter_map(|(key, miss)| Some((key, miss?))) {
        assert!(miss.standard_errors.abs() < 4.0, "{key}: {miss:?}");
    }
}

#[test]
fn forces_that_only_act_together_are_said_to_be_confused() {
    let keys = ["load.coulomb_extend_n", "load.static_extend_n", "load.constant_force_n"];
    let (_, found) = fit(&keys, &[0, 4]);
    let [unseen] = found.unseen.as_slice() else { panic!("{:?}", unseen(&found)) };
    let confused: Vec<&str> = unseen.confused_with.iter().map(|confusion| confusion.path).collect();
    assert_eq!(confused.len(), 2, "{} with {confused:?}", unseen.parameter.key.path);
}
