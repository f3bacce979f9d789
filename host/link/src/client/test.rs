//! The test that a rig has.

use anyhow::{Result, anyhow};
use pneudrive_app::moves::meant;
use pneudrive_controller::Sequence;
use pneudrive_protocol::{ProfiledMove, ReplyBody, RequestBody};

use super::Client;
use super::answer::unexpected;

/// The content of one answer about a test: its last sample, its round, the number of its moves, and some of them.
struct Part {
    last_sample: u32,
    round: u32,
    total: u8,
    moves: Vec<u8>,
}

impl Client {
    /// The rig's test as it was last downloaded.
    ///
    /// # Errors
    /// When the rig does not answer, or says what is no test.
    pub fn test(&mut self) -> Result<Sequence> {
        let head = self.test_part(0)?;
        let mut sequence = Sequence::new(head.last_sample);
        sequence.repeat_every(head.round).map_err(|_| self.no_test())?;
        let total = head.total;
        let mut part = head;
        loop {
            for bytes in part.moves.chunks(ProfiledMove::BYTES) {
                let next = ProfiledMove::from_bytes(bytes).and_then(|told| meant(&told));
                sequence.push(next.ok_or_else(|| self.no_test())?).map_err(|_| self.no_test())?;
            }
            let known = sequence.moves().len() as u8;
            if known >= total {
                return Ok(sequence);
            }
            part = self.test_part(known)?;
            if part.moves.is_empty() {
                return Err(self.no_test());
            }
        }
    }

    fn test_part(&mut self, from: u8) -> Result<Part> {
        self.ask(RequestBody::TestRead { first: from }, |reply| match *reply {
            ReplyBody::Test { last_sample, round, total, first, moves } if first == from => {
                Ok(Part { last_sample, round, total, moves: moves.to_vec() })
            }
            ref other => Err(unexpected(other)),
        })
    }

    fn no_test(&self) -> anyhow::Error {
        anyhow!("{}: what it says of its test is no test; update its firmware or this program", self.name)
    }
}
