//! The thesis, reproduced: its numbers are those of the golden file, and the command leaves them on a page.

use std::fs;
use std::path::Path;

use pneudrive_thesis::study::STARTS;
use pneudrive_thesis::{Exhibit, Experiment, exhibits, golden, run};

use crate::program::{exists, folder, ok, transcript};

const GOLDEN: &str = include_str!("thesis.toml");

/// The studies are left to `cargo xtask thesis`, which asks for `all`; host/tests/study.rs holds their verdicts.
fn wanted(asked: &str) -> Vec<&'static Exhibit> {
    let of_ci = |exhibit: &&Exhibit| matches!(exhibit.experiment, Experiment::Own(_));
    exhibits().into_iter().filter(|exhibit| !asked.is_empty() || of_ci(exhibit)).collect()
}

/// A change of the model shows here: find out why before the file is written anew (`cargo xtask thesis --write`).
#[test]
fn the_numbers_are_those_of_the_golden_file() {
    let asked = std::env::var("PNEUDRIVE_THESIS").unwrap_or_default();
    let shown = run(&wanted(&asked), STARTS, |_, _| {}).expect("every experiment can be repeated");
    if asked == "write" {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/thesis.toml");
        fs::write(path, golden::to_toml(&shown)).expect("written");
        return;
    }
    let changed = golden::changes(GOLDEN, &shown).expect("a golden file");
    assert!(changed.is_empty(), "{}", changed.join("\n"));
}

#[test]
fn the_golden_file_has_every_exhibit_and_the_readme_its_counts() {
    for exhibit in exhibits() {
        let heading =
            format!("[[\"{}\".number]]", format!("{} {}", exhibit.section, exhibit.place).trim_end());
        assert!(GOLDEN.contains(&heading), "{heading}");
    }
    let counts = GOLDEN.lines().nth(1).expect("a line of counts").trim_start_matches("# ");
    let readme = include_str!("../../README.md").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(readme.contains(counts.trim_end_matches('.')), "README has other counts than: {counts}");
}

/// docs/reference/thesis-audit.md: a row for the items of the thesis that differ or are missing for one reason, and lists of those that work.
#[test]
fn the_audit_counts_its_items() {
    let audit = include_str!("../../docs/reference/thesis-audit.md");
    let rows: Vec<Vec<&str>> = audit
        .lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with("| item"))
        .map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect())
        .collect();
    let items = |row: &Vec<&str>| row[0].split(';').count();
    let count = |word: &str| rows.iter().filter(|row| row[2] == word).map(items).sum::<usize>();
    let [differs, missing] = ["differs", "missing"].map(count);
    assert!(rows.iter().all(|row| ["differs", "missing"].contains(&row[2])), "every row is one of the two");
    let (_, lists) = audit.split_once("## What works as described").expect("the lists");
    let works: usize =
        lists.split("\n\n").filter(|list| list.contains("**")).map(|list| list.split(';').count()).sum();
    let all = works + differs + missing;
    let printed = format!("**{all} items: {works} work, {differs} differ, {missing} are missing.**");
    assert!(audit.contains(&printed), "the audit says otherwise than: {printed}");
    let unexplained = rows.iter().find(|row| row.get(3).is_none_or(|why| why.len() < 5));
    assert_eq!(unexplained, None, "what differs or is missing says why");
}

#[test]
fn a_section_leaves_its_page_and_its_numbers_and_tells_how_long_it_takes() {
    let folder = folder();
    let printed = ok(folder.path(), "thesis --only 7.1.3 --out t");
    exists(folder.path(), &["t/thesis.html", "t/thesis.toml"]);
    assert!(printed.starts_with("3 tables, figures and sections of the thesis: "), "{printed}");
    assert!(printed.contains("11 printed numbers: ") && !printed.contains("sentences"), "{printed}");
    let page = fs::read_to_string(folder.path().join("t/thesis.html")).expect("written");
    assert!(page.contains("7.1.3.1, Tab. 7.2") && !page.contains("7.1.2.1"), "one section alone");
    assert!(
        !page.contains("<script") && !page.contains("http") && !page.contains("NaN"),
        "it opens by itself"
    );
    assert!(
        page.contains("74.3 <small>") && page.contains("Lost from the scan: "),
        "what is printed, what is lost"
    );
    assert_eq!(page.matches("<section").count(), 3);
}

/// The statements of a study are on the page with their shares of starts.
#[test]
fn a_study_is_a_section_with_the_swings_of_its_starts() {
    let folder = folder();
    let printed = ok(folder.path(), "thesis --only 7.3.3 --starts 2 --out .");
    assert!(printed.contains("2 sentences: "), "{printed}");
    let page = fs::read_to_string(folder.path().join("thesis.html")).expect("written");
    assert!(page.contains("The valve works in three states") && page.contains("2 of 2, 100 % (34 to 100 %)"));
}

#[test]
fn a_section_that_there_is_not_and_a_file_of_the_users_are_refused() {
    let folder = folder();
    for wrong in ["--only 9", "--only 7.", "--only 7.1.2.11", "--starts 0"] {
        let printed = transcript(folder.path(), &format!("thesis {wrong} --out ."));
        assert!(printed.ends_with("= 2"), "{wrong}: {printed}");
    }
    let printed = transcript(folder.path(), "thesis --only 9 --out .");
    assert!(
        printed.contains("nothing of section 9 is reproduced; choose one of 7.1.1.3, 7.1.2.1,"),
        "{printed}"
    );
    for mine in ["thesis.html", "thesis.toml"] {
        fs::write(folder.path().join(mine), "mine").expect("written");
        let printed = transcript(folder.path(), "thesis --only 7.1.5 --out .");
        assert!(
            printed.contains(&format!("{mine} was not written by this program")) && printed.ends_with("= 1"),
            "{printed}"
        );
        assert_eq!(fs::read_to_string(folder.path().join(mine)).expect("there"), "mine");
        fs::remove_file(folder.path().join(mine)).expect("there");
    }
}
