//! The half that talks: frames in, one reply for each request.
//!
//! Every request is carried out or refused in one go, and answered with its own sequence number;
//! the host asks again for what it has not heard. Nothing here waits: a reply is written, and that
//! is all. Unasked go the rows of a [`Stream`](crate::stream) alone.

use core::borrow::BorrowMut;

use embedded_io::Write;
use pneudrive_controller::parameters::SetError;
use pneudrive_controller::sequencer::{Arrival, SequenceError};
use pneudrive_controller::{Mode, Move};
use pneudrive_protocol::{
    self as protocol, Accumulator, CHUNK_SAMPLES, CURRENT_VERSION, ConfigState, Event, MAX_EVENTS, MAX_FRAME,
    MAX_ROWS, MAX_VALUES, MIN_VERSION, Motion, Recent, RecordInfo, RecordedSample, Refused, Reply, ReplyBody,
    Request, RequestBody, Status, StreamedSample, UNTIL_STOPPED, Values, decode_request, encode_and_know,
    frame,
};

use crate::board::Board;
use crate::configuration::{Configuration, Source};
use crate::control::{ChangeError, Control, MoveError, SaveRefused, Test};
use crate::recorder::{CAPACITY, Recorder};
use crate::repetition::CarriedOut;
use crate::store::Store;
use crate::stream::Stream;

/// Version of the firmware, as `info` and TARGET files have it.
pub const FIRMWARE: &str = concat!("pneudrive ", env!("CARGO_PKG_VERSION"));

/// Messages of its own that it knows again: more than a line that brings them back holds.
const SAID: usize = 16;

/// Where a reply ends in [`Server::reply`], and its CRC; None: nothing is to be said.
type Framed = Option<(usize, u32)>;

/// The protocol server.
#[derive(Debug)]
pub struct Server {
    accumulator: Accumulator,
    /// The last request, by its CRC, and its reply.
    answered: Option<(u32, Framed)>,
    carried_out: CarriedOut,
    said: Recent<SAID>,
    reply: [u8; MAX_FRAME],
    stream: Stream,
}

impl Default for Server {
    fn default() -> Self {
        Server {
            accumulator: Accumulator::new(),
            answered: None,
            carried_out: CarriedOut::default(),
            said: Recent::default(),
            reply: [0; MAX_FRAME],
            stream: Stream::default(),
        }
    }
}

/// Room for what a reply borrows.
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
    /// own replies is nothing of the host's.
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
        for &byte in bytes {
            let damaged = self.accumulator.damaged;
            let Some(Ok(message)) = self.accumulator.push(byte) else { continue };
            let crc32 = frame::crc32(message);
            if self.said.holds(crc32) {
                continue;
            }
            control.host_heard(board);
            let framed = match self.answered {
                Some((answered, framed)) if answered == crc32 => framed,
                _ if self.carried_out.has(message, crc32) => continue,
                _ => answer(message, control, board, damaged, &mut self.stream, &mut self.reply),
            };
            self.answered = Some((crc32, framed));
            if let Some((len, crc32)) = framed {
                self.said.add(crc32);
                port.write_all(self.reply.get(..len).unwrap_or(&[]))?;
            }
        }
        Ok(())
    }

    /// What is to be done between two samples: a row of the stream is gathered, and the CRC of a finished
    /// record goes on. Changes nothing else.
    pub fn attend(&mut self, control: &mut Control<impl BorrowMut<Recorder>>) {
        self.stream.observe(control.state().observation());
        let _ = digest(control, DIGEST_BETWEEN);
    }

    /// Whether the stream waits for its host ([`Stream::is_full`]).
    #[must_use]
    pub fn waits_for_host(&self) -> bool {
        self.stream.is_full()
    }

    /// Writes what is due unasked: one frame at most. To be called when the port has room for it.
    ///
    /// # Errors
    /// When the port does not take it.
    pub fn speak<W: Write>(&mut self, port: &mut W) -> Result<(), W::Error> {
        let mut scratch = SCRATCH;
        let Some((sequence, body)) = self.stream.due(&mut scratch) else { return Ok(()) };
        let mut frame = [0; MAX_FRAME];
        let framed = encode_and_know(&Reply { sequence, body }, &mut frame);
        let Some((frame, crc32)) = framed else { return Ok(()) };
        self.said.add(crc32);
        port.write_all(frame)
    }
}

