//! The half that talks: one reply for each request.
//!
//! Every request is carried out or refused before the next one, and answered with its own sequence number. The host
//! repeats a request whose answer it has not received. Nothing here waits: a reply is written, and that is all. Only
//! the rows of a [`Stream`](crate::stream) go out unasked. A change of the drive happens in one piece, between two
//! control interrupts. A long read happens in several.

mod answers;
mod requests;

use core::borrow::BorrowMut;

use embedded_io::Write;
use pneudrive_protocol::session::NOBODY;
use pneudrive_protocol::{
    Accumulator, CHUNK_SAMPLES, Event, MAX_EVENTS, MAX_FRAME, MAX_ROWS, MAX_VALUES, MessageError,
    RecordedSample, Reply, ReplyBody, Request, RequestRefusal, StreamedSample, decode_request, encode_reply,
    frame,
};

use answers::{DIGEST_BETWEEN, digest};
use requests::carry_out;

use crate::board::Board;
use crate::change::Parts;
use crate::control::Control;
use crate::duplicate_filter::DuplicateFilter;
use crate::log::log_refusal;
use crate::recorder::Recorder;
use crate::shared_drive::SharedDrive;
use crate::store::Store;
use crate::stream::Stream;

/// Version of the firmware, as `info` and TARGET files have it.
pub const FIRMWARE: &str = concat!("pneudrive ", env!("CARGO_PKG_VERSION"));

/// The protocol server.
#[derive(Clone, Debug)]
pub struct Server {
    accumulator: Accumulator,
    /// The last request, by its CRC, and where its reply ends in `reply`.
    answered: Option<(u32, usize)>,
    duplicates: DuplicateFilter,
    reply: [u8; MAX_FRAME],
    talk: Talk,
    /// The session that has asked last.
    session: u32,
}

/// Work that takes more than one request.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
struct Talk {
    stream: Stream,
    change: Parts,
}

impl Server {
    /// All that it knows, but for bytes of replies before the last one.
    fn known(&self) -> impl PartialEq + core::hash::Hash + '_ {
        let Server { accumulator, answered, duplicates, reply, talk, session } = self;
        let len = answered.map_or(0, |(_, len)| len);
        (accumulator, answered, duplicates, reply.get(..len), talk, session)
    }
}

/// Two are equal if they give the same results from any further requests. Remains of earlier replies do not count.
impl PartialEq for Server {
    fn eq(&self, other: &Server) -> bool {
        self.known() == other.known()
    }
}

impl Eq for Server {}

impl core::hash::Hash for Server {
    fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
        self.known().hash(state);
    }
}

impl Default for Server {
    fn default() -> Self {
        Server {
            accumulator: Accumulator::new(),
            answered: None,
            duplicates: DuplicateFilter::default(),
            reply: [0; MAX_FRAME],
            talk: Talk::default(),
            session: NOBODY,
        }
    }
}

/// Room for the data that a reply borrows.
type Scratch = [u8; RecordedSample::BYTES * CHUNK_SAMPLES];

/// Nothing yet.
const SCRATCH: Scratch = [0; RecordedSample::BYTES * CHUNK_SAMPLES];

const _: () = {
    assert!(4 * MAX_VALUES <= SCRATCH.len());
    assert!(Event::BYTES * MAX_EVENTS <= SCRATCH.len());
    assert!(StreamedSample::BYTES * MAX_ROWS <= SCRATCH.len());
};

impl Server {
    /// Takes bytes from the port, carries out the requests in them and writes the replies.
    ///
    /// A request that comes twice, because its reply was lost, is carried out once and answered
    /// twice. One that changes something and comes again after later ones is not even answered: the host
    /// has had its answer, and an old `arm` must not follow on a `disarm`. What the line brings back of its
    /// own replies is no request.
    ///
    /// # Errors
    /// When the port does not take a reply.
    pub fn receive<B: Board, W: Write>(
        &mut self,
        bytes: &[u8],
        control: &mut Control<impl BorrowMut<Recorder>>,
        board: &mut B,
        port: &mut W,
    ) -> Result<(), W::Error> {
        self.receive_beside(bytes, &mut (control, board), port)
    }

