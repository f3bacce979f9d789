//! Requests of the PC and replies of the firmware. Enums gain variants at the end, nowhere else.

mod refused;
mod reply;
mod request;
mod state;

use serde::{Deserialize, Serialize};

pub use refused::{Refused, code};
pub use reply::{Reply, ReplyBody};
pub use request::{Request, RequestBody, UNTIL_STOPPED};
pub use state::{ConfigState, HISTOGRAM_BINS, Mode, Motion, RecordInfo, Spread, Status};

use crate::{MAX_MESSAGE, frame};

/// What can be sent: a [`Request`] or a [`Reply`].
pub trait Message: Serialize {}

impl Message for Request<'_> {}
impl Message for Reply<'_> {}

/// The message is not one of this version, though it came whole: a later version's, most likely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageError {
    /// The number it came under, to be answered with [`Refused::Unknown`]; None: not even that.
    pub sequence: Option<u16>,
}

/// The frame of a message at the front of `out`.
///
/// None if the message is above [`MAX_MESSAGE`] (its texts are longer than
/// [`MAX_TEXT`](crate::MAX_TEXT)) or `out` is too short; [`MAX_FRAME`](crate::MAX_FRAME) bytes are
/// always enough. Takes [`MAX_MESSAGE`] bytes of stack.
#[must_use]
pub fn encode<'out>(message: &impl Message, out: &'out mut [u8]) -> Option<&'out [u8]> {
    encode_and_know(message, out).map(|(frame, _)| frame)
}

/// The same, and the CRC of the message: to know it again ([`Recent`](crate::Recent)).
#[must_use]
pub fn encode_and_know<'out>(message: &impl Message, out: &'out mut [u8]) -> Option<(&'out [u8], u32)> {
    let mut buffer = [0; MAX_MESSAGE];
    let bytes = postcard::to_slice(message, &mut buffer).ok()?;
    let crc32 = frame::crc32(bytes);
    Some((frame::encode_with(crc32, bytes, out)?, crc32))
}

/// The same of a reply: one copy of it, which an image may have for size.
#[must_use]
#[inline(never)]
pub fn encode_reply<'out>(reply: &Reply<'_>, out: &'out mut [u8]) -> Option<(&'out [u8], u32)> {
    encode_and_know(reply, out)
}

/// The request in a message. What follows a known body is skipped.
///
/// # Errors
/// For a message that is no request of this version.
pub fn decode_request(message: &[u8]) -> Result<Request<'_>, MessageError> {
    let (sequence, body, _later) = decode(message)?;
    Ok(Request { sequence, body })
}

/// The reply in a message. What follows a known body is skipped.
///
/// # Errors
/// For a message that is no reply of this version.
pub fn decode_reply(message: &[u8]) -> Result<Reply<'_>, MessageError> {
    let (sequence, body, _later) = decode(message)?;
    Ok(Reply { sequence, body })
}

/// The sequence number first, on its own: it is known whatever the body turns out to be. Then the body, and what stands
/// behind it.
pub(crate) fn decode<'a, Body: Deserialize<'a>>(
    message: &'a [u8],
) -> Result<(u16, Body, &'a [u8]), MessageError> {
    let (sequence, rest) = postcard::take_from_bytes(message).map_err(|_| MessageError { sequence: None })?;
    let (body, later) =
        postcard::take_from_bytes(rest).map_err(|_| MessageError { sequence: Some(sequence) })?;
    Ok((sequence, body, later))
}

#[cfg(test)]
mod tests {
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
            min_version: u16::MAX,
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
            ReplyBody::Refused(Refused::Inconsistent { advice: text }),
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
        let request = Request { sequence: 1, body: RequestBody::Info };
        assert_eq!(encode(&request, &mut [0; 4]), None);
    }

    #[test]
    fn a_request_of_a_later_version_tells_its_sequence_number() {
        // 300 as a varint, then a variant that version 1 does not have.
        let later = [0xac, 0x02, 0x7f, 1, 2, 3];
        assert_eq!(decode_request(&later), Err(MessageError { sequence: Some(300) }));
        assert_eq!(decode_reply(&later), Err(MessageError { sequence: Some(300) }));
        assert_eq!(decode_request(&later[..2]), Err(MessageError { sequence: Some(300) }), "no body");
        assert_eq!(decode_request(&later[..1]), Err(MessageError { sequence: None }));
        assert_eq!(decode_request(&[]), Err(MessageError { sequence: None }));
        assert_eq!(decode_request(&[0xff; 8]), Err(MessageError { sequence: None }), "no u16");
    }

    #[test]
    fn what_a_later_version_appends_is_skipped() {
        let arm = Request { sequence: 7, body: RequestBody::Arm };
        assert_eq!(decode_request(&[7, 4]), Ok(arm));
        assert_eq!(decode_request(&[7, 4, 0xff, 0xff]), Ok(arm));
    }

    #[test]
    fn values_that_are_not_whole_are_no_message() {
        let refused = Err(MessageError { sequence: Some(7) });
        assert!(decode_request(&[7, 3, 1, 4, 1, 2, 3, 4]).is_ok());
        assert_eq!(decode_request(&[7, 3, 1, 3, 1, 2, 3]), refused);
        assert_eq!(decode_request(&[7, 3, 1, 4, 1, 2, 3]), refused, "more announced than there is");
    }
}
