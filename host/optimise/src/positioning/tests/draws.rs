//! Draws are reproducible, and within what is promised.

use pneudrive_sim::{Rig, keys};

use super::drive;
use crate::positioning::draw::{Draw, Spread, draws, places};
use crate::positioning::{Steps, usual_step_mm};

const WHOLE: Spread = Spread { whole_range: true, bristles: false };

fn drawn(rig: &Rig, spread: Spread) -> Vec<Rig> {
    let draws = draws(rig, spread, 7, 200).expect("draws");
    draws.iter().map(|draw| draw.rig(rig).unwrap_or_else(|problems| panic!("{problems}"))).collect()
}

/// Least and greatest of the drawn values of a key, over the file's.
fn ratios(file: &Rig, rigs: &[Rig], key: &str) -> [f64; 2] {
    let of = |rig: &Rig| rig.number_at(key).expect("a number");
    let values = rigs.iter().map(|rig| of(rig) / of(file));
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ratio| [low.min(ratio), high.max(ratio)])
}

/// 200 even draws reach the last tenth of the spread on both sides but for one set of draws in a billion.
fn fills([low, high]: [f64; 2], by: f64) -> bool {
    let (near, far) = (1.0 - 0.8 * by, 1.0 + 0.8 * by);
    (1.0 - by..near).contains(&low) && (far..=1.0 + by).contains(&high)
}

#[test]
fn load_and_friction_differ_by_30_percent_and_the_supply_by_5_and_nothing_else_does() {
    let file = drive("32x250", &[]);
    let rigs = drawn(&file, Spread::default());
    for (key, by) in [
        ("load.mass_kg", 0.3),
        ("load.static_extend_n", 0.3),
        ("load.coulomb_retract_n", 0.3),
        ("load.viscous_n_s_per_m", 0.3),
        ("supply.pressure_pa", 0.05),
    ] {
        let ratios = ratios(&file, &rigs, key);
        assert!(fills(ratios, by), "{key}: {ratios:?}");
    }
    for key in ["valve.underlap_mm", "valve.sonic_conductance_m3_per_s_pa", "actuator.residual_volume_1_m3"] {
        assert_eq!(ratios(&file, &rigs, key), [1.0, 1.0], "{key}");
    }
    assert!(rigs.iter().all(|rig| rig.get(&keys::sensors::NOISE_COUNTS) == 1.0));
}

#[test]
fn the_same_seed_draws_the_same_and_more_draws_begin_with_the_fewer() {
    let file = drive("32x250", &[]);
    let of = |seed, count| draws(&file, WHOLE, seed, count).expect("draws");
    let twenty: Vec<Draw> = of(3, 20);
    assert_eq!(twenty, of(3, 20));
    assert_eq!(twenty[..5], of(3, 5));
    assert_ne!(twenty, of(4, 20));
    assert_eq!(places(3, 20)[..5], places(3, 5));
}

#[test]
fn the_whole_range_stays_within_the_ranges_of_the_file_and_reaches_their_ends() {
    let file = drive("32x250", &[]);
    let rigs = drawn(&file, WHOLE);
    for key in [
        "valve.underlap_mm",
        "valve.critical_ratio",
        "valve.leakage_percent",
        "valve.sonic_conductance_m3_per_s_pa",
        "operator.hysteresis_percent",
        "operator.stiffness_per_mass_per_s2",
        "actuator.residual_volume_1_m3",
        "actuator.residual_volume_2_m3",
        "load.viscous_n_s_per_m",
    ] {
        let origin = file.origin(pneudrive_sim::rig::find_key(key).expect("a key"));
        let [low, high] = origin.range.expect("a range");
        let value = file.number_at(key).expect("a number");
        let [least, greatest] = ratios(&file, &rigs, key).map(|ratio| ratio * value);
        let tenth = 0.1 * (high - low);
        let rounding = 1e-12 * high;
        assert!((low - rounding..low + tenth).contains(&least), "{key}: {least} of {low}");
        assert!((high - tenth..high + rounding).contains(&greatest), "{key}: {greatest} of {high}");
    }
    assert!(fills(ratios(&file, &rigs, "load.mass_kg"), 0.3), "the mass is known to 30 %");
}

