//! What a rig with a planted defect makes of a request.

use pneudrive_protocol::change::start_crc32;
use pneudrive_protocol::io::output;
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
            // Answered as a stop is, and changes nothing.
            (Mutant::SwallowsStop, RequestBody::Stop) if rig.is_acknowledged() => body = RequestBody::Leave,
            _ => {}
        }
        InBoot { asked: InSession { request: Request { sequence, body }, session }, boot }
    }

    /// What a rig with this defect makes of a copy that has come from its owner.
    pub(crate) fn hear(self, rig: &mut Rig, session: u32) {
        if self == Mutant::HearsCopies && rig.drives() {
            // Always ahead of what it has heard, by a quarter of the range of numbers.
            rig.presence.ahead = rig.presence.ahead.wrapping_add(0x4000);
            let number = rig.presence.newest().wrapping_add(rig.presence.ahead);
            rig.control.host_heard(session, number, &rig.board);
        }
    }
}

impl Rig {
    /// Whether it is in a fault that its digital inputs have acknowledged.
    fn is_acknowledged(&self) -> bool {
        self.is_tripped() && self.control.selector().outputs() & output::FAULT == 0
    }
}
