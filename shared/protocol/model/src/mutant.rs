//! Defects that are planted, to see that the checker finds them: each changes what reaches the real firmware, or what
//! the host makes of its answers.

use pneudrive_protocol::change::start_crc32;
use pneudrive_protocol::{ANY_BOOT, InBoot, InSession, Request, RequestBody};

use crate::rig::Rig;

/// A planted defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mutant {
    /// The rig takes every host for the one that owns the drive.
    IgnoresOwner,
    /// The rig starts whatever test it has, whatever the start names.
    IgnoresNameOfStart,
    /// The rig saves a configuration value by value.
    SavesInParts,
    /// The rig sends chunks of whatever record it has, and the host does not look at the CRC-32 of the whole.
    IgnoresNameOfRecord,
    /// The rig takes requests that were meant for another boot, as it takes those of hosts before version 6.
    IgnoresBoot,
}

impl Mutant {
    /// The request as a rig with this defect takes it.
    #[must_use]
    pub fn distort<'a>(self, meant: InBoot<'a>, rig: &Rig) -> InBoot<'a> {
        let InBoot { asked: InSession { request: Request { sequence, body }, session }, boot } = meant;
        let (mut body, mut session, mut boot) = (body, session, boot);
        match (self, body) {
            (Mutant::IgnoresBoot, _) => boot = ANY_BOOT,
            (Mutant::IgnoresOwner, _) if rig.drives() => session = rig.control.owner(&rig.board).session,
            (Mutant::IgnoresNameOfStart, RequestBody::StartTest { .. }) => {
                let test = rig.control.test().crc32().unwrap_or(0);
                let crc32 = start_crc32(test, rig.control.configuration().hash());
                body = RequestBody::StartTest { crc32 };
            }
            (Mutant::IgnoresNameOfRecord, RequestBody::RecordChunk { first, count, .. }) => {
                body = RequestBody::RecordRead { first, count };
            }
            _ => {}
        }
        InBoot { asked: InSession { request: Request { sequence, body }, session }, boot }
    }
}
