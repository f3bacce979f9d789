//! The control interrupt costs what docs/firmware-figures.md says, and no more than is held: exact
//! instructions of whole runs in the emulator.
#![cfg(unix)]

use pneudrive_hil_tests::cost::{BUDGET, Cost, HELD, HELD_FIRST, document, measure, parts, table, together};

/// How far a figure may be off the table, per cent.
const TOLERANCE: u64 = 3;

fn numbers(table: &str) -> Vec<u64> {
    table.split([' ', '|', '\n']).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn sample_and_output_take_no_more_instructions_than_is_held() {
    let costs = measure().expect("an emulated board");
    let (both, first) = together(&costs);
    println!("{}\nall: {both}, first samples {first}, budget {BUDGET}", table(&costs));
    for Cost { run, figures } in &costs {
        let mean = figures.control_instructions.mean();
        assert!(mean <= BUDGET, "{run}: {mean:.0} instructions in the mean, the budget is {BUDGET}");
    }
    assert!(both.most <= HELD, "{} instructions at most, held are {HELD}", both.most);
    assert!(first.most <= HELD_FIRST, "{} at a first sample, held are {HELD_FIRST}", first.most);

    let text = std::fs::read_to_string(document()).expect("the document");
    let (written, measured) = (numbers(parts(&text).expect("a table").1), numbers(&table(&costs)));
    assert_eq!(written.len(), measured.len(), "write the table anew: cargo xtask figures");
    for (written, measured) in written.into_iter().zip(measured) {
        let off = written.abs_diff(measured) * 100;
        assert!(off <= TOLERANCE * written, "{measured} is not {written}: cargo xtask figures");
    }
}