/// Carries out the request in a message and frames its reply; none for a message that does not even have
/// a number to answer under.
fn answer<B: Board>(
    message: &[u8],
    control: &mut Control<impl BorrowMut<Recorder>>,
    board: &mut B,
    damaged_frames: u32,
    stream: &mut Stream,
    frame: &mut [u8; MAX_FRAME],
) -> Framed {
    let mut scratch = SCRATCH;
    let reply = match decode_request(message) {
        Ok(request) => Reply {
            sequence: request.sequence,
            body: carry_out(&request, control, board, damaged_frames, stream, &mut scratch),
        },
        Err(error) => match error.sequence {
            Some(sequence) => Reply { sequence, body: ReplyBody::Refused(Refused::Unknown) },
            None => return None,
        },
    };
    encode_and_know(&reply, frame).map(|(frame, crc32)| (frame.len(), crc32))
}

fn carry_out<'a, B: Board>(
    request: &Request<'a>,
    control: &'a mut Control<impl BorrowMut<Recorder>>,
    board: &'a mut B,
    damaged_frames: u32,
    stream: &mut Stream,
    scratch: &'a mut Scratch,
) -> ReplyBody<'a> {
    match request.body {
        RequestBody::Info => ReplyBody::Info {
            min_version: MIN_VERSION,
            version: CURRENT_VERSION,
            firmware: FIRMWARE,
            build: board.build(),
            board: board.name(),
            record_capacity: CAPACITY as u32,
        },
        RequestBody::Status => ReplyBody::Status(status(control, damaged_frames)),
        RequestBody::ConfigGet { first_id, count } => config(control, first_id, count, scratch),
        RequestBody::ConfigSet { first_id, values } => {
            done(control.set_parameters(first_id, values.iter()).map_err(|(id, error)| {
                let place = usize::from(id.saturating_sub(first_id));
                change_refused(id, values.iter().nth(place).unwrap_or(0), error)
            }))
        }
        RequestBody::Arm => done(control.arm(board).map_err(not_now)),
        RequestBody::Disarm => {
            control.disarm();
            ReplyBody::Done
        }
        RequestBody::Start => done(control.start(board).map_err(not_now)),
        RequestBody::Stop => {
            control.stop();
            ReplyBody::Done
        }
        RequestBody::Reference { position_counts } => {
            done(control.reference(position_counts).map_err(not_now))
        }
        RequestBody::TestBegin { name, duration_us, decimation, pre_trigger } => {
            let last_sample = duration_us / control.config().timing.period_us;
            done(control.set_test(Test::new(name, last_sample, decimation, pre_trigger)).map_err(not_now))
        }
        RequestBody::TestMove { time_us, target } => {
            let next = Move::at_time_us(time_us, control.config().timing.period_us, target);
            done(control.push_move(next).map_err(move_refused))
        }
        RequestBody::TestSpan { last_sample, .. } if last_sample > UNTIL_STOPPED => {
            ReplyBody::Refused(Refused::TestTooLong)
        }
        RequestBody::TestSpan { last_sample, round } => {
            done(control.set_span(last_sample, round).map_err(move_refused))
        }
        RequestBody::Home => done(control.home(board).map_err(not_now)),
        RequestBody::Motion => ReplyBody::Motion(motion(control)),
        RequestBody::ConfigSave => done(control.save_parameters(board).map_err(|refused| match refused {
            SaveRefused::NotNow(refusal) => not_now(refusal),
            SaveRefused::NotStored => Refused::NotStored,
        })),
        RequestBody::ConfigState => ReplyBody::ConfigState(config_state(control.configuration())),
        RequestBody::Events { first, count } => events(board.store(), first, count, scratch),
        RequestBody::Timing => {
            let [interval, latency] = control.timing();
            ReplyBody::Timing { interval, latency }
        }
        RequestBody::RecordInfo => record_info(control),
        RequestBody::RecordRead { first, count } => chunk(control, first, count, scratch),
        RequestBody::RecordChunk { crc32, first, count } => match digest(control, 0) {
            Some(crc) if crc == crc32 => chunk(control, first, count, scratch),
            _ => ReplyBody::Refused(Refused::OtherRecord),
        },
        RequestBody::StreamBegin { every, batch } => {
            stream.begin(request.sequence, every, batch);
            ReplyBody::Done
        }
        RequestBody::StreamGrant { until } => {
            stream.grant(until);
            ReplyBody::Done
        }
        RequestBody::StreamRead { first, count } => stream.read(first, count, scratch),
    }
}

