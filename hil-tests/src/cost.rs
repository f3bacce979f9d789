//! The cost of the control interrupt, over runs of the servo-drives in the emulator.

use std::fmt::Write;

use anyhow::Result;
use pneudrive_sim::Rig;

use crate::emulated_board::{Figures, Spread};
use crate::{QemuTarget, body};

/// What `on_sample` and `on_output` of one sample are to take together in the mean of a run, instructions,
/// recorder on.
pub const BUDGET: f64 = 400.0;

/// What they may take by now at most, after the first sample of a run: where moves begin.
pub const MAX_INSTRUCTIONS: u64 = 480;

/// The same of the first sample of a run.
pub const MAX_INSTRUCTIONS_OF_FIRST: u64 = 490;

/// What both may take under the law cascade, in the mean of a run and at most: on a drive by its data sheets, and on one whose
/// spool is measured behind tubes.
pub const BUDGETS_OF_CASCADE: [(f64, u64); 2] = [(2150.0, 3600), (2550.0, 4250)];

/// A run and what it has cost.
pub struct Cost {
    /// The rig and its loop.
    pub run: String,
    /// Its figures.
    pub figures: Figures,
}

/// What servo-drives A, B and C cost, in closed loop and in open loop.
///
/// # Errors
/// When there is no emulated board.
pub fn measure() -> Result<Vec<Cost>> {
    let cost = |(run, rig): (String, Rig)| {
        let target = QemuTarget::start(&rig)?;
        let _ = body::run_and_record(&target, &rig);
        Ok(Cost { run, figures: target.board().figures() })
    };
    runs().into_iter().map(cost).collect()
}

/// What the law cascade costs, there and back, on the drives of [`BUDGETS_OF_CASCADE`].
///
/// # Errors
/// When there is no emulated board.
pub fn measure_cascade() -> Result<Vec<Cost>> {
    let text = include_str!("../../sim/tests/cascade/press.toml");
    let moves = "test.moves=[[0.1, 12250], [0.8, 3000]]".to_owned();
    let press = Rig::read_with("press", text, &[moves])?;
    let cost = |(run, rig): (&str, Rig)| {
        let target = QemuTarget::start(&rig)?;
        let _ = body::run_and_record(&target, &rig);
        Ok(Cost { run: run.to_owned(), figures: target.board().figures() })
    };
    let runs = [("press, on a model", press), ("servo-c, on a model", body::with_a_measured_spool())];
    runs.into_iter().map(cost).collect()
}

/// The figures as a table of Markdown.
#[must_use]
pub fn table(costs: &[Cost]) -> String {
    let mut text =
        String::from("| run | sample | output | both | both, first sample |\n|---|---|---|---|---|\n");
    for Cost { run, figures } in costs {
        let Figures { sample_instructions, output_instructions, .. } = figures;
        let (both, first) = (figures.control_instructions, figures.first_instructions);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {run} | {sample_instructions} | {output_instructions} | {both} | {} |",
            first.most
        );
    }
    text
}

/// The figures of all runs together: after the first samples, and at them.
#[must_use]
pub fn together(costs: &[Cost]) -> (Spread, Spread) {
    let none = (Spread::default(), Spread::default());
    costs.iter().fold(none, |(both, first), Cost { figures, .. }| {
        (both.and(figures.control_instructions), first.and(figures.first_instructions))
    })
}

/// The table's name in docs/reference/firmware-figures.md.
pub const TABLE: &str = "instructions";

/// Measures, and writes the table of the document anew.
///
/// # Errors
/// When there is no emulated board, or no document.
pub fn write_the_table() -> Result<()> {
    pneudrive_build::figures::write(pneudrive_build::figures::FIRMWARE, TABLE, &table(&measure()?))
}

/// Steps that begin, arrive and are reversed.
fn runs() -> Vec<(String, Rig)> {
    let closed = "test.moves=[[0.0, 8192], [0.3, 16384], [1.2, 12000]]";
    let steps = "test.moves=[[0.0, 0], [0.1, 12], [0.5, -10], [1.2, 4]]";
    let counts = "test.moves=[[0.0, 0], [0.1, 512], [0.5, -512], [1.2, 200]]";
    let duration = "test.duration_s=2";
    let both = |(name, open): (&str, &str)| {
        [
            (format!("{name}, closed loop"), body::as_built_in(name, &[duration, closed])),
            (
                format!("{name}, open loop"),
                body::as_built_in(name, &[duration, open, "controller.loop=open"]),
            ),
        ]
    };
    [("servo-a", steps), ("servo-b", counts), ("servo-c", counts)].into_iter().flat_map(both).collect()
}
