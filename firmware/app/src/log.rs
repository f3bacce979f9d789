//! What the firmware logs to a debug probe, with the feature `log`: how it starts, changes of the drive's mode, refused requests and
//! damaged frames. An image without the feature has nothing of it. The interrupts of the control log nothing.

use pneudrive_controller::Mode;
use pneudrive_protocol::RequestRefusal;

/// Logs a line, as `defmt` does: `log!(error, "reset by fault {=u8}", code)`. A crate that uses it has the feature `log` and, with it, the
/// dependency `defmt`.
#[macro_export]
macro_rules! log {
    ($level:ident, $text:literal $(, $value:expr)* $(,)?) => {{
        #[cfg(feature = "log")]
        defmt::$level!($text $(, $value)*);
        #[cfg(not(feature = "log"))]
        {
            $(let _ = &$value;)*
        }
    }};
}

/// What was logged last.
#[derive(Debug, Default)]
pub(crate) struct LogState {
    mode: Option<Mode>,
    damaged_frames: u32,
}

impl LogState {
    /// Logs what has changed since the last call.
    pub(crate) fn log_changes(&mut self, mode: Mode, damaged_frames: u32) {
        if self.mode.replace(mode) != Some(mode) {
            log_mode(mode);
        }
        if self.damaged_frames != damaged_frames {
            log!(warn, "damaged frames: {=u32}", damaged_frames);
            self.damaged_frames = damaged_frames;
        }
    }
}

fn log_mode(mode: Mode) {
    match mode {
        Mode::Disarmed => log!(info, "mode: disarmed"),
        Mode::Armed => log!(info, "mode: armed"),
        Mode::Homing => log!(info, "mode: homing"),
        Mode::Running => log!(info, "mode: running"),
        Mode::Done => log!(info, "mode: done"),
        Mode::Fault(fault) => log!(error, "mode: fault {=u8}", fault.code()),
    }
}

/// Logs why a request was not carried out.
pub(crate) fn log_refusal(refused: &RequestRefusal<'_>) {
    match *refused {
        RequestRefusal::NotNow(code) => log!(warn, "refused: not now, code {=u8}", code),
        RequestRefusal::UnknownParameter { id } => log!(warn, "refused: no parameter {=u16}", id),
        RequestRefusal::OutOfRange { id, value } => {
            log!(warn, "refused: {=i32} is out of range of parameter {=u16}", value, id);
        }
        RequestRefusal::Inconsistent { advice } => log!(warn, "refused: {=str}", advice),
        RequestRefusal::TestTooLong => log!(warn, "refused: test too long"),
        RequestRefusal::MovesOutOfOrder => log!(warn, "refused: moves out of order"),
        RequestRefusal::TooManyMoves => log!(warn, "refused: too many moves"),
        RequestRefusal::NoRecord => log!(warn, "refused: no record"),
        RequestRefusal::RecordRange { samples } => {
            log!(warn, "refused: the record has {=u32} samples", samples)
        }
        RequestRefusal::Unknown => log!(warn, "refused: unknown request"),
        RequestRefusal::NotStored => log!(warn, "refused: the flash was not written"),
        RequestRefusal::OtherRecord => log!(warn, "refused: another record"),
        RequestRefusal::Owned(_) => log!(warn, "refused: another host commands the drive"),
        RequestRefusal::ChangeNotWhole => log!(warn, "refused: a part of the change is missing"),
        RequestRefusal::OtherTest => log!(warn, "refused: another test"),
        RequestRefusal::OtherBoot { number } => log!(warn, "refused: this is boot {=u32}", number),
    }
}
