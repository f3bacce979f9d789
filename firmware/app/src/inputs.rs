//! The digital inputs beside the control: their orders are carried out in pieces, as requests are ([`crate::selector`]).

use crate::shared_drive::{SharedDrive, with_learned};

/// Reads the inputs, carries out their orders and drives the outputs: once a sample, from the idle task. It works in
/// pieces, like a request: the learned null offset of the last run is prepared in between.
pub fn attend(drive: &mut impl SharedDrive) {
    if !drive.lock(|control, board| control.heed_inputs(board)) {
        return;
    }
    with_learned(drive, |control, learned, board| control.begin_selected(learned, board));
}
