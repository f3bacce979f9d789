//! What a rig with a planted defect makes of a request.

use pneudrive_protocol::change::start_crc32;
use pneudrive_protocol::{ANY_BOOT, InBoot, InSession, Request, RequestBody};

use crate::mutant::Mutant;
use crate::rig::Rig;

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
