//! The bytes that version 4 has added, as a peer of version 4 sends and expects them.
//!
//! DO NOT CHANGE THIS TEST. If it fails, the protocol was broken: append instead, and put what is new into
//! a file of its own. The bytes were worked out apart from the crate (by a script that writes varints,
//! CRC-32 and COBS by their definitions).

use pneudrive_protocol::{MAX_FRAME, Request, RequestBody, UNTIL_STOPPED, decode_request, encode};

fn assert_request(body: RequestBody<'_>, message: &[u8], frame: &[u8]) {
    let request = Request { sequence: 300, body };
    assert_eq!(encode(&request, &mut [0; MAX_FRAME]), Some(frame));
    assert_eq!(decode_request(message), Ok(request));
}

#[test]
#[rustfmt::skip]
fn requests() {
    assert_request(RequestBody::TestSpan { last_sample: UNTIL_STOPPED, round: 0 },
        &[0xac, 0x02, 0x17, 0xfe, 0xff, 0xff, 0xff, 0x0f, 0x00],
        &[0x09, 0xac, 0x02, 0x17, 0xfe, 0xff, 0xff, 0xff, 0x0f, 0x05, 0x5d, 0x51, 0x3c, 0x06, 0x00]);
    assert_request(RequestBody::TestSpan { last_sample: 70_000, round: 3077 },
        &[0xac, 0x02, 0x17, 0xf0, 0xa2, 0x04, 0x85, 0x18],
        &[0x0d, 0xac, 0x02, 0x17, 0xf0, 0xa2, 0x04, 0x85, 0x18, 0xf7, 0xd3, 0x4b, 0xec, 0x00]);
}
