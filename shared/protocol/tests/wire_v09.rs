//! The bytes that version 9 has added, as a peer of version 9 sends and expects them.
//!
//! DO NOT CHANGE THIS TEST. If it fails, the protocol was broken: append instead, and put what is new into
//! a file of its own. The bytes were worked out apart from the crate (by a script that writes varints,
//! CRC-32 and COBS by their definitions).

use pneudrive_protocol::{
    MAX_FRAME, Refused, Reply, ReplyBody, Request, RequestBody, code, decode_reply, decode_request, encode,
};

#[test]
#[rustfmt::skip]
fn the_trial_of_the_watchdog() {
    let request = Request { sequence: 300, body: RequestBody::TryWatchdog };
    assert_eq!(encode(&request, &mut [0; MAX_FRAME]), Some(&[0x08, 0xac, 0x02, 0x27, 0xff, 0xaa, 0x1f, 0xb8, 0x00][..]));
    assert_eq!(decode_request(&[0xac, 0x02, 0x27]), Ok(request));
}

#[test]
#[rustfmt::skip]
fn why_it_is_refused() {
    assert_eq!([code::NO_WATCHDOG, code::IN_FAULT], [133, 134]);
    let refused = |code| Reply { sequence: 300, body: ReplyBody::Refused(Refused::NotNow(code)) };
    assert_eq!(encode(&refused(133), &mut [0; MAX_FRAME]), Some(&[0x04, 0xac, 0x02, 0x06, 0x06, 0x85, 0x1c, 0x46, 0xa3, 0x40, 0x00][..]));
    assert_eq!(decode_reply(&[0xac, 0x02, 0x06, 0x00, 0x86]), Ok(refused(134)));
}
