//! Keys that are held, and limits of what is searched.

use super::*;

fn keys_of(settings: &[String]) -> Vec<&str> {
    settings.iter().filter_map(|setting| Some(setting.split_once('=')?.0)).collect()
}

#[test]
fn a_held_key_is_not_looked_for_and_the_others_go_by_it() {
    let space = |fixed: &[&str]| {
        let fixed: Vec<String> = fixed.iter().map(|&key| key.to_owned()).collect();
        let settings = [&["operator.dither_adjustable=true".to_owned()], &fixed[..]].concat();
        let keys: Vec<String> =
            fixed.iter().map(|one| one.split_once('=').expect("a value").0.to_owned()).collect();
        Space::of(&rig("servo-b", &settings), GOAL.settled_mm, &keys).expect("a space")
    };
    let settings = |fixed: &[&str]| {
        let space = space(fixed);
        space.settings(&vec![0.4; space.len()])
    };
    let value = |settings: &[String], key: &str| {
        settings.iter().find_map(|one| one.strip_prefix(&format!("{key}="))).map(str::to_owned)
    };
    let all = space(&[]).len();
    assert!(!keys_of(&settings(&["operator.dither_mm=0.1"])).contains(&"operator.dither_mm"));
    assert_eq!(space(&["operator.dither_mm=0.1"]).len(), all - 1);
    assert_eq!(space(&["operator.dither_mm=0.0"]).len(), all - 2, "no dither has no frequency");

    let (velocity, window) = ("controller.velocity_gain", "controller.velocity_window_samples");
    let number =
        |settings: &[String]| value(settings, velocity).expect("a gain").parse::<f64>().expect("a number");
    let ratio = number(&settings(&["controller.velocity_window_samples=3"]))
        / number(&settings(&["controller.velocity_window_samples=12"]));
    assert!((ratio - 4.0).abs() < 0.01, "{ratio}");
    assert_eq!(value(&settings(&["controller.velocity_window_samples=3"]), window), None);

    let profile = settings(&["controller.gain_profile=[900, 300]", "controller.profile_span_counts=7"]);
    assert!(!keys_of(&profile).iter().any(|key| key.contains("profile")), "{profile:?}");
    let steeper = settings(&["controller.gain_profile=[900, 600]", "controller.profile_span_counts=7"]);
    assert!((number(&steeper) / number(&profile) - 2.0).abs() < 0.02, "the damping goes with the last entry");
    let span = settings(&["controller.profile_span_counts=7"]);
    assert!(
        keys_of(&span).contains(&"controller.gain_profile")
            && value(&span, "controller.profile_span_counts").is_none()
    );
}

#[test]
fn a_key_that_cannot_be_held_is_refused_by_what_can() {
    let refused = |fixed: &str| {
        let task = Task { fixed: vec![fixed.to_owned()], ..task("servo-b", &[]) };
        fixed::check(&task).expect_err("refused").to_string()
    };
    for (fixed, why) in [
        ("operator.ditter_mm=0", "did you mean dither_mm?"),
        ("controller.velocity_gian=3", "did you mean velocity_gain?"),
        ("operator.dither_mm=loud", "must be a number"),
        ("load.mass_kg=2", "the spread draws load.mass_kg"),
        ("load.viscous_n_s_per_m=2", "the spread draws"),
        ("test.moves=[[0.0, 1]]", "the step itself sets test.moves"),
    ] {
        let message = refused(fixed);
        assert!(
            message.contains(why) && message.contains("operator.dither_mm, operator.dither_hz"),
            "{message}"
        );
    }
    let known = Relative { load: 0.0, friction: 0.3, supply: 0.0, valve: 0.0 };
    let fixed = ["load.mass_kg=2.0", "controller.period_s=0.002", "controller.velocity_gain=100"];
    let fixed = fixed.map(str::to_owned).to_vec();
    fixed::check(&Task { fixed, spread: known, ..task("servo-b", &[]) }).expect("any other key can be held");
    let all = ["proportional_gain", "velocity_gain", "acceleration_gain", "velocity_window_samples"]
        .into_iter()
        .chain(["acceleration_window_samples", "dead_band_counts", "null_offset_counts"]);
    let all: Vec<String> = all.map(|key| format!("controller.{key}")).collect();
    let rig_a = rig("servo-a", &["controller.law=proportional".to_owned()]);
    let error = Space::of(&rig_a, GOAL.settled_mm, &all).expect_err("nothing is left").to_string();
    assert!(error.contains("every key that tune searches is fixed"), "{error}");
}

#[test]
fn what_was_found_at_an_end_of_its_range_is_told_with_the_range() {
    let space =
        Space::of(&rig("servo-b", &["operator.dither_adjustable=true".to_owned()]), GOAL.settled_mm, &[])
            .expect("a space");
    let limits = |share: f64| {
        let places = space.places(&vec![share; space.len()]);
        places.into_iter().filter(|place| place.at_limit).map(|place| place.what).collect::<Vec<_>>()
    };
    assert_eq!(limits(0.5), [""; 0]);
    assert_eq!(limits(1.0).len(), space.len() - 1, "a dead band cannot be wider than what counts as settled");
    let low = limits(0.0);
    assert!(low.contains(&"time of the velocity feedback, T_d"));
    assert!(!low.iter().any(|what| what.starts_with("dither of")), "none is a natural end: {low:?}");
    let dither =
        space.places(&vec![1.0; space.len()]).into_iter().find(|place| place.what == "dither of the spool");
    assert_eq!(dither.map(|place| (place.range, place.value, place.unit)), Some(([0.0, 0.6], 0.6, "mm")));
    let settings = ["controller.velocity_gain=65535", "controller.gain_profile=[65535, 30]", "x=6"];
    assert_eq!(
        Space::saturated(&settings.map(str::to_owned)),
        ["controller.velocity_gain", "controller.gain_profile"]
    );
}
