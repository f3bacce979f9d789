//! Results are what they were, bit for bit, unless the CHANGELOG says why they are not.

use pneudrive_hil_tests::golden::{compare, golden_file, is_accounted_for, records, traces, virtual_rig};

#[test]
fn the_traces_of_built_in_rigs_and_reference_cases_are_the_golden_ones() {
    let (found, golden_file) = (traces().expect("transients"), golden_file().expect("golden.toml"));
    compare(&found, &golden_file, "trace").unwrap_or_else(|error| panic!("{error:#}"));
}

#[test]
fn the_samples_of_target_files_of_the_virtual_rig_are_the_golden_ones() {
    let (found, golden_file) =
        (records(virtual_rig).expect("a virtual rig"), golden_file().expect("golden.toml"));
    compare(&found, &golden_file, "target").unwrap_or_else(|error| panic!("{error:#}"));
}

#[cfg(unix)]
#[test]
fn the_samples_of_target_files_of_the_emulated_board_are_the_golden_ones() {
    use pneudrive_hil_tests::QemuTarget;
    let found = records(|rig| Ok(Box::new(QemuTarget::start(rig)?))).expect("an emulated board");
    compare(&found, &golden_file().expect("golden.toml"), "target")
        .unwrap_or_else(|error| panic!("{error:#}"));
}

#[test]
fn every_golden_result_has_a_cause_that_the_changelog_holds() {
    for (name, golden) in golden_file().expect("golden.toml") {
        let accounted = is_accounted_for(&golden.cause).expect("CHANGELOG.md");
        assert!(accounted, "{name}: CHANGELOG.md has no line with the words {:?}", golden.cause);
    }
    assert!(!is_accounted_for("words that no changelog has").expect("CHANGELOG.md"));
    assert!(!is_accounted_for(" ").expect("CHANGELOG.md"), "no cause is none");
}

#[test]
fn a_changed_a_new_and_a_lost_result_are_named() {
    let golden_file = golden_file().expect("golden.toml");
    let mut found: std::collections::BTreeMap<String, String> = golden_file
        .iter()
        .filter(|(name, _)| name.starts_with("trace"))
        .map(|(name, golden)| (name.clone(), golden.crc64.clone()))
        .collect();
    compare(&found, &golden_file, "trace").expect("the same");
    found.insert("trace servo-a".to_owned(), "0".repeat(16));
    found.insert("trace new".to_owned(), "0".repeat(16));
    found.remove("trace servo-c");
    let error = compare(&found, &golden_file, "trace").expect_err("three differ").to_string();
    assert!(error.contains(r#"["trace new", "trace servo-a"]; no more there: ["trace servo-c"]"#), "{error}");
}
