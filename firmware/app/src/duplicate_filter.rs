//! Requests that arrive a second time, behind later ones: the line has copied them, or a host asked again while the answer was
//! on its way. Copies that arrive after a reset name an earlier boot and are refused for that.

use pneudrive_protocol::{Request, RequestBody};

/// How many requests are remembered.
const REMEMBERED: usize = 8;

/// A request is forgotten when the numbers of its session are this far ahead of it. Numbers wrap after 65,536 requests; a stop must
/// not be taken for the copy of one that had the same number then.
const FORGOTTEN_AFTER: u16 = 0x4000;

/// The last requests of a host that changed something, the newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct DuplicateFilter([Option<Remembered>; REMEMBERED]);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Remembered {
    crc32: u32,
    session: u32,
    sequence: u16,
}

impl DuplicateFilter {
    /// Whether a request is a copy of one that was carried out, by the CRC of its message. One that changes something and is no copy
    /// is remembered: the next one like it is. Requests that change nothing are never duplicates, but their numbers count.
    pub(crate) fn is_duplicate(&mut self, request: &Request<'_>, crc32: u32) -> bool {
        let &Request { session, sequence, ref body, .. } = request;
        for slot in &mut self.0 {
            *slot = slot.filter(|old| !(old.session == session && old.is_far_behind(sequence)));
        }
        if body.is_idempotent() {
            return false;
        }
        let before = self.0.iter().flatten().any(|old| old.crc32 == crc32);
        if !before {
            self.0.rotate_right(1);
            self.0[0] = Some(Remembered { crc32, session, sequence });
        }
        before
    }
}

impl Remembered {
    /// Whether a request of this number is a quarter to three quarters of all numbers later. A copy of an earlier request, with a
    /// number just behind this one, is not.
    fn is_far_behind(&self, sequence: u16) -> bool {
        (FORGOTTEN_AFTER..=FORGOTTEN_AFTER.wrapping_neg()).contains(&sequence.wrapping_sub(self.sequence))
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

    fn disarm(sequence: u16) -> Request<'static> {
        Request { sequence, session: 1, boot: 0, body: RequestBody::Disarm }
    }

    #[test]
    fn the_last_ones_are_known_again_and_older_ones_are_not() {
        let mut duplicates = DuplicateFilter::default();
        let mut is_duplicate = |crc32| duplicates.is_duplicate(&disarm(0), crc32);
        assert!(!is_duplicate(0) && is_duplicate(0));
        for crc32 in 1..=REMEMBERED as u32 {
            assert!(!is_duplicate(crc32) && is_duplicate(crc32));
        }
        assert!(!is_duplicate(0), "forgotten");
    }

    #[test]
    fn a_copy_is_known_among_the_next_requests_and_not_when_the_numbers_have_come_round() {
        for first in [0, 40_000, u16::MAX] {
            let mut duplicates = DuplicateFilter::default();
            assert!(!duplicates.is_duplicate(&disarm(first), 7));
            let status = |sequence| Request { body: RequestBody::Status, ..disarm(sequence) };
            for later in (0..FORGOTTEN_AFTER).map(|later| first.wrapping_add(later)) {
                duplicates.is_duplicate(&status(later), 0);
            }
            duplicates.is_duplicate(&status(first.wrapping_sub(FORGOTTEN_AFTER - 1)), 0);
            assert!(
                duplicates.is_duplicate(&disarm(first), 7),
                "a late copy, after a late copy of an earlier request"
            );
            duplicates
                .is_duplicate(&Request { session: 2, ..status(first.wrapping_add(FORGOTTEN_AFTER)) }, 0);
            assert!(duplicates.is_duplicate(&disarm(first), 7), "another session has numbers of its own");
            duplicates.is_duplicate(&status(first.wrapping_add(FORGOTTEN_AFTER)), 0);
            assert!(!duplicates.is_duplicate(&disarm(first), 7), "another request of the same number");
        }
    }
}
