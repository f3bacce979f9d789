//! A program connected to the rig: its link, its pending bytes, and whether it is admitted.

use std::convert::Infallible;
use std::fmt;
use std::io::{self, Read, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use pneudrive_app::{Board, Control, Server};
use pneudrive_link::port::{is_wait, read_some};
use pneudrive_protocol::{
    Accumulator, MAX_FRAME, MAX_TEXT, Reply, ReplyBody, RequestBody, RequestRefusal, code, decode_request,
    encode,
};
use subtle::ConstantTimeEq;

/// Bytes to and from a caller.
pub(super) trait Stream: Read + Write + Send {}

impl<T: Read + Write + Send> Stream for T {}

/// The most pending bytes of a caller: a second of the serial line. Further bytes are lost, as on that line.
const UNTAKEN: usize = 92_160;

/// How long a caller with a wrong token is kept unheard before it is sent away.
pub(super) const PAUSE: Duration = Duration::from_secs(1);

/// The shortest token, bytes.
const MIN_TOKEN: usize = 16;

/// A secret shared by a rig on a network and its programs. It keeps others out; it is sent unencrypted.
#[derive(Clone)]
pub struct Token(Arc<str>);

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(..)")
    }
}

impl Token {
    /// A token of 16 to 64 bytes.
    ///
    /// # Errors
    /// For a shorter or a longer one.
    pub fn new(text: &str) -> Result<Token> {
        if !(MIN_TOKEN..=MAX_TEXT).contains(&text.len()) {
            bail!("a token must have {MIN_TOKEN} to {MAX_TEXT} bytes; this one has {}", text.len());
        }
        Ok(Token(text.into()))
    }

    /// Whether another token is the same, in a time that depends only on the length.
    fn is(&self, other: &str) -> bool {
        self.0.as_bytes().ct_eq(other.as_bytes()).into()
    }
}

/// A caller with its own server.
pub(super) struct Caller {
    port: Box<dyn Stream>,
    pub(super) server: Server,
    gate: Gate,
    untaken: Vec<u8>,
    /// When it came.
    pub(super) came: Instant,
    /// When it was heard last.
    pub(super) heard: Instant,
}

/// How far a caller has come.
enum Gate {
    /// It must show the token.
    Waits(Token, Box<Accumulator>),
    /// It has shown a wrong one then, and is not heard any more.
    Shut(Instant),
    /// It is let in.
    Open,
}

impl Caller {
    /// A caller that must first send the token, if there is one.
    pub(super) fn new(port: impl Stream + 'static, token: Option<Token>) -> Caller {
        let gate = token.map_or(Gate::Open, |token| Gate::Waits(token, Box::new(Accumulator::new())));
        let (came, heard) = (Instant::now(), Instant::now());
        Caller { port: Box::new(port), server: Server::default(), gate, untaken: Vec::new(), came, heard }
    }

    /// Whether it is let in.
    pub(super) fn is_in(&self) -> bool {
        matches!(self.gate, Gate::Open)
    }

    /// Executes the requests that have arrived, and returns their number of bytes. An error if the caller has gone, or has
    /// shown a wrong token a while ago.
    pub(super) fn hear(&mut self, control: &mut Control, board: &mut impl Board) -> io::Result<usize> {
        if let Gate::Shut(since) = self.gate {
            let is_over = since.elapsed() >= PAUSE;
            return if is_over { Err(io::ErrorKind::PermissionDenied.into()) } else { Ok(0) };
        }
        let mut bytes = [0; 1024];
        let count = read_some(&mut *self.port, &mut bytes)?;
        if count > 0 {
            self.heard = Instant::now();
        }
        let (mut asks, mut replies) = (&bytes[..count], Vec::new());
        while let (false, Some((&byte, rest))) = (self.is_in(), asks.split_first()) {
            self.knock(byte, &mut replies);
            asks = rest;
        }
        let Ok(()) = self.server.receive(asks, control, board, &mut replies);
        self.leave_for_it(&replies);
        Ok(count)
    }

    /// Takes a byte of a caller that is not admitted yet.
    fn knock(&mut self, byte: u8, replies: &mut Vec<u8>) {
        let Gate::Waits(token, accumulator) = &mut self.gate else { return };
        let Some(Ok(message)) = accumulator.push(byte) else { return };
        let Ok(request) = decode_request(message) else { return };
        let knows = match request.body {
            RequestBody::Token { token: sent } if token.is(sent) => true,
            RequestBody::Token { .. } => {
                self.gate = Gate::Shut(Instant::now());
                return;
            }
            _ => false,
        };
        let body =
            if knows { ReplyBody::Done } else { ReplyBody::Refused(RequestRefusal::NotNow(code::TOKEN)) };
        let mut frame = [0; MAX_FRAME];
        replies.extend(encode(&Reply { sequence: request.sequence, body }, &mut frame).unwrap_or(&[]));
        if knows {
            self.gate = Gate::Open;
        }
    }

    /// Queues replies and rows for the caller, if there is room.
    fn leave_for_it(&mut self, replies: &[u8]) {
        if self.untaken.len() + replies.len() <= UNTAKEN {
            self.untaken.extend_from_slice(replies);
        }
    }

    /// Queues the unsolicited rows that are due, and writes as much as the caller accepts without blocking.
    pub(super) fn speak(&mut self) -> io::Result<()> {
        let mut rows = Vec::new();
        let mut sent = None;
        // Many samples may have been taken since the last call.
        while sent != Some(rows.len()) {
            sent = Some(rows.len());
            let spoken: Result<(), Infallible> = self.server.speak(&mut rows);
            let Ok(()) = spoken;
        }
        self.leave_for_it(&rows);
        self.write()
    }

    fn write(&mut self) -> io::Result<()> {
        while !self.untaken.is_empty() {
            match self.port.write(&self.untaken) {
                Ok(0) => break,
                Ok(count) => drop(self.untaken.drain(..count)),
                Err(error) if is_wait(&error) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_neither_short_nor_long_and_not_shown() {
        assert!(Token::new(&"x".repeat(15)).is_err() && Token::new(&"x".repeat(65)).is_err());
        let token = Token::new("a secret of some length").expect("long enough");
        assert_eq!(format!("{token:?}"), "Token(..)");
        assert!(token.is("a secret of some length"));
        assert!(!token.is("a secret of some lengtH") && !token.is("a secret") && !token.is(""));
    }
}
