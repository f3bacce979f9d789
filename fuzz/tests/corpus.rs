//! The inputs in `fuzz/corpus`, one test a fuzz target.

use std::fs;
use std::path::Path;

use pneudrive_fuzz as properties;

/// Calls `property` with every input that is kept for a target, which must be some.
fn replay(target: &str, property: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let inputs: Vec<_> = entries.map(|entry| entry.expect("readable").path()).collect();
    assert!(inputs.len() >= 5, "{} holds {} inputs", folder.display(), inputs.len());
    for path in inputs {
        property(&fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())));
    }
}

#[test]
fn any_stream_of_bytes_leaves_the_decoder_of_frames_able_to_find_the_next() {
    replay("frame", properties::frame);
}

#[test]
fn any_message_that_is_understood_says_the_same_again() {
    replay("message", properties::message);
}

#[test]
fn whatever_hosts_ask_for_the_drive_moves_for_its_owner_alone_and_what_is_refused_changes_nothing() {
    replay("requests", properties::requests);
}

#[test]
fn any_target_file_that_is_read_is_the_one_that_would_be_written() {
    replay("target_file", properties::target_file);
}

#[test]
fn any_rig_file_that_is_taken_makes_a_drive() {
    replay("rig_file", properties::rig_file);
}
