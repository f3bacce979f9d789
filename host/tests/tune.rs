//! `pneudrive tune`: what it leaves, and what it refuses.

use std::fs;

use crate::program::{exists, folder, ok, transcript};

/// Gains that any others are better than.
const SHORT: &str = "tune servo-a --set controller.gain_profile=[65535] --tolerance-mm 2 --overshoot 20 --population 3 --generations 2 --draws 5";

#[test]
fn a_tuning_leaves_a_page_and_a_rig_that_can_be_simulated() {
    let folder = folder();
    let printed = ok(folder.path(), &format!("{SHORT} --out t"));
    exists(folder.path(), &["t/tune.html", "t/tuned.toml"]);
    let first = printed.lines().find(|line| !line.contains("runs")).expect("a verdict");
    assert!(first.starts_with("The goal is met in ") && first.contains(" of 5, "), "{printed}");
    assert!(first.contains("of the fresh draws (in brackets 95 % intervals)"), "{printed}");
    assert!(printed.contains("of 21 trials that the gains were tuned on"), "{printed}");
    let page = fs::read_to_string(folder.path().join("t/tune.html")).expect("written");
    let parts = [
        "The goal is met in",
        "the steps there and back of 5 fresh draws",
        "in 5 fresh draws from the spread",
        "the rig of the file in mid-stroke",
        "the step along the stroke",
        "sines in mid-stroke",
        "where the squared error of the sines arises",
        "controller.velocity_gain",
        "the gains within their search ranges",
        "the fresh draws one by one, the worst first",
        "the gain profile",
        "a sine of 0.5 Hz and 60.0 mm",
        "a sine of 1 Hz and 60.0 mm",
        "the search",
    ];
    let mut rest = &page[page.find("<body>").expect("a body")..];
    for part in parts {
        let at = rest.find(part).unwrap_or_else(|| panic!("{part}, in this order"));
        rest = &rest[at..];
    }
    ok(folder.path(), "rig check t/tuned.toml");
    ok(folder.path(), "simulate t/tuned.toml --set test.duration_s=0.1 --out run");
    // Again is no harm.
    ok(folder.path(), &format!("{SHORT} --out t"));
}

#[test]
fn what_is_somebody_elses_is_not_written_over_and_what_is_no_number_is_refused() {
    let folder = folder();
    fs::create_dir(folder.path().join("t")).expect("made");
    fs::write(folder.path().join("t/tuned.toml"), "name = \"mine\"\n").expect("written");
    let printed = transcript(folder.path(), &format!("{SHORT} --out t"));
    assert!(printed.contains("tuned.toml") && printed.ends_with("= 1"), "{printed}");
    assert_eq!(fs::read_to_string(folder.path().join("t/tuned.toml")).expect("there"), "name = \"mine\"\n");
    for wrong in ["--load 60%", "--population 1", "--step=-3"] {
        assert!(
            transcript(folder.path(), &format!("tune servo-a --out u {wrong}")).ends_with("= 2"),
            "{wrong}"
        );
    }
    assert!(transcript(folder.path(), "tune bang-bang --out u").contains("controller.loop=closed"));
}

#[test]
fn a_held_key_stays_in_the_file_that_is_left() {
    let folder = folder();
    let held = "--fix controller.velocity_gain=777 --fix controller.acceleration_window_samples";
    ok(folder.path(), &format!("{SHORT} --set name=mine {held} --out t"));
    let text = fs::read_to_string(folder.path().join("t/tuned.toml")).expect("written");
    assert!(text.contains("velocity_gain = 777  # set for pneudrive tune"), "{text}");
    assert!(text.contains("acceleration_window_samples = 3  # set for pneudrive tune"), "{text}");
    assert!(text.contains("name = \"mine\"  # set for pneudrive tune"), "{text}");
    for (wrong, printed) in [
        ("load.mass_kg=2", "the spread draws load.mass_kg"),
        ("load.mass_kg", "the spread draws load.mass_kg"),
        ("operator.ditter_mm=0", "did you mean dither_mm?"),
    ] {
        let told = transcript(folder.path(), &format!("tune servo-b --out u --fix {wrong}"));
        assert!(told.contains(printed) && told.ends_with("= 1"), "{told}");
    }
    assert!(transcript(folder.path(), "tune servo-b --out u --step 299").contains("does not fit between"));
}

/// The step and the sines take the place of a test with moves of its own.
#[test]
fn a_rig_whose_own_test_has_profiles_is_tuned_by_a_step_all_the_same() {
    let folder = folder();
    let moves = "[[test.move]]\nprofile = \"s-curve\"\nto_mm = 150\n";
    fs::write(folder.path().join("moves.toml"), moves).expect("written");
    fs::write(folder.path().join("profile.toml"), "[test]\nprofile = \"trapezoid\"\n").expect("written");
    for rig in ["moves.toml", "profile.toml"] {
        let printed = ok(folder.path(), &format!("tune {rig} --generations 0 --draws 2 --settled 1 --out t"));
        assert!(printed.contains("The goal is met in "), "{rig}: {printed}");
    }
}
