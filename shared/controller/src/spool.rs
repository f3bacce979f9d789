//! The spool location of a stepper valve, and whether it is reliable.
//!
//! Nothing measures the spool: its location is the sum of all pulses, and a reset ends the sum. The location that the
//! board has kept through the reset may be off by a pulse that was lost on the way. Without a kept location nothing
//! is known. A drive in doubt gives no pulse and does not arm until the spool has been walked back ([`Spool::seek`])
//! or the operator says that it is at its null ([`Spool::at_null`]).

use crate::drive::SpoolLocation;
use crate::supervisor::Refusal;

/// Whether the location is reliable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Reliability {
    /// Every pulse since mid-travel has been counted.
    #[default]
    Sure,
    /// A reset came while the spool was here.
    Kept(SpoolLocation),
    /// The location is not known.
    Lost,
}

/// The spool. By default it is at mid-travel, as in a simulated valve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Spool {
    /// The sum of the pulses; mid-travel while in doubt, so that no pulse is given.
    counted: SpoolLocation,
    reliability: Reliability,
}

impl Spool {
    /// After a reset, with the location that was kept through it, if any.
    pub fn after_reset(kept: Option<SpoolLocation>) -> Spool {
        let reliability = match kept {
            None => Reliability::Lost,
            Some(location) if location == SpoolLocation::default() => Reliability::Sure,
            Some(location) => Reliability::Kept(location),
        };
        Spool { counted: SpoolLocation::default(), reliability }
    }

    /// The sum of the pulses since mid-travel.
    pub fn counted(self) -> SpoolLocation {
        self.counted
    }

    /// The location, if it is reliable.
    pub fn sure(self) -> Option<SpoolLocation> {
        (self.reliability == Reliability::Sure).then_some(self.counted)
    }

    /// Whether it is known to be away from mid-travel.
    pub fn is_open(self) -> bool {
        self.walks() || matches!(self.reliability, Reliability::Kept(_))
    }

    /// Whether a disabled drive walks it back.
    pub fn walks(self) -> bool {
        self.counted != SpoolLocation::default()
    }

    /// The pulse toward `target`.
    pub fn step_toward(&mut self, target: i16) -> i8 {
        self.counted.step_toward(target)
    }

    /// Whether a drive with this spool may be armed.
    pub fn check(self) -> Result<(), Refusal> {
        match self.reliability {
            Reliability::Sure => Ok(()),
            Reliability::Kept(_) => Err(Refusal::SpoolInDoubt),
            Reliability::Lost => Err(Refusal::SpoolLost),
        }
    }

    /// Walks back from the location before the reset, one pulse a sample.
    ///
    /// # Errors
    /// When that is not known.
    pub fn seek(&mut self) -> Result<(), Refusal> {
        match self.reliability {
            Reliability::Sure => Ok(()),
            Reliability::Kept(location) => {
                *self = Spool { counted: location, reliability: Reliability::Sure };
                Ok(())
            }
            Reliability::Lost => Err(Refusal::SpoolLost),
        }
    }

    /// States that it is at mid-travel: the operator has checked it.
    ///
    /// # Errors
    /// While it walks.
    pub fn at_null(&mut self) -> Result<(), Refusal> {
        if self.walks() {
            return Err(Refusal::ValveNotAtNull);
        }
        *self = Spool::default();
        Ok(())
    }
}