#[test]
fn friction_of_the_whole_range_breaks_away_at_1_25_to_3_3_times_its_running_force() {
    let file = drive("32x250", &[]);
    let [low, high] = file.origin(&keys::friction::COULOMB_EXTEND_N).range.expect("a range");
    for rig in drawn(&file, WHOLE) {
        let of = |running, breakaway| (rig.get(running), rig.get(breakaway) / rig.get(running));
        let (out, ratio_out) = of(&keys::friction::COULOMB_EXTEND_N, &keys::friction::STATIC_EXTEND_N);
        let (back, ratio_back) = of(&keys::friction::COULOMB_RETRACT_N, &keys::friction::STATIC_RETRACT_N);
        assert!((0.9 * low..=1.1 * high).contains(&out) && (0.9 / 1.1..=1.1 / 0.9).contains(&(out / back)));
        assert!((1.25..=3.3).contains(&ratio_out) && (ratio_out - ratio_back).abs() < 1e-9);
    }
}

#[test]
fn a_spool_of_another_stiffness_keeps_its_damping_ratio() {
    let file = drive("32x250", &[]);
    let ratio = |rig: &Rig| {
        rig.get(&keys::empirical::DAMPING_PER_S) / rig.get(&keys::empirical::STIFFNESS_PER_MASS_PER_S2).sqrt()
    };
    for rig in drawn(&file, WHOLE) {
        assert!((ratio(&rig) / ratio(&file) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn bristles_are_the_same_draws_with_another_friction() {
    let file = drive("32x250", &[]);
    let dry = drawn(&file, Spread::default());
    let bristles = drawn(&file, Spread { bristles: true, ..Spread::default() });
    for (dry, bristles) in dry.iter().zip(&bristles) {
        assert_eq!(bristles.word_at("load.friction"), Some("lugre"));
        assert_eq!(dry.get(&keys::load::MASS_KG), bristles.get(&keys::load::MASS_KG));
        assert_eq!(dry.get(&keys::friction::STATIC_EXTEND_N), bristles.get(&keys::friction::STATIC_EXTEND_N));
    }
}

#[test]
fn a_rig_file_that_leaves_nothing_open_has_no_whole_range() {
    let file = Rig::builtin("servo-b").expect("a built-in rig");
    let message = draws(&file, WHOLE, 1, 1).expect_err("nothing is open").to_string();
    assert!(message.contains("servo-b") && message.contains("nothing is open"), "{message}");
}

#[test]
fn steps_go_both_ways_and_keep_5_percent_of_the_stroke_from_its_ends() {
    let file = drive("20x150", &[]);
    assert_eq!(usual_step_mm(&file), 60.0);
    assert_eq!(
        usual_step_mm(&drive(
            "20x150",
            &["actuator.stroke_m=0.1", "test.moves=[[0.0, 5000]]", "test.position_m=0.050005"]
        )),
        40.0
    );
    let steps: Vec<Steps> =
        places(1, 200).into_iter().map(|place| Steps::of(&file, 60.0, place).expect("it fits")).collect();
    assert!(steps.iter().all(|one| (one.to - one.from).abs() == 6000));
    let extending = steps.iter().filter(|one| one.to > one.from).count();
    assert!((70..130).contains(&extending), "{extending}");
    let ends = || steps.iter().flat_map(|one| [one.from, one.to]);
    assert!((750..1000).contains(&ends().min().expect("steps")));
    assert!((14_000..=14_250).contains(&ends().max().expect("steps")));
}

#[test]
fn a_step_that_does_not_fit_is_refused_with_the_way_that_there_is() {
    let file = drive("20x150", &[]);
    let place = places(1, 1)[0];
    let message = Steps::of(&file, 300.0, place).expect_err("too long").to_string();
    assert!(message.contains("300 mm") && message.contains("7.5 and 142.5 mm"), "{message}");
    assert!(Steps::of(&file, 0.004, place).is_err());
}
