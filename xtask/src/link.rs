//! The link under faults: often, and in all its states.

use pneudrive_build::cargo::{in_root, run};

use crate::tally::Tally;

/// The tests of the link, more often than CI has time for; they print their results.
pub fn soak(tally: &mut Tally) {
    let packages = ["test", "--package", "pneudrive", "--package", "pneudrive-link", "--test", "all"];
    let tests = ["--", "--nocapture", "faulty_link::", "kills::", "stream::", "two_hosts::"];
    let arguments = [&packages[..], &tests].concat();
    tally.check("soak of the link", || {
        let mut command = in_root(&arguments);
        command.env("PNEUDRIVE_DOWNLOADS", "100000").env("PNEUDRIVE_KILLS", "1000");
        run(command.env("PNEUDRIVE_PAIRS", "40").env("PNEUDRIVE_IMPORTS", "1500"))
    });
}

/// Bounds of the checker of the link: jobs of the two hosts, then faults, resets, power cuts and silences; with a PLC or a
/// gateway silences by halves and changes of contacts; and whether to go deep. These are CI's.
const BOUNDS_OF_CI: [&str; 2] = ["runs configures 1 1 1 0", "follows rests 1 1 0 0 2 0 gateway"];

/// All states of the link within wider bounds than the tests have.
pub fn states(tally: &mut Tally) {
    let wider = [
        "runs configures 2 1 1 0",
        "homes runs 2 1 0 0",
        "follows homes 1 0 0 0 2 0 gateway",
        "stops rests 0 0 0 0 0 6",
        "runs stops 0 0 0 0 0 2",
        "both both 1 0 0 0",
        "both both 0 0 0 1",
        "both both 1 1 1 0 deep",
        "runs runs 1 1 1 0",
        "runs runs 2 0 0 0",
        "runs runs 2 1 1 0 deep",
    ];
    for bounds in BOUNDS_OF_CI.into_iter().chain(wider) {
        all_states(tally, bounds, &["--release"]);
    }
}

/// The tests within the bounds of CI, with the builds of its tests.
pub fn states_in_short(tally: &mut Tally) {
    for bounds in BOUNDS_OF_CI {
        all_states(tally, bounds, &[]);
    }
}

fn all_states(tally: &mut Tally, bounds: &str, profile: &[&str]) {
    let run_it = ["--package", "pneudrive-link-states", "--example", "link_states", "--"];
    let bounds_of_it: Vec<&str> = bounds.split(' ').collect();
    tally.check(&format!("states of the link: {bounds}"), || {
        run(&mut in_root(&[&["run"], profile, &run_it, &bounds_of_it].concat()))
    });
}
