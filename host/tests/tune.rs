//! `pneudrive tune`: what it leaves, and what it refuses.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

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
        "steps there and back in 5 fresh draws",
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
        "search",
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

/// Enough generations for a kill to come in between.
const LONG: &str =
    "tune servo-a --time 0.3 --tolerance-mm 2 --population 3 --generations 3 --draws 1 --yes --out t";

/// How many generations a state file has, behind its mark and its task.
fn generations(folder: &Path) -> usize {
    fs::read_to_string(folder.join("t/tune.state")).map_or(0, |text| text.lines().count().saturating_sub(2))
}

#[test]
fn a_killed_search_goes_on_where_it_stopped_and_ends_as_an_uninterrupted_one() {
    let (whole, killed) = (folder(), folder());
    ok(whole.path(), LONG);
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command
        .current_dir(killed.path())
        .args(LONG.split_whitespace())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let mut program = command.spawn().expect("the program runs");
    while generations(killed.path()) < 1 && program.try_wait().expect("a child").is_none() {
        std::thread::sleep(Duration::from_millis(2));
    }
    program.kill().expect("it runs");
    program.wait().expect("it was started");
    assert!(generations(killed.path()) >= 1 && !killed.path().join("t/tuned.toml").exists());
    let other = transcript(killed.path(), &LONG.replace("--draws 1", "--draws 2"));
    assert!(other.contains("tune.state is of an interrupted search of another task"), "{other}");
    let printed = transcript(killed.path(), LONG);
    assert!(
        printed.contains("generations of an interrupted search") && printed.ends_with("= 0"),
        "{printed}"
    );
    for name in ["tuned.toml", "tune.html"] {
        let read = |folder: &Path| fs::read(folder.join("t").join(name)).expect("written");
        assert!(read(whole.path()) == read(killed.path()), "{name} differs");
    }
    for folder in [whole, killed] {
        assert!(!folder.path().join("t/tune.state").exists(), "what is over has nothing to go on from");
    }
}

/// Once a default of the program decided over the law, the feed-forward and the dither of a tuned file.
#[test]
fn a_tuned_file_has_the_whole_result_and_says_what_was_searched() {
    let folder = folder();
    let small = "--time 0.3 --tolerance-mm 2 --population 2 --generations 1 --draws 1";
    ok(folder.path(), &format!("tune servo-b-tuned {small} --fix controller.velocity_gain=777 --out t"));
    let text = fs::read_to_string(folder.path().join("t/tuned.toml")).expect("written");
    let line = |begin: &str| {
        let found = text.lines().find(|line| line.starts_with(begin));
        found.unwrap_or_else(|| panic!("{begin}: {text}")).to_owned()
    };
    let searched = line("# Searched: ");
    assert!(
        searched.contains("controller.acceleration_gain") && searched.contains("operator.dither_mm"),
        "{searched}"
    );
    assert_eq!(line("# Fixed: "), "# Fixed: controller.velocity_gain");
    let not_searched = line("# Not searched: ");
    for key in ["controller.law", "controller.velocity_feed_forward", "controller.acceleration_feed_forward"]
    {
        assert!(not_searched.contains(key) && !searched.contains(key), "{key}: {not_searched}");
        let (_, name) = key.split_once('.').expect("a table");
        assert!(text.lines().any(|line| line.starts_with(&format!("{name} = "))), "{key}: {text}");
    }
    assert!(text.lines().any(|line| line.starts_with("dither_mm = ")), "{text}");
    ok(folder.path(), "tune t/tuned.toml --time 0.3 --generations 0 --draws 1 --out again");
    let again = fs::read_to_string(folder.path().join("again/tuned.toml")).expect("written");
    assert_eq!(again.matches("# Written by pneudrive tune").count(), 1, "{again}");
    assert!(again.contains("# Searched: none\n"), "{again}");
}
