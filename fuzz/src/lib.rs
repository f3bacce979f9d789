//! What must hold for any bytes at all. The fuzz targets call these with what the fuzzer invents, the tests
//! with the inputs that are kept in `fuzz/corpus`.
//!
//! Each panics where its property does not hold.

mod checks;
mod drive;
mod requests;

use pneudrive_controller::Config;
use pneudrive_protocol::{
    Accumulator, MAX_FRAME, MAX_MESSAGE, Message, decode_reply, decode_request, encode, frame,
};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Accuracy, Plant, Rig};

pub use drive::{Step, requests};

/// The decoder of frames takes any stream, and finds the next whole frame behind one delimiter.
pub fn frame(stream: &[u8]) {
    let mut accumulator: Accumulator = Accumulator::new();
    for &byte in stream {
        if let Some(Ok(message)) = accumulator.push(byte) {
            let mut frame = [0; MAX_FRAME];
            assert!(frame::encode(message, &mut frame).is_some(), "a message that was sent can be sent");
        }
    }
    let mut next = [0; MAX_FRAME];
    let next = frame::encode(b"next", &mut next).expect("a short message");
    let after = [&[0], next].concat();
    let found = after.iter().filter_map(|&byte| accumulator.push(byte).map(|taken| taken == Ok(b"next")));
    assert_eq!(found.last(), Some(true), "the frame behind the delimiter is found");
}

/// A request or reply that is understood says the same again when it is sent on.
pub fn message(message: &[u8]) {
    if message.len() > MAX_MESSAGE {
        return;
    }
    if let Ok(request) = decode_request(message) {
        assert_eq!(decode_request(&sent(&request)), Ok(request));
    }
    if let Ok(reply) = decode_reply(message) {
        assert_eq!(decode_reply(&sent(&reply)), Ok(reply));
    }
}

/// A message as its receiver has it.
fn sent(message: &impl Message) -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    let frame = encode(message, &mut out).expect("what came in a frame fits one");
    let mut accumulator: Accumulator = Accumulator::new();
    let mut bytes = std::iter::once(&0).chain(frame);
    let whole = bytes.find_map(|&byte| accumulator.push(byte)?.ok().map(<[u8]>::to_vec));
    whole.expect("a whole frame")
}

/// A TARGET file that is read is the one that would be written.
pub fn target_file(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(file) = TargetFile::from_text(text) {
        let again = TargetFile::from_text(&file.to_text()).expect("a file that was written");
        assert_eq!(again, file);
    }
}

/// A rig that exists is valid: a controller and a plant can be made of it, and its plant can be sampled.
pub fn rig_file(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match Rig::read("fuzz", text) {
        Ok(rig) => {
            Config::new(&rig.parameters()).expect("a consistent controller");
            let _ = rig.sequence();
            let _ = Plant::new(&rig, Accuracy::of(&rig), 0).sample();
        }
        Err(problems) => assert!(!problems.to_string().is_empty(), "a refusal says why"),
    }
}
