//! What firmware and PC say to each other over a stream of bytes (serial port, pty, TCP).
//!
//! The PC sends [`Request`]s. The firmware answers each with one [`Reply`] of the same sequence number, in the order
//! in which they came. Only a repeated request that changes something and arrives behind later ones gets no reply.
//! Several requests may be on their way. The rows of a stream alone come unasked: as replies under the number of the
//! request that began it, and no more of them than were granted.
//!
//! # A frame
//!
//! ```text
//! COBS( sequence | session | boot | body | CRC-32 ) 0x00     a request
//! COBS( sequence |                  body | CRC-32 ) 0x00     a reply
//!       \___________ message __________/
//! ```
//!
//! | part | bytes | holds |
//! |---|---|---|
//! | sequence | 1 to 3 | number of the request, `u16` as a varint |
//! | session | 2 to 5 | the [session] of the host, `u32` as a varint, from [`session::FIRST`] on |
//! | boot | 1 to 5 | the [boot](session) that the request is meant for, `u32` as a varint |
//! | body | 1 and more | number of the variant as a varint, then its fields in order |
//! | CRC-32 | 4 | ISO-HDLC, of the message, little endian |
//! | COBS | 1 to 3 | what it costs to have no 0x00 in the frame |
//! | delimiter | 1 | 0x00: the frame is over |
//!
//! Messages are written as [postcard](https://postcard.jamesmunns.com/wire-format) writes them:
//! integers above 8 bits as varints (signed ones zigzag), texts and byte slices after their length.
//! Runs of parameter values and recorded samples travel as plain little endian bytes, so that both
//! ends take them from where they are ([`Values`], [`RecordedSample`]).
//!
//! ```
//! use pneudrive_protocol::{Accumulator, MAX_FRAME, Request, RequestBody, decode_request, encode, session};
//!
//! let stop = Request { sequence: 7, session: session::FIRST, boot: session::NO_BOOT, body: RequestBody::Stop };
//! let mut room = [0; MAX_FRAME];
//! let (delimiter, frame) = encode(&stop, &mut room).and_then(<[u8]>::split_last).expect("room for a frame");
//!
//! let mut line: Accumulator = Accumulator::new();
//! for &byte in frame {
//!     assert_eq!(line.push(byte), None, "nothing before the delimiter");
//! }
//! let message = line.push(*delimiter).expect("the frame is over").expect("it came whole");
//! assert_eq!(decode_request(message), Ok(stop));
//! ```
//!
//! A reader knows nothing until it has seen a delimiter: whoever opens a link sends a 0x00 first.
//! [`Accumulator`] says what damage costs.
//!
//! # Messages are append-only
//!
//! - Enums gain variants at the end. Variants are never reordered or removed, and the fields they
//!   have never change.
//! - Whatever follows a known body is skipped, so fields may be appended to one. Its readers then fail on
//!   the shorter body of an older peer: a new variant is the better choice unless the appended fields are
//!   only ever sent to whom they are known.
//! - A request that firmware does not know still tells its sequence number ([`MessageError`]), so
//!   that it can be answered with [`RequestRefusal::Unknown`]. A host learns so what an older firmware lacks.
//! - [`VERSION`] stays as it is as long as these rules are kept. Peers of different versions do not talk to each other: the PC
//!   refuses the rig and says which of the two to update. The request `Info` and its reply therefore stay as they are for ever.
//! - `tests/wire_v1.rs` holds the bytes of every message, and says how to append one.
//!
//! # What is promised
//!
//! No allocation, no `unsafe`, no panic on any input. Of the controller only ids and numbers are
//! known here.
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod change;
pub mod event;
pub mod frame;
pub mod io;
pub mod message;
pub mod owner;
pub mod profiled;
pub mod record;
pub mod session;
pub mod stream;
pub mod values;

pub use event::Event;
pub use frame::{Accumulator, FrameError};
pub use message::{
    ConfigState, HISTOGRAM_BINS, Message, MessageError, Mode, Motion, RecordInfo, Reply, ReplyBody, Request,
    RequestBody, RequestRefusal, Spread, Status, UNTIL_STOPPED, code, decode_reply, decode_request, encode,
    encode_reply,
};
pub use owner::{Owner, Presence};
pub use profiled::ProfiledMove;
pub use record::{RecordCrc, RecordedSample};
pub use stream::StreamedSample;
pub use values::Values;