fn done<'a>(result: Result<(), Refused<'a>>) -> ReplyBody<'a> {
    match result {
        Ok(()) => ReplyBody::Done,
        Err(refused) => ReplyBody::Refused(refused),
    }
}

fn not_now<'a>(refusal: pneudrive_controller::Refusal) -> Refused<'a> {
    Refused::NotNow(refusal.code())
}

fn move_refused<'a>(error: MoveError) -> Refused<'a> {
    match error {
        MoveError::Refused(refusal) => not_now(refusal),
        MoveError::Sequence(SequenceError::Full) => Refused::TooManyMoves,
        MoveError::Sequence(SequenceError::OutOfOrder) => Refused::MovesOutOfOrder,
    }
}

fn change_refused<'a>(id: u16, value: i32, error: ChangeError) -> Refused<'a> {
    match error {
        ChangeError::Refused(refusal) => not_now(refusal),
        ChangeError::Value(SetError::UnknownId) => Refused::UnknownParameter { id },
        ChangeError::Value(SetError::OutOfRange) => Refused::OutOfRange { id, value },
        ChangeError::Inconsistent(error) => Refused::Inconsistent { advice: error.advice() },
    }
}

fn status(control: &Control<impl BorrowMut<Recorder>>, damaged_frames: u32) -> Status {
    let (state, seen) = (control.state(), control.state().observation());
    let (mode, fault) = match state.supervisor.mode() {
        Mode::Disarmed => (protocol::Mode::Disarmed, 0),
        Mode::Armed => (protocol::Mode::Armed, 0),
        Mode::Running => (protocol::Mode::Running, 0),
        Mode::Done => (protocol::Mode::Done, 0),
        // Version 1 has no word for it; `Motion` of version 2 has.
        Mode::Homing => (protocol::Mode::Running, 0),
        Mode::Fault(fault) => (protocol::Mode::Fault, fault.code()),
    };
    Status {
        mode,
        fault,
        referenced: state.supervisor.is_referenced(),
        index: seen.index,
        duration_samples: control.test().sequence().duration_samples,
        setpoint: seen.setpoint,
        position: seen.position,
        error: seen.error,
        command: seen.command,
        pressure_1: seen.pressure_1,
        pressure_2: seen.pressure_2,
        spool: seen.spool,
        recorded: control.recorder.borrow().len() as u32,
        damaged_frames,
    }
}

fn motion(control: &Control<impl BorrowMut<Recorder>>) -> Motion {
    let (state, moves) = (control.state(), control.state().sequencer());
    Motion {
        homing: state.supervisor.mode() == Mode::Homing,
        arrival: match moves.arrival() {
            Arrival::Idle => 0,
            Arrival::Moving => 1,
            Arrival::Arrived => 2,
            Arrival::NotReached => 3,
        },
        begun: u16::try_from(moves.begun(control.test().sequence())).unwrap_or(u16::MAX),
        not_reached: moves.not_reached(),
        learned_null_offset: state.learned_null_offset(),
    }
}

