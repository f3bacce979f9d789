//! What a rig with a planted defect makes of a request.

use std::borrow::BorrowMut;

use pneudrive_app::{Board, Recorder, Store};
use pneudrive_protocol::change::start_crc32;
use pneudrive_protocol::io::output;
use pneudrive_protocol::{Request, RequestBody};

use crate::mutant::Mutant;
use crate::rig::Rig;

impl Mutant {
    /// The request as a rig with this defect takes it.
    #[must_use]
    pub fn distort<'a>(self, request: Request<'a>, rig: &mut Rig) -> Request<'a> {
        match (self, request.body) {
            (Mutant::IgnoresBoot, _) => Request { boot: rig.board.store().boot(), ..request },
            (Mutant::IgnoresOwner, _) if rig.drives() => {
                Request { session: rig.control.owner(&rig.board).session, ..request }
            }
            (Mutant::IgnoresNameOfStart, RequestBody::Start { .. }) => {
                let test = rig.control.test().crc32().unwrap_or(0);
                let crc32 = start_crc32(test, rig.control.configuration().hash());
                Request { body: RequestBody::Start { crc32 }, ..request }
            }
            (Mutant::IgnoresNameOfRecord, RequestBody::RecordRead { first, count, .. }) => {
                let recorder: &mut Recorder = rig.control.recorder.borrow_mut();
                let crc32 = recorder.digest(usize::MAX).unwrap_or(0);
                Request { body: RequestBody::RecordRead { crc32, first, count }, ..request }
            }
            // Answered as a stop is, and changes nothing.
            (Mutant::SwallowsStop, RequestBody::Stop) if rig.is_acknowledged() => {
                Request { body: RequestBody::Leave, ..request }
            }
            _ => request,
        }
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
