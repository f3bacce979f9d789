//! Listens to the line to the host, like a logic analyser, for the start of a run or a homing run.
//!
//! A simulated plant is frozen between runs and reset for each, so that a record does not depend on when the requests
//! came. No pin of the board signals the start of a run, but the reply to its request does.

use pneudrive_protocol::{Accumulator, ReplyBody, RequestBody, decode_reply, decode_request, frame};

/// What has begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begun {
    /// A run of the test: the next sample is its first.
    Run,
    /// A homing run, or what the inputs start: the plant goes on as it stands.
    Homing,
}

/// A request to begin something.
struct Asked {
    crc32: u32,
    sequence: u16,
    what: Begun,
}

/// Requests that are remembered: a host has no more on their way.
const REMEMBERED: usize = 64;

/// Listens to both directions.
#[derive(Default)]
pub struct Tap {
    requests: Accumulator,
    replies: Accumulator,
    asked: Vec<Asked>,
    /// Requests that were carried out: what comes of them again is a repetition.
    granted: Vec<u32>,
}

impl Tap {
    /// A byte of the host, as the board hears it; whether a whole request has come with it.
    pub fn request(&mut self, byte: u8) -> bool {
        let Some(Ok(message)) = self.requests.push(byte) else { return false };
        let Ok(request) = decode_request(message) else { return false };
        let what = match request.body {
            RequestBody::Start { .. } => Begun::Run,
            RequestBody::Home => Begun::Homing,
            _ => return true,
        };
        let (crc32, sequence) = (frame::crc32(message), request.sequence);
        if !self.granted.contains(&crc32) {
            self.asked.push(Asked { crc32, sequence, what });
            self.asked.drain(..self.asked.len().saturating_sub(REMEMBERED));
        }
        true
    }

    /// What the board sends; what has begun with it.
    pub fn reply(&mut self, bytes: &[u8]) -> Option<Begun> {
        bytes.iter().filter_map(|&byte| self.reply_byte(byte)).last()
    }

    fn reply_byte(&mut self, byte: u8) -> Option<Begun> {
        let message = self.replies.push(byte)?.ok()?;
        let reply = decode_reply(message).ok()?;
        let place = self.asked.iter().position(|asked| asked.sequence == reply.sequence)?;
        let Asked { crc32, what, .. } = self.asked.remove(place);
        if reply.body != ReplyBody::Done {
            return None;
        }
        // A copy that was on its way already is carried out no more than one that comes later.
        self.asked.retain(|asked| asked.crc32 != crc32);
        self.granted.push(crc32);
        self.granted.drain(..self.granted.len().saturating_sub(REMEMBERED));
        Some(what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_protocol::{MAX_FRAME, Reply, Request, RequestRefusal, encode};

    const START: RequestBody<'_> = RequestBody::Start { crc32: 1 };

    fn request(tap: &mut Tap, sequence: u16, body: RequestBody<'_>) {
        let (mut bytes, request) = ([0; MAX_FRAME], Request { sequence, session: 1005, boot: 1, body });
        let framed = encode(&request, &mut bytes).expect("room");
        let whole = framed.iter().filter(|&&byte| tap.request(byte)).count();
        assert_eq!(whole, 1, "at its last byte");
    }

    fn reply(tap: &mut Tap, sequence: u16, body: ReplyBody<'_>) -> Option<Begun> {
        let mut bytes = [0; MAX_FRAME];
        tap.reply(encode(&Reply { sequence, body }, &mut bytes).expect("room"))
    }

    #[test]
    fn a_run_begins_with_the_reply_to_its_request_and_once() {
        let mut tap = Tap::default();
        request(&mut tap, 7, START);
        assert_eq!(reply(&mut tap, 6, ReplyBody::Done), None);
        assert_eq!(reply(&mut tap, 7, ReplyBody::Done), Some(Begun::Run));
        request(&mut tap, 7, START);
        assert_eq!(reply(&mut tap, 7, ReplyBody::Done), None, "a repetition");
    }

    #[test]
    fn a_request_that_was_repeated_before_its_reply_begins_one_run() {
        let mut tap = Tap::default();
        request(&mut tap, 7, START);
        request(&mut tap, 7, START);
        assert_eq!(reply(&mut tap, 7, ReplyBody::Done), Some(Begun::Run));
        assert_eq!(reply(&mut tap, 7, ReplyBody::Done), None, "the reply to the copy");
    }

    #[test]
    fn a_request_that_noise_has_hit_is_none() {
        let (mut tap, mut bytes) = (Tap::default(), [0; MAX_FRAME]);
        let request = Request { sequence: 7, session: 1005, boot: 1, body: START };
        let mut framed = encode(&request, &mut bytes).expect("room").to_vec();
        framed[2] ^= 0x10;
        assert!(!framed.iter().any(|&byte| tap.request(byte)));
        assert_eq!(reply(&mut tap, 7, ReplyBody::Done), None);
    }

    #[test]
    fn a_run_that_is_refused_does_not_begin() {
        let mut tap = Tap::default();
        request(&mut tap, 7, RequestBody::Home);
        assert_eq!(reply(&mut tap, 7, ReplyBody::Refused(RequestRefusal::NotNow(1))), None);
        request(&mut tap, 8, RequestBody::Home);
        assert_eq!(reply(&mut tap, 8, ReplyBody::Done), Some(Begun::Homing));
    }
}
