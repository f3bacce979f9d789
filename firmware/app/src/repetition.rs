//! Requests that come late a second time, behind later ones: an echo of the line, or of a host that asked
//! again while the answer was on its way. Those that come after a reset are told by the boot that they name.

use pneudrive_protocol::{InBoot, Recent, RequestBody};

/// Requests that are remembered.
const REMEMBERED: usize = 8;

/// The last requests of a host that changed something.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct CarriedOut(Recent<REMEMBERED>);

impl CarriedOut {
    /// Whether a request of this boot that changes something was carried out before; from now on it was. Hosts of version 4 and
    /// older share a session: one that asks the same under the same number by chance (1 in 65,536) gets no answer.
    pub(crate) fn has(&mut self, now: &InBoot<'_>, crc32: u32) -> bool {
        if now.asked.request.body.is_idempotent() {
            return false;
        }
        let before = self.0.holds(crc32);
        self.0.add(crc32);
        before
    }
}

/// Whether a request that was meant for another boot may be carried out: it changes nothing, or it can only take the
/// energy out of the drive.
pub(crate) fn counts_in_any_boot(body: &RequestBody<'_>) -> bool {
    body.is_idempotent() || matches!(body, RequestBody::Stop | RequestBody::Disarm)
}
