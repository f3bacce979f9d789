//! `pneudrive tune`: what it leaves, and what it refuses.

mod program;

use std::fs;

use program::{exists, folder, ok, transcript};

const SHORT: &str = "tune servo-a --settled 2 --overshoot 20 --population 3 --generations 2";

#[test]
fn a_tuning_leaves_a_page_and_a_rig_that_can_be_simulated() {
    let folder = folder();
    let said = ok(folder.path(), &format!("{SHORT} --out t"));
    exists(folder.path(), &["t/tune.html", "t/tuned.toml"]);
    assert!(said.contains("of the file") && said.contains("The goal is met on "), "{said}");
    let page = fs::read_to_string(folder.path().join("t/tune.html")).expect("written");
    for part in
        ["the worst over all rigs", "the gains found, rig by rig", "controller.velocity_gain", "the search"]
    {
        assert!(page.contains(part), "{part}");
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
    let said = transcript(folder.path(), &format!("{SHORT} --out t"));
    assert!(said.contains("tuned.toml") && said.ends_with("= 1"), "{said}");
    assert_eq!(fs::read_to_string(folder.path().join("t/tuned.toml")).expect("there"), "name = \"mine\"\n");
    for wrong in ["--settled 0", "--load 60%", "--population 1", "--step=-3"] {
        assert!(
            transcript(folder.path(), &format!("tune servo-a --out u {wrong}")).ends_with("= 2"),
            "{wrong}"
        );
    }
    assert!(transcript(folder.path(), "tune bang-bang --out u").contains("controller.loop=closed"));
}
