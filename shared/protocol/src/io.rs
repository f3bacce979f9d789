//! The digital inputs and outputs of a drive that is commanded without a PC: a bit each.
//!
//! A positioning controller has such terminals: a number selects a record of a table, an edge begins it, and the drive
//! answers by ready, in position and fault.

/// Inputs.
pub mod input {
    /// The number of a move record; [`HOMING`] homes the axis. 0 is none: so are lines that are all open.
    pub const NUMBER: u8 = 0x0f;
    /// The number that homes the axis: a broken wire never turns another number into this one.
    pub const HOMING: u8 = 15;
    /// From off to on: begins the record of the number.
    pub const START: u8 = 0x10;
    /// From off to on: acknowledges a fault or a stop.
    pub const ACKNOWLEDGE: u8 = 0x20;
    /// Off: stops the drive. So a broken wire stops it, as a contact that opens does.
    pub const RUN: u8 = 0x40;
    /// Off: nothing begins, and what these inputs have begun is disabled.
    pub const ENABLE: u8 = 0x80;
}

/// Outputs.
pub mod output {
    /// A start is listened to.
    pub const READY: u8 = 0x01;
    /// What was begun last is done: the axis has arrived, has stayed for its dwell, and is there now.
    pub const IN_POSITION: u8 = 0x02;
    /// The drive has tripped or was stopped, and nobody has acknowledged it.
    pub const FAULT: u8 = 0x04;
    /// The lamp of the board.
    pub const LAMP: u8 = 0x08;
}

/// Codes of why the last start of the inputs was not carried out, beside those of the controller (below 128) and of
/// [`RequestRefusal::NotNow`](crate::RequestRefusal::NotNow); 0: it was.
pub mod refused {
    /// There is no record of this number.
    pub const NO_RECORD: u8 = 160;
    /// Records are positions: the controller must be in closed loop.
    pub const OPEN_LOOP: u8 = 161;
    /// The fault or the stop was not acknowledged.
    pub const FAULT: u8 = 162;
    /// Start or number changed before they had stayed for their settling time.
    pub const UNSETTLED: u8 = 163;
}
