//! The table tests/counts/work.md, which docs/reference/counts.md shows: work counters of every built-in rig and every
//! reference case.

use pneudrive_sim::rigfile::{BUILTIN, builtin};
use pneudrive_sim::{Accuracy, Rig, run};

pub const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/counts/work.md");

const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases");

/// Before the rows.
const BEGIN: &str = "|---|---|---|---|---|---|---|---|\n";

/// A built-in rig, or a reference case.
pub fn rig(name: &str) -> Result<Rig, String> {
    let text = match builtin(name) {
        Some(text) => text.to_owned(),
        None => std::fs::read_to_string(format!("{CASES}/{name}.toml"))
            .map_err(|_| format!("{name} is neither a built-in rig nor a reference case"))?,
    };
    Rig::read(name, &text).map_err(|problems| problems.to_string())
}

/// The row of a rig.
pub fn row(name: &str, rig: &Rig) -> String {
    let run = run(rig, Accuracy::of(rig)).expect("a transient");
    let (work, network) = (run.work.integrator, run.work.network);
    let a_sample = work.n_rhs_evaluations as f64 / run.observations.len() as f64;
    format!(
        "| {name} | {a_sample:.1} | {} | {} | {} | {} | {} | {} |\n",
        work.n_rhs_evaluations,
        work.n_steps,
        work.n_rejected_steps,
        work.n_restarts,
        network.iterations,
        network.bracketed,
    )
}

/// All rows.
pub fn rows() -> Result<String, String> {
    let mut names: Vec<String> = BUILTIN.iter().map(|(name, _)| (*name).to_owned()).collect();
    let files = std::fs::read_dir(CASES).map_err(|error| format!("{CASES}: {error}"))?;
    let files = files.filter_map(|file| file.ok()?.file_name().into_string().ok());
    let mut cases: Vec<String> =
        files.filter_map(|file| Some(file.strip_suffix(".toml")?.to_owned())).collect();
    cases.sort();
    names.extend(cases);
    names.iter().map(|name| rig(name).map(|rig| row(name, &rig))).collect()
}

/// The rows that a page has.
pub fn of_page(page: &str) -> Option<&str> {
    page.split_once(BEGIN).map(|(_, rows)| rows)
}

/// The page with other rows.
pub fn replaced(page: &str, rows: &str) -> Option<String> {
    of_page(page).map(|old| format!("{}{rows}", page.trim_end_matches(old)))
}