fn config_state(configuration: &Configuration) -> ConfigState {
    ConfigState {
        source: match configuration.source() {
            Source::NeverSaved => 0,
            Source::Stored => 1,
            Source::TakenOver => 2,
            Source::Damaged => 3,
        },
        saves: configuration.saves(),
        hash: configuration.hash(),
        saved: configuration.is_saved(),
        ignored: configuration.ignored(),
    }
}

fn events<'a>(store: &impl Store, first: u8, count: u8, room: &'a mut [u8]) -> ReplyBody<'a> {
    let total = store.events();
    let wanted = usize::from(first)..usize::from(first) + usize::from(count).min(MAX_EVENTS);
    let mut bytes = 0;
    for (slot, event) in room.chunks_exact_mut(Event::BYTES).zip(wanted.filter_map(|nth| store.event(nth))) {
        slot.copy_from_slice(&event.to_bytes());
        bytes += Event::BYTES;
    }
    ReplyBody::Events { total: total as u8, first, events: room.get(..bytes).unwrap_or(&[]) }
}

fn config<'a>(
    control: &Control<impl BorrowMut<Recorder>>,
    first_id: u16,
    count: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let count = usize::from(count).min(MAX_VALUES) as u16;
    let ids = first_id..first_id.saturating_add(count);
    if let Some(id) = ids.clone().find(|&id| control.parameters().get(id).is_none()) {
        return ReplyBody::Refused(Refused::UnknownParameter { id });
    }
    let values = ids.filter_map(|id| control.parameters().get(id));
    match Values::fill(room, values) {
        Some(values) => ReplyBody::Config { first_id, values },
        None => ReplyBody::Refused(Refused::UnknownParameter { id: first_id }),
    }
}

/// Samples that one `RecordInfo` takes into the CRC of the record; the host asks until all are in. A drive
/// that holds its last setpoint goes on sampling meanwhile, and a request must not make a sample late.
const DIGEST_AT_ONCE: usize = 64;

/// Those that it goes on by between two samples, so that the CRC is mostly there when it is asked for.
const DIGEST_BETWEEN: usize = 8;

/// Goes on with the CRC of a record that is over, and tells it once it is there.
fn digest(control: &mut Control<impl BorrowMut<Recorder>>, samples: usize) -> Option<u32> {
    let over = !matches!(control.state().supervisor.mode(), Mode::Armed | Mode::Running);
    if over { control.recorder.borrow_mut().digest(samples) } else { None }
}

fn record_info(control: &mut Control<impl BorrowMut<Recorder>>) -> ReplyBody<'_> {
    let crc = digest(control, DIGEST_AT_ONCE);
    let measured_period_ns = control.measured_period_ns();
    let recorder: &Recorder = control.recorder.borrow();
    ReplyBody::RecordInfo(RecordInfo {
        test: control.test().name(),
        samples: recorder.len() as u32,
        first_index: recorder.first_index(),
        decimation: recorder.decimation() as u16,
        pre_trigger: recorder.pre_trigger(),
        complete: crc.is_some(),
        measured_period_ns,
        mean_spool_raw: recorder.mean_spool(),
        crc32: crc.unwrap_or(0),
    })
}

fn chunk<'a>(
    control: &Control<impl BorrowMut<Recorder>>,
    first: u32,
    count: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let recorder: &Recorder = control.recorder.borrow();
    if recorder.is_empty() {
        return ReplyBody::Refused(Refused::NoRecord);
    }
    let samples = recorder.len() as u32;
    let end = first.saturating_add(u32::from(count).min(CHUNK_SAMPLES as u32));
    if count == 0 || end > samples {
        return ReplyBody::Refused(Refused::RecordRange { samples });
    }
    let mut bytes = 0;
    for (slot, i) in room.chunks_exact_mut(RecordedSample::BYTES).zip(first..end) {
        if let Some(stored) = recorder.get(i as usize) {
            slot.copy_from_slice(stored);
            bytes += RecordedSample::BYTES;
        }
    }
    ReplyBody::Chunk { first, samples: room.get(..bytes).unwrap_or(&[]) }
}
