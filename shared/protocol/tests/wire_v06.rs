//! The bytes that version 6 has added, as a peer of version 6 sends and expects them.
//!
//! DO NOT CHANGE THIS TEST. If it fails, the protocol was broken: append instead, and put what is new into
//! a file of its own. The bytes were worked out apart from the crate (by a script that writes varints,
//! CRC-32 and COBS by their definitions).

use pneudrive_protocol::{
    ANY_BOOT, InBoot, InSession, MAX_FRAME, Refused, Reply, ReplyBody, Request, RequestBody, decode_reply,
    decode_request, encode,
};

const SESSION: u32 = 0xfeed_beef;

fn in_session(body: RequestBody<'_>) -> InSession<'_> {
    InSession { request: Request { sequence: 300, body }, session: SESSION }
}

fn assert_request(body: RequestBody<'_>, boot: u32, message: &[u8], frame: &[u8]) {
    let meant = InBoot { asked: in_session(body), boot };
    assert_eq!(encode(&meant, &mut [0; MAX_FRAME]), Some(frame));
    assert_eq!(InBoot::decode(message), Ok(meant));
    assert_eq!(InSession::decode(message), Ok(meant.asked), "as firmware of version 5 reads it");
    assert_eq!(decode_request(message), Ok(meant.asked.request), "as firmware before version 5 reads it");
}

fn assert_reply(body: ReplyBody<'_>, message: &[u8], frame: &[u8]) {
    let reply = Reply { sequence: 300, body };
    assert_eq!(encode(&reply, &mut [0; MAX_FRAME]), Some(frame));
    assert_eq!(decode_reply(message), Ok(reply));
}

#[test]
#[rustfmt::skip]
fn a_boot_stands_behind_the_session_of_any_request() {
    assert_request(RequestBody::Home, 70_000,
        &[0xac, 0x02, 0x0d, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0xf0, 0xa2, 0x04],
        &[0x10, 0xac, 0x02, 0x0d, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0xf0, 0xa2, 0x04, 0x0c, 0xc7, 0x7f, 0x7a, 0x00]);
    assert_request(RequestBody::ArmAs { host: "pc" }, 3,
        &[0xac, 0x02, 0x18, 0x02, 0x70, 0x63, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0x03],
        &[0x11, 0xac, 0x02, 0x18, 0x02, 0x70, 0x63, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0x03, 0x98, 0xac, 0x71, 0x93, 0x00]);
}

#[test]
#[rustfmt::skip]
fn boots() {
    let message = [0xac, 0x02, 0x20, 0xef, 0xfd, 0xb6, 0xf7, 0x0f];
    assert_eq!(encode(&in_session(RequestBody::Boot), &mut [0; MAX_FRAME]), Some(
        &[0x0d, 0xac, 0x02, 0x20, 0xef, 0xfd, 0xb6, 0xf7, 0x0f, 0x88, 0x4f, 0xea, 0xdc, 0x00][..]));
    assert_eq!(InBoot::decode(&message), Ok(InBoot { asked: in_session(RequestBody::Boot), boot: ANY_BOOT }));
    assert_reply(ReplyBody::Boot { number: 70_000 }, &[0xac, 0x02, 0x0d, 0xf0, 0xa2, 0x04],
        &[0x0b, 0xac, 0x02, 0x0d, 0xf0, 0xa2, 0x04, 0x29, 0x92, 0x2e, 0x79, 0x00]);
    assert_reply(ReplyBody::Boot { number: ANY_BOOT }, &[0xac, 0x02, 0x0d, 0x00],
        &[0x04, 0xac, 0x02, 0x0d, 0x05, 0x82, 0xd3, 0xd3, 0x90, 0x00]);
    assert_reply(ReplyBody::Refused(Refused::OtherBoot { number: 4 }), &[0xac, 0x02, 0x06, 0x0f, 0x04],
        &[0x0a, 0xac, 0x02, 0x06, 0x0f, 0x04, 0x65, 0xe9, 0x84, 0x5d, 0x00]);
}
