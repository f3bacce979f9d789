//! No request that an enabled drive takes makes a sample late.
#![cfg(unix)]

use pneudrive_hil_tests::requests::{MAX_INSTRUCTIONS, measure};

#[test]
fn no_piece_of_a_request_to_an_enabled_drive_takes_80_us_at_six_cycles_an_instruction() {
    let requests = measure().expect("an emulated board");
    for (name, instructions) in &requests {
        println!("{instructions:6} {name}");
    }
    let longest = requests.iter().max_by_key(|(_, instructions)| *instructions).expect("requests");
    assert!(longest.1 > 0 && longest.1 <= MAX_INSTRUCTIONS, "{longest:?}, {MAX_INSTRUCTIONS} are allowed");
}