/// The version described here. Only peers of the same version understand each other.
pub const VERSION: u16 = 1;

/// The longest message, bytes, without CRC and framing.
pub const MAX_MESSAGE: usize = 512;

/// The longest frame, bytes: the longest message with CRC, COBS and delimiter.
pub const MAX_FRAME: usize = cobs::max_encoding_length(MAX_MESSAGE + frame::CRC_BYTES) + 1;

/// The most parameter values that one message carries.
pub const MAX_VALUES: usize = 64;

/// The most recorded samples that one message carries.
pub const CHUNK_SAMPLES: usize = 32;

/// The most events of the fault log that one message carries.
pub const MAX_EVENTS: usize = 16;

/// The most moves of a test that one message carries.
pub const MAX_TOLD_MOVES: usize = 12;

/// The numbers of move records: 1 to this one.
pub const MOVE_RECORDS: u8 = 14;

/// The most rows of a stream that one message carries.
pub const MAX_ROWS: usize = 24;

/// Texts up to this long always fit their message, bytes of UTF-8. Longer ones may not.
pub const MAX_TEXT: usize = 64;

/// Varints of a `u16` and of a 32-bit number at their longest, bytes.
const U16_BYTES: usize = 3;
const U32_BYTES: usize = 5;
/// Sequence and number of the variant (one byte, while there are fewer than 128).
const HEADER_BYTES: usize = U16_BYTES + 1;
/// The same of a request, with session and boot.
const REQUEST_BYTES: usize = HEADER_BYTES + 2 * U32_BYTES;
/// A text at its longest, with its length.
const TEXT_BYTES: usize = 1 + MAX_TEXT;

// The largest messages, each field at its longest; all others are plainly smaller.
const _: () = {
    let config = REQUEST_BYTES + U16_BYTES + U16_BYTES + MAX_VALUES * size_of::<i32>();
    assert!(config <= MAX_MESSAGE, "Config, ConfigSet");
    let chunk = HEADER_BYTES + U32_BYTES + U16_BYTES + CHUNK_SAMPLES * RecordedSample::BYTES;
    assert!(chunk <= MAX_MESSAGE, "Chunk");
    let info = HEADER_BYTES + U16_BYTES + 3 * TEXT_BYTES + U32_BYTES;
    assert!(info <= MAX_MESSAGE, "Info");
    let record_info = HEADER_BYTES + TEXT_BYTES + 4 * U32_BYTES + 3 * U16_BYTES + 1;
    assert!(record_info <= MAX_MESSAGE, "RecordInfo");
    let events = HEADER_BYTES + 2 + U16_BYTES + MAX_EVENTS * Event::BYTES;
    assert!(events <= MAX_MESSAGE, "Events");
    let rows = HEADER_BYTES + U32_BYTES + U16_BYTES + MAX_ROWS * StreamedSample::BYTES;
    assert!(rows <= MAX_MESSAGE, "Rows");
    let test = HEADER_BYTES + 2 * U32_BYTES + 2 + U16_BYTES + MAX_TOLD_MOVES * ProfiledMove::BYTES;
    assert!(test <= MAX_MESSAGE, "Test");
    let records = HEADER_BYTES + 1 + U16_BYTES + MAX_TOLD_MOVES * ProfiledMove::BYTES;
    assert!(records <= MAX_MESSAGE, "MoveRecords");
    let part = REQUEST_BYTES + U32_BYTES + 2 * U16_BYTES + change::PART_BYTES;
    assert!(part <= MAX_MESSAGE, "ChangePart");
    assert!(change::MAX_CHANGE <= u16::MAX as usize, "first of ChangePart");
    assert!(MAX_VALUES <= u8::MAX as usize, "count of ConfigGet");
    assert!(CHUNK_SAMPLES <= u8::MAX as usize, "count of RecordRead");
};
