//! Requests that come late a second time, behind later ones: a copy of the line, or of a host that asked
//! again while the answer was on its way. Those that come after a reset are told by the boot that they name.

use pneudrive_protocol::RequestBody;

/// Requests that are remembered.
const REMEMBERED: usize = 8;

/// The last requests of a host that changed something, by the CRC of their messages, the newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct CarriedOut([Option<u32>; REMEMBERED]);

impl CarriedOut {
    /// Whether a request that changes something was carried out before; from now on it was.
    pub(crate) fn has(&mut self, body: &RequestBody<'_>, crc32: u32) -> bool {
        if body.is_idempotent() {
            return false;
        }
        let before = self.0.contains(&Some(crc32));
        if !before {
            self.0.rotate_right(1);
            self.0[0] = Some(crc32);
        }
        before
    }
}

/// Whether a request that was meant for another boot may be carried out: it changes nothing, or it can only take the
/// energy out of the drive.
pub(crate) fn counts_in_any_boot(body: &RequestBody<'_>) -> bool {
    body.is_idempotent() || matches!(body, RequestBody::Stop | RequestBody::Disarm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_ones_are_known_again_and_older_ones_are_not() {
        let mut carried_out = CarriedOut::default();
        let mut has = |crc32| carried_out.has(&RequestBody::Disarm, crc32);
        assert!(!has(0) && has(0));
        for crc32 in 1..=REMEMBERED as u32 {
            assert!(!has(crc32) && has(crc32));
        }
        assert!(!has(0), "forgotten");
    }
}
