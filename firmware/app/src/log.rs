//! What the firmware tells a debug probe, with the feature `log`: how it starts, changes of the drive's mode, refused requests and
//! damaged frames. An image without the feature has nothing of it. The control's interrupts tell nothing.

use pneudrive_controller::Mode;
use pneudrive_protocol::RequestRefusal;

/// Tells, as `defmt` does: `tell!(error, "reset by fault {=u8}", code)`. A crate that uses it has the feature `log` and, with it, the
/// dependency `defmt`.
#[macro_export]
macro_rules! tell {
    ($level:ident, $text:literal $(, $value:expr)* $(,)?) => {{
        #[cfg(feature = "log")]
        defmt::$level!($text $(, $value)*);
        #[cfg(not(feature = "log"))]
        {
            $(let _ = &$value;)*
        }
    }};
}

/// What was told last.
#[derive(Debug, Default)]
pub(crate) struct Told {
    mode: Option<Mode>,
    damaged_frames: u32,
}

impl Told {
    /// Tells what is new.
    pub(crate) fn news(&mut self, mode: Mode, damaged_frames: u32) {
        if self.mode.replace(mode) != Some(mode) {
            tell_mode(mode);
        }
        if self.damaged_frames != damaged_frames {
            tell!(warn, "damaged frames: {=u32}", damaged_frames);
            self.damaged_frames = damaged_frames;
        }
    }
}

fn tell_mode(mode: Mode) {
    match mode {
        Mode::Disarmed => tell!(info, "mode: disarmed"),
        Mode::Armed => tell!(info, "mode: armed"),
        Mode::Homing => tell!(info, "mode: homing"),
        Mode::Running => tell!(info, "mode: running"),
        Mode::Done => tell!(info, "mode: done"),
        Mode::Fault(fault) => tell!(error, "mode: fault {=u8}", fault.code()),
    }
}

/// Tells why a request was not carried out.
pub(crate) fn tell_refusal(refused: &RequestRefusal<'_>) {
    match *refused {
        RequestRefusal::NotNow(code) => tell!(warn, "refused: not now, code {=u8}", code),
        RequestRefusal::UnknownParameter { id } => tell!(warn, "refused: no parameter {=u16}", id),
        RequestRefusal::OutOfRange { id, value } => {
            tell!(warn, "refused: {=i32} is out of range of parameter {=u16}", value, id);
        }
        RequestRefusal::Inconsistent { advice } => tell!(warn, "refused: {=str}", advice),
        RequestRefusal::TestTooLong => tell!(warn, "refused: test too long"),
        RequestRefusal::MovesOutOfOrder => tell!(warn, "refused: moves out of order"),
        RequestRefusal::TooManyMoves => tell!(warn, "refused: too many moves"),
        RequestRefusal::NoRecord => tell!(warn, "refused: no record"),
        RequestRefusal::RecordRange { samples } => {
            tell!(warn, "refused: the record has {=u32} samples", samples)
        }
        RequestRefusal::Unknown => tell!(warn, "refused: unknown request"),
        RequestRefusal::NotStored => tell!(warn, "refused: the flash was not written"),
        RequestRefusal::OtherRecord => tell!(warn, "refused: another record"),
        RequestRefusal::Owned(_) => tell!(warn, "refused: another host commands the drive"),
        RequestRefusal::ChangeNotWhole => tell!(warn, "refused: a part of the change is missing"),
        RequestRefusal::OtherTest => tell!(warn, "refused: another test"),
        RequestRefusal::OtherBoot { number } => tell!(warn, "refused: this is boot {=u32}", number),
    }
}