    /// The same while an interrupt controls the drive: it is locked for short pieces of a request.
    ///
    /// # Errors
    /// When the port does not take a reply.
    pub fn receive_beside<W: Write>(
        &mut self,
        bytes: &[u8],
        drive: &mut impl SharedDrive,
        port: &mut W,
    ) -> Result<(), W::Error> {
        for &byte in bytes {
            let damaged = self.accumulator.damaged;
            let Some(Ok(message)) = self.accumulator.push(byte) else { continue };
            let (crc32, request) = (frame::crc32(message), decode_request(message));
            let of_this_boot = request.ok().filter(|request| is_heard(request, drive));
            if let Some(now) = of_this_boot {
                self.session = now.session;
            }
            let len = match self.answered {
                Some((answered, len)) if answered == crc32 => len,
                _ if of_this_boot.is_some_and(|now| self.duplicates.is_duplicate(&now, crc32)) => continue,
                _ => match answer(&request, drive, damaged, &mut self.talk, &mut self.reply) {
                    Some(len) => len,
                    None => continue,
                },
            };
            self.answered = Some((crc32, len));
            port.write_all(self.reply.get(..len).unwrap_or(&[]))?;
        }
        Ok(())
    }

    /// The work between two samples: a row of the stream is gathered, and the CRC of a finished record continues.
    /// Nothing else changes.
    pub fn attend(&mut self, control: &mut Control<impl BorrowMut<Recorder>>) {
        self.talk.stream.observe(control.state().observation());
        let _ = digest(control, DIGEST_BETWEEN);
    }

    /// Frames that were damaged on the line.
    pub(crate) fn damaged_frames(&self) -> u32 {
        self.accumulator.damaged
    }

    /// The session that has asked last.
    #[must_use]
    pub fn session(&self) -> u32 {
        self.session
    }

    /// The link to the host is closed, where a link can be: an owner at its end has gone.
    pub fn host_goes(&self, control: &mut Control<impl BorrowMut<Recorder>>) {
        if self.session != NOBODY {
            control.host_leaves(self.session);
        }
    }

    /// Whether the stream waits for its host ([`Stream::is_full`]).
    #[must_use]
    pub fn waits_for_host(&self) -> bool {
        self.talk.stream.is_full()
    }

    /// Writes the frame that is due unasked: one at most. Call it when the port has room for it.
    ///
    /// # Errors
    /// When the port does not take it.
    pub fn speak<W: Write>(&mut self, port: &mut W) -> Result<(), W::Error> {
        let mut scratch = SCRATCH;
        let Some((sequence, body)) = self.talk.stream.due(&mut scratch) else { return Ok(()) };
        let mut frame = [0; MAX_FRAME];
        port.write_all(encode_reply(&Reply { sequence, body }, &mut frame).unwrap_or(&[]))
    }
}

/// Whether a request is meant for this boot: its host is there, then. One that was meant for another boot is no sign of
/// that, nor does it change anything.
fn is_heard(request: &Request<'_>, drive: &mut impl SharedDrive) -> bool {
    drive.lock(|control, board| {
        let of_this_boot = request.boot == board.store().boot();
        if of_this_boot {
            control.host_heard(request.session, request.sequence, board);
        }
        of_this_boot
    })
}

/// Carries out a request and frames its reply: its length. None for what is not even a request.
fn answer(
    request: &Result<Request<'_>, MessageError>,
    drive: &mut impl SharedDrive,
    damaged_frames: u32,
    talk: &mut Talk,
    frame: &mut [u8; MAX_FRAME],
) -> Option<usize> {
    let mut scratch = SCRATCH;
    let reply = match request {
        Ok(request) => Reply {
            sequence: request.sequence,
            body: carry_out(request, drive, damaged_frames, talk, &mut scratch),
        },
        Err(MessageError { sequence }) => {
            Reply { sequence: (*sequence)?, body: ReplyBody::Refused(RequestRefusal::Unknown) }
        }
    };
    if let ReplyBody::Refused(refused) = &reply.body {
        log_refusal(refused);
    }
    encode_reply(&reply, frame).map(<[u8]>::len)
}
