//! Requests of the PC and replies of the firmware. Enums gain variants at the end, nowhere else.

mod reply;
mod request;
mod request_refusal;
mod state;

use serde::Serialize;

pub use reply::{Reply, ReplyBody};
pub use request::{Request, RequestBody, UNTIL_STOPPED};
pub use request_refusal::{RequestRefusal, code};
pub use state::{ConfigState, HISTOGRAM_BINS, Mode, Motion, RecordInfo, Spread, Status};

use crate::session::is_of_host;
use crate::{MAX_MESSAGE, frame};

/// What can be sent: a [`Request`] or a [`Reply`].
pub trait Message: Serialize {}

impl Message for Request<'_> {}
impl Message for Reply<'_> {}

/// A message that came whole but is not known here: most likely of a later firmware or program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageError {
    /// Its sequence number, to be answered with [`RequestRefusal::Unknown`]; None: it is not even a message of the
    /// other side.
    pub sequence: Option<u16>,
}

/// The frame of a message at the front of `out`.
///
/// None if the message is above [`MAX_MESSAGE`] (its texts are longer than
/// [`MAX_TEXT`](crate::MAX_TEXT)) or `out` is too short; [`MAX_FRAME`](crate::MAX_FRAME) bytes are
/// always enough. Takes [`MAX_MESSAGE`] bytes of stack.
#[must_use]
pub fn encode<'out>(message: &impl Message, out: &'out mut [u8]) -> Option<&'out [u8]> {
    let mut buffer = [0; MAX_MESSAGE];
    frame::encode(postcard::to_slice(message, &mut buffer).ok()?, out)
}

/// [`encode`] for replies, not generic: an image that calls it holds one copy and is smaller.
#[must_use]
#[inline(never)]
pub fn encode_reply<'out>(reply: &Reply<'_>, out: &'out mut [u8]) -> Option<&'out [u8]> {
    encode(reply, out)
}

/// The request in a message. What follows a known body is skipped.
///
/// # Errors
/// For a message that is no request known here. A message whose session no host may have is not a request at all: a
/// reply that the line echoes, for instance.
#[inline(never)] // One copy of it, which an image may have for size.
pub fn decode_request(message: &[u8]) -> Result<Request<'_>, MessageError> {
    let (sequence, session, boot, body) = head_of_request(message).ok_or(MessageError { sequence: None })?;
    let body = postcard::from_bytes(body).map_err(|_| MessageError { sequence: Some(sequence) })?;
    Ok(Request { sequence, session, boot, body })
}

/// Its sequence number, session and boot, and the bytes of its body: known whatever that turns out to be.
fn head_of_request(message: &[u8]) -> Option<(u16, u32, u32, &[u8])> {
    let (sequence, rest) = postcard::take_from_bytes(message).ok()?;
    let (session, rest) = postcard::take_from_bytes(rest).ok()?;
    let (boot, body) = postcard::take_from_bytes(rest).ok()?;
    is_of_host(session).then_some((sequence, session, boot, body))
}

