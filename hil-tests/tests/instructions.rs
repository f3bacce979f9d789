//! The control interrupt costs what docs/firmware-figures.md says, and no more than is held: exact
//! instructions of whole runs in the emulator.
#![cfg(unix)]

use pneudrive_build::figures::{FIRMWARE, Off};
use pneudrive_hil_tests::cost::{
    BUDGET, Cost, MAX_INSTRUCTIONS, MAX_INSTRUCTIONS_OF_FIRST, TABLE, measure, table, together,
};

#[test]
fn sample_and_output_take_no_more_instructions_than_is_held() {
    let costs = measure().expect("an emulated board");
    let (both, first) = together(&costs);
    println!("{}\nall: {both}, first samples {first}, budget {BUDGET}", table(&costs));
    for Cost { run, figures } in &costs {
        let mean = figures.control_instructions.mean();
        assert!(mean <= BUDGET, "{run}: {mean:.0} instructions in the mean, the budget is {BUDGET}");
    }
    assert!(both.most <= MAX_INSTRUCTIONS, "{} instructions at most, held are {MAX_INSTRUCTIONS}", both.most);
    assert!(
        first.most <= MAX_INSTRUCTIONS_OF_FIRST,
        "{} at a first sample, held are {MAX_INSTRUCTIONS_OF_FIRST}",
        first.most
    );
    pneudrive_build::figures::hold(FIRMWARE, TABLE, &table(&costs), Off::EitherWay)
        .unwrap_or_else(|error| panic!("{error:#}"));
}
