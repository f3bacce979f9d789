//! What docs/explanation/rigs.md says that the built-in rigs reach.

use crate::program::{folder, ok};

/// The cells of a rig in the table.
fn stated(rig: &str) -> Vec<String> {
    let row = include_str!("../../docs/explanation/rigs.md")
        .lines()
        .find(|line| line.starts_with(&format!("| {rig} |")));
    let row = row.unwrap_or_else(|| panic!("{rig} has a row"));
    row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// The same of the fresh draws, as `tune` says them: met, interval, tuned on, settle, after, overshoot, error, swing, open.
fn judged(rig: &str, settled_mm: &str) -> Vec<String> {
    let folder = folder();
    let asked = format!("tune {rig} --generations 0 --time 3 --tolerance-mm {settled_mm} --out t");
    let printed = ok(folder.path(), &asked);
    let row =
        printed.lines().find(|line| line.starts_with("of the file")).expect("the row of the file's gains");
    row.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).skip(1).map(str::to_owned).collect()
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn the_tuned_rigs_reach_what_the_page_says() {
    for rig in ["servo-a-tuned", "servo-c-tuned"] {
        let (row, at_1, at_5) = (stated(rig), judged(rig, "1"), judged(rig, "0.05"));
        let met = |seen: &[String]| format!("{} ({})", seen[0], seen[1]);
        let expected = [&at_1[3], &at_1[4], &at_1[6], &met(&at_1), &at_1[8], &met(&at_5)];
        assert_eq!(row[1..].iter().collect::<Vec<_>>(), expected, "{rig}");
    }
}
