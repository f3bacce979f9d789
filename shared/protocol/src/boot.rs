//! Boots: which start of the drive a request is meant for.
//!
//! A drive gives each of its boots another number. A host of version 6 or newer asks for it when it connects
//! ([`RequestBody::Boot`](crate::RequestBody::Boot)) and from then on puts it behind the session of every request, as a
//! varint. A request for another boot, such as a copy that comes after a reset, is refused if it could arm, move or change
//! anything. Firmware before version 6 skips the number; a host before version 6 does not send it.

use serde::Serialize;

use crate::message::{Message, MessageError, Request, decode};
use crate::session::{INPUTS, InSession, OLD_HOSTS};

/// Stands for no boot: a drive that cannot tell its boots apart answers it, and a request that names it counts in any.
pub const ANY_BOOT: u32 = 0;

/// A request with its session and the boot that it is meant for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct InBoot<'a> {
    /// The request in its session.
    pub asked: InSession<'a>,
    /// The number of the boot; [`ANY_BOOT`] is not sent by anyone.
    pub boot: u32,
}

impl Message for InBoot<'_> {}

impl<'a> InBoot<'a> {
    /// The request in a message, its session and its boot.
    ///
    /// # Errors
    /// For a message that is no request of this version, and for one whose session or boot is 0 or no number, or the
    /// session that of the [digital inputs](INPUTS). No host sends such a message, but a reply that the line brings back can read as one.
    #[inline(never)] // One copy of it, which an image may have for size.
    pub fn decode(message: &'a [u8]) -> Result<InBoot<'a>, MessageError> {
        let (sequence, body, behind) = decode(message)?;
        let no_request = MessageError { sequence: Some(sequence) };
        let (session, behind) = number(behind).ok_or(no_request)?;
        if session == Some(INPUTS) {
            return Err(no_request);
        }
        let (boot, _later) = number(behind).ok_or(no_request)?;
        let asked = InSession { request: Request { sequence, body }, session: session.unwrap_or(OLD_HOSTS) };
        Ok(InBoot { asked, boot: boot.unwrap_or(ANY_BOOT) })
    }

    /// Whether the request counts in this boot of a drive: it names this boot or none. A drive that cannot tell its boots
    /// apart ([`ANY_BOOT`]) has told no host of a boot, so a request that names one is from an earlier boot.
    #[must_use]
    pub fn counts_in(&self, boot: u32) -> bool {
        self.boot == ANY_BOOT || self.boot == boot
    }
}

/// The number at the front of what stands behind a body, if anything does, and what follows it. None for 0 and for what is
/// no number: hosts leave out what they do not have.
fn number(behind: &[u8]) -> Option<(Option<u32>, &[u8])> {
    if behind.is_empty() {
        return Some((None, behind));
    }
    let (number, later) = postcard::take_from_bytes(behind).ok()?;
    (number != 0).then_some((Some(number), later))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::{Accumulator, MAX_FRAME, RequestBody, encode};

    fn message(request: &impl Message) -> std::vec::Vec<u8> {
        let mut out = [0; MAX_FRAME];
        let frame = encode(request, &mut out).expect("fits");
        let mut accumulator: Accumulator = Accumulator::new();
        frame.iter().find_map(|&byte| accumulator.push(byte)?.ok().map(<[u8]>::to_vec)).expect("whole")
    }

    const HOME: Request<'_> = Request { sequence: 300, body: RequestBody::Home };

    #[test]
    fn a_request_is_the_same_with_and_without_its_boot() {
        let asked = InSession { request: HOME, session: 7 };
        let meant = InBoot { asked, boot: 70_000 };
        assert_eq!(InBoot::decode(&message(&meant)), Ok(meant));
        assert_eq!(InSession::decode(&message(&meant)), Ok(asked), "as firmware of version 5 reads it");
        let of_any = InBoot { asked, boot: ANY_BOOT };
        assert_eq!(InBoot::decode(&message(&asked)), Ok(of_any), "as a host of version 5 sends it");
        let old = InBoot { asked: InSession { request: HOME, session: OLD_HOSTS }, boot: ANY_BOOT };
        assert_eq!(InBoot::decode(&message(&HOME)), Ok(old), "as a host before version 5 sends it");
    }

    #[test]
    fn a_request_counts_in_its_own_boot_and_one_without_a_boot_in_any() {
        let meant = |boot| InBoot { asked: InSession { request: HOME, session: 7 }, boot };
        assert!(meant(3).counts_in(3) && meant(ANY_BOOT).counts_in(3));
        assert!(!meant(3).counts_in(4) && !meant(4).counts_in(3));
        assert!(
            !meant(3).counts_in(ANY_BOOT),
            "a drive that cannot tell its boots apart has told no host of one"
        );
        assert!(meant(ANY_BOOT).counts_in(ANY_BOOT));
    }

    #[test]
    fn a_session_or_a_boot_that_no_host_sends_makes_no_request() {
        let home = message(&HOME);
        let behind = |bytes: &[u8]| InBoot::decode(&[&home, bytes].concat()).map(|meant| meant.boot);
        let none = Err(MessageError { sequence: Some(HOME.sequence) });
        for bytes in [
            &[0][..],
            &[0, 3],
            &[7, 0],
            &[0xff],
            &[7, 0xff],
            &[7, 0xff, 0xff, 0xff, 0xff, 0xff, 1],
            &[0xff, 0xff, 0xff, 0xff, 0x0f, 3],
        ] {
            assert_eq!(behind(bytes), none, "{bytes:?}");
        }
        assert_eq!(behind(&[7, 3, 0, 0xff]), Ok(3), "a later version may send more behind the boot");
    }
}