/// The reply in a message. What follows a known body is skipped.
///
/// # Errors
/// For a message that is no reply known here.
pub fn decode_reply(message: &[u8]) -> Result<Reply<'_>, MessageError> {
    let (sequence, body) = postcard::take_from_bytes(message).map_err(|_| MessageError { sequence: None })?;
    let body = postcard::from_bytes(body).map_err(|_| MessageError { sequence: Some(sequence) })?;
    Ok(Reply { sequence, body })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::{
        Accumulator, CHUNK_SAMPLES, MAX_FRAME, MAX_ROWS, MAX_TEXT, MAX_VALUES, RecordedSample,
        StreamedSample, Values,
    };

    /// The message that the frame of `message` carries.
    fn carried<'a>(message: &impl Message, accumulator: &'a mut Accumulator) -> &'a [u8] {
        let mut out = [0; MAX_FRAME];
        let (delimiter, frame) = encode(message, &mut out).expect("fits").split_last().expect("a frame");
        for &byte in frame {
            assert_eq!(accumulator.push(byte), None);
        }
        accumulator.push(*delimiter).expect("a frame").expect("whole")
    }

    #[test]
    fn the_largest_messages_fit() {
        let text = str::from_utf8(&[b'x'; MAX_TEXT]).expect("ASCII");
        let mut buffer = [0; 4 * MAX_VALUES];
        let values = Values::fill(&mut buffer, [-1; MAX_VALUES]).expect("room");
        let samples = [0xff; CHUNK_SAMPLES * RecordedSample::BYTES];
        let info = ReplyBody::Info {
            version: u16::MAX,
            firmware: text,
            build: text,
            board: text,
            record_capacity: u32::MAX,
        };
        let record = RecordInfo {
            test: text,
            samples: u32::MAX,
            first_index: i32::MIN,
            decimation: u16::MAX,
            pre_trigger: u16::MAX,
            complete: true,
            measured_period_ns: u32::MAX,
            mean_spool_raw: i16::MIN,
            crc32: u32::MAX,
        };
        let bodies = [
            info,
            ReplyBody::RecordInfo(record),
            ReplyBody::Chunk { first: u32::MAX, samples: &samples },
            ReplyBody::Config { first_id: u16::MAX, values },
            ReplyBody::Rows { first: u32::MAX, rows: &[0xff; MAX_ROWS * StreamedSample::BYTES] },
            ReplyBody::Refused(RequestRefusal::Inconsistent { advice: text }),
        ];
        for body in bodies {
            let reply = Reply { sequence: u16::MAX, body };
            let mut accumulator = Accumulator::new();
            assert_eq!(decode_reply(carried(&reply, &mut accumulator)), Ok(reply));
        }
    }

    #[test]
    fn a_message_above_the_largest_is_not_encoded() {
        let reply = Reply { sequence: 1, body: ReplyBody::Chunk { first: 0, samples: &[0; MAX_MESSAGE] } };
        assert_eq!(encode(&reply, &mut [0; 2 * MAX_FRAME]), None);
        let request = Request { sequence: 1, session: 128, boot: 0, body: RequestBody::Info };
        assert_eq!(encode(&request, &mut [0; 4]), None);
    }

    /// Sequence 300, session 128, boot 3.
    const HEAD: [u8; 5] = [0xac, 0x02, 0x80, 0x01, 3];

    fn request(body: &[u8]) -> Vec<u8> {
        [&HEAD[..], body].concat()
    }

    #[test]
    fn a_request_that_is_not_known_tells_its_sequence_number() {
        let unknown = MessageError { sequence: Some(300) };
        assert_eq!(decode_request(&request(&[0x7f, 1, 2, 3])), Err(unknown));
        assert_eq!(decode_request(&request(&[])), Err(unknown), "no body");
        for end in 0..HEAD.len() {
            assert_eq!(decode_request(&HEAD[..end]), Err(MessageError { sequence: None }), "{end} bytes");
        }
        assert_eq!(decode_request(&[0xff; 8]), Err(MessageError { sequence: None }), "no u16");
        assert_eq!(decode_reply(&[0xac, 0x02, 0x7f, 1, 2, 3]), Err(unknown));
        assert_eq!(decode_reply(&[0xac]), Err(MessageError { sequence: None }));
    }

    #[test]
    fn what_a_later_version_appends_is_skipped() {
        let disarm = Request { sequence: 300, session: 128, boot: 3, body: RequestBody::Disarm };
        assert_eq!(decode_request(&request(&[5])), Ok(disarm));
        assert_eq!(decode_request(&request(&[5, 0xff, 0xff])), Ok(disarm));
    }

    #[test]
    fn values_that_are_not_whole_are_no_message() {
        let refused = Err(MessageError { sequence: Some(300) });
        assert!(decode_request(&request(&[3, 1, 4, 1, 2, 3, 4])).is_ok());
        assert_eq!(decode_request(&request(&[3, 1, 3, 1, 2, 3])), refused);
        assert_eq!(decode_request(&request(&[3, 1, 4, 1, 2, 3])), refused, "more announced than there is");
    }

    /// On a line that is coupled into itself each side hears what it has said.
    #[test]
    fn no_reply_reads_as_a_request_and_no_request_as_a_reply() {
        for session in [128, 0x1001, u32::MAX - 1] {
            let request = Request { sequence: 300, session, boot: 3, body: RequestBody::Disarm };
            let mut accumulator = Accumulator::new();
            assert!(decode_reply(carried(&request, &mut accumulator)).is_err());
        }
        for session in [0, 1, 127, u32::MAX] {
            let request = Request { sequence: 300, session, boot: 3, body: RequestBody::Disarm };
            let mut accumulator = Accumulator::new();
            let error = Err(MessageError { sequence: None });
            assert_eq!(decode_request(carried(&request, &mut accumulator)), error, "{session}");
        }
    }
}
