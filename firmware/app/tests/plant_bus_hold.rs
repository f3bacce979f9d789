//! What was added to version 1 of the plant bus: the plant of a drive that holds moves on.
//!
//! DO NOT CHANGE THIS TEST. A plant that knows version 1 alone takes these bytes for [`Next::Advance`].

use pneudrive_app::plant_bus::{Next, Outputs};

#[test]
fn a_plant_that_is_held_moves_on_and_is_told_so_behind_the_number_of_its_step() {
    let outputs = Outputs { next: Next::Hold, ..Outputs::OFF };
    let mut bytes = [0; Outputs::BYTES];
    (bytes[4], bytes[8]) = (1, 1);
    assert_eq!(outputs.to_bytes(), bytes);
    assert_eq!(Outputs::from_bytes(bytes), Some(outputs));
    bytes[8] = 2;
    let advance = Outputs { next: Next::Advance, ..Outputs::OFF };
    assert_eq!(
        Outputs::from_bytes(bytes),
        Some(advance),
        "what a later version says of a step is passed over"
    );
}
