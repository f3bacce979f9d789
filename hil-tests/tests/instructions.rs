//! The control interrupt costs what docs/reference/firmware-figures.md says, and no more than is held: exact
//! instructions of whole runs in the emulator.
#![cfg(unix)]

use pneudrive_build::figures::{FIRMWARE, OffTable};
use pneudrive_hil_tests::cost::{
    BUDGET, BUDGETS_OF_CASCADE, Cost, MAX_INSTRUCTIONS, MAX_INSTRUCTIONS_OF_FIRST, TABLE, measure,
    measure_cascade, table, together,
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
    pneudrive_build::figures::hold(FIRMWARE, TABLE, &table(&costs), OffTable::EitherWay)
        .unwrap_or_else(|error| panic!("{error:#}"));
}

/// The law cascade computes a model of the drive at each sample, and a trajectory where a move begins.
#[test]
fn the_law_on_a_model_takes_no_more_instructions_than_is_held() {
    let costs = measure_cascade().expect("an emulated board");
    println!("{}", table(&costs));
    assert_eq!(costs.len(), BUDGETS_OF_CASCADE.len());
    for (Cost { run, figures }, (mean, most)) in costs.into_iter().zip(BUDGETS_OF_CASCADE) {
        let figures = figures.control_instructions;
        assert!(figures.mean() <= mean, "{run}: {:.0} in the mean, held are {mean}", figures.mean());
        assert!(figures.most <= most, "{run}: {} at most, held are {most}", figures.most);
    }
}
