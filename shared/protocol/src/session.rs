//! Sessions: which host a request comes from, and which one commands the drive.
//!
//! A host draws a number for as long as it runs and puts it behind the body of every request, as a varint. Firmware
//! before version 5 skips it, and a host before version 5 does not send it: that is session 0.

use serde::Serialize;

use crate::message::{Message, MessageError, Request, decode};

pub use crate::owner::{HOST_BYTES, INPUTS, OLD_HOSTS};

/// A request with the session that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct InSession<'a> {
    /// The request.
    pub request: Request<'a>,
    /// The host's number; [`OLD_HOSTS`] is not sent by anyone.
    pub session: u32,
}

impl Message for InSession<'_> {}

impl<'a> InSession<'a> {
    /// The request in a message and its session.
    ///
    /// # Errors
    /// For a message that is no request of this version.
    pub fn decode(message: &'a [u8]) -> Result<InSession<'a>, MessageError> {
        let (sequence, body, behind) = decode(message)?;
        let session = postcard::take_from_bytes(behind).map_or(OLD_HOSTS, |(session, _)| session);
        Ok(InSession { request: Request { sequence, body }, session })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Accumulator, MAX_FRAME, RequestBody, decode_request, encode};

    fn message(request: &impl Message) -> std::vec::Vec<u8> {
        let mut out = [0; MAX_FRAME];
        let frame = encode(request, &mut out).expect("fits");
        let mut accumulator: Accumulator = Accumulator::new();
        frame.iter().find_map(|&byte| accumulator.push(byte)?.ok().map(<[u8]>::to_vec)).expect("whole")
    }

    extern crate std;

    #[test]
    fn a_request_is_the_same_with_and_without_its_session() {
        let request = Request { sequence: 300, body: RequestBody::RecordRead { first: 7, count: 3 } };
        let owned = InSession { request, session: 0xfeed_beef };
        assert_eq!(InSession::decode(&message(&owned)), Ok(owned));
        assert_eq!(decode_request(&message(&owned)), Ok(request), "as firmware before version 5 reads it");
        let old = InSession { request, session: OLD_HOSTS };
        assert_eq!(InSession::decode(&message(&request)), Ok(old), "as a host before version 5 sends it");
    }

    #[test]
    fn what_stands_behind_a_body_and_is_no_number_is_no_session() {
        assert_eq!(InSession::decode(&[7, 4, 0xff]).map(|request| request.session), Ok(OLD_HOSTS));
        assert_eq!(InSession::decode(&[7, 99]), Err(MessageError { sequence: Some(7) }));
    }
}
